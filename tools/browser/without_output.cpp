// In place of what the page has no use for: files, pictures, figures.
#include "app/setup/adaptation.hpp"
#include "app/setup/excavations.hpp"
#include "app/setup/process.hpp"
#include "base/appended_file.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "figures/animation.hpp"
#include "figures/figures.hpp"
#include "figures/read_png.hpp"
#include "record/checkpoint_file.hpp"
#include "record/outputs.hpp"
#include "scenario/built_in.hpp"
#include "scenario/reading.hpp"

namespace knap {

std::string read_whole_file(const std::filesystem::path& path) {
    throw OutputError("`" + path.string() + "` cannot be read: a page reads no files");
}
void write_whole_file(const std::filesystem::path&, std::string_view, bool) {}
AppendedFile::AppendedFile(std::filesystem::path) {}
AppendedFile::AppendedFile(AppendedFile&&) noexcept = default;
AppendedFile::~AppendedFile() = default;
void AppendedFile::add(std::string_view) {}
void AppendedFile::close() {}
std::string unpacked_checkpoint(const std::string& file) { return file; }
const std::vector<BuiltIn>& built_in_files() {
    static const std::vector<BuiltIn> none;
    return none;
}
std::optional<Picture> read_png(const std::string&, std::string& problem) {
    problem = "cannot be read: a page reads no files";
    return std::nullopt;
}
void read_traces(const Table& table) { table.error("bad-file", "file", "cannot be read: a page reads no files"); }
double free_memory() { return 2e9; }  // of the 4 GB that a module can have, half of it for what is transient

// Tables of figures are left out of a scenario before it is read.
std::vector<std::string> figure_subjects() { return {}; }
std::vector<std::string> figure_colours() { return {}; }
std::vector<std::string> figure_abscissas() { return {}; }
std::vector<std::string> growing_subjects() { return {}; }
bool shows_body(const std::string&) { return true; }
bool takes_marks(const std::string&) { return false; }
bool takes_measured(const std::string&) { return false; }
FigureNeed need_of_figure(const std::string&, const std::string&) { return {}; }
std::vector<IdleKey> idle_keys(const FigureOptions&) { return {}; }
void check_type(const FigureOptions&) {}
bool has_few_colours(const std::string&) { return false; }
std::string_view unit_of_figure(const std::string&, const std::string&) { return ""; }
Vec2 picture_size(const FigureOptions&, const Vec2&) { return {1, 1}; }
double longest_side(const FigureOptions&) { return 1; }
double drawing_memory(const FigureOptions&, const Vec2&) { return 0; }

bool FigureOptions::is_animation() const { return false; }
void check_animation(const std::filesystem::path&) {}

// The page refuses scenarios with excavations or refinement (engine.cpp).
AdaptationForecast forecast(const Scenario&, const Mesh&) { return {}; }
std::string replace_where_it_does_not_pay(Scenario&, const Mesh&) { return {}; }
std::vector<Diagnostic> findings_of_excavations(const ReadResult&, const Model&) { return {}; }

// Neither are outputs described nor expected.
const std::vector<OutputTable>& output_tables() {
    static const std::vector<OutputTable> none;
    return none;
}

}  // namespace knap
