#include "base/whole_file.hpp"

#include "base/checksum.hpp"
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
    return OutputError("cannot write " + path.string() + ": " + error_text(error));
}

OutputError cannot_read(const fs::path& path, int error) {
    return OutputError("cannot read " + path.string() + ": " + error_text(error));
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

namespace {

/// An open file that is read.
class Source {
public:
    explicit Source(const fs::path& path) : path_(path), file_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (file_ < 0) throw cannot_read(path_, errno);
    }
    ~Source() { close(file_); }
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;

    /// The next bytes, fewer than n at the end alone.
    std::string next(std::size_t n) {
        std::string bytes(n, '\0');
        std::size_t done = 0;
        for (ssize_t last = 1; last != 0 && done < n; done += static_cast<std::size_t>(std::max<ssize_t>(last, 0)))
            if (last = read(file_, bytes.data() + done, n - done); last < 0 && errno != EINTR)
                throw cannot_read(path_, errno);
        bytes.resize(done);
        return bytes;
    }
    void skip_to_last(std::size_t n) {
        const off_t size = lseek(file_, 0, SEEK_END);
        if (size < 0 || lseek(file_, std::max<off_t>(0, size - static_cast<off_t>(n)), SEEK_SET) < 0)
            throw cannot_read(path_, errno);
    }

private:
    const fs::path& path_;
    int file_;
};

}  // namespace

std::string read_whole_file(const fs::path& path) {
    Source source(path);
    std::string bytes;
    for (bool more = true; more;) {
        constexpr std::size_t least = 1 << 16;
        const std::size_t n = std::max(least, bytes.size());
        const std::string next = source.next(n);
        bytes += next, more = next.size() == n;
    }
    bytes.shrink_to_fit();
    return bytes;
}

std::string read_begin(const fs::path& path, std::size_t n) { return Source(path).next(n); }

std::string read_given_file(const fs::path& path, const std::string& code) {
    try {
        return read_whole_file(path);
    } catch (const OutputError& error) {
        throw UserError(code, error.what());
    }
}

std::string fault_of_end(const fs::path& path, std::string_view mark) {
    std::error_code none;
    if (!fs::exists(path, none)) return "does not exist";
    try {
        const std::size_t n = 2 * mark.size();
        Source source(path);
        source.skip_to_last(n);
        const std::string end = source.next(n);
        if (end.empty()) return "is empty";
        if (end.find(mark) != end.npos) return "";
    } catch (const OutputError& error) {
        return std::string("is damaged: ") + error.what();
    }
    return "is cut off after " + std::to_string(fs::file_size(path, none)) + " bytes";
}

std::string fault_of_bytes(const fs::path& path, std::uint64_t sum) {
    try {
        return checksum(read_whole_file(path)) == sum ? "" : "is damaged: its checksum is wrong";
    } catch (const OutputError& error) {
        return std::string("is damaged: ") + error.what();
    }
}

std::string error_text(int error) { return error == ELOOP ? "it is a symbolic link" : std::strerror(error); }

}  // namespace knap
