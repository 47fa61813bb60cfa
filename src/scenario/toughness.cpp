#include "scenario/toughness.hpp"

#include "scenario/toml_tree.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr CalibrationFormat toughness_format{
    "toughness", "softening,unloading,order,gamma,edges,load,through,seeds,speed_over_cR,surplus,deviation", 2};
constexpr std::string_view of_norm = " norm";  // behind the softening
constexpr double beyond_edges = 2;             // of the table: from 3 to 30 edges the surplus changes by 0.06

ToughnessRow toughness_row(const CalibrationLine& line) {
    const std::vector<double>& numbers = line.numbers;
    if (!(numbers[2] > 0)) throw bad_calibration(toughness_format, line, "has no edges");
    if (numbers[4] > 0 && !(numbers[7] > 0)) throw bad_calibration(toughness_format, line, "has no surplus");
    return {.law = {line.words[0], line.words[1], static_cast<Index>(numbers[0]), numbers[1], numbers[2]},
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

}  // namespace

std::string softening_words(const Node& law) {
    const Node *softening = law.find("softening"), *coupling = law.find("coupling");
    std::string text = softening && softening->valid ? softening->text : "linear";
    for (const char* parameter : {"plateau", "exponent"})
        if (const Node* node = law.find(parameter); node && node->valid) text += formatted(" %.4g", node->number);
    if (coupling && coupling->valid && coupling->text == "norm") text += of_norm;
    return text;
}

std::string given_keys(const Node& law, std::span<const char* const> keys) {
    std::vector<std::string> given;
    for (const char* key : keys)
        if (const Node* node = law.find(key); node && node->is_given() && !(node->is_number() && node->number == 0))
            given.emplace_back(key);
    return joined(given, " and ");
}

std::vector<ToldOfLaw> told_of(const MeshedLaw& law) {
    return {{formatted("order %d", law.order), {}},
            {"softening " + law.softening, {"softening", "coupling"}},
            {"unloading " + law.unloading, {"unloading"}},
            {formatted("gamma %.4g", law.gamma), {"gamma", "friction_over_pressure", "friction_csv"}}};
}

std::string told_text(const Node& law, const std::vector<ToldOfLaw>& told) {
    std::vector<std::string> given, by_default;
    for (const ToldOfLaw& part : told) {
        const bool is_given = part.keys.empty() || std::ranges::any_of(part.keys, [&](const char* key) {
                                  const Node* node = law.find(key);
                                  return node && node->is_given();
                              });
        (is_given ? given : by_default).push_back(part.words);
    }
    return joined(given, ", ") + (by_default.empty() ? "" : "; by default " + joined(by_default, ", "));
}

MeshedLaw MeshedLaw::with(Coupling coupling) const {
    MeshedLaw law = *this;
    if (law.softening.ends_with(of_norm)) law.softening.resize(law.softening.size() - of_norm.size());
    if (coupling == Coupling::norm) law.softening += of_norm;
    return law;
}

std::string toughness_csv(const std::vector<ToughnessRow>& rows) {
    std::string text = std::string(toughness_format.columns) + "\n";
    for (const ToughnessRow& row : rows)
        text += row.law.softening + "," + row.law.unloading +
                formatted(",%d,%.4g,%.4g,%.4g,%.3g,%d,%.3g,%.4f,%.4f\n", row.law.order, row.law.gamma, row.law.edges,
                          row.load, row.through, row.seeds, row.speed, row.surplus, row.deviation);
    return text;
}

ToughnessTable::ToughnessTable(const std::string& csv) {
    for (const CalibrationLine& line : calibration_lines(toughness_format, csv)) {
        const ToughnessRow row = toughness_row(line);
        if (row.through > 0) all_.push_back(row);
        if (!row.breaks()) continue;
        const auto same = std::ranges::find_if(rows_, [&](const ToughnessRow& other) {
            return same_kind(row.law, other.law) && row.law.gamma == other.law.gamma &&
                   row.law.edges == other.law.edges;
        });
        if (same == rows_.end()) rows_.push_back(row);
        else if (row.load < same->load) *same = row;
    }
}

/// [-] In [0, 1].
double apart(double a, double b) { return a == b ? 0 : std::abs(a - b) / (a + b); }

std::optional<double> distance(const MeshedLaw& row, const MeshedLaw& law) {
    if (row.softening.ends_with(of_norm) != law.softening.ends_with(of_norm)) return {};
    const auto shape = [](const std::string& words) { return words.substr(0, words.find(' ')); };
    const double other_kind = 100, other_parameter = 10;
    double sum = apart(row.gamma, law.gamma) + 0.1 * apart(row.edges, law.edges);
    if (row.softening != law.softening)
        sum += shape(row.softening) == shape(law.softening) ? other_parameter : other_kind;
    if (row.unloading != law.unloading) sum += other_kind;
    if (row.order != law.order) sum += other_kind;
    return sum;
}

std::vector<std::string> differences(const MeshedLaw& row, const MeshedLaw& law, double factor) {
    std::vector<std::string> parts;
    const auto without_coupling = [](std::string words) {
        if (words.ends_with(of_norm)) words.resize(words.size() - of_norm.size());
        return words;
    };
    if (row.softening != law.softening) parts.push_back("softening " + without_coupling(row.softening));
    if (row.unloading != law.unloading) parts.push_back("unloading " + row.unloading);
    if (row.order != law.order) parts.push_back(formatted("order %d", row.order));
    if (row.gamma != law.gamma) parts.push_back(formatted("gamma %.3g", row.gamma));
    if (std::abs(std::log(row.edges / law.edges)) > std::log(factor))
        parts.push_back(formatted("%.3g edges", row.edges));
    return parts;
}

std::optional<Surplus> ToughnessTable::find(const MeshedLaw& law) const {
    std::vector<SurplusPoint> points;
    for (const ToughnessRow& row : rows_)
        if (same_kind(row.law, law))
            points.push_back({{row.law.gamma, std::log(row.law.edges)}, {row.surplus, row.deviation}});
    return interpolated(points, {law.gamma, std::log(law.edges)}, {0, std::log(beyond_edges)});
}

std::optional<Surplus> ToughnessTable::at_speed(const MeshedLaw& law, double speed) const {
    std::vector<SurplusPoint> points;
    for (const ToughnessRow& row : all_)
        if (same_kind(row.law, law))
            points.push_back({{row.law.gamma, std::log(row.law.edges), row.speed}, {row.surplus, row.deviation}});
    return interpolated(points, {law.gamma, std::log(law.edges), speed}, {0, std::log(beyond_edges), 0});
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

}  // namespace knap
