#pragma once
// One process at a time in a directory. The system lets go of a lock when its process ends, however it ends.
#include <filesystem>

namespace knap {

/// Takes an open file for this process alone until it is closed. Where another process has it, closes it and throws UserError about the directory.
void lock_or_refuse(int file, const std::filesystem::path& directory);

/// A directory that is there, for this process alone; leaves no trace in it.
class DirectoryLock {
public:
    /// Throws UserError where another process has it, or it cannot be opened.
    explicit DirectoryLock(const std::filesystem::path& directory);
    ~DirectoryLock();
    DirectoryLock(const DirectoryLock&) = delete;
    DirectoryLock& operator=(const DirectoryLock&) = delete;

private:
    int file_;
};

}  // namespace knap
