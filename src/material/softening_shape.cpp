#include "material/softening_shape.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int n_of_curve = 12;            // pieces of a curved shape
constexpr double cut_exponential = 0.01;  // [-] traction at which the exponential is cut; the rest is lowered to 0

/// A curve B(x) on [0, end], interpolated at knots t -> x(t), 0 <= t <= 1, that ascend.
template <class Curve, class Place>
std::vector<Vec2> interpolated(const Curve& B, const Place& place) {
    std::vector<Vec2> knots;
    for (int i = 0; i <= n_of_curve; ++i) {
        const double x = place(static_cast<double>(i) / n_of_curve);
        knots.emplace_back(x, i == 0 ? 1 : i == n_of_curve ? 0 : B(x));
    }
    return knots;
}

// The knots of a curve follow the density |B''|^0.4, for which the mean square error of the polygon is least.

/// B = (exp(-x/d) - c)/(1 - c); the scale d follows from the area.
std::vector<Vec2> exponential() {
    constexpr double c = cut_exponential, power = 0.4;
    const double last = std::pow(c, power);  // exp(-0.4 x/d) at the end
    return interpolated([](double x) { return (std::exp(-x) - c) / (1 - c); },
                        [&](double t) { return -std::log(1 - t * (1 - last)) / power; });
}

/// B = (1 - x/x_f)^n, the law of K. Park, G. H. Paulino, J. R. Roesler (J. Mech. Phys. Solids 57, 2009, 891) in mode I
/// without its initial slope: n = alpha - 1.
std::vector<Vec2> power(double n) {
    const double density = 1 + 0.4 * (n - 2);
    return interpolated([&](double x) { return std::pow(1 - x, n); },
                        [&](double t) { return 1 - std::pow(1 - t, 1 / density); });
}

std::vector<Vec2> knots_of(const SofteningOptions& options) {
    switch (options.shape) {
        case SofteningOptions::Shape::linear: break;
        // P.-E. Petersson, Crack growth and development of fracture zones in plain concrete, Lund 1981
        case SofteningOptions::Shape::petersson: return {{0, 1}, {0.8, 1. / 3}, {3.6, 0}};
        // fib Model Code for Concrete Structures 2010, 5.1.8.2
        case SofteningOptions::Shape::mc2010: return {{0, 1}, {1, 0.2}, {5, 0}};
        case SofteningOptions::Shape::exponential: return exponential();
        case SofteningOptions::Shape::trapezoid: return {{0, 1}, {options.plateau, 1}, {1, 0}};
        case SofteningOptions::Shape::power: return power(options.exponent);
        case SofteningOptions::Shape::table: return options.table;
    }
    return {{0, 1}, {2, 0}};
}

}  // namespace

SofteningShape::SofteningShape(std::vector<Vec2> knots) : knots_(std::move(knots)) {
    const double strength = knots_.front().y();
    double area = 0;
    for (std::size_t i = 0; i + 1 < knots_.size(); ++i)
        area += 0.5 * (knots_[i].y() + knots_[i + 1].y()) / strength * (knots_[i + 1].x() - knots_[i].x());
    for (Vec2& knot : knots_) knot = {knot.x() / area, knot.y() / strength};
    consumed_ = {0};
    for (std::size_t i = 0; i + 1 < knots_.size(); ++i) {
        const Vec2 &a = knots_[i], &b = knots_[i + 1];
        const double fall = a.y() - b.y(), length = b.x() - a.x();
        slopes_.push_back(length > 0 ? fall / length : infinity);
        consumed_.push_back(consumed_.back() + 0.5 * fall * (a.x() + b.x()));
    }
}

int SofteningShape::piece_at(double x) const {
    std::size_t i = 0;
    while (i + 1 < slopes_.size() && x >= knots_[i + 1].x()) ++i;
    return static_cast<int>(i);
}

double SofteningShape::traction(double x) const {
    if (x >= final_opening()) return 0;
    const int i = piece_at(x);
    return std::max(0.0, knots_[i].y() - slopes_[i] * (x - knots_[i].x()));
}

double SofteningShape::continued_traction(double x) const {
    return x > final_opening() ? slopes_.back() * (final_opening() - x) : traction(x);
}

double SofteningShape::opening(double beta) const {
    if (beta <= 0) return final_opening();
    std::size_t i = 0;
    while (i + 1 < slopes_.size() && knots_[i + 1].y() >= beta) ++i;
    if (slopes_[i] == 0) return knots_[i + 1].x();
    return knots_[i].x() + (knots_[i].y() - beta) / slopes_[i];
}

double SofteningShape::dissipated(double beta) const {
    if (beta <= 0) return 1;
    std::size_t i = 0;
    while (i + 1 < slopes_.size() && knots_[i + 1].y() >= beta) ++i;
    return consumed_[i] + 0.5 * (knots_[i].y() - beta) * (knots_[i].x() + opening(beta));
}

double SofteningShape::steepest(double beta) const {
    double steepest = 0;
    for (std::size_t i = 0; i < slopes_.size(); ++i)
        if (knots_[i + 1].y() < beta) steepest = std::max(steepest, slopes_[i]);
    return steepest;
}

std::string fault_of_softening(const std::vector<Vec2>& knots) {
    if (knots.size() < 2) return "has less than two points";
    if (knots.size() > SofteningShape::max_pieces + 1)
        return "has more than " + std::to_string(SofteningShape::max_pieces + 1) + " points";
    if (knots.front().x() != 0) return "does not begin at the opening 0";
    if (!(knots.front().y() > 0)) return "does not begin with a traction above 0";
    if (knots.back().y() != 0) return "does not end with the traction 0";
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        if (knots[i + 1].x() < knots[i].x()) return "has openings that do not ascend";
        if (knots[i + 1].y() > knots[i].y()) return "has a traction that grows with the opening";
        if (knots[i + 1] == knots[i]) return "has a point twice";
        if (knots[i].y() == 0) return "goes on behind the traction 0";
    }
    if (!(knots.back().x() > 0)) return "has no area";
    return "";
}

std::shared_ptr<const SofteningShape> make_softening(const SofteningOptions& options) {
    if (options.shape == SofteningOptions::Shape::linear) return nullptr;
    return std::make_shared<const SofteningShape>(knots_of(options));
}

}  // namespace knap
