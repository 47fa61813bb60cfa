// Softening polygons: their area, their potential, the published points, and how near the polygons of curves are.
#include "material/softening_shape.hpp"
#include "base/random.hpp"
#include "material/cohesive_law.hpp"
#include "support/relative.hpp"
#include "support/softening_shapes.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace softening_shape_test {

using namespace knap;
using namespace knap::tests;

using Shape = SofteningOptions::Shape;

TEST_CASE("every softening shape has the area 1 and a potential that it is the derivative of") {
    Random random(1, "shapes");
    for (const auto& [name, shape] : all_softening_shapes()) {
        CAPTURE(name);
        double area = 0;
        for (std::size_t i = 0; i + 1 < shape->knots().size(); ++i) {
            const Vec2 &a = shape->knots()[i], &b = shape->knots()[i + 1];
            area += 0.5 * (a.y() + b.y()) * (b.x() - a.x());
        }
        CHECK(area == relative(1, 1e-14));
        CHECK(shape->traction(0) == 1);
        CHECK(shape->traction(shape->final_opening()) == 0);
        CHECK(shape->traction(1.5 * shape->final_opening()) == 0);
        CHECK(shape->opening(0) == shape->final_opening());
        CHECK(shape->dissipated(1) == 0);
        CHECK(shape->dissipated(0) == 1);
        CHECK(shape->dissipated(1e-300) == relative(1, 1e-14));
        double steepest = 0;
        for (int i = 0; i < 300; ++i) {
            const double b = random.uniform(0.001, 0.999), d = 1e-6;
            CHECK(shape->traction(shape->opening(b)) == relative(b, 1e-12));
            // f' = -x(b)
            CHECK((shape->dissipated(b - d) - shape->dissipated(b + d)) / (2 * d) == relative(shape->opening(b), 1e-5));
            // what an opening to x and back costs: the area below B minus the recoverable part
            const double x = random.uniform(0, shape->final_opening()), beta = shape->traction(x);
            double below = 0;
            const int n = 2000;
            for (int k = 0; k < n; ++k) below += shape->traction((k + 0.5) * x / n) * x / n;
            CHECK(shape->dissipated(beta) == within(below - beta * x, 3e-6));  // of 1, by 2000 parts
            steepest = std::max(steepest, (shape->traction(x) - shape->traction(x + d)) / d);
        }
        CHECK(steepest == relative(shape->steepest(), 1e-4));
    }
}

TEST_CASE("the published points of the bilinear softenings of concrete and the plateau of a trapezoid") {
    const SofteningShape petersson = *make_softening({.shape = Shape::petersson}),
                         mc2010 = *make_softening({.shape = Shape::mc2010}),
                         half = *make_softening({.shape = Shape::trapezoid, .plateau = 0.5}),
                         dugdale = *make_softening({.shape = Shape::trapezoid, .plateau = 1}),
                         linear = *make_softening({.shape = Shape::power, .exponent = 1});
    CHECK(petersson.traction(0.8) == relative(1. / 3, 1e-14));
    CHECK(petersson.final_opening() == relative(3.6, 1e-14));
    CHECK(petersson.steepest() == relative(1 / 1.2, 1e-14));
    CHECK(petersson.steepest(1. / 3) == relative(1 / 8.4, 1e-12));  // only the second piece is left
    CHECK(petersson.dissipated(0.5) == relative(0.6 * 0.25, 1e-13));
    CHECK(petersson.dissipated(0.2) == relative(1 - 3.6 * 0.2 + 4.2 * 0.04, 1e-13));
    CHECK(mc2010.traction(1) == relative(0.2, 1e-14));
    CHECK(mc2010.final_opening() == relative(5, 1e-14));
    CHECK(half.traction(0.6) == 1);
    CHECK(half.final_opening() == relative(4. / 3, 1e-14));
    CHECK(half.steepest() == relative(1.5, 1e-14));
    CHECK(dugdale.traction(1 - 1e-9) == 1);
    CHECK(dugdale.traction(1) == 0);
    CHECK(dugdale.dissipated(0.3) == relative(0.7, 1e-14));
    CHECK(std::isinf(dugdale.steepest()));
    for (const double x : {0.1, 0.7, 1.9}) CHECK(linear.traction(x) == relative(1 - x / 2, 1e-13));
    CHECK(make_softening({}) == nullptr);
}

TEST_CASE("the polygons of curves are within .7 percent of them") {
    const SofteningShape exponential = *make_softening({.shape = Shape::exponential});
    constexpr double c = 0.01;
    const double d = (1 - c) / (1 - c + c * std::log(c));
    double worst = 0;
    for (double x = 0; x < 5; x += 1e-3)
        worst = std::max(worst, std::abs(exponential.traction(x) - std::max(0.0, (std::exp(-x / d) - c) / (1 - c))));
    MESSAGE("exponential: ", worst);
    CHECK(worst < 0.004);
    CHECK(exponential.final_opening() == relative(-d * std::log(c), 0.01));
    for (const double n : {0.5, 2.0, 4.0, 10.0}) {
        const SofteningShape power = *make_softening({.shape = Shape::power, .exponent = n});
        worst = 0;
        for (double x = 0; x < n + 1; x += 1e-3)
            worst = std::max(worst, std::abs(power.traction(x) - std::pow(1 - x / (n + 1), n)));
        MESSAGE("power ", n, ": ", worst);
        CHECK(worst < (n < 1 ? 0.05 : 0.007));  // vertical at its end for n < 1
    }
}

