// [[traces]]: lines of a map, from a csv file or GeoJSON (RFC 7946), become cracks of a shape.
#include "base/formatted.hpp"
#include "scenario/reading.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace knap {
namespace {

constexpr int max_reports = 5;  // of the mistakes of one file

bool is_json(const std::string& file) { return file.ends_with(".json") || file.ends_with(".geojson"); }

/// A polyline of a map.
struct Trace {
    std::vector<Vec2> points;  // [m] in the coordinates of the file
    std::string name, kind;    // of the csv, or the place in GeoJSON; its class, or ""
    int line = 0;              // of the file, where it begins
};

/// Reads the traces of a file, and reports its mistakes with their lines.
class TraceFile {
public:
    TraceFile(const Table& table, const std::string& bytes)
        : table_(table), bytes_(bytes), property_(table.text("property")), unit_(table.number("unit")) {}

    /// Empty after an error.
    std::vector<Trace> read() {
        if (is_json(table_.text("file"))) read_json();
        else read_csv();
        for (const Trace& trace : traces_)
            if (trace.points.size() < 2 && n_reports_ == 0)
                report(trace.line, name_of(trace) + " has one point; a line needs two");
        if (traces_.empty() && n_reports_ == 0) report(1, "there is no trace in the file");
        if (n_reports_ > 0) traces_.clear();
        return std::move(traces_);
    }

    void report(int line, const std::string& problem, const std::string& note = {}) {
        if (++n_reports_ <= max_reports) table_.error_in_file("bad-file", "file", bytes_, line, problem, note);
    }
    bool has_reports() const { return n_reports_ > 0; }
    /// Columns of the csv file besides trace, x and y, or properties of lines in GeoJSON.
    const std::set<std::string>& properties() const { return properties_; }

    static std::string name_of(const Trace& trace) { return "trace `" + trace.name + "`"; }

private:
    // ---- csv

    struct Columns {
        std::size_t trace = 0, x = 0, y = 0, kind = 0, n = 0;  // `kind`: n where there is none
        double metres_x = 0, metres_y = 0;                     // of one unit; 0: unknown
    };

    void read_csv() {
        std::optional<Columns> columns;
        std::set<std::string> ended;
        for_each_line(bytes_, [&](int number, std::string_view content) {
            if (has_decimal_comma(content)) return report(number, decimal_comma), false;
            const std::vector<std::string> cells = cells_of(content, ",;\t");
            if (!columns) {
                columns = columns_of(cells, number);
                return columns.has_value();
            }
            if (cells.size() < columns->n) {
                report(number, "this line has " + std::to_string(cells.size()) + " values for " +
                                   std::to_string(columns->n) + " names");
                return true;
            }
            const Quantity x = parse_quantity(cells[columns->x]), y = parse_quantity(cells[columns->y]);
            if (!x.problem.empty() || !y.problem.empty() || !x.unit.empty() || !y.unit.empty()) {
                report(number, "x or y of this line is not a number", "units stand in the line of names: x [m], y [m]");
                return true;
            }
            const std::string &name = cells[columns->trace],
                              kind = columns->kind < cells.size() ? cells[columns->kind] : std::string();
            if (traces_.empty() || traces_.back().name != name) {
                if (!traces_.empty()) ended.insert(traces_.back().name);
                if (ended.contains(name))
                    report(number, "trace `" + name + "` goes on after another one",
                           "the points of a trace follow one another");
                traces_.push_back({.name = name, .kind = kind, .line = number});
            } else if (traces_.back().kind != kind) {
                report(number, "trace `" + name + "` has the class `" + kind + "` here, and `" + traces_.back().kind +
                                   "` before");
            }
            traces_.back().points.emplace_back(x.value * columns->metres_x, y.value * columns->metres_y);
            return true;
        });
    }

    std::optional<Columns> columns_of(const std::vector<std::string>& names, int number) {
        Columns columns{.n = names.size()};
        columns.kind = columns.n;
        std::size_t n_found = 0;
        std::string problem;
        for (std::size_t i = 0; i < names.size(); ++i) {
            const auto [name, unit] = column_title(names[i]);
            if (name == property_) columns.kind = i;
            if (name == "trace") columns.trace = i, ++n_found;
            else if (name != "x" && name != "y") properties_.insert(name);
            if (name != "x" && name != "y") continue;
            ++n_found;
            double metres = unit_.value_or(0);
            if (unit) {
                const Quantity one = parse_quantity("1 " + *unit);
                metres = one.problem.empty() && one.dimension == dimension_of("m") ? one.value : 0;
                if (metres == 0) problem = "the unit `" + *unit + "` of " + name + " is no length";
            } else if (metres == 0) {
                problem = name + " has no unit";
            }
            (name == "x" ? columns.x : columns.y) = i;
            (name == "x" ? columns.metres_x : columns.metres_y) = metres;
        }
        if (n_found != 3) problem = "the first line does not name the columns trace, x and y";
        if (problem.empty()) return columns;
        report(number, problem, "as `trace, x [m], y [m], class`: a line for each point");
        return std::nullopt;
    }

