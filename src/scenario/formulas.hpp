#pragma once
// Formulas in the place of numbers with a unit: "-0.5*0.027*(100 - y) MPa".
#include "model/place_field.hpp"

#include <string_view>

namespace knap {

/// A formula of x, y [m] and t [s] whose values are in `unit`, in SI, or in the unit of the same kind behind it. Throws
/// UserError ("bad-formula").
PlaceField::Formula parse_formula(std::string_view text, std::string_view unit);

/// Whether a text that is no number with a unit is meant as a formula, and not as a number with a misspelt unit.
bool looks_like_formula(std::string_view text);

}  // namespace knap
