// [[inclusions]] and [[joints]], which become regions, holes and cracks of the shape; [[map]], whose colours are
// materials; [[grains]].
#include "figures/read_png.hpp"
#include "microstructure/inclusions.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace knap {
namespace {

constexpr double min_size = 1.5;  // [mesh size] grains and inclusions of fewer triangles would have no shape
constexpr int max_colour_distance =
    80;  // of a pixel from the colour that it counts as, each of red, green, blue to 255

/// Random sets change a shape; with a mesh file or without a good body there is none.
bool has_body(const Table& set) {
    const Reading& reading = set.reading();
    if (reading.values.given("mesh.file")) {
        set.error_at_name("exclusive-keys", "", "has no meaning beside mesh.file",
                          "the file says what the body is; grains and maps go with it");
        return false;
    }
    const Scenario& scenario = reading.scenario;
    return scenario.shape.outer.points.size() >= 3 && scenario.mesh.size > 0 && !reading.findings.has_errors();
}

void check_size(const Table& table, double size, const std::string& cure) {
    if (table.has("size") && size < min_size * table.reading().scenario.mesh.size)
        table.error("out-of-range", "size", "is below 1.5 times mesh.size", cure);
}

void read_inclusions(const Table& table, std::size_t number) {
    Scenario& scenario = table.reading().scenario;
    const double size = scenario.mesh.size;
    const std::optional<std::string> amount = table.the_one({"fraction", "number"}, true);
    if (size > 0) table.compute("distance", Node::of_number(0.5 * size));
    InclusionOptions options{.tag = table.material("material"), .mesh = scenario.mesh};
    table.fill(options);
    if (table.has("direction")) options.direction = table.radians("direction");
    const bool pores = !table.given("material");
    if (pores) table.compute("name", Node::of_text("pores"));
    if (table.has("name")) table.check_name("name", table.text("name"), "a boundary");
    if (!pores && table.given("name"))
        table.error_at_name("exclusive-keys", "name", "belongs to pores, which have no material");
    check_size(table, options.size, "larger inclusions or a finer mesh");
    if (table.has("distance") && options.distance < 0.2 * size)
        table.error("out-of-range", "distance", "is below a fifth of mesh.size");
    if (!amount || !has_body(table)) return;
    if (pores) options.boundary = boundary_index(scenario.shape, table.has("name") ? table.text("name") : "pores");
    RandomSet set{.path = table.path(), .part = pores ? RandomSet::Part::holes : RandomSet::Part::regions};
    set.first = pores ? scenario.shape.holes.size() : scenario.shape.regions.size();
    try {
        const PlacedInclusions placed =
            place_inclusions(scenario.shape, options, scenario.seed, "inclusions " + std::to_string(number));
        set.n = placed.n;
        set.fraction = placed.fraction;
    } catch (const ShapeError& error) {
        const std::string smaller = options.number > 0 ? ", or smaller inclusions" : "";
        table.report("geometry", *amount, "`" + table.path() + "` " + error.what()).note =
            "a smaller " + *amount + ", a smaller distance" + smaller;
    }
    scenario.random_sets.push_back(set);
}

void read_joints(const Table& table, std::size_t number) {
    Scenario& scenario = table.reading().scenario;
    JointOptions options{.direction = table.radians("direction"), .spread = table.radians("spread")};
    table.fill(options);
    options.tag = table.material("material");
    options.nearest = 0.2 * scenario.mesh.size;
    const auto belong_together = [&](const std::string& text, const std::string& note) {
        table.report("missing-key", "", "`" + table.path() + "`: " + text).note = note;
    };
    if (table.has("persistence") && (options.persistence < 1) != table.given("length"))
        belong_together("length belongs to a persistence below 1", "both, or none of them for joints from end to end");
    if (table.given("thickness") != table.given("material"))
        belong_together("thickness and material belong together", "they make veins");
    if (table.given("interface")) table.the_one({"interface", "thickness"}, false);
    if (table.has("spacing") && options.spacing < scenario.mesh.size)
        table.error("out-of-range", "spacing", "is below mesh.size");
    if (table.has("thickness") && options.thickness < 0.5 * scenario.mesh.size)
        table.error("out-of-range", "thickness", "is below half of mesh.size");
    if (!has_body(table)) return;
    if (table.given("interface")) {
        options.joint = static_cast<Index>(scenario.law_of_joint.size());
        scenario.law_of_joint.push_back(-1);  // found with the laws
    }
    RandomSet set{.path = table.path(), .part = options.tag ? RandomSet::Part::regions : RandomSet::Part::cracks};
    const auto size_of_part = [&] {
        return options.tag ? scenario.shape.regions.size() : scenario.shape.cracks.size();
    };
    set.first = size_of_part();
    int n_left_out = 0;
    try {
        n_left_out = place_joints(scenario.shape, options, scenario.seed, "joints " + std::to_string(number));
    } catch (const ShapeError& error) {
        table.report("geometry", "spacing", "`" + table.path() + "` " + error.what()).note =
            "a larger spacing or length, or a smaller body";
    }
    set.n = static_cast<int>(size_of_part() - set.first);
    scenario.random_sets.push_back(set);
    if (n_left_out > 0)
        table.reading().findings.warning(
            "geometry",
            std::to_string(n_left_out) + " traces of `" + table.path() + "` found no place beside the other lines",
            table.reading().at(table.path()));
}

// ---- maps

using Rgb = std::array<int, 3>;

struct PaintedMaterial {
    Rgb rgb;
    Index material;
};

std::optional<Rgb> colour_of(const std::string& text) {
    Rgb rgb{};
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    for (int i = 0; i < 3; ++i) {
        const char* begin = text.data() + 1 + 2 * i;
        const auto [end, code] = std::from_chars(begin, begin + 2, rgb[i], 16);
        if (code != std::errc() || end != begin + 2) return std::nullopt;
    }
    return rgb;
}

std::vector<PaintedMaterial> palette(const Table& map) {
    std::vector<PaintedMaterial> found;
    const std::vector<Table> rows = map.list("colour");
    for (const Table& row : rows) {
        const std::optional<Index> material = row.material("material");
        if (!row.has("rgb")) continue;
        const auto rgb = colour_of(row.text("rgb"));
        if (!rgb)
            row.report("bad-value", "rgb", "`" + row.text("rgb") + "` is no colour").note =
                "as \"#rrggbb\", two digits 0-9 a-f each";
        if (rgb && material) found.push_back({*rgb, *material});
    }
    if (rows.empty())
        map.error("missing-key", "", "has no colours", "colour = [{ rgb = \"#ff0000\", material = \"NAME\" }]");
    return found;
}

Index material_of_pixel(const std::vector<PaintedMaterial>& palette, const std::uint8_t* pixel) {
    Index material = -1;
    int least = max_colour_distance * max_colour_distance;
    for (const PaintedMaterial& painted : palette) {
        int squared = 0;
        for (int i = 0; i < 3; ++i) squared += (pixel[i] - painted.rgb[i]) * (pixel[i] - painted.rgb[i]);
        if (squared <= least) least = squared, material = painted.material;
    }
    return material;
}

/// The rectangle round the body.
void set_box(const Table& table, MaterialMap& map) {
    if (const std::optional<Box> box = table.box("box")) {
        map.low = box->low;
        map.high = box->high;
        return;
    }
    const Scenario& scenario = table.reading().scenario;
    const std::vector<Vec2>& points = scenario.given ? scenario.given->mesh.vertices : scenario.shape.outer.points;
    if (points.empty()) return;
    map.low = map.high = points.front();
    for (const Vec2& x : points) map.low = map.low.cwiseMin(x), map.high = map.high.cwiseMax(x);
}

void read_map(const Table& table, std::size_t number) {
    Reading& reading = table.reading();
    const std::vector<PaintedMaterial> colours = palette(table);
    if (!table.has("file")) return;
    const std::string file = table.text("file");
    const std::optional<std::string> bytes = reading.bytes_of(table.path("file"), file);
    if (!bytes) return;
    const Node& at = reading.at(table.path("file"));
    std::string problem;
    const std::optional<Picture> picture = read_png(*bytes, problem);
    if (!picture) {
        reading.findings.error("bad-file", "`" + file + "` " + problem, at);
        return;
    }
    MaterialMap map{.width = picture->width, .height = picture->height};
    set_box(table, map);
    for (std::size_t pixel = 0; pixel < picture->rgb.size() / 3; ++pixel)
        map.material.push_back(material_of_pixel(colours, &picture->rgb[3 * pixel]));
    const auto n = static_cast<double>(map.material.size()),
               n_none = static_cast<double>(std::ranges::count(map.material, -1));
    if (n_none == n && !colours.empty()) {
        reading.findings.error("bad-value", "no pixel of `" + file + "` has one of the colours",
                               reading.at(table.path()));
    } else if (n_none > 0) {
        const std::string percent = std::to_string(static_cast<int>(std::ceil(100 * n_none / n)));
        reading.findings.warning(
            "map", percent + " % of the pixels of `" + file + "` have none of the colours and change nothing", at);
    }
    reading.scenario.maps.push_back(std::move(map));
    reading.scenario.files.push_back({table.path("file"), "map" + std::to_string(number + 1) + ".png", *bytes});
}

// ---- grains

std::vector<Mineral> minerals(const Table& grains, Index base) {
    std::vector<Mineral> found;
    double sum = 0;
    for (const Table& mineral : grains.list("mineral")) {
        const double fraction = mineral.number("fraction").value_or(0);
        sum += fraction;
        const std::optional<Index> material = mineral.material("material");
        if (!material) continue;
        found.push_back({*material, fraction});
        if (*material == base)
            mineral
                .report("duplicate-name", "material",
                        "`" + mineral.path() + "` is of the material that the other grains keep")
                .note = "its fraction is what the others leave";
    }
    if (sum > 1 + 1e-9)
        grains.report("out-of-range", item("mineral", 0) + ".fraction",
                      "the fractions of `" + grains.path() + "` sum to more than 1");
    return found;
}

void read_grains(const Table& table) {
    Scenario& scenario = table.reading().scenario;
    GrainedRock rock;
    if (!scenario.materials.empty()) table.compute("in", Node::of_text(scenario.materials.front().name));
    rock.material = table.material("in").value_or(0);
    if (std::ranges::count(scenario.rocks, rock.material, &GrainedRock::material) > 0)
        table.error("duplicate-name", "", "is the second that makes grains of this material");
    table.fill(rock.grains);
    rock.grains.direction = table.radians("direction");
    rock.minerals = minerals(table, rock.material);
    check_size(table, rock.grains.size, "a grain needs a few triangles: larger grains or a finer mesh");
    scenario.rocks.push_back(std::move(rock));
}

}  // namespace

void read_microstructure(Reading& reading) {
    std::size_t n_inclusions = 0, n_joints = 0, n_maps = 0;
    for (const Table& table : reading.list("inclusions")) read_inclusions(table, n_inclusions++);
    for (const Table& table : reading.list("joints")) read_joints(table, n_joints++);
    for (const Table& table : reading.list("map")) read_map(table, n_maps++);
    for (const Table& table : reading.list("grains")) read_grains(table);
}

}  // namespace knap
