// Warnings about tables over time that steps do not resolve, tables over temperature that the run does not
// reach, and fields of temperature that the mesh does not resolve.
#include "app/check/findings.hpp"

#include "app/check/heat_scales.hpp"
#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "heat/conduction.hpp"
#include "mesh/polygon.hpp"
#include "model/time_tables.hpp"
#include "output/outputs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace knap {
namespace {

constexpr double much_of_table = 0.05;  // [-] of the range of a table

/// Between two ends of steps; those of a table do not tell of it.
struct Peak {
    double time, factor;  // [s], [-]
    double passed;        // [-] by which it exceeds the values at both ends
};

/// The largest one in steps of size h [s].
std::optional<Peak> unresolved_peak(const TimeFunction& table, double h, double end) {
    std::optional<Peak> found;
    if (table.time.empty()) return found;
    const auto [least, largest] = std::ranges::minmax(table.value);
    for (std::size_t i = 0; i < table.time.size(); ++i) {
        const double t = table.time[i], begin = h * std::floor(t / h);
        if (t <= 0 || t >= end || t == begin) continue;
        const double before = table(begin), after = table(begin + h), low = std::min(before, after),
                     high = std::max(before, after);
        const double passed = std::max(table.value[i] - high, low - table.value[i]);
        if (passed > much_of_table * (largest - least) && (!found || passed > found->passed))
            found = Peak{t, table.value[i], passed};
    }
    return found;
}

// What a step does with a peak.
constexpr const char* loads_mean =
    "a step takes the mean of the load, so that its impulse is exact and its peak is not met";
constexpr const char* motions_pass = "only the displacements at the ends of steps count, and this motion is not made";
constexpr const char* heat_mean = "a step takes all of the heat, but the temperatures of the peak are not met";
constexpr const char* temperatures_mean = "a step takes their mean";

class TablesOverTime {
public:
    TablesOverTime(const ReadResult& read, const Model& model, const StepPlan& plan)
        : read_(read), scenario_(read.scenario), model_(model), plan_(plan) {}

    std::vector<Diagnostic> found() {
        const bool implicit = scenario_.time.scheme.takes_implicit_steps();
        const double h = plan_.limits.largest, step = implicit ? nearest_corner * h : h;
        for (std::size_t i = 0; i < scenario_.loads.size(); ++i) {
            const Load& load = scenario_.loads[i];
            judge(item("load", i), load.history, step,
                  load.kind == Load::Kind::displacement ? motions_pass : loads_mean);
        }
        for (std::size_t i = 0; i < scenario_.crack_pressures.size(); ++i)
            judge(item("pressure", i), scenario_.crack_pressures[i].history, step, loads_mean);
        for (std::size_t i = 0; i < scenario_.obstacles.size(); ++i) {
            for (const Drive& drive : scenario_.obstacles[i].drive)
                judge(item("obstacle", i), drive.history, step,
                      drive.kind == Drive::Kind::displacement ? motions_pass : loads_mean);
            for (const ObstacleForce& force : scenario_.obstacles[i].forces)
                judge(item("obstacle", i), force.history, step, loads_mean);
        }
        if (scenario_.heat) judge_heat(implicit, step);
        judge_corners();
        return std::move(found_);
    }

private:
    void judge_heat(bool implicit, double step) {
        const Heat& heat = *scenario_.heat;
        const double between = implicit ? step : heat.every * step;  // [s] changes of temperature
        if (!heat.conduction) return judge("heat", heat.field.history, between, temperatures_mean);
        double of_heat = plan_.limits.largest;  // [s] a step of the conduction
        const bool any =
            std::ranges::any_of(heat.exchanges, [](const HeatExchange& e) { return !e.history.time.empty(); });
        if (any && !implicit)
            of_heat = std::min(between, Conduction::safety * Conduction(model_).stable_step(initial_state(model_)));
        for (std::size_t i = 0; i < heat.exchanges.size(); ++i) {
            using Kind = HeatExchange::Kind;
            const Kind kind = heat.exchanges[i].kind;
            const bool gives = kind == Kind::flux || kind == Kind::source;
            judge(item("heat.exchange", i), heat.exchanges[i].history, gives || !implicit ? of_heat : between,
                  gives ? heat_mean : temperatures_mean);
        }
    }

