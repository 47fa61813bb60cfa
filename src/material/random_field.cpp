#include "material/random_field.hpp"

#include <cmath>
#include <numbers>

namespace knap {

namespace {
constexpr int n_waves = 512;
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