TEST_CASE("what is wrong with a table of a softening is named") {
    const std::vector<std::pair<std::vector<Vec2>, const char*>> tables = {
        {{{0, 1}}, "less than two"},
        {{{0.1, 1}, {1, 0}}, "opening 0"},
        {{{0, 0}, {1, 0}}, "traction above 0"},
        {{{0, 1}, {1, 0.5}}, "traction 0"},
        {{{0, 1}, {2, 0.5}, {1, 0}}, "ascend"},
        {{{0, 1}, {1, 1.5}, {2, 0}}, "grows"},
        {{{0, 1}, {1, 0.5}, {1, 0.5}, {2, 0}}, "twice"},
        {{{0, 1}, {1, 0}, {2, 0}}, "behind"},
        {{{0, 1}, {0, 0}}, "no area"},
        {std::vector<Vec2>(14, Vec2(0, 1)), "more than 13"}};
    for (const auto& [table, fault] : tables)
        CHECK_MESSAGE(fault_of_softening(table).find(fault) != std::string::npos, fault, ": ",
                      fault_of_softening(table));
    CHECK(fault_of_softening({{0, 3}, {1, 1}, {1, 0.5}, {5, 0}}).empty());
}

TEST_CASE("tractions and driving force are the derivatives of the surface energy for every softening shape") {
    Random random(1, "law");
    const double step = 1e-6;
    for (const auto& [name, shape] : all_softening_shapes()) {
        CAPTURE(name);
        const CohesiveLaw law{.sigma_c = 3, .G_c = 6, .gamma = 0.7, .softening = shape};
        CHECK(law.delta_c() == relative(2 * shape->final_opening(), 1e-14));
        CHECK(law.softening_length() == relative(2 / shape->steepest(), 1e-14));
        for (int i = 0; i < 200; ++i) {
            const double u_N = random.uniform(0.01, 4), u_T = random.uniform(-4, 4), beta = random.uniform(0.01, 0.99),
                         s = law.equivalent_opening(u_N, u_T);
            const double by_beta =
                (law.surface_energy(beta + step, u_N, u_T) - law.surface_energy(beta - step, u_N, u_T)) / (2 * step);
            CHECK(by_beta == within(law.sigma_c * s - law.G_c * shape->opening(beta), 1e-7));
            const double next = law.next_cohesion(beta, u_N, u_T), least = law.surface_energy(next, u_N, u_T);
            CHECK(next <= beta);
            for (double other = 0; other <= beta; other += 0.01)
                CHECK(law.surface_energy(other, u_N, u_T) >= least - 1e-12);
        }
    }
}

// A step wave of 1.5 times the strength reaches an interface between two bars: u' = 2 (X - B(u)), E = rho = sigma_c = 1,
// G_c = .05. Times of the break and openings at t = .03 by closed forms; those of curves differ by their polygons.
TEST_CASE("a step wave opens interfaces of every shape as the closed forms say") {
    struct Reference {
        SofteningOptions options;
        double breaks, opening, tolerance;
    };
    for (const auto& [options, breaks, opening, tolerance] :
         {Reference{{.shape = Shape::trapezoid, .plateau = 1}, 0.05, 0.03, 1e-4},
          Reference{{.shape = Shape::petersson}, 0.07819497, 0.05080659, 1e-6},
          Reference{{.shape = Shape::exponential}, 0.09903392, 0.04872663, 7e-3},
          Reference{{.shape = Shape::power, .exponent = 2}, 0.07019110, 0.04419899, 7e-3},
          Reference{{.shape = Shape::trapezoid, .plateau = 0.5}, 0.05164354, 0.03, 1e-5}}) {
        const CohesiveLaw law{.sigma_c = 1, .G_c = 0.05, .softening = make_softening(options)};
        const auto rate = [&](double u) { return 2 * (1.5 - law.next_cohesion(1, u, 0)); };
        constexpr double h = 1e-6;
        double u = 0, t = 0, at_03 = 0;
        for (int i = 0; law.next_cohesion(1, u, 0) > 0; ++i) {
            if (i == 30000) at_03 = u;
            const double a = rate(u), b = rate(u + h / 2 * a), c = rate(u + h / 2 * b), d = rate(u + h * c),
                         next = u + h / 6 * (a + 2 * b + 2 * c + d);
            t += next < law.delta_c() ? h : h * (law.delta_c() - u) / (next - u);
            u = next;
        }
        CAPTURE(opening);
        CHECK(t == relative(breaks, tolerance));
        CHECK(at_03 == relative(opening, tolerance));
    }
}

}  // namespace softening_shape_test
