// [[inclusions]], [[joints]] and [[traces]], which become regions, holes and cracks of the shape; [[map]], whose
// colours are materials; [[grains]].
#include "figures/read_png.hpp"
#include "microstructure/inclusions.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace knap {
namespace {

constexpr double min_size = 1.5;         // [mesh size] grains and inclusions of fewer triangles would have no shape
constexpr Index max_grains = 100'000;    // of a picture
constexpr int max_colour_distance = 80;  // of a pixel from its colour, in the RGB cube of side 255

/// Without a mistake so far.
bool is_valid(const Table& set, const Body& body) {
    return body.shape.outer.points.size() >= 3 && body.mesh.size > 0 && !set.reading().findings.has_errors();
}

/// An error if a length is below `factor` times the mesh size; `factor_text` names the factor: "half of ".
void check_length(const Table& table, double mesh_size, const char* key, double factor, const char* factor_text,
                  const char* cure = "") {
    const std::optional<double> length = table.number(key);
    if (length && *length < factor * mesh_size)
        table.error("out-of-range", key, std::string("is below ") + factor_text + "mesh.size", cure);
}

/// Calls `place`, which adds inclusions or joints to a part of the shape; reports its failure at `key`.
template <class Place>
void place_set(const Table& table, const Body& body, PlacedSet::Part part, const std::string& key,
               const std::string& cure, Place place) {
    const Shape& shape = body.shape;
    const auto size = [&] {
        if (part == PlacedSet::Part::regions) return shape.regions.size();
        return part == PlacedSet::Part::holes ? shape.holes.size() : shape.cracks.size();
    };
    PlacedSet set{.path = table.path(),
                  .body = static_cast<std::size_t>(&body - table.scenario().bodies.data()),
                  .part = part,
                  .first = size()};
    try {
        set.fraction = place();
    } catch (const ShapeError& error) {
        table.error("geometry", key, std::string("cannot be met: ") + error.what(), cure);
    }
    set.n = static_cast<int>(size() - set.first);
    table.scenario().placed_sets.push_back(set);
}

void read_inclusions(const Table& table, std::size_t number) {
    Body* const body = body_to_change(table);
    const MeshOptions& mesh = body ? body->mesh : table.scenario().mesh;
    const double size = mesh.size;
    const auto amount = table.one_of({"fraction", "number"}, true);
    if (size > 0) table.compute("distance", Node::of_number(0.5 * size));
    const bool pores = !table.given("material");
    if (pores) table.compute("name", Node::of_text("pores"));
    InclusionOptions options{.tag = table.material("material"), .mesh = mesh};
    table.fill(options);
    if (!pores && table.given("name"))
        table.error("exclusive-keys", "name", "belongs to pores, which have no material");
    check_length(table, size, "size", min_size, "1.5 times ", "larger inclusions or a finer mesh");
    check_length(table, size, "distance", 0.2, "a fifth of ");
    if (!amount || !body || !is_valid(table, *body)) return;
    if (pores)
        options.boundary = boundary_index(body->shape, (body->name.empty() ? "" : body->name + ".") +
                                                           (table.has("name") ? table.text("name") : "pores"));
    const std::string cure =
        "a smaller " + *amount + ", or a smaller distance" + (options.number > 0 ? ", or smaller inclusions" : "");
    place_set(table, *body, pores ? PlacedSet::Part::holes : PlacedSet::Part::regions, *amount, cure, [&] {
        return place_inclusions(body->shape, options, table.scenario().seed, "inclusions " + std::to_string(number))
            .fraction;
    });
}

void read_joints(const Table& table, std::size_t number) {
    Scenario& scenario = table.scenario();
    Body* const body = body_to_change(table);
    const double size = body ? body->mesh.size : scenario.mesh.size;
    JointOptions options{.tag = table.material("material"), .nearest = 0.2 * size};
    table.fill(options);
    const bool crosses = options.persistence == 1, has_law = table.given("interface");
    if (table.has("persistence") && crosses == table.given("length"))
        table.error("missing-key", "", ": length belongs to a persistence below 1",
                    "both keys, or none of them for joints from end to end");
    if (table.given("thickness") != table.given("material"))
        table.error("missing-key", "", ": thickness and material belong together", "they make veins");
    if (has_law) table.one_of({"interface", "thickness"}, false);
    check_length(table, size, "spacing", 1, "");
    check_length(table, size, "thickness", 0.5, "half of ");
    if (!body || !is_valid(table, *body)) return;
    if (has_law) options.joint = table.new_joint_set();
    int n_left_out = 0;
    place_set(table, *body, options.tag ? PlacedSet::Part::regions : PlacedSet::Part::cracks, "spacing",
              "a larger spacing or length, or a smaller body", [&] {
                  n_left_out = place_joints(body->shape, options, scenario.seed, "joints " + std::to_string(number));
                  return 0.;
              });
    if (n_left_out > 0)
        table.warning("geometry", "",
                      "left out " + std::to_string(n_left_out) + " traces, which found no place between other lines");
}

// ---- maps

using Rgb = std::array<int, 3>;

struct PaintedMaterial {
    Rgb rgb;
    Index material;
    std::size_t row;  // of the table
};

/// "#rrggbb"
std::optional<Rgb> colour_of(const std::string& text) {
    unsigned rgb = 0;
    const char* end = text.data() + text.size();
    if (text.size() != 7 || text[0] != '#' || std::from_chars(text.data() + 1, end, rgb, 16).ptr != end) return {};
    return Rgb{static_cast<int>(rgb >> 16), static_cast<int>(rgb >> 8 & 255), static_cast<int>(rgb & 255)};
}

std::vector<PaintedMaterial> palette(const Table& map) {
    std::vector<PaintedMaterial> found;
    const std::vector<Table> rows = map.list("colour");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Table& row = rows[i];
        const auto material = row.material("material");
        const auto rgb = colour_of(row.text("rgb"));
        if (row.has("rgb") && !rgb)
            row.error("bad-value", "rgb", "= \"" + row.text("rgb") + "\" is no colour",
                      "as \"#rrggbb\", two hexadecimal digits each");
        if (rgb && material) found.push_back({*rgb, *material, i});
    }
    if (rows.empty())
        map.error("missing-key", "", "has no colours", "colour = [{ rgb = \"#ff0000\", material = \"NAME\" }]");
    return found;
}

