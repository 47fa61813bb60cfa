#pragma once
// From values to the structs of the floors below, with the checks that need more than one key. Each function goes on past a mistake.
#include "scenario/findings.hpp"
#include "scenario/scenario.hpp"
#include "scenario/values.hpp"

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>

namespace knap {

/// Where the files are that a scenario names.
struct Beside {
    std::filesystem::path directory;
    bool in_binary = false;  // the scenario is a built-in one

    /// Nothing when it cannot be read.
    std::optional<std::string> bytes_of(const std::string& file) const;
};

struct Assembly {
    Values& values;
    Findings& findings;
    Scenario& scenario;
    Beside beside;

    /// Where a message about `path` belongs: there, or at the nearest table above it.
    const Node& at(std::string path) const;
    /// The name of the one that is given of some keys of a table; says so when there are more, or none though one is `needed`.
    std::optional<std::string> the_one(const std::string& table, std::initializer_list<const char*> names, bool needed) const;
    /// Number of the material that a key names; nothing, and a finding, when there is none.
    std::optional<Index> material_at(const std::string& path) const;
    void unknown_name(const std::string& path, const std::string& what, const std::string& name, const std::vector<std::string>& known) const;
    /// Says so where a name breaks the rule of all names, or where something else that has columns is called the same.
    void check_column_name(const std::string& path, const std::string& name, const std::string& what) const;
    /// Loads that prescribe a motion, then obstacles.
    std::vector<std::string> drivers() const;
    /// Whether the run will have such a number of its summary; of "NAME_force_x" there must be a NAME that drives, else it says so.
    void check_summary_number(const std::string& path, const std::string& name) const;
};

void assemble_materials(Assembly& assembly);  // before shape and laws
void assemble_mesh_options(Assembly& assembly);
void assemble_shape(Assembly& assembly);       // before loads
void assemble_mesh_file(Assembly& assembly);   // instead of a shape: the mesh that mesh.file names
void assemble_inclusions(Assembly& assembly);  // after the shape, which they change
void assemble_joints(Assembly& assembly);      // after inclusions
void assemble_maps(Assembly& assembly);
void assemble_grains(Assembly& assembly);
void assemble_foundations(Assembly& assembly); // before laws: a law may have the name that a foundation uses
void assemble_laws(Assembly& assembly);
void assemble_loads(Assembly& assembly);
void assemble_obstacles(Assembly& assembly);
void assemble_time(Assembly& assembly);
void assemble_output(Assembly& assembly);
void assemble_probes(Assembly& assembly);
void assemble_specimen(Assembly& assembly);    // after loads, obstacles and probes, which it names
void assemble_figures(Assembly& assembly);
void assemble_limits(Assembly& assembly);
void assemble_expectations(Assembly& assembly);
void assemble_study(Assembly& assembly);       // last: it may name probes, loads and expectations
void assemble_sweep(Assembly& assembly);

void assemble_plausibility(Assembly& assembly);  // last: warns of values that hardly anybody means

/// Says so where a name of the scenario breaks the rule of all names; `what` it is of: "a probe".
void check_name(const Assembly& assembly, const std::string& path, const std::string& name, const std::string& what);

/// The history of a load or an obstacle: its ramp, table or csv.
TimeFunction assemble_history(Assembly& assembly, const std::string& table);

/// All of them.
void assemble(Assembly& assembly);

}  // namespace knap
