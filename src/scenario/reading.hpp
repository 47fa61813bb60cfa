#pragma once
// From values to the options structs of the lower layers, with the checks that need more than one key. Table::fill
// writes the members that the key table binds to a key; the rest is read here, block by block. A reader continues after
// a mistake.
#include "scenario/findings.hpp"
#include "scenario/keys.hpp"
#include "scenario/scenario.hpp"
#include "scenario/values.hpp"

#include <filesystem>
#include <initializer_list>
#include <span>

namespace knap {

/// Location of the files that a scenario names.
struct FileSource {
    std::filesystem::path directory;
    bool in_program = false;  // of a built-in scenario

    /// None if the file cannot be read.
    std::optional<std::string> bytes_of(const std::string& file) const;
};

using NamedEnd = std::pair<std::string, GaugeEnd>;

class Table;

struct Reading {
    Values& values;
    Findings& findings;
    Scenario& scenario;
    FileSource files;
    std::vector<std::string> joint_tables = {};  // of each joint set the table whose key `interface` names its law

    Table table(const std::string& path);
    /// The tables of [[path]], or the tables [path.NAME].
    std::vector<Table> list(const std::string& path);

    /// The position of a name in a list; none, and an error, if it is not there. `what`: "material".
    std::optional<Index> find(const std::string& path, const std::string& what, const std::string& name,
                              const std::vector<std::string>& known) const;
    /// Obstacles, and loads with prescribed motion.
    std::vector<NamedEnd> drivers() const;
    /// Reports a summary number such as NAME_force_x for which there is no driver NAME.
    void check_summary_number(const std::string& path, const std::string& name) const;
};

/// One table of a scenario, such as [time] or load[2]: the values of its keys, and findings at their places.
class Table {
public:
    Table(Reading& reading, std::string path, Node& node) : reading_(reading), path_(std::move(path)), node_(node) {}

    Reading& reading() const { return reading_; }
    Scenario& scenario() const { return reading_.scenario; }
    const std::string& name() const { return node_.name; }
    /// Path of one of its keys; of the table itself for "".
    std::string path(std::string_view key = "") const { return joined_path(path_, key); }
    Table table(const std::string& key) const { return reading_.table(path(key)); }
    std::vector<Table> list(const std::string& key) const { return reading_.list(path(key)); }

    /// Whether a key is in the file or on the command line, valid or not; for "" the table itself.
    bool given(std::string_view key = "") const {
        const Node* node = at(key);
        return node && node->is_given() && node->key;
    }
    /// Whether a key has a valid value, given or by default.
    bool has(std::string_view key) const { return at(key) && at(key)->valid; }
    template <class T>
    std::optional<T> get(std::string_view key) const {
        return has(key) ? value_as<T>(*at(key)) : std::nullopt;
    }
    std::optional<double> number(std::string_view key) const { return get<double>(key); }
    std::string text(std::string_view key) const { return get<std::string>(key).value_or(""); }
    std::vector<std::string> texts(std::string_view key) const {
        return get<std::vector<std::string>>(key).value_or(std::vector<std::string>());
    }
    std::vector<Node> items(std::string_view key) const { return has(key) ? at(key)->children : std::vector<Node>(); }
    /// The unit of a value that is a multiple: "cR", "CFL", "%"; "" for SI.
    std::string unit(std::string_view key) const { return has(key) ? at(key)->unit : ""; }

    /// Members of `object` take the values of the keys that are bound to them.
    template <class T>
    void fill(T& object) const {
        for (const Node& node : node_.children)
            if (node.valid && node.key->owner && *node.key->owner == typeid(T)) node.key->store(&object, node);
    }
    /// Sets the computed default of a key.
    void compute(std::string_view key, Node value) const;
    /// Replaces a key by another one of the table.
    void replace(std::string_view key, const std::string& by, Node value) const;
    /// Removes the default of a key that has no meaning in this scenario.
    void leave_out(std::string_view key) const {
        if (Node* node = at(key)) node->valid = false;
    }

    /// A finding "`PATH.KEY` TEXT" at a key, or at the nearest table above if it is absent (or for "").
    void error(const std::string& code, std::string_view key, const std::string& text, const std::string& note = {},
               const std::string& hint = {}) const;
    void warning(const std::string& code, std::string_view key, const std::string& text, const std::string& note = {},
                 const std::string& hint = {}) const;

