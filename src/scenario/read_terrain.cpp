// [[obstacle]] shape = "polyline": its points, their roughness, and ranges with laws of their own.
#include "base/formatted.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <optional>

namespace knap {
namespace {

constexpr double same_x = 1e-9;  // [-] of the width of the terrain

/// What is wrong with the points of an open polyline, or "".
std::string fault_of(const std::vector<Vec2>& points) {
    const auto nearby = [&](std::size_t i) { return place_text(points[i]); };
    if (points.size() < 2) return "has one point; a polyline needs two";
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
        if (points[i] == points[i + 1]) return "has two points in a row at " + nearby(i);
    const Polyline line(points);
    std::string fault;
    const auto side = [&](Index i) { return Segment{line.sides()[i].start, line.sides()[i].end}; };
    for (Index i = 0; i + 1 < line.n_points() && fault.empty(); ++i) {
        const Polyline::Side& own = line.sides()[i];
        if (i > 0 && line.sides()[i - 1].along.dot(own.along) < -1 + 1e-12)
            return "turns back on itself at " + nearby(i);
        line.visit_near(own.start, own.length, [&](Index j) {
            if (j <= i + 1 || distance_between(side(i), side(j)) > 0 || !fault.empty()) return;
            const auto [a, b] = side(i);
            const auto [c, d] = side(j);
            const double across = cross(b - a, d - c), share = across == 0 ? 0 : cross(c - a, d - c) / across;
            fault = "crosses or touches itself at " + place_text(a + std::clamp(share, 0.0, 1.0) * (b - a));
        });
    }
    return fault;
}

struct GivenRange {
    std::string path;  // of its table
    SurfaceRange surface;
    Roughness roughness;
};

/// The ranges, ascending; none after an error.
std::vector<GivenRange> read_ranges(const Table& table, const Box& box, const ContactLaw& law,
                                    const Roughness& roughness) {
    std::vector<GivenRange> ranges;
    const double low = box.low.x(), high = box.high.x(), tolerance = same_x * (high - low);
    const auto metres = [](double x) { return shortest(x) + " m"; };
    const auto within = "the terrain reaches from x = " + metres(low) + " to " + metres(high);
    bool is_bad = false;
    for (const Table& entry : table.list("range")) {
        SurfaceRange surface{entry.number("from").value_or(low), entry.number("to").value_or(high), law};
        read_contact_law(entry, surface.law);
        const auto bad = [&](const char* key, const std::string& text, const std::string& note) {
            entry.error("out-of-range", key, text, note);
            is_bad = true;
        };
        for (const auto& [key, x] : {std::pair("from", surface.from), {"to", surface.to}})
            if (x < low - tolerance || x > high + tolerance) bad(key, "lies beyond the terrain", within);
        if (!(surface.from < surface.to)) bad("from", "is not less than `to`", within);
        ranges.push_back({entry.path(), surface, roughness});
        entry.fill(ranges.back().roughness);
    }
    std::ranges::sort(ranges, {}, [](const GivenRange& range) { return range.surface.from; });
    for (std::size_t i = 1; i < ranges.size() && !is_bad; ++i)
        if (const SurfaceRange& before = ranges[i - 1].surface, &now = ranges[i].surface;
            now.from < before.to - tolerance) {
            table.reading()
                .table(ranges[i].path)
                .error("out-of-range", "from", "begins within another range",
                       "which reaches from x = " + metres(before.from) + " to " + metres(before.to));
            is_bad = true;
        }
    if (is_bad) ranges.clear();
    return ranges;
}

/// The points after their offsets; none after an error.
std::optional<std::vector<Vec2>> read_roughness(const Table& table, const std::vector<Vec2>& points,
                                                const std::vector<GivenRange>& given, const Roughness& elsewhere) {
    std::vector<RoughRange> ranges, smooth;
    for (const GivenRange& range : given) {
        ranges.push_back({range.surface.from, range.surface.to, range.roughness});
        smooth.push_back(ranges.back());
        smooth.back().roughness.size = 0;
    }
    if (elsewhere.size == 0 && std::ranges::all_of(ranges, [](const auto& r) { return r.roughness.size == 0; }))
        return points;
    const auto seed = static_cast<std::uint64_t>(table.number("seed").value_or(table.scenario().seed));
    const Random random(seed, "roughness of " + table.text("name"));
    // an offset is less than the segments beside it are long
    const std::vector<Vec2> before = roughened(points, smooth, {.spacing = elsewhere.spacing}, random);
    for (std::size_t i = 0; i + 1 < before.size(); ++i) {
        const double length = (before[i + 1] - before[i]).norm(), x = 0.5 * (before[i] + before[i + 1]).x();
        const auto range =
            std::ranges::find_if(given, [&](const GivenRange& r) { return r.surface.from <= x && x <= r.surface.to; });
        if ((range == given.end() ? elsewhere : range->roughness).size < length) continue;
        const Table own = table.reading().table(range == given.end() ? table.path() : range->path);
        (own.given("roughness") ? own : table)
            .error("out-of-range", "roughness", "is as large as the segments",
                   "that at " + place_text(before[i]) + " is " + shortest(length) + " m long");
        return std::nullopt;
    }
    std::vector<Vec2> rough = roughened(points, ranges, elsewhere, random);
    if (const std::string fault = fault_of(rough); !fault.empty()) {
        table.error("out-of-range", "roughness", "is too large: the rough terrain " + fault,
                    "a smaller roughness, or a larger spacing");
        return std::nullopt;
    }
    return rough;
}

}  // namespace

void read_polyline(const Table& table, Obstacle& obstacle) {
    const auto form = table.one_of({"points", "csv"}, true);
    if (!form || !table.has(*form)) return;
    auto points = form == "csv" ? read_pairs(table, {.line = "x, y",
                                                     .first = "x",
                                                     .note = "each line: x, y along the polyline, with a line of names "
                                                             "`x [m], y [m]` or units behind the numbers",
                                                     .key = "points",
                                                     .unit = "m"})
                                : *table.get<std::vector<Vec2>>("points");
    if (points.empty()) return;
    if (const std::string fault = fault_of(points); !fault.empty())
        return table.error("out-of-range", *form, fault, "the points of an open polyline in order");
    Roughness roughness;
    table.fill(roughness);
    const std::vector<GivenRange> ranges = read_ranges(table, bounding_box(points), obstacle.contact, roughness);
    for (const GivenRange& range : ranges) obstacle.ranges.push_back(range.surface);
    auto rough = read_roughness(table, points, ranges, roughness);
    if (!rough) return;
    obstacle.start.position = bounding_box(points).middle();
    for (Vec2& p : *rough) p -= obstacle.start.position;
    obstacle.outline.kind = Outline::Kind::polyline;
    obstacle.outline.line = std::make_shared<const Polyline>(*rough);
    obstacle.outline.points = std::move(*rough);
}

}  // namespace knap
