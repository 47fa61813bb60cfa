#pragma once
// Numbers with units: "40 mm", "3.08 MPa", "1.18e-3 g/mm3", "1 mm/ms". Everything becomes SI, angles become degrees.
#include "base/text.hpp"

#include <string>
#include <string_view>

namespace knap {

/// Powers of the base units. `rayleigh` counts the problem's own unit cR, the Rayleigh wave speed; `courant` its CFL,
/// the stable step of the explicit bulk.
struct Dimension {
    int length = 0, mass = 0, time = 0, angle = 0, rayleigh = 0, courant = 0;
    bool operator==(const Dimension&) const = default;
};

struct Quantity {
    double value = 0;  // in SI (degrees, multiples of cR or CFL)
    Dimension dimension;
    std::string unit;           // as it was written
    std::string problem;        // what is wrong with the text; empty = nothing
    bool unknown_unit = false;  // that is what is wrong
};

/// Reads a number and a unit; says in `problem` why it could not. Does not depend on the locale. Powers of ten are
/// applied to the decimal text, so that "0.3 mm" and 0.3e-3 are the same double.
Quantity parse_quantity(std::string_view text);

/// Dimension of a unit that is known to be good ("J/m2"); "" has none.
Dimension dimension_of(std::string_view unit);

/// "a length", "a pressure", ...; for what has no name, its unit.
std::string kind_name(const Dimension& dimension);

/// What was probably meant by a unit that is not known: "did you mean GPa?"; where several come near, one of the
/// dimension of `wanted` ("Pa").
std::string unit_meant(std::string_view unknown, std::string_view wanted);

/// All units, for people: one a line of a Markdown table.
std::string units_markdown();

}  // namespace knap
