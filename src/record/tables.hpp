#pragma once
// The tables of a run: in memory, and in files of its directory that grow line by line.
#include "base/appended_file.hpp"
#include "model/state.hpp"
#include "output/history_csv.hpp"

#include <functional>
#include <optional>

namespace knap {

class Tables {
public:
    using Line = std::function<std::vector<double>(const State&)>;

    /// An empty directory: nothing is written. `celsius`: temperatures are in degrees Celsius.
    Tables(std::filesystem::path directory, bool celsius) : directory_(std::move(directory)), celsius_(celsius) {}

    /// `line`: what write_lines() adds; without it lines come by add_line().
    void add(History Histories::*table, std::vector<std::string> columns, Line line = {});
    /// Writes all lines so far and opens the files for the next ones. This and what follows throw OutputError.
    void open();
    void close();
    void write_lines(const State& now);
    void add_line(History Histories::*table, std::vector<double> line);

    void write(const char* file, const History& table) const;
    /// Tables that were deleted during the run.
    void write_missing() const;

    const Histories& all() const { return histories_; }
    Histories& all() { return histories_; }

    void serialize(auto& archive) { archive(histories_); }

private:
    struct Sheet {
        const char* file;
        History Histories::*table;
        Line line;
        std::optional<AppendedFile> growing;
    };
    void append(Sheet& sheet, std::vector<double> line);

    std::filesystem::path directory_;
    bool celsius_;
    Histories histories_;
    std::vector<Sheet> sheets_;
};

}  // namespace knap
