#pragma once
// A formula of x, y and t: numbers, + - * / ^, parentheses, pi, and the functions that expression.cpp lists.
#include <string>
#include <string_view>
#include <vector>

namespace knap {

class Expression {
public:
    /// The number zero.
    Expression() : Expression("0") {}
    /// Throws UserError ("bad-formula") that names the place.
    explicit Expression(std::string_view text);

    double operator()(double x, double y, double t) const;
    const std::string& text() const { return text_; }
    bool depends_on_time() const;
    bool depends_on_place() const;

    enum class Code { number, x, y, t, negate, add, subtract, multiply, divide, power, function };
    struct Step {
        Code code;
        double number = 0;
        int function = 0;
    };

private:
    std::string text_;
    std::vector<Step> steps_;  // in the order of a stack machine
};

}  // namespace knap
