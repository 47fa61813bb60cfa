// Formulas and tables of x, y and t.
#include "base/error.hpp"
#include "base/expression.hpp"
#include "base/grid_table.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace formulas_test {

using namespace knap;
using namespace knap::tests;

TEST_CASE("formulas follow the usual order of operations") {
    const auto value = [](const char* text) { return Expression(text)(2, 3, 0.5); };
    CHECK(value("1 + 2*x^2 - y/3") == 8);
    CHECK(value("-x^2") == -4);
    CHECK(value("2^-1") == 0.5);
    CHECK(value("2^3^2") == 512);
    CHECK(value("x - y - t") == -1.5);
    CHECK(value("8/2/2") == 2);
    CHECK(value("-(x + y)*--t") == -2.5);
    CHECK(value("max(x, min(y, 10*t))") == 3);
    CHECK(value(" 20+300 * exp( -x/1e-1 ) ") == relative(20 + 300 * std::exp(-20.), 1e-15));
    CHECK(value("erf(x) + erfc(x)") == relative(1, 1e-15));
    CHECK(value("tan(atan(x))") == relative(value("x"), 1e-15));
    CHECK(value("cos(pi)") == -1);
    CHECK(Expression("3*t").depends_on_time());
    CHECK(!Expression("tan(x)").depends_on_time());
    CHECK(Expression("1 - y").depends_on_place());
    CHECK(!Expression("3*t").depends_on_place());
}

TEST_CASE("what is no formula is refused with its place") {
    for (const auto& [text, place] : {std::pair{"", "at its end"},
                                      {"1 +", "at its end"},
                                      {"2 x", "at `x`"},
                                      {"sin x", "`(` is expected"},
                                      {"z*2", "unknown at `z*2`"},
                                      {"(1", "`)` is expected"},
                                      {"max(1)", "`,` is expected"},
                                      {"1e999", "not a number"}}) {
        CAPTURE(text);
        std::string message;
        try {
            Expression{text};
        } catch (const UserError& error) {
            message = error.what();
        }
        CHECK_MESSAGE(message.find(place) != std::string::npos, message);
    }
    CHECK_THROWS_AS(Expression(std::string(5000, '(')), UserError);
    CHECK_THROWS_AS(Expression(std::string(5000, '-').append("1")), UserError);
}

// A function that is linear in x, y and t each is its own table.
TEST_CASE("a table over a grid is linear between its places and constant outside") {
    const auto f = [](double x, double y, double t) { return (2 + x) * (3 - y) * (1 + 4 * t); };
    std::vector<std::array<double, 4>> rows;
    for (const double t : {0.5, 0.0})
        for (const double x : {3.0, 0.0, 1.0})
            for (const double y : {-1.0, 2.0}) rows.push_back({x, y, t, f(x, y, t)});
    const GridTable table(rows);
    CHECK(table.depends_on_time());
    for (const auto& [x, y, t] : {std::array{0.0, -1.0, 0.0}, {3.0, 2.0, 0.5}, {0.3, 1.1, 0.2}, {2.9, -0.4, 0.49}})
        CHECK(table(x, y, t) == relative(f(x, y, t), 1e-15));
    CHECK(table(-7, 0.5, 0.1) == relative(f(0, 0.5, 0.1), 1e-15));
    CHECK(table(2, 9, 3) == relative(f(2, 2, 0.5), 1e-15));
    CHECK_FALSE(GridTable({{0, 0, 0, 5}}).depends_on_time());
    CHECK(GridTable({{0, 0, 0, 5}})(1, 2, 3) == 5);
    const auto message = [&](std::vector<std::array<double, 4>> changed) -> std::string {
        try {
            GridTable{changed};
        } catch (const UserError& error) {
            return error.what();
        }
        return "";
    };
    auto missing = rows, twice = rows;
    missing.erase(missing.begin() + 7);  // x = 3, y = 2, t = 0
    twice.push_back({1, 2, 0, 0});
    CHECK_MESSAGE(message(missing).find("there is no line for x = 3, y = 2, t = 0") != std::string::npos,
                  message(missing));
    CHECK_MESSAGE(message(twice).find("there is a second line for x = 1, y = 2, t = 0") != std::string::npos,
                  message(twice));
}

}  // namespace formulas_test
