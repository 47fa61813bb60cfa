#pragma once
// Numbers with units: "40 mm", "3.08 MPa", "1.18e-3 g/mm3", "1 mm/ms". They become SI, angles degrees.
#include <string>
#include <string_view>

namespace knap {

/// Powers of the base units. `rayleigh` counts the unit cR, the Rayleigh wave speed of the material; `courant` the unit
/// CFL, the stable step of the explicit bulk.
struct Dimension {
    int length = 0, mass = 0, time = 0, angle = 0, temperature = 0, rayleigh = 0, courant = 0;
    bool operator==(const Dimension&) const = default;
};

struct Quantity {
    double value = 0;   // in SI (degrees, multiples of cR or CFL)
    double number = 0;  // in the unit as written
    Dimension dimension;
    std::string unit;           // as written
    std::string problem;        // error message; empty = none
    bool unknown_unit = false;  // the problem is the unit
};

/// Reads a number and a unit, with `problem` set if it cannot. Independent of the locale. Powers of ten are applied to
/// the decimal text, so that "0.3 mm" and 0.3e-3 are the same double.
Quantity parse_quantity(std::string_view text);

/// Dimension of a valid unit ("J/m2"); "" has none.
Dimension dimension_of(std::string_view unit);

/// "a length", "a pressure", ...; the unit itself if its dimension has no name.
std::string kind_name(const Dimension& dimension);

/// A suggestion for an unknown unit, "did you mean `GPa`?", or "". Units with the dimension of `expected` ("Pa") come
/// first.
std::string unit_suggestion(std::string_view unknown, std::string_view expected);

/// A regular expression (ECMAScript) of texts with a number and a unit of the kind of `unit`, of one to three factors,
/// as J/m2 or W/m2/K; "*": with any unit.
std::string quantity_pattern(std::string_view unit);

/// A Markdown table of all units.
std::string units_markdown();

}  // namespace knap
