// viridis and plasma: S. van der Walt, N. Smith (2015), public domain (CC0), here by nine colours each and straight lines between.
#include "figures/colour_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace knap {

namespace {

constexpr std::array<std::uint32_t, 9> viridis_anchors{0x440154, 0x472D7B, 0x3B528B, 0x2C728E, 0x21908C, 0x27AD81, 0x5DC863, 0xAADC32, 0xFDE725};
// without the yellow end, which is lost on a light background
constexpr std::array<std::uint32_t, 7> plasma_anchors{0x0D0887, 0x4C02A1, 0x7E03A8, 0xA92395, 0xCC4678, 0xE56B5D, 0xF89441};
constexpr std::array<std::uint32_t, 6> fading_anchors{0x1B0C3B, 0x6B1D70, 0xB63A64, 0xE0785A, 0xDDB79C, 0xCDCCC8};
constexpr std::array<std::uint32_t, 9> diverging_anchors{0x123061, 0x2A62A6, 0x5D97C9, 0xA9CBE3, 0xF4F3F0, 0xF2B898, 0xDD7A5B, 0xB53A3B, 0x6B0F24};

Vec2 split(double x, std::size_t n) {  // cell and place in it
    const double at = std::clamp(x, 0.0, 1.0) * static_cast<double>(n - 1);
    const double cell = std::min(std::floor(at), static_cast<double>(n - 2));
    return {cell, at - cell};
}

double channel(std::uint32_t colour, int shift) { return static_cast<double>((colour >> shift) & 0xFF) / 255; }

}  // namespace

ColourMap ColourMap::viridis() { return ColourMap(viridis_anchors); }
ColourMap ColourMap::plasma() { return ColourMap(plasma_anchors); }
ColourMap ColourMap::fading() { return ColourMap(fading_anchors); }
ColourMap ColourMap::diverging() { return ColourMap(diverging_anchors); }

Colour ColourMap::operator()(double x) const {
    const Vec2 place = split(x, anchors_.size());
    const auto i = static_cast<std::size_t>(place[0]);
    const auto mixed = [&](int shift) { return (1 - place[1]) * channel(anchors_[i], shift) + place[1] * channel(anchors_[i + 1], shift); };
    return {mixed(16), mixed(8), mixed(0)};
}

}  // namespace knap
