// Details of the shape that cut the stable step, and numbers of steps, frames, lines and pictures that nobody can mean.
#include "app/run/model_findings.hpp"

#include "app/run/run.hpp"
#include "mesh/polygon.hpp"
#include "mesh/size_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knap {
namespace {

constexpr std::size_t most_details = 5;      // that are named
constexpr double surely_short = 1e9;         // triangle-steps
constexpr double longest = 5 * 86400.;       // [s] of one core
constexpr double most_frames = 1e4, most_lines = 1e6, most_pictures = 1e3;
constexpr double frame_bytes = 85;           // a triangle

struct Part {
    std::string path;  // of the scenario
    double distance;   // [m]
};

/// The scenario's name of a hole, crack or region of the shape, which a random set may have put there.
std::string path_of(const Scenario& scenario, RandomSet::Part part, const char* list, std::size_t number) {
    for (const RandomSet& set : scenario.random_sets)
        if (set.part == part && number >= set.first && number < set.first + static_cast<std::size_t>(set.n)) return set.path;
    return item(list, number);
}

double distance_to_line(const std::vector<Vec2>& line, bool closed, const Vec2& x) {
    double least = 1e300;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < line.size(); ++i) least = std::min(least, distance_to_segment(line[i], line[(i + 1) % line.size()], x));
    return least;
}

/// Parts of the shape near a place, nearest first.
std::vector<Part> parts_near(const Scenario& scenario, const Vec2& x, double reach) {
    const Shape& shape = scenario.shape;
    std::vector<Part> parts;
    const auto add = [&](const std::string& path, const std::vector<Vec2>& line, bool closed) {
        if (const double d = distance_to_line(line, closed, x); d < reach) parts.push_back({path, d});
    };
    add("domain", shape.outer.points, true);
    for (std::size_t i = 0; i < shape.holes.size(); ++i) add(path_of(scenario, RandomSet::Part::holes, "domain.hole", i), shape.holes[i].points, true);
    for (std::size_t i = 0; i < shape.cracks.size(); ++i) add(path_of(scenario, RandomSet::Part::cracks, "domain.crack", i), shape.cracks[i].points, false);
    for (std::size_t i = 0; i < shape.regions.size(); ++i) add(path_of(scenario, RandomSet::Part::regions, "domain.region", i), shape.regions[i].points, true);
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.distance < b.distance; });
    return parts;
}

/// "`joints[0]` and `domain.hole[0]`", "two traces of `joints[0]`"
std::string culprits(const std::vector<Part>& parts) {
    if (parts.empty()) return "the mesh";
    if (parts.size() == 1) return "a detail of `" + parts[0].path + "`";
    const auto [first, second] = std::minmax(parts[0].path, parts[1].path);  // whichever is nearer: the same detail
    if (first != second) return "`" + first + "` and `" + second + "`";
    return "two parts of `" + parts[0].path + "`";
}

/// Each detail once, by its slowest triangle.
void check_details(const ReadResult& read, const Model& model, const StepPlan& plan, std::vector<Diagnostic>& found) {
    const SizeField size(read.scenario.mesh, 1);
    std::vector<std::string> named;
    for (const auto& [t, step] : plan.slow) {
        const Vec2 a = model.mesh.corner(t, 0), b = model.mesh.corner(t, 1), c = model.mesh.corner(t, 2), x = (a + b + c) / 3;
        const std::vector<Part> parts = parts_near(read.scenario, x, 2 * size(x));
        const std::string who = culprits(parts);
        if (std::find(named.begin(), named.end(), who) != named.end()) continue;
        named.push_back(who);
        if (named.size() > most_details) return;
        char text[300];
        std::snprintf(text, sizeof text,
                      "a triangle at (%.6g, %.6g) m has an edge of %.3g m where the mesh size is %.3g m, and a stable step of %.3g s, %.3g times below the %.3g s of that "
                      "size; all triangles step with the smallest. Next to it: ",
                      x.x(), x.y(), std::min({(b - a).norm(), (c - b).norm(), (a - c).norm()}), size(x), step, plan.usual_step / step, plan.usual_step);
        found.push_back(warning_at(read, parts.empty() ? "mesh.size" : parts[0].path, "small-step", text + who,
                                   "move one of them, let them meet, or drop the detail; another seed places random traces elsewhere; bulk = \"implicit\" takes larger steps"));
    }
}

std::string count_text(double n) { return n < 1e6 ? std::to_string(static_cast<long long>(n)) : with_unit(n, ""); }

void check_numbers(const ReadResult& read, const Model& model, const StepPlan& plan, const Cost* cost, std::vector<Diagnostic>& found) {
    const Scenario& scenario = read.scenario;
    const double end = scenario.time.end, n_steps = static_cast<double>(plan.n_steps), triangles = model.mesh.n_triangles();
    const double seconds = cost != nullptr                             ? cost->total()
                           : n_steps * triangles > surely_short ? estimate_cost(scenario, model, plan, 0, 0.05).total()
                                                                : 0;
    char text[300];
    if (seconds > longest) {
        std::snprintf(text, sizeof text, "`time.end` = %.6g s is %.3g steps of %.3g s: about %.2g days of one core", end, n_steps, plan.limits.largest, seconds / 86400);
        found.push_back(warning_at(read, "time.end", "too-long", text,
                                   "a smaller time.end (waves cross a body in micro- to milliseconds), larger triangles, or bulk = \"implicit\""));
    }
    const auto check = [&](const char* key, double every, double most, const char* what, double bytes) {
        const double n = every > 0 ? std::min(end / every, n_steps) : 0;
        if (!(n > most)) return;
        std::snprintf(text, sizeof text, "`%s` = %.6g s in a run of %.6g s makes %.3g %s, some %.2g GB", key, every, end, n, what, 1e-9 * n * bytes);
        char cure[120];
        std::snprintf(cure, sizeof cure, "%s of %.1g s makes a thousand", key, end / 1000);
        found.push_back(warning_at(read, key, "too-many", text, cure));
    };
    check("output.every", scenario.output.fields ? scenario.output.every : 0, most_frames, "frames", frame_bytes * triangles);
    check("output.history_every", scenario.output.history_every, most_lines, "lines in each table", 500);
    for (std::size_t i = 0; i < scenario.figures.size(); ++i)
        if (const std::size_t n = scenario.figures[i].at.size(); static_cast<double>(n) > most_pictures)
            found.push_back(warning_at(read, item("figure", i) + ".at", "too-many", "`" + item("figure", i) + "` draws " + count_text(static_cast<double>(n)) + " pictures",
                                       "fewer times, or frames (output.every) and `knap render` for those that are wanted"));
}

}  // namespace

std::vector<Diagnostic> findings_of_steps(const ReadResult& read, const Model& model, const StepPlan& plan, const Cost* cost) {
    std::vector<Diagnostic> found;
    check_details(read, model, plan, found);
    check_numbers(read, model, plan, cost, found);
    return found;
}

std::vector<Diagnostic> findings_of_model(const ReadResult& read, const Model& model, const StepPlan& plan, const Cost* cost) {
    std::vector<Diagnostic> found = resolution_warnings(read, mean_edge(model.mesh));
    for (const auto& more : {findings_of_loads(read, model, plan), findings_of_places(read, model), findings_of_steps(read, model, plan, cost)})
        found.insert(found.end(), more.begin(), more.end());
    return found;
}

}  // namespace knap