    // ---- GeoJSON

    /// A character of the text, which counts the lines before it.
    struct LineCounter {
        using difference_type = std::ptrdiff_t;
        using value_type = char;
        using pointer = const char*;
        using reference = const char&;
        using iterator_category = std::input_iterator_tag;
        const char* at;
        int* line;
        reference operator*() const { return *at; }
        LineCounter& operator++() {
            *line += *at++ == '\n';
            return *this;
        }
        bool operator==(const LineCounter& other) const { return at == other.at; }
    };

    void read_json() {
        using nlohmann::json;
        int line = 1;
        std::vector<int> lines;  // of the coordinates, in the order of the geometries
        const auto note_line = [&](int, json::parse_event_t event, const json& key) {
            if (event == json::parse_event_t::key && key == "coordinates") lines.push_back(line);
            return true;
        };
        json root;
        try {
            const char* const begin = bytes_.data();
            root = json::parse(LineCounter{begin, &line}, LineCounter{begin + bytes_.size(), &line}, note_line);
        } catch (const json::exception&) {
            return report(line, "this is no JSON: it cannot be read from here on");
        }
        if (!unit_)
            table_.error("missing-key", "unit", "is missing: coordinates of GeoJSON have no unit",
                         "unit = \"1 m\"; longitudes and latitudes must be projected to metres before");
        if (!unit_) return void(++n_reports_);
        const json features = root.is_object() && root.contains("features") ? root["features"] : json::array({root});
        std::size_t n_geometries = 0, number = 0;
        for (const json& feature : features) {
            const std::string place = "features[" + std::to_string(number++) + "]";
            const json geometry = feature.is_object() ? feature.value("geometry", feature) : json();
            if (geometry.is_null()) continue;
            const int at = n_geometries < lines.size() ? lines[n_geometries] : 1;
            ++n_geometries;
            try {
                const std::string type = geometry.at("type");
                const json& points = geometry.at("coordinates");
                if (type == "LineString") {
                    add_line(points, feature, place, at);
                } else if (type == "MultiLineString") {
                    for (const json& part : points) add_line(part, feature, place, at);
                } else {
                    report(at, place + " is a " + type, "traces are LineString and MultiLineString");
                }
            } catch (const json::exception&) {
                report(at, place + " has no type and coordinates of a line", "[[x, y], [x, y], ...]");
            }
        }
    }

    void add_line(const nlohmann::json& points, const nlohmann::json& feature, const std::string& place, int line) {
        Trace trace{.name = place, .line = line};
        const auto properties = feature.find("properties");
        if (properties != feature.end() && properties->is_object() && properties->contains(property_)) {
            const nlohmann::json& kind = (*properties)[property_];
            trace.kind = kind.is_string() ? kind.get<std::string>() : kind.dump();
        }
        if (properties != feature.end() && properties->is_object())
            for (const auto& [name, value] : properties->items()) properties_.insert(name);
        for (const nlohmann::json& point : points)
            trace.points.emplace_back(point.at(0).get<double>() * *unit_, point.at(1).get<double>() * *unit_);
        traces_.push_back(std::move(trace));
    }

