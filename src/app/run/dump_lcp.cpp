#include "app/run/dump_lcp.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/union_find.hpp"
#include "lcp/matrix_market.hpp"
#include "stepper/implicit/corner_partition.hpp"
#include "stepper/implicit/step_lcp.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace knap {
namespace {

constexpr double max_entries = 2e7;  // of a stored matrix: about half a gigabyte of text

/// Upper bound of the number of entries: rows of points are coupled where both belong to one part of the body that
/// cannot break.
double upper_bound_of_entries(const Model& model, const SchemeOptions& scheme) {
    UnionFind parts(model.mesh.triangles.size());
    bool friction = false, gamma = false, ramps = false, norm = false;
    double n_layers = 1;  // of the cohesion of a point
    for (const CohesiveLaw& law : model.laws) {
        if (law.softening) n_layers = std::max(n_layers, static_cast<double>(law.softening->knots().size() - 1));
        ramps = ramps || law.unloading == Unloading::secant;
    }
    for (const FanPoint& point : model.fan_points) {
        if (unbreakable(model, point) && point.before != rigid_support && point.after != rigid_support)
            parts.join(model.mesh.triangle_of(point.before), model.mesh.triangle_of(point.after));
        friction = friction || model.laws[point.law].friction_range()[1] > 0;
        gamma = gamma || model.laws[point.law].gamma > 0;
        norm = norm || model.laws[point.law].coupling == Coupling::norm;
    }
    const double rows = (scheme.cohesion == CohesionScheme::implicit_beta ? 2 * n_layers + 1
                         : ramps                                          ? 3
                                                                          : 1) +
                        (friction ? 3 + norm : 0) +
                        (norm    ? 9
                         : gamma ? 3
                                 : 0);
    std::vector<double> n_points(model.mesh.triangles.size(), 0);
    for (const FanPoint& point : model.fan_points)
        for (const Index corner : {point.before, point.after})
            if (!unbreakable(model, point) && corner != rigid_support)
                n_points[parts.find(model.mesh.triangle_of(corner))] += 1;
    double entries = 0;
    for (const double n : n_points) entries += rows * n * rows * n;
    return entries;
}

}  // namespace

StepSelection StepSelection::parse(const std::string& text) {
    StepSelection selection;
    std::istringstream items(text);
    for (std::string item; std::getline(items, item, ',');) {
        std::vector<std::int64_t> numbers;
        std::istringstream parts(item);
        bool good = !item.empty() && item.back() != ':';
        for (std::string part; std::getline(parts, part, ':');) {
            std::int64_t number = 0;
            const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
            good = good && error == std::errc() && end == part.data() + part.size() && number > 0;
            numbers.push_back(number);
        }
        if (!good || numbers.empty() || numbers.size() > 3 || numbers.front() > numbers.back())
            throw UserError("bad-value", "`" + text + "` does not select steps",
                            "examples: 10 or 10,20 or 10:20 or 10:5:40 (from 10 every fifth up to 40)");
        selection.ranges_.push_back({numbers.front(), numbers.size() == 3 ? numbers[1] : 1, numbers.back()});
    }
    return selection;
}

bool StepSelection::contains(std::int64_t step) const {
    for (const auto& [first, stride, last] : ranges_)
        if (step >= first && step <= last && (step - first) % stride == 0) return true;
    return false;
}

std::string StepSelection::outside(std::int64_t first, std::int64_t last) const {
    std::string text;
    for (const auto& [from, stride, limit] : ranges_) {
        const auto number = [from = from, stride = stride](std::int64_t k) { return from + k * stride; };
        const auto n_until = [from = from, stride = stride, limit = limit](std::int64_t step) {
            return step < from ? 0 : (std::min(step, limit) - from) / stride + 1;
        };
        const auto add = [&, stride = stride](std::int64_t begin, std::int64_t end) {
            if (begin >= end) return;
            text += (text.empty() ? "" : ",") + std::to_string(number(begin));
            if (begin + 1 < end)
                text += (stride > 1 ? ":" + std::to_string(stride) : "") + ":" + std::to_string(number(end - 1));
        };
        add(0, n_until(first - 1));
        add(n_until(last), n_until(limit));
    }
    return text;
}

void check_dump(const Model& model, const SchemeOptions& scheme) {
    if (scheme.bulk != BulkScheme::implicit_theta)
        throw UserError("exclusive-keys", "--dump-lcp stores the complementarity problem of the implicit bulk",
                        "set time.bulk = \"implicit\"");
    if (scheme.damping > 0 && scheme.damping_of == DampingOf::vibration)
        throw UserError("exclusive-keys",
                        "--dump-lcp stores one problem of a step, and with time.damping of vibrations the motion of "
                        "free pieces is found by several",
                        "use damping_of = \"motion\", or no damping");
    if (model.large_rotation)
        throw UserError("exclusive-keys",
                        "--dump-lcp stores one linear problem of a step, and with large rotations it is solved by "
                        "several",
                        "use rotation = \"small\"");
    if (!StepLcp::fits_by_polygon(model, scheme))
        throw UserError("exclusive-keys",
                        "--dump-lcp stores a linear problem, and with an implicit cohesion or coupling = \"norm\" the "
                        "ramps of unloading = \"secant\" multiply two unknowns; nor has it a G_II, or unloading = "
                        "\"vertical\"",
                        "use cohesion = \"explicit\" or unloading = \"constant\"");
    const double entries = upper_bound_of_entries(model, scheme);
    if (entries > max_entries)
        throw UserError(
            "too-large",
            formatted("the complementarity problem of a step could have %.2g entries; at most %.2g are stored", entries,
                      max_entries),
            "use a coarser mesh (mesh.size), or fewer interfaces that can break in one piece of the body");
}

std::string dump_lcp(const Model& model, const State& start, double h, const SchemeOptions& scheme,
                     const std::filesystem::path& directory) {
    const std::string name = formatted("step_%06lld", static_cast<long long>(start.n_steps + 1));
    const LcpProblem problem = StepLcp(model, start, h, scheme).problem();
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    try {
        write_lcp(directory / name, problem);
    } catch (const UserError& failure) {
        throw SimulationError(failure.what());
    }
    const char* polygon =
        has_norm(model) ? "; the half ellipse of the norm as a polygon of 8 sides round it, by up to 8.2 % larger" : "";
    return formatted("lcp: %s: %d unknowns, %lld entries, h = %.6g s from t = %.9g s%s\n", name.c_str(), problem.size(),
                     static_cast<long long>(problem.M.nonZeros()), h, start.time, polygon);
}

}  // namespace knap
