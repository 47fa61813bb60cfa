// Formulas of x, y and t.
#include "base/error.hpp"
#include "base/expression.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

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
    CHECK(value("cos(pi)") == -1);
    CHECK(Expression("3*t").depends_on_time());
    CHECK(!Expression("tan(x)").depends_on_time());
}

TEST_CASE("what is no formula is refused with its place") {
    for (const auto& [text, place] : {std::pair{"", "at its end"}, {"1 +", "at its end"}, {"2 x", "at `x`"}, {"sin x", "`(` is expected"},
                                      {"z*2", "unknown at `z*2`"}, {"(1", "`)` is expected"}, {"max(1)", "`,` is expected"}, {"1e999", "not a number"}}) {
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
    CHECK_THROWS_AS(Expression(std::string(5000, '-') + "1"), UserError);
}
