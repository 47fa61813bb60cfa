#include "figures/colours.hpp"

#include <algorithm>
#include <array>

namespace knap {
namespace {

constexpr std::array<std::uint32_t, n_curve_colours> curve_colours{0x0072B2, 0xD55E00, 0x009E73,
                                                                   0xE69F00, 0xCC79A7, 0x56B4E9};
constexpr std::array<std::uint32_t, 9> viridis_colours{0x440154, 0x472D7B, 0x3B528B, 0x2C728E, 0x21908C,
                                                       0x27AD81, 0x5DC863, 0xAADC32, 0xFDE725};
constexpr std::array<std::uint32_t, 7> plasma_colours{0x0D0887, 0x4C02A1, 0x7E03A8, 0xA92395,
                                                      0xCC4678, 0xE56B5D, 0xF89441};
constexpr std::array<std::uint32_t, 6> fading_colours{0x1B0C3B, 0x6B1D70, 0xB63A64, 0xE0785A, 0xDDB79C, 0xCDCCC8};
constexpr std::array<std::uint32_t, 9> diverging_colours{0x123061, 0x2A62A6, 0x5D97C9, 0xA9CBE3, 0xF4F3F0,
                                                         0xF2B898, 0xDD7A5B, 0xB53A3B, 0x6B0F24};

/// (1 - t) a + t b
Colour mixed(std::uint32_t a, std::uint32_t b, double t) {
    const auto channel = [&](int shift) { return ((1 - t) * ((a >> shift) & 0xFF) + t * ((b >> shift) & 0xFF)) / 255; };
    return {channel(16), channel(8), channel(0)};
}

}  // namespace

const ColourMap ColourMap::viridis{viridis_colours}, ColourMap::plasma{plasma_colours},
    ColourMap::fading{fading_colours}, ColourMap::diverging{diverging_colours};

Colour curve_colour(std::size_t i) { return mixed(curve_colours[i % n_curve_colours], 0, 0); }

Colour ColourMap::operator()(double x) const {
    const double at = std::clamp(x, 0., 1.) * static_cast<double>(colours.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(at), colours.size() - 2);
    return mixed(colours[i], colours[i + 1], at - static_cast<double>(i));
}

Limits round_limits(double low, double high, bool is_signed) {
    if (!(low <= high)) return {};
    if (is_signed) {
        low = std::min(low, 0.0), high = std::max(high, 0.0);
        if (-low > 0.25 * high && high > 0.25 * -low) high = std::max(-low, high), low = -high;
    }
    if (high - low > 1e-9 * std::max(std::abs(high), std::abs(low))) return round_range(low, high, 7);
    const double margin = high == 0 ? 1 : 0.1 * std::abs(high);
    return {low - (low == 0 && !is_signed ? 0 : margin), high + margin};
}

Colour ColourScale::operator()(double value) const {
    const double shown = std::clamp(value, low, high);
    return map(about_zero ? 0.5 + 0.5 * shown / std::max(std::abs(low), std::abs(high)) : (shown - low) / (high - low));
}

}  // namespace knap
