// What moved in all runs of a sweep: where, how high, how fast, how far, in which pieces, and through which collectors.
#include "app/ensemble/ensemble.hpp"
#include "base/quantile.hpp"
#include "figures/chart.hpp"
#include "figures/curve_figures.hpp"
#include "output/history_csv.hpp"
#include "record/outputs.hpp"

#include <algorithm>
#include <map>

namespace knap {
namespace {

namespace fs = std::filesystem;

constexpr Colour ground_colour{0.35, 0.28, 0.2}, faint{0.1, 0.35, 0.6, 0.35};
constexpr double at_rest = 0.01;              // of its diameter: what moves less is the ground
constexpr int n_places = 100;                 // of envelopes
constexpr int n_classes = 40;                 // of run-outs
constexpr std::size_t most_points = 500'000;  // of all trajectories in one figure; then those of the heaviest pieces

/// The way of one piece through one run.
struct Way {
    double mass = 0;                           // [kg] at its start
    std::vector<double> x, y, height, energy;  // [m], [m], [m], [J]
};

/// A piece at the end of its run.
struct Remains {
    std::size_t run = 0;
    double x = 0, mass = 0, diameter = 0;  // [m], [kg], [m]
};

struct Ways {
    std::vector<Way> all;
    std::vector<Remains> remains;
    double low = infinity, high = -infinity;  // [m] x of all
};

/// Of the runs that are done, without what stays where it is, as a ground that is a body.
Ways read_ways(const Ensemble& sweep, const fs::path& runs) {
    Ways found;
    for (std::size_t r = 0; r < sweep.runs.size(); ++r) {
        const fs::path file = runs / sweep.runs[r].name / "trajectories.csv";
        if (sweep.runs[r].result.status != "done" || !fs::exists(file)) continue;
        const History table = read_csv(file);
        std::map<double, Way> of_piece;  // by its label; of an obstacle -1 - its number
        std::map<double, Remains> at_end;
        const std::size_t time = table.place_of("time"), label = table.place_of("label"),
                          obstacle = table.place_of("obstacle"), mass = table.place_of("mass"),
                          diameter = table.place_of("diameter"), x = table.place_of("x"), y = table.place_of("y"),
                          height = table.place_of("height"), energy = table.place_of("energy");
        for (const std::vector<double>& row : table.rows) {
            const double key = std::isnan(row[label]) ? -1 - row[obstacle] : row[label];
            Way& way = of_piece[key];
            if (way.x.empty()) way.mass = row[mass];
            way.x.push_back(row[x]), way.y.push_back(row[y]);
            way.height.push_back(row[height]), way.energy.push_back(row[energy]);
            if (row[time] == table.rows.back()[time]) at_end[key] = {r, row[x], row[mass], row[diameter]};
        }
        std::erase_if(of_piece, [&](const auto& piece) {
            const Way& way = piece.second;
            const auto stays = [&](const std::vector<double>& values) {
                const auto [least, most] = std::ranges::minmax(values);
                return most - least < at_rest * at_end[piece.first].diameter;
            };
            return way.x.size() > 1 && stays(way.x) && stays(way.y);
        });
        for (auto& [piece, way] : of_piece) {
            const auto [least, most] = std::ranges::minmax(way.x);
            found.low = std::min(found.low, least), found.high = std::max(found.high, most);
            if (const auto there = at_end.find(piece); there != at_end.end() && there->second.mass > 0)
                found.remains.push_back(there->second);
            found.all.push_back(std::move(way));
        }
    }
    return found;
}

/// The surface of an obstacle; of a half plane between two x.
Curve surface_of(const Obstacle& obstacle, double low, double high) {
    Curve curve{.colour = ground_colour, .width = 1.8};
    const Rotation turned = Rotation::by(obstacle.start.angle);
    const auto add = [&](const Vec2& p) { curve.x.push_back(p.x()), curve.y.push_back(p.y()); };
    const Vec2 at = obstacle.start.position;
    switch (obstacle.outline.kind) {
        case Outline::Kind::half_plane: {
            const Vec2 normal = turned.turned(obstacle.outline.normal);
            for (const double x : {low, high})
                if (normal.y() > 0) add({x, at.y() - normal.x() / normal.y() * (x - at.x())});
            break;
        }
        case Outline::Kind::disc:
            for (int i = 0; i <= 60; ++i)
                add(at + obstacle.outline.radius * Rotation::by(6 * i * degree).turned({1, 0}));
            break;
        default:
            for (const Vec2& p : obstacle.outline.points) add(at + turned.turned(p));
            if (obstacle.outline.kind == Outline::Kind::polygon)
                add(at + turned.turned(obstacle.outline.points.front()));
    }
    return curve;
}

Chart chart_of_ways(const Ensemble& sweep, const Ways& ways) {
    std::vector<const Way*> heaviest;
    for (const Way& way : ways.all) heaviest.push_back(&way);
    std::ranges::stable_sort(heaviest, std::greater<>(), &Way::mass);
    Chart chart{.title = "Trajectories",
                .x_quantity = "x",
                .x_unit = "m",
                .y_quantity = "y",
                .y_unit = "m",
                .x_with_zero = false,
                .y_with_zero = false};
    const double margin = 0.1 * (ways.high - ways.low);
    chart.x_within = Limits{ways.low - margin, ways.high + margin};
    std::size_t n_points = 0, n_drawn = 0;
    for (const Way* way : heaviest) {
        if ((n_points += way->x.size()) > most_points) break;
        chart.curves.push_back({.x = way->x, .y = way->y, .colour = faint, .width = 0.7});
        ++n_drawn;
    }
    chart.title += " of " + std::to_string(n_drawn) + " pieces";
    if (n_drawn < heaviest.size()) chart.title += ", the heaviest of " + std::to_string(heaviest.size());
    for (const Obstacle& obstacle : sweep.obstacles)
        if (!obstacle.is_free()) chart.curves.push_back(surface_of(obstacle, ways.low, ways.high));
    const Box range = axis_ranges(chart);
    for (std::size_t k = 0; k < sweep.collectors.size(); ++k) {
        const CollectorOptions& line = sweep.collectors[k];
        Curve& curve = chart.curves.emplace_back(Curve{.label = line.name, .colour = curve_colour(k + 1), .dash = 1});
        if (line.x) curve.x = {*line.x, *line.x}, curve.y = {range.low.y(), range.high.y()};
        else curve.x = {line.from.x(), line.to.x()}, curve.y = {line.from.y(), line.to.y()};
    }
    return chart;
}

/// Largest value, 95 % and median of what passes each of many places x; ways are straight between their points.
Chart envelope(const Ways& ways, const char* quantity, const char* unit, std::vector<double> Way::*member) {
    const double width = (ways.high - ways.low) / n_places;
    std::vector<std::vector<double>> passing(n_places);
    for (const Way& way : ways.all)
        for (std::size_t i = 1; i < way.x.size(); ++i) {
            const auto [a, b] = std::minmax(way.x[i - 1], way.x[i]);
            const auto place = [&](double x) { return (x - ways.low) / width - 0.5; };
            for (int k = std::max(0, static_cast<int>(std::ceil(place(a)))); k < n_places && k < place(b); ++k) {
                const double s = (ways.low + (k + 0.5) * width - way.x[i - 1]) / (way.x[i] - way.x[i - 1]);
                passing[k].push_back((1 - s) * (way.*member)[i - 1] + s * (way.*member)[i]);
            }
        }
    Chart chart{.title = std::string(quantity) + " over x",
                .x_quantity = "x",
                .x_unit = "m",
                .y_quantity = quantity,
                .y_unit = unit,
                .x_with_zero = false};
    for (const auto& [label, q] : {std::pair{"largest", 1.}, {"95 %", 0.95}, {"median", 0.5}}) {
        Curve& curve = chart.curves.emplace_back(Curve{.label = label, .colour = curve_colour(chart.curves.size())});
        for (int k = 0; k < n_places; ++k)
            if (const double value = quantile(passing[k], q); std::isfinite(value))
                curve.x.push_back(ways.low + (k + 0.5) * width), curve.y.push_back(value);
    }
    return chart;
}

/// Parts of the mass, and of the runs by their farthest piece, that come to lie at each place.
Chart run_outs(const Ways& ways) {
    const double width = (ways.high - ways.low) / n_classes;
    const auto place = [&](double x) { return std::clamp(static_cast<int>((x - ways.low) / width), 0, n_classes - 1); };
    std::vector<double> mass(n_classes, 0), runs(n_classes, 0);
    std::map<std::size_t, double> farthest;  // by run
    double total = 0;
    for (const Remains& piece : ways.remains) {
        mass[place(piece.x)] += piece.mass, total += piece.mass;
        const auto [at, is_new] = farthest.emplace(piece.run, piece.x);
        if (!is_new) at->second = std::max(at->second, piece.x);
    }
    for (const auto& [run, x] : farthest) runs[place(x)] += 100. / static_cast<double>(farthest.size());
    for (double& part : mass) part *= 100 / total;
    Chart chart{.title = "Run-out",
                .x_quantity = "x at the end",
                .x_unit = "m",
                .y_quantity = "part [%]",
                .x_with_zero = false};
    for (const auto& [label, values] : {std::pair{"mass", &mass}, {"farthest pieces", &runs}}) {
        Curve& curve = chart.curves.emplace_back(Curve{.label = label, .colour = curve_colour(chart.curves.size())});
        for (int k = 0; k < n_classes; ++k)
            for (const int end : {0, 1})
                curve.x.push_back(ways.low + (k + end) * width), curve.y.push_back((*values)[k]);
    }
    return chart;
}

Chart sizes(const Ways& ways) {
    History table{.columns = {"diameter", "mass_part"}, .rows = {}};
    double total = 0;
    for (const Remains& piece : ways.remains) total += piece.mass;
    for (const Remains& piece : ways.remains) table.rows.push_back({piece.diameter, piece.mass / total});
    return fragment_size_chart(table);
}

}  // namespace

std::string passages_csv(const Ensemble& sweep, const fs::path& runs) {
    std::vector<std::string> columns = names_of(passage_columns());
    std::vector<std::string> header = header_of("passages.csv", columns);
    header.insert(header.begin(), "run");
    std::string text = csv_line(header) + "\n";
    for (const EnsembleRun& run : sweep.runs) {
        const fs::path file = runs / run.name / "passages.csv";
        if (run.result.status != "done" || !fs::exists(file)) continue;
        const History table = read_csv(file);
        for (const std::vector<double>& row : table.rows) {
            const std::string line = csv_line(row);
            text += run.name + "," + sweep.collectors.at(static_cast<std::size_t>(row.front())).name +
                    line.substr(line.find(',')) + "\n";
        }
    }
    return text;
}

std::string passages_table(const Ensemble& sweep, const fs::path& runs) {
    std::vector<Passages> all(sweep.collectors.size());
    std::vector<int> n_runs(sweep.collectors.size(), 0);  // with a passage
    const auto add = [](std::vector<double>& to, const std::vector<double>& more) {
        to.insert(to.end(), more.begin(), more.end());
    };
    for (const EnsembleRun& run : sweep.runs) {
        const fs::path file = runs / run.name / "passages.csv";
        if (run.result.status != "done" || !fs::exists(file)) continue;
        const History table = read_csv(file);
        for (std::size_t k = 0; k < all.size(); ++k) {
            const Passages more = passages_of(table, k);
            n_runs[k] += !more.mass.empty();
            for (const auto member : {&Passages::mass, &Passages::energy, &Passages::height, &Passages::speed})
                add(all[k].*member, more.*member);
        }
    }
    std::string text = "Passages of all runs together:\n\n| collector | runs |", line = "\n|---|---|";
    for (const auto& number : collector_numbers()) {
        std::string name(number.name.substr(2));
        std::ranges::replace(name, '_', ' ');
        text += " " + name + " |", line += "---|";
    }
    text += line + "\n";
    for (std::size_t k = 0; k < all.size(); ++k) {
        text += "| " + sweep.collectors[k].name + " | " + std::to_string(n_runs[k]) + " |";
        for (const auto& number : collector_numbers())
            text += " " + shown_text(number.of(all[k]), number.unit, 4) + " |";
        text += "\n";
    }
    return text + "\n";
}

std::vector<CaptionedFigure> draw_trajectories(const Ensemble& sweep, const fs::path& runs, const fs::path& figures) {
    const Ways ways = read_ways(sweep, runs);
    std::vector<CaptionedFigure> drawn;
    if (!(ways.high > ways.low)) return drawn;
    const auto draw = [&](const Chart& chart, const char* name, const char* caption) {
        const auto is_empty = [](const Curve& curve) { return curve.x.empty(); };
        if (!std::ranges::all_of(chart.curves, is_empty))
            drawn.push_back({draw_chart(chart, figures / (std::string(name) + ".png"), 1200).file, caption});
    };
    draw(chart_of_ways(sweep, ways), "trajectories", "Ways of the pieces of all runs");
    draw(envelope(ways, "Height", "m", &Way::height), "heights",
         "Height above the ground along the way, percentiles over all runs");
    draw(envelope(ways, "Energy", "J", &Way::energy), "energies",
         "Kinetic energy along the way, percentiles over all runs");
    draw(run_outs(ways), "run_out", "Where the pieces of all runs come to rest");
    draw(sizes(ways), "sizes", "Sizes of the pieces of all runs");
    return drawn;
}

}  // namespace knap