    void judge(const std::string& path, const TimeFunction& table, double step, const char* what) {
        if (!found_.empty() && found_.back().message.starts_with("`" + path + "`")) return;  // a drive of the same
        const auto peak = unresolved_peak(table, step, scenario_.time.end);
        if (!peak) return;
        warn(path,
             formatted("`%s` has a peak of its factor, %.6g at t = %s, between the ends of a step of %s: %s",
                       path.c_str(), peak->factor, readable(peak->time, "s", 6).c_str(), readable(step, "s").c_str(),
                       what),
             "a smaller time.step; with the explicit bulk it follows from the mesh (mesh.size, time.safety)");
    }

    void judge_corners() {
        if (2 * plan_.n_at_corners <= plan_.n_steps) return;
        warn("time.step",
             formatted("%lld of %lld steps end at corners of tables over time, which steps of %s would pass over",
                       static_cast<long long>(plan_.n_at_corners), static_cast<long long>(plan_.n_steps),
                       readable(plan_.limits.largest, "s").c_str()),
             "tables with fewer points, if the run takes too long");
    }

    void warn(const std::string& key, std::string message, std::string note) {
        found_.push_back(read_.at(key, {.severity = Diagnostic::Severity::warning,
                                        .code = "unresolved-table",
                                        .message = std::move(message),
                                        .note = std::move(note)}));
    }

    const ReadResult& read_;
    const Scenario& scenario_;
    const Model& model_;
    const StepPlan& plan_;
    std::vector<Diagnostic> found_;
};

/// A table over temperature against the temperatures of the run.
class TablesOverTemperature {
public:
    TablesOverTemperature(const ReadResult& read, const Mesh& mesh) : read_(read), mesh_(mesh) {}

    std::vector<Diagnostic> found() {
        const Scenario& scenario = read_.scenario;
        for (const NamedLaw& named : scenario.laws) {
            if (!named.law.of_temperature) continue;
            const std::string path = "interface." + named.name;
            judge(path + ".strength_table", named.law.of_temperature->strength, true);
            judge(path + ".friction_table", named.law.of_temperature->friction, false);
        }
        for (std::size_t i = 0; i < scenario.crack_pressures.size(); ++i)
            judge(item("pressure", i) + ".pressure_table", scenario.crack_pressures[i].over_temperature, false);
        for (std::size_t i = 0; i < scenario.materials.size(); ++i) {
            const std::string path = "material." + scenario.materials[i].name;
            const Thermal& thermal = scenario.heat->materials[i];
            judge(path + ".expansion_table", {thermal.expansion.temperature, thermal.expansion.strain}, true);
            judge(path + ".conductivity_table", thermal.conductivity_part.table(), true);
            judge(path + ".heat_capacity_table", thermal.capacity_part.table(), true);
        }
        return std::move(found_);
    }

private:
    /// Values that go on beyond the table (`trend`) are suspect far from it; others are often meant to stay.
    void judge(const std::string& path, const TemperatureTable& table, bool trend) {
        if (table.empty()) return;
        if (!range_) range_ = temperatures_of_run(read_.scenario, mesh_);
        const auto& [low, high] = *range_;
        const std::vector<double>&T = table.temperature, &v = table.value;
        const std::size_t n = T.size();
        const double span = T[n - 1] - T[0];
        double largest = 0;
        for (const double value : v) largest = std::max(largest, std::abs(value));
        const auto ends_flat = [&](std::size_t end, std::size_t next) {
            return std::abs(v[end]) <= 1e-3 * largest || std::abs(v[end] - v[next]) <= 1e-3 * largest;
        };
        if (high < T[0] || low > T[n - 1]) warn(path, "never reach it: one end of it holds all the time", T);
        else if (trend &&
                 ((low < T[0] - span && !ends_flat(0, 1)) || (high > T[n - 1] + span && !ends_flat(n - 1, n - 2))))
            warn(path, "go far beyond it, where its last value (of expansion_table the slope) goes on", T);
    }

    void warn(const std::string& path, const char* what, const std::vector<double>& T) {
        const char* const unit = unit_of_temperature("K", read_.scenario.heat->celsius).data();
        found_.push_back(read_.at(
            path,
            {.severity = Diagnostic::Severity::warning,
             .code = "table-not-reached",
             .message = formatted("`%s` covers %.6g to %.6g %s, and the temperatures of the run, %.6g to %.6g %s, %s",
                                  path.c_str(), T.front(), T.back(), unit, (*range_)[0], (*range_)[1], unit, what),
             .note = "a table over the temperatures of the run; all temperatures count from one zero"}));
    }

