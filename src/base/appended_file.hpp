#pragma once
// A file that grows: tables and logs of a run.
#include <cstdint>
#include <filesystem>
#include <string_view>

namespace knap {

/// Every text is with the system when add() returns. All functions throw OutputError with path and reason. A symbolic
/// link is not followed.
class AppendedFile {
public:
    /// Opens it at its end, or makes it.
    explicit AppendedFile(std::filesystem::path path);
    ~AppendedFile();
    AppendedFile(AppendedFile&& other) noexcept;
    AppendedFile& operator=(AppendedFile&&) = delete;

    void add(std::string_view text);
    std::int64_t size() const { return size_; }  // [byte]
    void truncate(std::int64_t size);            // [byte] where it is longer
    /// What was written late may fail here: on a file system of another machine, with a quota.
    void close();

    int descriptor() const { return file_; }  // -1: closed

private:
    void check(bool good) const;
    std::filesystem::path path_;
    int file_;
    std::int64_t size_ = 0;
};

}  // namespace knap
