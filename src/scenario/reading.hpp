#pragma once
// From values to the options structs of the lower floors, with the checks that need more than one key. Members that are
// bound to their key in the key table are filled in by `Table::fill`; what is left is read here, block by block. A
// reader goes on past a mistake.
#include "scenario/findings.hpp"
#include "scenario/scenario.hpp"
#include "scenario/values.hpp"

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace knap {

/// Where the files are that a scenario names.
struct Beside {
    std::filesystem::path directory;
    bool in_binary = false;  // the scenario is a built-in one

    /// Nothing when it cannot be read.
    std::optional<std::string> bytes_of(const std::string& file) const;
};

class Table;

struct Reading {
    Values& values;
    Findings& findings;
    Scenario& scenario;
    Beside beside;

    Table table(const std::string& path);
    std::vector<Table> list(const std::string& path);  // of [[path]]

    /// Where a message about `path` belongs: there, or at the nearest table above it.
    const Node& at(const std::string& path) const { return values.place_of(path); }
    void unknown_name(const std::string& path, const std::string& what, const std::string& name,
                      const std::vector<std::string>& known) const;
    /// The bytes of a file; nothing, and a finding, when it cannot be read.
    std::optional<std::string> bytes_of(const std::string& path, const std::string& file) const;
    /// Obstacles, and loads that prescribe a motion: the loads first.
    std::vector<std::string> drivers() const;
    /// Whether the run will have such a number of its summary; of "NAME_force_x" there must be a NAME that drives, else
    /// it says so.
    void check_summary_number(const std::string& path, const std::string& name) const;
};

/// One table of a scenario, such as [time] or load[2]: the values of its keys, and findings at their places.
class Table {
public:
    Table(Reading& reading, std::string path) : reading_(reading), path_(std::move(path)) {}

    /// Path of one of its keys; of the table itself for "".
    std::string path(const std::string& key = "") const {
        return path_ + (path_.empty() || key.empty() ? "" : ".") + key;
    }
    Table table(const std::string& key) const { return {reading_, path(key)}; }
    std::vector<Table> list(const std::string& key) const { return reading_.list(path(key)); }

    bool given(const std::string& key = "") const { return reading_.values.given(path(key)); }
    bool has(const std::string& key = "") const { return reading_.values.has(path(key)); }
    std::optional<double> number(const std::string& key) const { return reading_.values.number(path(key)); }
    std::string text(const std::string& key) const { return reading_.values.text(path(key)).value_or(""); }
    std::optional<bool> flag(const std::string& key) const { return reading_.values.flag(path(key)); }
    std::optional<Vec2> pair(const std::string& key) const { return reading_.values.pair(path(key)); }
    std::optional<Box> box(const std::string& key) const { return reading_.values.box(path(key)); }
    std::vector<Vec2> points(const std::string& key) const { return reading_.values.points(path(key)); }
    std::vector<const Node*> items(const std::string& key) const { return reading_.values.items(path(key)); }
    /// The unit in which a good value was kept: "cR", "CFL", "%", or "" for SI.
    std::string unit(const std::string& key) const {
        return has(key) ? reading_.values.find(path(key))->node.unit : "";
    }
    double radians(const std::string& key) const;  // of a key in degrees; 0 where there is none

    /// Members of `object` take the values of the keys that are bound to them.
    template <class T>
    void fill(T& object) const {
        reading_.values.fill(path_, object);
    }
    /// Gives a key that was not set its value.
    void compute(const std::string& key, Node value) const { reading_.values.compute(path(key), std::move(value)); }

    /// Findings "`PATH.KEY` TEXT" at a key, or at the table where there is no such key (and for "").
    void error(const std::string& code, const std::string& key, const std::string& text,
               const std::string& note = "") const;
    void error_at_name(const std::string& code, const std::string& key, const std::string& text,
                       const std::string& note = "") const;
    void warning(const std::string& code, const std::string& key, const std::string& text,
                 const std::string& note = "") const;

    /// The same with a message of its own.
    Diagnostic& report(const std::string& code, const std::string& key, const std::string& message) const {
        return reading_.findings.error(code, message, reading_.at(path(key)));
    }

    /// The name of the one that is given of some keys; says so when there are more, or none though one is `needed`.
    std::optional<std::string> the_one(std::initializer_list<const char*> names, bool needed) const;
    /// Number of the material that a key names; nothing, and a finding, when there is none.
    std::optional<Index> material(const std::string& key) const;
    /// Says so where a name breaks the rule of all names; `what` it is of: "a probe".
    void check_name(const std::string& key, const std::string& name, const std::string& what) const;
    /// The same, and where something else that has columns is called the same.
    void check_column_name(const std::string& key, const std::string& name, const std::string& what) const;

    Reading& reading() const { return reading_; }

private:
    Reading& reading_;
    std::string path_;
};

/// The index of a name in a list; the size of the list where it has no such name.
Index index_in(const std::vector<std::string>& names, const std::string& name);

// The blocks, in the order in which they are read.
void read_materials(Reading& reading);       // before shape and laws
void read_body(Reading& reading);            // [domain] and [mesh]: before everything that names a boundary
void read_mesh_file(Reading& reading);       // instead of a shape: the mesh that mesh.file names
void read_microstructure(Reading& reading);  // inclusions and joints, which change the shape; maps; grains
void read_supports(Reading& reading);     // before laws: a law may have the name that a support uses
void read_laws(Reading& reading);
void read_loads(Reading& reading);           // loads, initial velocities, obstacles
void read_run(Reading& reading);             // time, output, probes, specimen, figures, limits, expectations
void read_specimen(Reading& reading);        // after loads, obstacles and probes, which it names
void read_study(Reading& reading);           // after everything that a study may name: probes, loads, expectations
void read_sweep(Reading& reading);
void warn_of_implausible(Reading& reading);  // values that hardly anybody means

/// All of them.
void read_all(Reading& reading);

/// Index of a boundary's name in a shape, where it is put if it is new.
Index boundary_index(Shape& shape, const std::string& name);

}  // namespace knap