    const ReadResult& read_;
    const Mesh& mesh_;
    std::optional<std::array<double, 2>> range_;  // [K] temperatures of the run, once a table needs them
    std::vector<Diagnostic> found_;
};

/// A field of temperatures whose grid does not cover the body or the run.
std::vector<Diagnostic> findings_of_grid(const ReadResult& read, const Mesh& mesh) {
    std::vector<Diagnostic> found;
    const auto& grid = read.scenario.heat->field.grid;
    const Box box = bounding_box(mesh.vertices);
    constexpr double beyond = 0.1;  // [-] of the body, or of the run
    for (std::size_t k = 0; grid && k < 3; ++k) {
        const std::vector<double>& axis = grid->axis(k);
        const double low = k < 2 ? box.low[k] : 0, high = k < 2 ? box.high[k] : read.scenario.time.end,
                     allowed = beyond * (high - low);
        const bool misses = axis.back() <= low || axis.front() >= high,
                   leaves = low < axis.front() - allowed || high > axis.back() + allowed;
        if (axis.size() < 2 || !(misses || (k < 2 && leaves)))
            continue;  // after its last time a table may stay as it is
        found.push_back(read.at(
            "heat.temperature",
            {.severity = Diagnostic::Severity::warning,
             .code = "table-not-reached",
             .message =
                 formatted("the table of `heat.temperature` covers %c = %.6g to %.6g %s, and the %s %.6g to %.6g "
                           "%s: beyond the table its border goes on",
                           "xyt"[k], axis.front(), axis.back(), k < 2 ? "m" : "s",
                           k < 2 ? "body extends from" : "run goes from", low, high, k < 2 ? "m" : "s"),
             .note = "lengths in m and times in s from the start of the run"}));
    }
    return found;
}

/// A field of temperatures that bends within an edge: thermal strains are interpolated between the nodes.
std::vector<Diagnostic> findings_of_resolution(const ReadResult& read, const Model& model) {
    constexpr double allowed =
        0.02;  // [-] of the range; the interpolation errs by a part that falls with the size squared
    const Heat& heat = *read.scenario.heat;
    const Mesh& mesh = model.mesh;
    if (heat.field.is_uniform()) return {};
    const double end = read.scenario.time.end, pieces = mesh.order;
    double worst = 0, length = 0, at_time = 0;
    Vec2 place;
    for (const double t : heat.field.is_constant() ? std::vector{0.0} : std::vector{end / 2, end}) {
        const auto T = [&](const Vec2& x) { return heat.field.value_at(x, t); };
        std::vector<double> of_vertex;
        for (const Vec2& x : mesh.vertices) of_vertex.push_back(T(x));
        const auto [low, high] = std::ranges::minmax(of_vertex);
        if (!(high > low)) continue;
        for (Index n = 0; n < mesh.n_triangles(); ++n)
            for (Index k = 0; k < 3; ++k) {
                const auto [from, to] = mesh.side_vertices(n, k);
                const Vec2 &a = mesh.vertices[from], piece = (mesh.vertices[to] - a) / pieces;
                const double mean = 0.5 * (of_vertex[from] + (pieces > 1 ? T(a + piece) : of_vertex[to])),
                             departure = std::abs(T(a + 0.5 * piece) - mean) / (high - low);
                if (departure > worst)
                    worst = departure, length = pieces * piece.norm(), place = a + 0.5 * piece, at_time = t;
            }
    }
    if (worst <= allowed) return {};
    return {read.at(
        "heat.temperature",
        {.severity = Diagnostic::Severity::warning,
         .code = "heat",
         .message = formatted("the temperature bends within an edge of %s at %s: it departs there by %.2g %% of its "
                              "range from what is interpolated%s; thermal stresses and stress intensity factors err "
                              "by a similar part",
                              readable(length, "m").c_str(), place_text(place).c_str(), 100 * worst,
                              at_time > 0 ? (", at " + readable(at_time, "s")).c_str() : ""),
         .note = "a size of at most " + readable(length * std::sqrt(allowed / worst), "m", 2) + " there"})};
}

}  // namespace

std::vector<Diagnostic> findings_of_tables(const ReadResult& read, const Model& model, const StepPlan& plan) {
    std::vector<Diagnostic> found = TablesOverTime(read, model, plan).found();
    if (!read.scenario.heat) return found;
    if (read.scenario.heat->field.frozen) return found;
    for (Diagnostic& other : TablesOverTemperature(read, model.mesh).found()) found.push_back(std::move(other));
    for (Diagnostic& other : findings_of_grid(read, model.mesh)) found.push_back(std::move(other));
    for (Diagnostic& other : findings_of_resolution(read, model)) found.push_back(std::move(other));
    return found;
}

}  // namespace knap
