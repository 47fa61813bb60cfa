#include "app/run/run_log.hpp"

#include "app/run/directory_lock.hpp"
#include "base/error.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace knap {

RunLog::RunLog(std::filesystem::path path) : path_(std::move(path)), file_(open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
    if (file_ < 0) throw UserError("cannot-write", "cannot write `" + path_.string() + "`: " + std::strerror(errno));
    lock_or_refuse(file_, path_.parent_path());
    size_ = lseek(file_, 0, SEEK_END);
}

RunLog::~RunLog() { close(file_); }

void RunLog::add(const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t n = write(file_, text.data() + done, text.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw OutputError("cannot write " + path_.string() + ": " + std::strerror(errno));
        done += static_cast<std::size_t>(n);
    }
    size_ += static_cast<std::int64_t>(text.size());
}

void RunLog::cut_to(std::int64_t size) {
    if (ftruncate(file_, std::min(size, size_)) != 0) throw OutputError("cannot write " + path_.string() + ": " + std::strerror(errno));
    size_ = std::min(size, size_);
}

}  // namespace knap
