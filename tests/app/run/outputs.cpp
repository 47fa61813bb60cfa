// Every number that a run writes carries its unit, and the list of outputs (scenarios/OUTPUTS.md) has all of them.
#include "app/program.hpp"

#include "output/history_csv.hpp"
#include "record/outputs.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <regex>
#include <set>
#include <sstream>

namespace outputs_test {

using namespace knap;
using namespace program;
using Json = nlohmann::ordered_json;

namespace {

/// A plate that a platen and a named load pull and press until it breaks: all tables, all arrays.
const std::string scene = R"(knap = 1
[domain]
shape = "rectangle"
size = ["20 mm", "10 mm"]
thickness = "5 mm"
[mesh]
size = "2 mm"
[material.glass]
density = 2450
E = "32 GPa"
nu = 0.2
[interface.default]
sigma_c = "3 MPa"
G_c = "3 J/m2"
[[load]]
name = "grip"
on = "top"
velocity = [0, "2 m/s"]
[[load]]
on = "bottom"
velocity = [0, 0]
[[obstacle]]
name = "platen"
shape = "disc"
centre = ["-3 mm", "5 mm"]
radius = "2 mm"
velocity = ["1 m/s", 0]
[[probe]]
name = "middle"
at = ["10 mm", "5 mm"]
[[probe]]
name = "edge"
at = ["10 mm", "5 mm"]
watch = "interface"
[[collector]]
name = "exit"
x = "30 mm"
[specimen]
test = "tension"
force = "grip"
axial = ["grip", "load1"]
lateral = ["left", "right"]
[time]
end = "6 us"
[output]
every = "3 us"
breaks = true
[expect]
grip_largest_force = { above = "1 N" }
[study]
levels = [1, 2]
quantity = [{ of = "grip_force_y" }, { of = "grip_force_y", largest = true }, { of = "largest_speed" }]
)";

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    return cells;
}

void check_header(const fs::path& file, const std::string& table) {
    const std::string text = text_of(file);
    for (const std::string& head : cells_of(text.substr(0, text.find('\n')))) {
        const std::string name(name_in_header(head));
        CAPTURE(table + ": " + head);
        const Output* row = find_output(table, name);
        REQUIRE(row != nullptr);
        CHECK(head == (row->unit.empty() ? name : name + " [" + std::string(row->unit) + "]"));
    }
}

std::set<std::string> arrays_in(const fs::path& vtu) {
    const std::string text = text_of(vtu), head = text.substr(0, text.find("<AppendedData"));
    const std::regex name("<DataArray [^>]*Name=\"([^\"]*)\"");
    std::set<std::string> found;
    for (std::sregex_iterator at(head.begin(), head.end(), name), end; at != end; ++at) found.insert((*at)[1]);
    for (const char* of_vtk : {"Points", "connectivity", "offsets", "types", "TimeValue"}) found.erase(of_vtk);
    return found;
}

void check_no_odd_numbers(const fs::path& file) {
    const std::string text = text_of(file);
    CAPTURE(file.string());
    CHECK_FALSE(std::regex_search(text, std::regex("[^a-zA-Z]-?nan[^a-zA-Z]")));
    CHECK_FALSE(std::regex_search(text, std::regex("[^0-9a-zA-Z.]-0(\\.0+)?[^.0-9a-zA-Z]")));
}

}  // namespace

