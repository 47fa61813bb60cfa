#include "base/appended_file.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace knap {

AppendedFile::AppendedFile(std::filesystem::path path)
    : path_(std::move(path)), file_(open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0666)) {
    check(file_ >= 0);
    size_ = lseek(file_, 0, SEEK_END);
}

AppendedFile::~AppendedFile() {
    if (file_ >= 0) ::close(file_);
}

AppendedFile::AppendedFile(AppendedFile&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)), size_(other.size_) {}

void AppendedFile::check(bool good) const {
    if (good) return;
    throw OutputError("cannot write " + path_.string() + ": " + error_text(errno));
}

void AppendedFile::add(std::string_view text) {
    while (!text.empty()) {
        const ssize_t n = write(file_, text.data(), text.size());
        check(n >= 0 || errno == EINTR);
        if (n <= 0) continue;
        text.remove_prefix(static_cast<std::size_t>(n));
        size_ += n;
    }
}

void AppendedFile::truncate(std::int64_t size) {
    size_ = std::min(size, size_);
    check(ftruncate(file_, size_) == 0);
}

void AppendedFile::close() {
    if (file_ >= 0) check(::close(std::exchange(file_, -1)) == 0);
}

}  // namespace knap
