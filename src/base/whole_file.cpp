#include "base/whole_file.hpp"

#include "base/error.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace knap {
namespace fs = std::filesystem;
namespace {

OutputError cannot_write(const fs::path& path, int error) {
    return OutputError("cannot write " + path.string() + ": " + std::strerror(error));
}

/// A new file of this process: what is left of an earlier one is removed, and a symbolic link is not followed.
void make_new(const fs::path& path, const fs::path& final_name) {
    if (unlink(path.c_str()) != 0 && errno != ENOENT) throw cannot_write(final_name, errno);
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file < 0 || close(file) != 0) throw cannot_write(final_name, errno);
}

/// The error of fsync or close; 0: none. Pipes, devices and some file systems have no fsync.
int error_of_sync(int file) { return fsync(file) != 0 && errno != EINVAL && errno != EROFS ? errno : 0; }

/// Errors are reported with the final name.
void write_bytes(const fs::path& path, std::string_view text, const fs::path& final_name, bool durable) {
    const int follow = path == final_name ? 0 : O_NOFOLLOW;  // /dev/stdout is a link
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | follow, 0666);
    int error = file < 0 ? errno : 0;
    while (!text.empty() && error == 0) {
        const ssize_t n = write(file, text.data(), text.size());
        if (n >= 0) text.remove_prefix(static_cast<std::size_t>(n));
        else if (errno != EINTR) error = errno;
    }
    if (durable && error == 0) error = error_of_sync(file);
    if (file >= 0 && close(file) != 0 && error == 0) error = errno;
    if (error != 0) throw cannot_write(final_name, error);
}

fs::path directory_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

}  // namespace

void write_whole_file(const fs::path& path, std::string_view text, bool durable) {
    write_whole_file(path, [&](const fs::path& written) { write_bytes(written, text, path, durable); });
    if (durable) flush_to_disk(directory_of(path));
}

void replace_whole_file(const fs::path& path, const fs::path& older, std::string_view text) {
    write_whole_file(path, [&](const fs::path& written) {
        write_bytes(written, text, path, true);
        if (std::rename(path.c_str(), older.c_str()) != 0 && errno != ENOENT) throw cannot_write(older, errno);
    });
    flush_to_disk(directory_of(path));
}

void write_whole_file(const fs::path& path, const std::function<void(const fs::path&)>& write) {
    std::error_code unknown;
    if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown)) return write(path);
    const fs::path written = path.string() + ".part";
    make_new(written, path);
    try {
        write(written);
        if (std::rename(written.c_str(), path.c_str()) != 0) throw cannot_write(path, errno);
    } catch (...) {
        fs::remove(written, unknown);
        throw;
    }
}

void flush_to_disk(const fs::path& path) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    int error = file < 0 ? errno : error_of_sync(file);
    if (file >= 0 && close(file) != 0 && error == 0) error = errno;
    if (error != 0) throw cannot_write(path, error);
}

std::string read_whole_file(const fs::path& path) {
    std::string bytes;
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    int error = file < 0 ? errno : 0;
    for (ssize_t n = 1; n != 0 && error == 0;) {
        constexpr std::size_t least = 1 << 16;
        const std::size_t done = bytes.size();
        bytes.resize(done + std::max(least, done));
        n = read(file, bytes.data() + done, bytes.size() - done);
        bytes.resize(done + static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
        if (n < 0 && errno != EINTR) error = errno;
    }
    if (file >= 0) close(file);
    if (error != 0) throw OutputError("cannot read " + path.string() + ": " + std::strerror(error));
    bytes.shrink_to_fit();
    return bytes;
}

}  // namespace knap
