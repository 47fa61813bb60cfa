#include "scenario/toughness.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "scenario/toml_tree.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace knap {
namespace {

constexpr const char* toughness_columns =
    "softening,unloading,order,gamma,edges,load,through,seeds,speed_over_cR,surplus,deviation";
constexpr double beyond_edges = 2;  // of the table: from 3 to 30 edges the surplus changes by 0.06

std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, ',');) fields.emplace_back(trimmed(field));
    return fields;
}

ToughnessRow toughness_row(const std::string& line, int number) {
    const std::vector<std::string> fields = fields_of(line);
    const auto refuse = [&](const std::string& what) {
        return UserError("bad-csv", "line " + std::to_string(number) + " of the table of toughness " + what,
                         std::string("each line: ") + toughness_columns + "; `knap calibrate` writes such a table");
    };
    if (fields.size() != 11) throw refuse("has " + std::to_string(fields.size()) + " fields instead of 11");
    std::vector<double> numbers;
    for (std::size_t i = 2; i < fields.size(); ++i) {
        double& value = numbers.emplace_back(0);
        const auto [end, fault] = std::from_chars(fields[i].data(), fields[i].data() + fields[i].size(), value);
        if (fault != std::errc() || end != fields[i].data() + fields[i].size() || !(value >= 0 && value < 1e9))
            throw refuse("has `" + fields[i] + "` in place of a number");
    }
    if (!(numbers[2] > 0)) throw refuse("has no edges");
    if (numbers[4] > 0 && !(numbers[7] > 0)) throw refuse("has no surplus");
    return {.law = {fields[0], fields[1], static_cast<Index>(numbers[0]), numbers[1], numbers[2]},
            .load = numbers[3],
            .through = numbers[4],
            .seeds = static_cast<int>(numbers[5]),
            .speed = numbers[6],
            .surplus = numbers[7],
            .deviation = numbers[8]};
}

bool same_kind(const MeshedLaw& a, const MeshedLaw& b) {
    return a.softening == b.softening && a.unloading == b.unloading && a.order == b.order;
}

using Points = std::map<double, Surplus>;  // over ln(edges) or gamma

/// Linear between the points; none outside.
std::optional<Surplus> between(const Points& points, double x) {
    const double tolerance = 1e-9 * (1 + std::abs(x));
    const auto above = points.lower_bound(x - tolerance);
    if (above == points.end()) return {};
    if (above->first <= x + tolerance) return above->second;
    if (above == points.begin()) return {};
    const auto below = std::prev(above);
    const double part = (x - below->first) / (above->first - below->first);
    return Surplus{std::lerp(below->second.mean, above->second.mean, part),
                   std::lerp(below->second.deviation, above->second.deviation, part)};
}

}  // namespace

std::string softening_words(const Node& law) {
    const Node* softening = law.find("softening");
    if (!softening || !softening->valid) return "linear";
    std::string text = softening->text;
    for (const char* parameter : {"plateau", "exponent"})
        if (const Node* node = law.find(parameter); node && node->valid) text += formatted(" %.4g", node->number);
    return text;
}

std::string toughness_csv(const std::vector<ToughnessRow>& rows) {
    std::string text = std::string(toughness_columns) + "\n";
    for (const ToughnessRow& row : rows)
        text += row.law.softening + "," + row.law.unloading +
                formatted(",%d,%.4g,%.4g,%.4g,%.3g,%d,%.3g,%.4f,%.4f\n", row.law.order, row.law.gamma, row.law.edges,
                          row.load, row.through, row.seeds, row.speed, row.surplus, row.deviation);
    return text;
}

ToughnessTable::ToughnessTable(const std::string& csv) {
    std::istringstream in(csv);
    int number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        const std::string content(trimmed(std::string_view(line).substr(0, line.find_first_of("#\r"))));
        if (content.empty() || content == toughness_columns) continue;
        const ToughnessRow row = toughness_row(content, number);
        if (!row.breaks()) continue;
        const auto same = std::ranges::find_if(rows_, [&](const ToughnessRow& other) {
            return same_kind(row.law, other.law) && row.law.gamma == other.law.gamma &&
                   row.law.edges == other.law.edges;
        });
        if (same == rows_.end()) rows_.push_back(row);
        else if (row.load < same->load) *same = row;
    }
    if (number == 0) throw UserError("bad-csv", "the table of toughness is empty", "`knap calibrate` writes one");
}

std::optional<Surplus> ToughnessTable::find(const MeshedLaw& law) const {
    std::map<double, Points> by_gamma;  // then over ln(edges)
    for (const ToughnessRow& row : rows_)
        if (same_kind(row.law, law))
            by_gamma[row.law.gamma][std::log(row.law.edges)] = Surplus{row.surplus, row.deviation};
    Points over_gamma;
    for (const auto& [gamma, over_edges] : by_gamma) {
        const double fewest = over_edges.begin()->first, most = over_edges.rbegin()->first, x = std::log(law.edges);
        const double margin = std::log(beyond_edges) + 1e-9;
        if (x < fewest - margin || x > most + margin) continue;
        over_gamma[gamma] = *between(over_edges, std::clamp(x, fewest, most));
    }
    return between(over_gamma, law.gamma);
}

std::optional<Surplus> ToughnessTable::of_measured(MeshedLaw law) const {
    const double edges = law.edges;
    std::optional<Surplus> found = find(law);
    // the surplus changes by less than a tenth over a factor of two in the edges: a contraction
    for (int round = 0; round < 50; ++round) {
        law.edges = edges / (found ? found->mean : 1.2);
        const std::optional<Surplus> next = find(law);
        if (found && next && std::abs(next->mean - found->mean) < 1e-12) return next;
        if (!next && round > 0) return {};
        found = next;
    }
    return found;
}

std::string ToughnessTable::contents() const {
    struct Extent {
        double gamma[2] = {infinity, 0}, edges[2] = {infinity, 0};
    };
    std::map<std::string, Extent> kinds;
    for (const ToughnessRow& row : rows_) {
        Extent& extent = kinds[formatted("order %d, softening %s, unloading %s", row.law.order,
                                         row.law.softening.c_str(), row.law.unloading.c_str())];
        extent.gamma[0] = std::min(extent.gamma[0], row.law.gamma);
        extent.gamma[1] = std::max(extent.gamma[1], row.law.gamma);
        extent.edges[0] = std::min(extent.edges[0], row.law.edges);
        extent.edges[1] = std::max(extent.edges[1], row.law.edges);
    }
    std::vector<std::string> parts;
    for (const auto& [kind, extent] : kinds)
        parts.push_back(kind + formatted(": gamma %.4g to %.4g, %.3g to %.3g edges", extent.gamma[0], extent.gamma[1],
                                         extent.edges[0], extent.edges[1]));
    return parts.empty() ? "no row whose cracks ran through" : joined(parts, "; ");
}

}  // namespace knap