TEST_CASE("outputs: every column and number and array of a run is in the list and carries its unit") {
    const Folder folder("outputs");
    std::ofstream(folder.path / "plate.toml") << scene;
    const Answer run = command("run " + folder.in_shell("plate.toml") + " -q -j 1 -o " + folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    const fs::path made = folder.path / "run";

    for (const fs::path& file : fs::directory_iterator(made))
        if (file.extension() == ".csv") check_header(file, file.filename().string());
    for (const OutputTable& table : output_tables())  // of the tables of a run, all
        if (table.name.ends_with(".csv") && table.name != "study.csv" && table.name != "sweep.csv" &&
            table.name != "statistics.csv" && table.name != "safety.csv" &&
            table.name != "fluids.csv" &&  // of injected fluids

            table.name != "trajectories.csv")  // that is in place of fragment_paths.csv
            CHECK_MESSAGE(fs::exists(made / table.name), table.name);
    for (const fs::path& file : fs::directory_iterator(made))
        if (file.extension() == ".csv" || file.extension() == ".json" || file.extension() == ".txt")
            check_no_odd_numbers(file);
    CHECK(read_csv(made / "breaks.csv").rows.size() > 3);

    for (const char* part : {"bulk", "interfaces", "obstacles"})
        for (const std::string& array : arrays_in(made / "fields" / (std::string(part) + "_0001.vtu")))
            CHECK_MESSAGE(find_output("fields/" + std::string(part), array) != nullptr, part, " ", array);
    CHECK(arrays_in(made / "fields/bulk_0001.vtu").size() ==
          output_table("fields/bulk").rows.size() - 4);  // no grains, no heat, no rigid pieces, no layers by place
    CHECK(arrays_in(made / "fields/interfaces_0001.vtu").size() ==
          output_table("fields/interfaces").rows.size() - 1);  // no fluid

    const Json record = Json::parse(text_of(made / "run.json"));
    for (const auto& entry : record.items())
        CHECK_MESSAGE(find_output("run.json", entry.key()) != nullptr, entry.key());
    const std::set<std::string_view> sometimes{"temperature_unit", "reason",     "ended",          "pieces",
                                               "output_failed",    "adaptation", "scheme_changes", "mass_scaling"};
    for (const Output& row : output_table("run.json").rows)
        CHECK_MESSAGE((sometimes.contains(row.name) || record.contains(row.name)), std::string(row.name));
    for (const auto& [name, value] : record["summary"].items()) {
        CAPTURE(name);
        const Output* row = find_output("summary", name);
        REQUIRE(row != nullptr);
        CHECK(record["summary_units"].at(name) == row->unit);
    }
    CHECK(record["summary"].size() == record["summary_units"].size());
    for (const Json& gate : record["gates"]) {
        const Output* row = find_output("gates", gate["name"].get<std::string>());
        CAPTURE(gate["name"].get<std::string>());
        REQUIRE(row != nullptr);
        CHECK(gate["unit"] == row->unit);
    }
    double parts = 0;
    for (const auto& [part, seconds] : record["cpu_parts_s"].items()) {
        CAPTURE(part);
        CHECK(seconds.get<double>() > -1e-3);  // of clocks of threads and of the process
        parts += seconds.get<double>();
    }
    CHECK(parts == tests::relative(record["cpu_s"].get<double>(), 1e-9));
    CHECK(record["thickness_m"] == 0.005);
    CHECK(record["reaction_of"] == "grip");
    CHECK(record["summary"]["grip_force_y"] == record["summary"]["reaction_y"]);
    CHECK(record["expect"][0]["unit"] == "N");

    CHECK(run.has("(of grip)"));
    CHECK(run.has("those of the thickness of 0.005 m"));
    CHECK(std::regex_search(run.text, std::regex("external_work +[0-9.e+-]+ J\n")));
    CHECK(std::regex_search(command("info " + folder.in_shell("run")).text,
                            std::regex("largest_speed +[0-9.e+-]+ m/s\n")));
    CHECK(command("info --csv " + folder.in_shell("run")).has(",external_work [J],"));
}

TEST_CASE("outputs: studies name loads and their tables carry units") {
    const Folder folder("outputs of studies");
    std::ofstream(folder.path / "plate.toml") << scene;
    const Answer study = command("study " + folder.in_shell("plate.toml") + " -q -o " + folder.in_shell("s"));
    CAPTURE(study.text);
    CHECK(study.code == 0);
    const std::string table = text_of(folder.path / "s/study.csv");
    CHECK(
        table.starts_with("line,level,seed,status,bulk,cohesion,size [m],step "
                          "[s],triangles,steps,cuts,linear_solves,factorisations,cpu [s],grip_force_y [N],"));
    CHECK(table.find(",largest_speed [m/s],") != std::string::npos);
    const Answer unknown = command("check " + folder.in_shell("plate.toml") + " -s 'expect.gripp_force_y={below=1}'");
    CHECK(unknown.code == 2);
    CHECK(unknown.has("did you mean `grip`?"));
    const Answer twice = command("check " + folder.in_shell("plate.toml") + " -s 'load[1].name=platen'");
    CHECK(twice.code == 2);
    CHECK(twice.has("duplicate-name"));
    const Answer number = command("check " + folder.in_shell("plate.toml") + " -s 'probe[1].name=largest'");
    CHECK(number.code == 2);
    CHECK(number.has("its column `largest_slip` has the name of a summary number"));
}

}  // namespace outputs_test
