#pragma once
// A stress, traction, pressure or angle over place and time, as a scenario gives it.
#include "base/error.hpp"
#include "base/expression.hpp"
#include "base/vec.hpp"
#include "mesh/point_table.hpp"

#include <array>
#include <memory>
#include <string>

namespace knap {

class BadPlace;

/// Up to three components: formulas, or a table of points.
struct PlaceField {
    struct Formula {
        Expression of_place;
        double unit = 1;  // of its values, in that of the key
    };
    std::string path;  // of the key in the scenario
    std::string text;  // its value there
    std::size_t n_values = 3;
    std::array<Formula, 3> formulas;
    std::shared_ptr<const PointTable> table = nullptr;  // in the place of the formulas

    bool depends_on_time() const;
    /// In the unit of the key: Pa, deg. Throws BadPlace where the points of the table do not reach.
    std::array<double, 3> at(const Vec2& place, double t) const;
    /// At t = 0. Throws BadPlace also where a formula is no finite number, or a table reaches at some times alone.
    std::array<double, 3> at_start(const Vec2& place) const;

private:
    BadPlace unreached(const Vec2& place) const;
};

/// A field has no value at a place of the body.
class BadPlace : public UserError {
public:
    BadPlace(const PlaceField& field, const std::string& message, const std::string& cure)
        : UserError("no-value", message, cure), path(field.path) {}
    std::string path;
};

}  // namespace knap