/// The nearest colour of the palette; null where all are far.
const PaintedMaterial* colour_of_pixel(const std::vector<PaintedMaterial>& palette, const std::uint8_t* pixel) {
    const PaintedMaterial* nearest = nullptr;
    int min_squared = max_colour_distance * max_colour_distance;
    for (const PaintedMaterial& painted : palette) {
        int squared = 0;
        for (int i = 0; i < 3; ++i) squared += (pixel[i] - painted.rgb[i]) * (pixel[i] - painted.rgb[i]);
        if (squared <= min_squared) min_squared = squared, nearest = &painted;
    }
    return nearest;
}

void read_map(const Table& table, std::size_t number) {
    Scenario& scenario = table.scenario();
    const std::vector<PaintedMaterial> colours = palette(table);
    if (!table.has("file")) return;
    const auto bytes = table.bytes_of("file");
    if (!bytes) return;
    std::string problem;
    const std::optional<Picture> picture = read_png(*bytes, problem);
    if (!picture)
        return table.error(
            "bad-file", "file", problem,
            "knap-convert PICTURE.tif PICTURE.png (or .jpg), of `pip install './tools/python[convert]'`");
    std::vector<Vec2> points;  // of the bodies
    if (scenario.given) points = scenario.given->mesh.vertices;
    for (const Body& body : scenario.bodies)
        points.insert(points.end(), body.shape.outer.points.begin(), body.shape.outer.points.end());
    if (points.empty()) return;
    const Box box = table.get<Box>("box").value_or(bounding_box(points));
    MaterialMap map{.low = box.low, .high = box.high, .width = picture->width, .height = picture->height};
    table.compute("smooth", Node::of_boolean(table.get<bool>("grains").value_or(false)));
    table.fill(map);
    std::vector<bool> found(colours.size(), false);
    for (std::size_t pixel = 0; pixel < picture->rgb.size() / 3; ++pixel) {
        const PaintedMaterial* const painted = colour_of_pixel(colours, &picture->rgb[3 * pixel]);
        map.material.push_back(painted ? painted->material : -1);
        if (painted) found[static_cast<std::size_t>(painted - colours.data())] = true;
    }
    const auto n = static_cast<double>(map.material.size()),
               n_none = static_cast<double>(std::ranges::count(map.material, -1));
    if (n_none == n && !colours.empty()) {
        table.error("bad-value", "", "has no pixel with one of the colours");
        found.assign(found.size(), true);
    } else if (n_none > 0) {
        const std::string percent = std::to_string(static_cast<int>(std::ceil(100 * n_none / n)));
        table.warning(
            "map", "file",
            "has " + percent + " % of its pixels in none of the colours; they change nothing" +
                (map.grains ? " and are no grain: edges among them have the law of their material with itself, "
                              "not that within grains"
                            : ""));
    }
    const std::vector<Table> rows = table.list("colour");
    for (std::size_t i = 0; i < colours.size(); ++i)
        if (const Table& row = rows[colours[i].row]; !found[i])
            row.warning("map", "rgb",
                        "= \"" + row.text("rgb") + "\" is the colour of no pixel: the map gives `" +
                            row.text("material") + "` to no place by it",
                        "the colours as the picture has them: knap-convert --colours");
    if (map.grains && n_none < n) {
        const Index n_grains = map.find_patches(picture->rgb);
        if (n_grains == 0)
            table.error("bad-value", "least_pixels", "leaves no patch of the picture as a grain",
                        "a smaller one; or colours without noise: knap-convert --colours");
        else if (n_grains > max_grains)
            table.error("bad-value", "grains",
                        "makes " + std::to_string(n_grains) +
                            " grains of the picture: its colours "
                            "have noise or soft edges",
                        "a larger least_pixels; or colours without noise: knap-convert --colours");
    }
    scenario.maps.push_back(std::move(map));
    scenario.files.push_back({table.path("file"), "map" + std::to_string(number + 1) + ".png", *bytes});
}

