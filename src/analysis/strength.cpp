#include "analysis/strength.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

using Column = std::vector<double>;
constexpr double unknown = Strength::unknown;

/// y = at_zero + slope x
struct Line {
    double slope = unknown, at_zero = unknown;
};

/// Least squares over the lines [first, last).
Line fit(const Column& x, const Column& y, std::size_t first, std::size_t last) {
    const double n = static_cast<double>(last - first);
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (std::size_t i = first; i < last; ++i) mean_x += x[i] / n, mean_y += y[i] / n;
    for (std::size_t i = first; i < last; ++i) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    if (!(xx > 0)) return {};
    return {xy / xx, mean_y - xy / xx * mean_x};
}

/// The lines on which the stress first passes from one part of the peak to the other, at least the two around them.
/// (After a fracture, waves may raise the stress above that at which it broke.)
std::array<std::size_t, 2> between(const Column& stress, std::size_t peak, const std::array<double, 2>& parts) {
    std::size_t first = 0;
    while (first < peak && stress[first] < parts[0] * stress[peak]) ++first;
    std::size_t last = first;
    while (last <= peak && stress[last] <= parts[1] * stress[peak]) ++last;
    if (last - first >= 3) return {first, last};
    return {first > 0 ? first - 1 : 0, std::min(last + 1, peak + 1)};
}

/// The first line with at least n breaks.
std::size_t first_with(const Column& n_breaks, double n) {
    return std::ranges::find_if(n_breaks, [n](double found) { return found >= n; }) - n_breaks.begin();
}

constexpr double fallen = 0.95;  // [-] of the largest stress: the specimen has failed

/// Interfaces broke since the line before the peak, until the stress that has fallen rises again.
bool failed(const Column& stress, const Column& n_breaks, std::size_t peak) {
    const double before = peak > 0 ? n_breaks[peak - 1] : 0, limit = fallen * stress[peak];
    std::size_t i = peak;
    while (i < stress.size() && stress[i] >= limit) ++i;
    for (; i < stress.size() && stress[i] < limit; ++i)
        if (n_breaks[i] > before) return true;
    return false;
}

double dilatancy(const Column& stress, const Column& volumetric, std::size_t peak, std::size_t first_break) {
    const std::size_t n_elastic = std::min(first_break, peak + 1);
    if (n_elastic < 3) return unknown;
    const Line elastic = fit(stress, volumetric, 0, n_elastic);
    const double tolerance = 0.01 * std::abs(elastic.slope * stress[n_elastic - 1]);
    const auto of_cracks = [&](std::size_t i) { return volumetric[i] - elastic.at_zero - elastic.slope * stress[i]; };
    if (!(of_cracks(peak) < -tolerance)) return unknown;
    std::size_t i = peak;
    while (i > 0 && of_cracks(i - 1) < -tolerance) --i;
    return stress[i];
}

}  // namespace

Strength strength_of(const History& curve, const std::array<double, 2>& modulus_between) {
    Strength found;
    if (curve.rows.size() < 2) return found;
    const Column stress = curve.column("stress"), axial = curve.column("axial_strain");
    const std::size_t peak = std::ranges::max_element(stress) - stress.begin();
    if (!(stress[peak] > 0)) return found;
    found.peak_stress = stress[peak];
    found.peak_strain = axial[peak];
    const auto [first, last] = between(stress, peak, modulus_between);
    found.tangent_modulus = fit(axial, stress, first, last).slope;
    if (curve.has("lateral_strain"))
        found.strain_ratio = -fit(axial, curve.column("lateral_strain"), first, last).slope;

    Column n_breaks = curve.column("tensile_breaks");
    const Column n_shear = curve.column("shear_breaks");
    for (std::size_t i = 0; i < n_breaks.size(); ++i) n_breaks[i] += n_shear[i];
    if (failed(stress, n_breaks, peak)) found.strength = found.peak_stress;
    if (n_breaks.back() > 0)  // where nothing broke before the peak, cracks start there
        found.crack_initiation =
            stress[n_breaks[peak] == 0 ? peak : first_with(n_breaks, std::max(1.0, std::ceil(0.01 * n_breaks[peak])))];
    if (!curve.has("volumetric_strain")) return found;
    const Column volumetric = curve.column("volumetric_strain");
    found.dilatancy = dilatancy(stress, volumetric, peak, first_with(n_breaks, 1));
    const std::size_t reversal = std::ranges::max_element(volumetric) - volumetric.begin();
    if (reversal + 1 < volumetric.size()) found.crack_damage = stress[std::min(reversal, peak)];
    return found;
}

MaterialConstants material_constants(const Strength& strength, PlaneModel plane) {
    if (plane == PlaneModel::stress) return {strength.tangent_modulus, strength.strain_ratio};
    const double nu = strength.strain_ratio / (1 + strength.strain_ratio);
    return {strength.tangent_modulus * (1 - nu * nu), nu};
}

}  // namespace knap
