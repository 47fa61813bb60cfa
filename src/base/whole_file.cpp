#include "base/whole_file.hpp"

#include "base/error.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>

namespace knap {
namespace fs = std::filesystem;
namespace {

OutputError cannot_write(const fs::path& path, int error) {
    return OutputError("cannot write " + path.string() + ": " + std::strerror(error));
}

/// Errors are reported with the final name.
void write_bytes(const fs::path& path, std::string_view text, const fs::path& final_name, bool durable) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    int error = file < 0 ? errno : 0;
    while (!text.empty() && error == 0) {
        const ssize_t n = write(file, text.data(), text.size());
        if (n >= 0) text.remove_prefix(static_cast<std::size_t>(n));
        else if (errno != EINTR) error = errno;
    }
    if (durable && error == 0 && fsync(file) != 0 && errno != EINVAL && errno != EROFS) error = errno;  // those: a pipe
    if (file >= 0 && close(file) != 0 && error == 0) error = errno;
    if (error != 0) throw cannot_write(final_name, error);
}

}  // namespace

void write_whole_file(const fs::path& path, std::string_view text, bool durable) {
    write_whole_file(path, [&](const fs::path& written) { write_bytes(written, text, path, durable); });
}

void replace_whole_file(const fs::path& path, const fs::path& older, std::string_view text) {
    write_whole_file(path, [&](const fs::path& written) {
        write_bytes(written, text, path, true);
        if (std::rename(path.c_str(), older.c_str()) != 0 && errno != ENOENT) throw cannot_write(older, errno);
    });
}

void write_whole_file(const fs::path& path, const std::function<void(const fs::path&)>& write) {
    std::error_code unknown;
    if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown)) return write(path);
    const fs::path written = path.string() + ".part";
    try {
        write(written);
        if (std::rename(written.c_str(), path.c_str()) != 0) throw cannot_write(path, errno);
    } catch (...) {
        fs::remove(written, unknown);
        throw;
    }
}

std::string read_whole_file(const fs::path& path) {
    errno = 0;
    std::ifstream in(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    if (!in)
        throw OutputError("cannot read " + path.string() + (errno ? std::string(": ") + std::strerror(errno) : ""));
    return std::move(bytes).str();
}

}  // namespace knap
