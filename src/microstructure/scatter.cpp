#include "microstructure/scatter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr int n_waves = 512;

double normal_survival(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

/// Standard deviation of the logarithm of a lognormal number of mean 1.
double log_deviation(const Scatter& s) { return std::sqrt(std::log1p(s.deviation * s.deviation)); }

double weibull_scale(const Scatter& s) { return 1 / std::tgamma(1 + 1 / s.modulus); }

/// S_0^-1(exp(-hazard))
double untruncated(const Scatter& s, double hazard) {
    switch (s.kind) {
        case Scatter::Kind::none: break;
        case Scatter::Kind::weibull: return weibull_scale(s) * std::pow(hazard, 1 / s.modulus);
        case Scatter::Kind::normal: return 1 + s.deviation * normal_quantile(hazard);
        case Scatter::Kind::lognormal:
            return std::exp(log_deviation(s) * normal_quantile(hazard) - 0.5 * log_deviation(s) * log_deviation(s));
        case Scatter::Kind::uniform: return 1 + std::sqrt(3.0) * s.deviation * (1 - 2 * std::exp(-hazard));
    }
    return 1;
}

}  // namespace

double survival(const Scatter& s, double x) {
    switch (s.kind) {
        case Scatter::Kind::none: return x < 1 ? 1 : 0;
        case Scatter::Kind::weibull: return x > 0 ? std::exp(-std::pow(x / weibull_scale(s), s.modulus)) : 1;
        case Scatter::Kind::normal: return normal_survival((x - 1) / s.deviation);
        case Scatter::Kind::lognormal:
            return x > 0 ? normal_survival(std::log(x) / log_deviation(s) + 0.5 * log_deviation(s)) : 1;
        case Scatter::Kind::uniform: return std::clamp(0.5 - 0.5 * (x - 1) / (std::sqrt(3.0) * s.deviation), 0.0, 1.0);
    }
    return 0;
}

double strength_factor(const Scatter& s, double hazard) {
    const double at_lowest = survival(s, s.lowest), at_highest = std::isinf(s.highest) ? 0 : survival(s, s.highest);
    if (at_lowest < 1 || at_highest > 0) hazard = -std::log(at_highest + std::exp(-hazard) * (at_lowest - at_highest));
    return std::clamp(untruncated(s, hazard), s.lowest, s.highest);
}

double normal_hazard(double z) {
    return z < 0 ? -std::log1p(-normal_survival(-z)) : -std::log(normal_survival(std::min(z, 34.0)));
}

double normal_quantile(double hazard) {
    // Newton's method for ln Q(z) = -hazard, a concave function; below the median for 1 - Q by symmetry
    if (!(hazard > 0)) hazard = std::numeric_limits<double>::min();
    if (hazard < std::numbers::ln2) return -normal_quantile(-std::log(-std::expm1(-hazard)));
    hazard = std::min(hazard, 600.0);                                       // exp(-600) is still a number
    double z = std::sqrt(std::max(0.0, 2 * (hazard - std::numbers::ln2)));  // Q(z) <= exp(-z^2/2)/2: never too small
    for (int i = 0; i < 50; ++i) {
        const double q = normal_survival(z),
                     density = std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
        const double step = (std::log(q) + hazard) * q / density;
        z += step;
        if (std::abs(step) <= 1e-14 * (1 + std::abs(z))) break;
    }
    return z;
}

RandomField::RandomField(double correlation_length, Random& random) {
    const double deviation = std::numbers::sqrt2 / correlation_length;
    for (int i = 0; i < n_waves; ++i) {
        const double k_x = deviation * random.normal(), k_y = deviation * random.normal();
        waves_.push_back({{k_x, k_y}, random.uniform(0, 2 * std::numbers::pi)});
    }
}

double RandomField::operator()(const Vec2& x) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::cos(wave.k.dot(x) + wave.phase);
    return std::sqrt(2.0 / n_waves) * sum;
}

}  // namespace knap
