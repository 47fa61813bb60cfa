#pragma once
// What cracks can be coloured by, interface by interface.
#include "figures/colour_bar.hpp"
#include "figures/figures.hpp"

#include <optional>
#include <string>
#include <vector>

namespace knap {

/// Of an interface of a frame (of second order: of half of one).
enum class Kind { intact, damaged, broken, precrack };
Kind kind_of(const Frame& frame, Index interface);
std::vector<Index> interfaces_of(const Frame& frame, Kind kind);
double mean_cohesion(const Frame& frame, Index interface);

struct CrackColour {
    std::string name;      // as in FigureOptions::colour
    std::string quantity;  // as beside the colour bar
    std::string unit;
    bool damaged = false, precracks = false;  // these have a colour, too
    bool needs_breaks = false;                // taken from breaks.csv
    bool falls = false;                       // what has least is drawn last
    std::optional<ColourRange> range = {};    // whatever the data
    ColourMap map = ColourMap::plasma();
};

const std::vector<CrackColour>& crack_colours();
/// Throws UserError for a name that is none of them.
const CrackColour& crack_colour(const std::string& name);

/// Value per interface; not finite where it has none. `breaks` is looked at where the colour needs it; of interfaces that are not in it nothing is known.
std::vector<double> crack_values(const CrackColour& colour, const Frame& frame, const History* breaks);

}  // namespace knap
