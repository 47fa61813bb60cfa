// [[map]]: pictures whose colours are materials.
#include <charconv>
#include <cmath>

#include "observe/read_png.hpp"
#include "scenario/assemble.hpp"

namespace knap {
namespace {

constexpr int farthest = 80;  // of a pixel from the colour that it counts as, in steps of 255 along red, green and blue

struct PaintedMaterial {
    std::array<int, 3> rgb;
    Index material;
};

std::optional<std::array<int, 3>> colour_of(const std::string& text) {
    std::array<int, 3> rgb{};
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    for (int i = 0; i < 3; ++i) {
        const char* begin = text.data() + 1 + 2 * i;
        if (const auto [end, code] = std::from_chars(begin, begin + 2, rgb[i], 16); code != std::errc() || end != begin + 2) return std::nullopt;
    }
    return rgb;
}

std::vector<PaintedMaterial> palette(const Assembly& assembly, const std::string& map) {
    std::vector<PaintedMaterial> found;
    for (std::size_t i = 0; i < assembly.values.count(map + ".colour"); ++i) {
        const std::string path = item(map + ".colour", i);
        const std::optional<Index> material = assembly.material_at(path + ".material");
        const std::optional<std::string> text = assembly.values.text(path + ".rgb");
        if (!text) continue;
        const auto rgb = colour_of(*text);
        if (!rgb)
            assembly.findings.error("bad-value", "`" + *text + "` is no colour", assembly.at(path + ".rgb")).note = "as \"#rrggbb\", two digits 0-9 a-f each";
        if (rgb && material) found.push_back({*rgb, *material});
    }
    if (assembly.values.count(map + ".colour") == 0)
        assembly.findings.error("missing-key", "`" + map + "` has no colours", assembly.at(map)).note = "colour = [{ rgb = \"#ff0000\", material = \"NAME\" }]";
    return found;
}

Index nearest(const std::vector<PaintedMaterial>& palette, const std::uint8_t* pixel) {
    Index material = -1;
    int least = farthest * farthest;
    for (const PaintedMaterial& painted : palette) {
        int squared = 0;
        for (int i = 0; i < 3; ++i) squared += (pixel[i] - painted.rgb[i]) * (pixel[i] - painted.rgb[i]);
        if (squared <= least) least = squared, material = painted.material;
    }
    return material;
}

/// The rectangle round the body.
void set_box(const Assembly& assembly, const std::string& path, MaterialMap& map) {
    if (const std::optional<Box> box = assembly.values.box(path + ".box")) {
        map.low = box->low;
        map.high = box->high;
        return;
    }
    const auto& given = assembly.scenario.given;
    const std::vector<Vec2>& points = given ? given->mesh.vertices : assembly.scenario.shape.outer.points;
    if (points.empty()) return;
    map.low = map.high = points.front();
    for (const Vec2& x : points) map.low = map.low.cwiseMin(x), map.high = map.high.cwiseMax(x);
}

}  // namespace

void assemble_maps(Assembly& assembly) {
    for (std::size_t i = 0; i < assembly.values.count("map"); ++i) {
        const std::string path = item("map", i);
        const std::vector<PaintedMaterial> colours = palette(assembly, path);
        const std::optional<std::string> file = assembly.values.text(path + ".file");
        if (!file) continue;
        const std::optional<std::string> bytes = assembly.beside.bytes_of(*file);
        const Node& at = assembly.at(path + ".file");
        if (!bytes) {
            assembly.findings.error("missing-file", "cannot read `" + (assembly.beside.directory / *file).string() + "`", at).note =
                "file names are relative to the scenario file";
            continue;
        }
        std::string problem;
        const std::optional<Picture> picture = read_png(*bytes, problem);
        if (!picture) {
            assembly.findings.error("bad-file", "`" + *file + "` " + problem, at);
            continue;
        }
        MaterialMap map{.width = picture->width, .height = picture->height};
        set_box(assembly, path, map);
        std::size_t n_none = 0;
        for (std::size_t pixel = 0; pixel < picture->rgb.size() / 3; ++pixel) {
            map.material.push_back(nearest(colours, &picture->rgb[3 * pixel]));
            n_none += map.material.back() < 0;
        }
        if (n_none == map.material.size() && !colours.empty())
            assembly.findings.error("bad-value", "no pixel of `" + *file + "` has one of the colours", assembly.at(path));
        else if (n_none > 0)
            assembly.findings.warning("map", std::to_string(static_cast<int>(std::ceil(100.0 * static_cast<double>(n_none) / static_cast<double>(map.material.size())))) +
                                                 " % of the pixels of `" + *file + "` have none of the colours and change nothing", at);
        assembly.scenario.maps.push_back(std::move(map));
        assembly.scenario.files.push_back({path + ".file", "map" + std::to_string(i + 1) + ".png", *bytes});
    }
}

}  // namespace knap
