#include "app/run/directory_lock.hpp"

#include "base/error.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace knap {

void lock_or_refuse(int file, const std::filesystem::path& directory) {
    if (flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;  // other errors: a file system without locks
    close(file);
    throw UserError("run-busy", "another process is running in `" + directory.string() + "`", "wait for it, or choose another directory with --output");
}

DirectoryLock::DirectoryLock(const std::filesystem::path& directory) : file_(open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (file_ < 0) throw UserError("cannot-write", "cannot look into `" + directory.string() + "`: " + std::strerror(errno));
    lock_or_refuse(file_, directory);
}

DirectoryLock::~DirectoryLock() { close(file_); }

}  // namespace knap
