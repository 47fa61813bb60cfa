#pragma once
// Tables of numbers over time (energy.csv, cracks.csv), and their files: comma-separated, one header line of names with
// units ("time [s]"), the shortest decimals that read back to the same bits, no locale. An empty field is NaN: the
// value does not exist, or is not known.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

/// A table of numbers with named columns.
struct History {
    std::vector<std::string> columns;
    std::vector<std::vector<double>> rows;
    std::string file = {};  // that it was read from; empty for the table of a run in progress

    bool has(const std::string& column) const;
    /// Place of a column in a row. Throws UserError for an unknown name, as the next one.
    std::size_t place_of(const std::string& column) const;
    std::vector<double> column(const std::string& name) const;

    void serialize(auto& archive) { archive(columns, rows); }
};

/// All tables of a run, by the names of their files. A table that a run does not have is empty.
struct Histories {
    History energy, cracks, reactions, fluids, probes, breaks, stress_strain, fragments, fragment_history,
        fragment_paths, passages, trajectories;

    void serialize(auto& archive);
};

struct HistoryFile {
    const char* name;
    History Histories::*table;
    bool regular = false;  // a line at every output.history_every
    bool drawn = true;     // in some figure
};
inline constexpr HistoryFile history_files[]{{"energy.csv", &Histories::energy, true},
                                             {"cracks.csv", &Histories::cracks, true},
                                             {"reactions.csv", &Histories::reactions, true},
                                             {"fluids.csv", &Histories::fluids, true, false},
                                             {"probes.csv", &Histories::probes, true},
                                             {"breaks.csv", &Histories::breaks},
                                             {"stress_strain.csv", &Histories::stress_strain, true},
                                             {"fragments.csv", &Histories::fragments},
                                             {"fragment_history.csv", &Histories::fragment_history, false, false},
                                             {"fragment_paths.csv", &Histories::fragment_paths},
                                             {"passages.csv", &Histories::passages, false, false},
                                             {"trajectories.csv", &Histories::trajectories}};

void Histories::serialize(auto& archive) {
    for (const HistoryFile& file : history_files) archive(this->*file.table);
}

/// "time [s]" -> "time"
std::string_view name_in_header(std::string_view header);

/// One line of a file, without the line end.
std::string csv_line(const std::vector<std::string>& columns);
std::string csv_line(const std::vector<double>& row);

/// `header`: the columns with their units, "time [s]". Throws OutputError naming the path.
void write_csv(const History& history, const std::vector<std::string>& header, const std::filesystem::path& path);

/// The columns are named without their units. Throws UserError naming the path and line.
History read_csv(const std::filesystem::path& path);

}  // namespace knap