    /// An error at a line of the file that a key names, whose text this is.
    void error_in_file(const std::string& code, std::string_view key, const std::string& text, int line,
                       const std::string& problem, const std::string& note) const;

    /// The error that two parts of the scenario do not go together, with the reason in exclusions.hpp, at
    /// a key of this table, of which `one` tells.
    void exclude(std::string_view key, std::string_view one, std::string_view other, const std::string& cure) const;

    /// The name of the only given one of some keys; an error if there are more, or none although one is `needed`.
    std::optional<std::string> one_of(const std::vector<std::string>& names, bool needed) const;
    /// Number of the material that a key names; none, and an error, if there is no such material.
    std::optional<Index> material(std::string_view key) const;
    /// The formula of x, y and t that a key has; none, and an error, if it is no formula.
    std::optional<Expression> formula(std::string_view key) const;
    /// The bytes of the file that a key names; none, and an error, if it cannot be read.
    std::optional<std::string> bytes_of(std::string_view key) const;
    /// Number of a new joint set; read_laws finds the law that the key `interface` of this table names.
    Index new_joint_set() const;
    /// An error if a load, obstacle or probe of this name would have columns with names that exist already.
    void check_column_name(const std::string& name) const;

private:
    std::string message(std::string_view key, const std::string& text) const {
        return "`" + path(key) + (text.starts_with(':') ? "`" : "` ") + text;
    }
    Node* at(std::string_view key) const { return key.empty() ? &node_ : node_.find(key); }

