#include "model/place_field.hpp"

#include "base/formatted.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

bool PlaceField::depends_on_time() const {
    if (table) return table->depends_on_time();
    return std::ranges::any_of(formulas, [](const Formula& formula) { return formula.of_place.depends_on_time(); });
}

BadPlace PlaceField::unreached(const Vec2& place) const {
    return {*this, "`" + path + "`: the points of " + text + " do not reach " + place_text(place) + " of the body",
            "points round all places that need a value, or on a line that has them all: in between it is linear, and "
            "beyond them unknown"};
}

std::array<double, 3> PlaceField::at(const Vec2& place, double t) const {
    if (table) {
        if (const auto found = table->at(place, t)) return *found;
        throw unreached(place);
    }
    std::array<double, 3> value{};
    for (std::size_t k = 0; k < n_values; ++k)
        value[k] = formulas[k].unit * formulas[k].of_place(place.x(), place.y(), t);
    return value;
}

std::array<double, 3> PlaceField::at_start(const Vec2& place) const {
    if (table && !table->reaches(place)) throw unreached(place);
    const std::array<double, 3> value = at(place, 0);
    if (!std::ranges::all_of(value, [](double v) { return std::isfinite(v); }))
        throw BadPlace(*this, "`" + path + "` is no finite number at " + place_text(place),
                       "a formula that has a value everywhere in the body");
    return value;
}

}  // namespace knap