// ---- grains

void read_grains(const Table& table) {
    Scenario& scenario = table.scenario();
    GrainedRock rock;
    if (!scenario.materials.empty()) table.compute("in", Node::of_text(scenario.materials.front().name));
    rock.material = table.material("in").value_or(0);
    if (std::ranges::count(scenario.rocks, rock.material, &GrainedRock::material) > 0)
        table.error("duplicate-name", "", "is the second that makes grains of this material");
    table.fill(rock.grains);
    double sum = 0;
    for (const Table& row : table.list("mineral")) {
        Mineral mineral{.region = row.material("material").value_or(-1)};
        row.fill(mineral);
        sum += mineral.fraction;
        if (mineral.region < 0) continue;
        rock.minerals.push_back(mineral);
        if (mineral.region == rock.material)
            row.error("duplicate-name", "material", "is the material of the other grains",
                      "its fraction is the rest that the others leave");
    }
    if (sum > 1 + 1e-9)
        table.error("out-of-range", "mineral[0].fraction", "and the other fractions sum to more than 1");
    check_length(table, scenario.mesh.size, "size", min_size, "1.5 times ",
                 "a grain needs a few triangles: larger grains or a finer mesh");
    scenario.rocks.push_back(std::move(rock));
}

}  // namespace

Body* body_to_change(const Table& entry) {
    std::vector<Body>& bodies = entry.scenario().bodies;
    if (entry.reading().table("mesh").given("file")) {
        entry.exclude("", "[[" + entry.path().substr(0, entry.path().find('[')) + "]]", "mesh.file",
                      "curves and surfaces of the file ([[mesh.joint]]), or grains and maps");
        return nullptr;
    }
    std::vector<std::string> names;
    for (const Body& body : bodies) names.push_back(body.name);
    if (!entry.given("body") && bodies.size() > 1)
        entry.error("missing-key", "body", "is missing", "the name of a body: " + first_of(names));
    if (!entry.given("body")) return bodies.size() == 1 ? &bodies.front() : nullptr;
    const auto found = entry.reading().find(entry.path("body"), "body", entry.text("body"), names);
    return found ? &bodies[*found] : nullptr;
}

void read_microstructure(Reading& reading) {
    std::size_t n_inclusions = 0, n_joints = 0, n_maps = 0;
    for (const Table& table : reading.list("inclusions")) read_inclusions(table, n_inclusions++);
    for (const Table& table : reading.list("joints")) read_joints(table, n_joints++);
    for (const Table& table : reading.list("traces")) read_traces(table);
    for (const Table& table : reading.list("map")) read_map(table, n_maps++);
    for (const Table& table : reading.list("grains")) read_grains(table);
}

}  // namespace knap