    Reading& reading_;
    std::string path_;
    Node& node_;
};

/// Calls visit(number, content) for the lines of a csv file that are neither empty nor a # comment, until it returns
/// false.
template <class Visit>
void for_each_line(const std::string& text, const Visit& visit) {
    int number = 0;
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // with which spreadsheets begin
    for (std::size_t begin = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::string_view content(text.data() + begin, end - begin);
        begin = end + 1, ++number;
        if (content.ends_with('\r')) content.remove_suffix(1);
        content = content.substr(0, content.find('#'));
        if (!trimmed(content).empty() && !visit(number, content)) return;
    }
}

/// Whether a line of cells between ; or tabs has decimal commas, 1,5; what to say of it.
bool has_decimal_comma(std::string_view line);
inline constexpr const char* decimal_comma = "this line has decimal commas: 1,5 is 1.5 in this file";

/// The trimmed cells of a line; any of `separators` stands between two of them.
std::vector<std::string> cells_of(std::string_view line, std::string_view separators);

/// `x [mm]` in the line of names: the name, and the unit where brackets give one.
struct ColumnTitle {
    std::string name;
    std::optional<std::string> unit;
};
ColumnTitle column_title(std::string_view cell);

/// What a file of pairs contains, for messages.
struct PairsFile {
    std::string line;   // "time, factor"
    std::string first;  // the first numbers, which must ascend: "times"
    std::string note = "each line: " + line;
    std::string key = "table";   // that takes the place of `source`
    std::string_view unit = {};  // of both numbers, in the line of names, as in `x [mm], y [mm]`, or behind them; these
                                 // first numbers may also descend. Empty: plain numbers
    std::string_view first_unit = {};  // of the first of two plain numbers, where the line of names gives one
    const char* source = "csv";
};
/// The pairs in the file that the key `source` of a table names; lines of names at the start, # comments are skipped.
/// They replace the key by another one, so that the resolved scenario needs no other file. Empty after an error.
std::vector<Vec2> read_pairs(const Table& table, const PairsFile& file);

/// "a, b, c"; of many names the first ones, and their number.
std::string first_of(std::vector<std::string> names);

/// Index of a boundary's name in a shape, to which a new name is added.
Index boundary_index(Shape& shape, const std::string& name);

/// The outline, holes, cracks and regions of [domain] or a [[body]]. Names of boundaries begin with `prefix`; curves
/// become polygons with sides of the size of `mesh`.
void read_shape(const Table& table, const MeshOptions& mesh, const std::string& prefix, Shape& shape);
/// A closed curve by points, by centre and radius, or by a box; empty, and an error, where it is none.
std::vector<Vec2> read_curve(const Table& table, const MeshOptions& mesh);
/// The factor over time of a load, an obstacle or a temperature: its ramp, table or csv.
TimeFunction read_history(const Table& table);
/// Formulas, or the csv file of points with these columns, in the place of the numbers of a key; null after an error,
/// and where all are numbers, unless a field `also_of_numbers` is wanted.
std::shared_ptr<const PlaceField> read_place_field(const Table& table, const std::string& key,
                                                   const std::vector<std::string>& columns,
                                                   bool also_of_numbers = false);
/// Keys of [[initial]] that give a velocity.
inline constexpr std::array keys_of_initial_motion{"velocity", "spin", "strain_rate"};
/// The pairs [temperature, value] of a key; empty, and an error, where their temperatures do not ascend.
TemperatureTable read_over_temperature(const Table& table, const char* key);
/// time.start = "run:..."
bool starts_from_run(Reading& reading);
/// What a message proposes for a law that needs temperatures.
const char* cure_without_heat(Reading& reading);
/// [[traces]]: lines of a file become cracks of a shape.
void read_traces(const Table& table);
/// The body that an entry which changes a shape names, or the only one. Null with a mesh file and without such a body.
Body* body_to_change(const Table& entry);
/// The outline and the laws of an obstacle that is a polyline; its law elsewhere is read before.
void read_polyline(const Table& table, Obstacle& obstacle);
/// Friction and restitution of a table, or its R_N and R_T; what it does not give stays as in `law`.
void read_contact_law(const Table& table, ContactLaw& law);
/// Beyond theta = 1/(1 + e) the impact law of the theta scheme gains energy; `owner` has the restitution e.
void check_theta(const Table& time, const std::string& owner, double e);
/// A place: boundary, box, body.
Selection read_selection(const Table& table);
/// `on` of an entry that acts by its key `what`: on a boundary, or (`in_volume`) in a body, where none means all.
Selection read_place(const Table& entry, const std::string& what, bool in_volume = false);
/// time.start of a run that starts from the state of another one, and output.states, which keeps such states.
void read_start(const Table& time);
void check_states(const Table& output, double end);
/// The body of mesh.file.
void read_mesh_file(Reading& reading);

// The blocks, in the order in which they are read.
void read_materials(Reading& reading);       // before shape and laws
void read_body(Reading& reading);            // [domain], [mesh], [[body]]: before everything that names a boundary
void read_microstructure(Reading& reading);  // inclusions, joints, traces, which change the shape; maps; grains
void read_supports(Reading& reading);        // before laws: a law may have the name that a support uses
void read_laws(Reading& reading);
void check_laws(Reading& reading);        // after laws and time
void read_loads(Reading& reading);        // loads, initial velocities, obstacles
void read_run(Reading& reading);          // time, output, probes, specimen, figures, limits, expectations
void read_heat(Reading& reading);         // after materials, body and time
void read_contact(Reading& reading);      // after laws and time
void read_pressures(Reading& reading);    // after laws and microstructure: joints have laws
void read_excavations(Reading& reading);  // after microstructure and time: outlines that the mesh follows
void read_rigid(Reading& reading);        // likewise
void read_adapt(Reading& reading);        // after everything that it does not go together with
void read_strength(Reading& reading);     // after laws, body, specimen and adapt: it divides sigma_c by the surplus
void read_toughness(Reading& reading);    // after laws, body and adapt: it divides G_c by the surplus of the mesh
void read_study(Reading& reading);        // after everything that a study may name: probes, loads, expectations
void read_sweep(Reading& reading);
void warn_of_implausible(Reading& reading);  // values that are likely mistakes

/// All of them.
void read_all(Reading& reading);

/// The text of the table of `knap calibrate` that [toughness] or [strength] names, stored with the run as `stored_as`;
/// without one that of the program. None: an error was reported.
std::optional<std::string> calibration_table(const Table& table, const char* of_program, const char* stored_as);
void report_bad_calibration(const Table& table, const UserError& error);
/// Whether a law has keys that no row of the program's table has, which is a mistake. A table of the scenario was
/// measured with them.
bool report_keys_without_rows(const Table& table, const std::string& law, std::span<const char* const> keys);

}  // namespace knap
