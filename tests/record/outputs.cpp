// The list of what a run writes.
#include "record/outputs.hpp"

#include "figures/figures.hpp"
#include "output/history_csv.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <string>

namespace outputs_test {

using namespace knap;

TEST_CASE("outputs: every row has a name of its own in its table and a known unit and a meaning") {
    const std::set<std::string_view> units{"",      "s",      "m",    "m2",  "m3", "m/s",     "rad",
                                           "rad/s", "deg",    "N",    "N m", "J",  "J/m2",    "Pa",
                                           "kg",    "kg m/s", "byte", "1/s", "K",  "Pa m^0.5"};
    std::set<std::string> tables;
    for (const OutputTable& table : output_tables()) {
        CAPTURE(table.name);
        CHECK(tables.insert(table.name).second);
        CHECK(!table.doc.empty());
        CHECK(!table.rows.empty());
        std::set<std::string_view> names;
        for (const Output& row : table.rows) {
            CAPTURE(row.name);
            CHECK(names.insert(row.name).second);
            CHECK(units.contains(row.unit));
            CHECK(!row.doc.empty());
        }
    }
}

TEST_CASE("outputs: a name means one thing in all tables that a study looks through") {
    // by name alone the summary is searched first, then the tables in their order: the same name must have the same unit
    for (const char* one : {"summary", "energy.csv", "cracks.csv", "stress_strain.csv"})
        for (const char* other : {"energy.csv", "cracks.csv", "reactions.csv", "probes.csv", "stress_strain.csv"})
            for (const Output& row : output_table(one).rows) {
                const Output* same = find_output(other, row.name);
                if (!same || same->name.starts_with('*')) continue;  // names that would make such a column are refused
                CAPTURE(std::string(one) + " and " + other + ": " + std::string(row.name));
                CHECK(same->unit == row.unit);
            }
}

TEST_CASE("outputs: units by name also where the scenario gave a part of it") {
    CHECK(unit_of("summary", "broken_length") == "m");
    CHECK(unit_of("summary", "upper_force_y") == "N");
    CHECK(unit_of("reactions.csv", "upper_u_x") == "m");
    CHECK(unit_of("reactions.csv", "upper_moment") == "N m");
    CHECK(unit_of("nothing.csv", "time") == "");
    CHECK(find_output("summary", "_force_x") == nullptr);  // of nobody
    CHECK(unit_of_column("a_cohesion") == "");
    CHECK(unit_of_column("tip_speed") == "m/s");
    CHECK(unit_of_slope("surface") == "W");
    CHECK(unit_of_figure("stress_xy", "opening") == "Pa");
    CHECK(unit_of_figure("cracks", "opening") == "m");
    CHECK(header_of("probes.csv", {"time", "a_v_x", "a_cohesion"}) ==
          std::vector<std::string>{"time [s]", "a_v_x [m/s]", "a_cohesion"});
    CHECK(name_in_header("a_v_x [m/s]") == "a_v_x");
    CHECK(name_in_header("tips") == "tips");
}

TEST_CASE("outputs: texts of values have a unit and there is no minus zero") {
    CHECK(value_text(12.5, "mm") == "12.5 mm");
    CHECK(value_text(-0.0, "J") == "0 J");
    CHECK(shown_text(15.4395e-6, "s") == "15.4395 µs");
    CHECK(shown_text(0.00035, "m2") == "0.00035 m2");  // a prefix would be wrong: mm2 are 1e-6 m2
    CHECK(shown_text(NAN, "s") == "none");
    CHECK(value_text(std::nan(""), "J") == "none");
    CHECK(value_text(1.0 / 3, "", 3) == "0.333");
}

}  // namespace outputs_test
