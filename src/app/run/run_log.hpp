#pragma once
// log.txt of a run: every line is on the disk at once. Who holds it is the only process that writes into the run's directory.
#include <cstdint>
#include <filesystem>
#include <string>

namespace knap {

class RunLog {
public:
    /// Throws UserError where another process is at this run, or it cannot be opened.
    explicit RunLog(std::filesystem::path path);
    ~RunLog();
    RunLog(const RunLog&) = delete;
    RunLog& operator=(const RunLog&) = delete;

    /// Throws OutputError.
    void add(const std::string& text);
    std::int64_t size() const { return size_; }  // [byte]
    void cut_to(std::int64_t size);              // [byte]

private:
    std::filesystem::path path_;
    int file_;
    std::int64_t size_ = 0;
};

}  // namespace knap