    const Table& table_;
    const std::string& bytes_;
    std::string property_;
    std::optional<double> unit_;  // [m] of one unit of coordinates that have none of their own
    std::vector<Trace> traces_;
    std::set<std::string> properties_;
    int n_reports_ = 0;
};

/// Whether a part of a polyline lies in the body, and not in its holes.
bool is_inside(const Shape& shape, const std::vector<Vec2>& points) {
    for (const Segment& s : sides_of(points, false)) {
        std::vector<double> cuts{0, 1};
        const auto cut = [&](const Ring& ring) {
            double position = 0;
            for (const Segment& side : sides_of(ring.points, true))
                if (segments_cross(s, side, position)) cuts.push_back(position);
        };
        cut(shape.outer);
        for (const Ring& hole : shape.holes) cut(hole);
        std::ranges::sort(cuts);
        for (std::size_t i = 1; i < cuts.size(); ++i)
            if (shape.contains(s.a + 0.5 * (cuts[i - 1] + cuts[i]) * (s.b - s.a))) return true;
    }
    return false;
}

/// Beyond the outline by more than what snap joins to it.
bool is_beyond(const Shape& shape, const Vec2& p) {
    if (contains(shape.outer.points, p)) return false;
    const double reach = std::max(shape.snap, shape.tolerance());
    return std::ranges::none_of(sides_of(shape.outer.points, true),
                                [&](const Segment& side) { return distance_to_segment(side.a, side.b, p) <= reach; });
}

/// A class of the file that no table takes would be missing in the body without a word: the first table of the file
/// says so. True without a mistake.
bool check_classes(const Table& table, const std::vector<Trace>& traces, bool is_first, TraceFile& file) {
    if (const std::string property = table.text("property");
        (table.given("property") || table.given("class")) && !file.properties().contains(property)) {
        const std::vector<std::string> others(file.properties().begin(), file.properties().end());
        table.error("unknown-name", "property",
                    "= \"" + property + "\" is no column or property of the traces in the file",
                    others.empty() ? "they have none" : "known: " + first_of(others), did_you_mean(property, others));
        return false;
    }
    std::set<std::string> taken, known;
    for (const Table& other : table.reading().list("traces"))
        if (other.text("file") == table.text("file")) {
            if (!other.given("class")) return true;
            taken.insert(other.text("class"));
        }
    for (const Trace& trace : traces) known.insert(trace.kind);
    if (const std::string own = table.text("class"); !known.contains(own)) {
        table.error("unknown-name", "class", "= \"" + own + "\" is no class of the traces in the file",
                    "known: " + first_of({known.begin(), known.end()}));
        return false;
    }
    if (!is_first) return true;
    for (const Trace& trace : traces)
        if (taken.insert(trace.kind).second)
            file.report(trace.line,
                        TraceFile::name_of(trace) + " has the class `" + trace.kind + "`, which no [[traces]] takes",
                        "another [[traces]] with class = \"" + trace.kind + "\"");
    return !file.has_reports();
}

}  // namespace

void read_traces(const Table& table) {
    Body* const body = body_to_change(table);
    const std::optional<std::string> bytes = table.has("file") ? table.bytes_of("file") : std::nullopt;
    if (!bytes) return;
    TraceFile file(table, *bytes);
    const std::vector<Trace> traces = file.read();
    if (traces.empty()) return;
    const std::vector<Table> tables = table.reading().list("traces");
    const auto first = std::ranges::find_if(
        tables, [&](const Table& other) { return other.text("file") == table.text("file"); });  // of this file
    if (!check_classes(table, traces, first->path() == table.path(), file)) return;
    Scenario& scenario = table.scenario();
    const std::string copy = "traces" + std::to_string(first - tables.begin() + 1);
    scenario.files.push_back({table.path("file"), copy + (is_json(table.text("file")) ? ".geojson" : ".csv"), *bytes});
    if (!body || body->shape.outer.points.size() < 3) return;
    Shape& shape = body->shape;
    const Vec2 origin = table.get<Vec2>("origin").value_or(Vec2(0, 0));
    const bool crops = table.get<bool>("crop").value_or(false);
    PlacedSet set{.path = table.path(),
                  .body = static_cast<std::size_t>(body - scenario.bodies.data()),
                  .part = PlacedSet::Part::cracks,
                  .first = shape.cracks.size()};
    const Index joint = table.given("interface") ? table.new_joint_set() : -1;
    std::vector<std::pair<const Trace*, Vec2>> beyond;  // and where
    for (const Trace& trace : traces) {
        if (table.given("class") && trace.kind != table.text("class")) continue;
        Crack crack{.points = trace.points, .joint = joint};
        for (Vec2& p : crack.points) p -= origin;
        const auto out = std::ranges::find_if(crack.points, [&](const Vec2& p) { return is_beyond(shape, p); });
        if (out != crack.points.end() && !crops) {
            beyond.emplace_back(&trace, *out);
        } else if (is_inside(shape, crack.points)) {
            shape.cracks.push_back(std::move(crack));
            set.file_lines.push_back(trace.line);
        } else {
            ++set.n_cropped;
        }
    }
    set.n = static_cast<int>(set.file_lines.size());
    const bool together = beyond.size() > 2;  // most likely one mistake: the unit or the origin
    for (std::size_t i = 0; i < (together ? 1 : beyond.size()); ++i) {
        const auto& [trace, place] = beyond[i];
        const Box box = bounding_box(shape.outer.points);
        const std::string all = std::to_string(beyond.size() + set.file_lines.size() + set.n_cropped);
        file.report(trace->line,
                    (together ? std::to_string(beyond.size()) + " of " + all + " traces leave the body, as " : "") +
                        TraceFile::name_of(*trace) + (together ? "" : " leaves the body") + " at " + place_text(place),
                    "the body reaches from " + place_text(box.low) + " to " + place_text(box.high) +
                        "; origin moves the map, crop = true cuts it at the border");
    }
    if (set.n == 0 && !file.has_reports())
        table.error("geometry", "file", "has no trace that lies in the body", "origin or unit of the map");
    scenario.placed_sets.push_back(std::move(set));
}

}  // namespace knap
