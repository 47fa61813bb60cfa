#pragma once
// Colour maps that grow evenly in lightness and are safe for the colour-blind.
#include "figures/canvas.hpp"

#include <span>

namespace knap {

class ColourMap {
public:
    static ColourMap viridis();    // sizes: dark blue, green, yellow
    static ColourMap plasma();     // lines on a light background: dark blue, magenta, orange
    static ColourMap fading();     // what goes to nothing: from dark purple by red to the grey of what is still whole
    static ColourMap diverging();  // signed values: blue, nearly white at the middle, red

    /// Colour at `x` in [0, 1]; what lies outside gets the end's colour.
    Colour operator()(double x) const;

private:
    explicit ColourMap(std::span<const std::uint32_t> anchors) : anchors_(anchors) {}
    std::span<const std::uint32_t> anchors_;  // 0xRRGGBB, evenly spaced
};

}  // namespace knap
