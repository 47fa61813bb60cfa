#include "base/expression.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr int max_depth = 32;  // of the stack, and of parentheses

struct Function {
    std::string_view name;
    int n_arguments;
    double (*value)(double, double);
};

constexpr std::array functions{
    Function{"sin", 1, [](double a, double) { return std::sin(a); }},
    Function{"cos", 1, [](double a, double) { return std::cos(a); }},
    Function{"tan", 1, [](double a, double) { return std::tan(a); }},
    Function{"atan", 1, [](double a, double) { return std::atan(a); }},
    Function{"tanh", 1, [](double a, double) { return std::tanh(a); }},
    Function{"exp", 1, [](double a, double) { return std::exp(a); }},
    Function{"log", 1, [](double a, double) { return std::log(a); }},
    Function{"sqrt", 1, [](double a, double) { return std::sqrt(a); }},
    Function{"abs", 1, [](double a, double) { return std::abs(a); }},
    Function{"erf", 1, [](double a, double) { return std::erf(a); }},
    Function{"erfc", 1, [](double a, double) { return std::erfc(a); }},
    Function{"min", 2, [](double a, double b) { return std::min(a, b); }},
    Function{"max", 2, [](double a, double b) { return std::max(a, b); }},
};

/// sum = product {(+|-) product},  product = signed {(*|/) signed},  signed = [-] power,  power = atom [^ signed]
class Parser {
public:
    explicit Parser(std::string_view text) : text_(text) {}

    std::vector<Expression::Step> parse() {
        sum();
        if (!at_end()) fail("an operator is expected");
        return std::move(steps_);
    }

private:
    using Code = Expression::Code;

    void sum() {
        product();
        for (char c; (c = taken_of("+-")) != 0;) product(), emit(c == '+' ? Code::add : Code::subtract);
    }
    void product() {
        with_sign();
        for (char c; (c = taken_of("*/")) != 0;) with_sign(), emit(c == '*' ? Code::multiply : Code::divide);
    }
    void with_sign() {
        if (++nesting_ > max_depth) fail("it is nested too deeply");
        if (taken_of("+-") == '-') with_sign(), emit(Code::negate);
        else power();
        --nesting_;
    }
    void power() {
        atom();
        if (taken_of("^") != 0) with_sign(), emit(Code::power);
    }
    void atom() {
        if (taken_of("(") != 0) {
            sum();
            need(')');
        } else if (!at_end() && (std::isdigit(static_cast<unsigned char>(text_[at_])) || text_[at_] == '.')) {
            double value = 0;
            const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
            if (error != std::errc()) fail("this is not a number");
            at_ = end - text_.data();
            emit(Code::number, value);
        } else {
            word();
        }
    }
    void word() {
        const std::size_t begin = at_;
        while (at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_]))) ++at_;
        const std::string_view name = text_.substr(begin, at_ - begin);
        if (name == "x") return emit(Code::x);
        if (name == "y") return emit(Code::y);
        if (name == "t") return emit(Code::t);
        if (name == "pi") return emit(Code::number, std::numbers::pi);
        const auto* found = std::ranges::find(functions, name, &Function::name);
        if (found == functions.end()) {
            at_ = begin;
            fail(name.empty() ? "a number, x, y, t, a function or ( is expected" : "this name is unknown");
        }
        need('(');
        sum();
        for (int i = 1; i < found->n_arguments; ++i) need(','), sum();
        need(')');
        emit(Code::function, 0, static_cast<int>(found - functions.begin()));
    }

    void emit(Code code, double number = 0, int function = 0) {
        const bool pushes = code == Code::number || code == Code::x || code == Code::y || code == Code::t;
        const bool joins = code == Code::add || code == Code::subtract || code == Code::multiply ||
                           code == Code::divide || code == Code::power ||
                           (code == Code::function && functions[function].n_arguments == 2);
        depth_ += pushes ? 1 : joins ? -1 : 0;
        if (depth_ > max_depth) fail("it is nested too deeply");
        steps_.push_back({code, number, function});
    }
    bool at_end() {
        while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
        return at_ == text_.size();
    }
    /// The next character, if it is one of these; else 0.
    char taken_of(std::string_view these) {
        return !at_end() && these.find(text_[at_]) != std::string_view::npos ? text_[at_++] : '\0';
    }
    void need(char c) {
        if (taken_of({&c, 1}) == 0) fail(std::string("`") + c + "` is expected");
    }
    [[noreturn]] void fail(const std::string& problem) {
        std::string known;
        for (const Function& function : functions) known += (known.empty() ? "" : " ") + std::string(function.name);
        throw UserError(
            "bad-formula",
            problem + (at_ < text_.size() ? " at `" + std::string(text_.substr(at_, 20)) + "`" : " at its end"),
            "a formula of x, y [m] and t [s] with + - * / ^ ( ) pi and " + known);
    }

    std::string_view text_;
    std::size_t at_ = 0;
    int depth_ = 0, nesting_ = 0;
    std::vector<Expression::Step> steps_;
};

}  // namespace

Expression::Expression(std::string_view text) : text_(text), steps_(Parser(text_).parse()) {}

bool Expression::depends_on_time() const {
    return std::ranges::any_of(steps_, [](const Step& step) { return step.code == Code::t; });
}

bool Expression::depends_on_place() const {
    return std::ranges::any_of(steps_, [](const Step& step) { return step.code == Code::x || step.code == Code::y; });
}

double Expression::operator()(double x, double y, double t) const {
    double stack[max_depth + 1]{};
    double* top = stack;  // behind the last value
    for (const Step& step : steps_) {
        switch (step.code) {
            case Code::number: *top++ = step.number; break;
            case Code::x: *top++ = x; break;
            case Code::y: *top++ = y; break;
            case Code::t: *top++ = t; break;
            case Code::negate: top[-1] = -top[-1]; break;
            case Code::add: --top, top[-1] += top[0]; break;
            case Code::subtract: --top, top[-1] -= top[0]; break;
            case Code::multiply: --top, top[-1] *= top[0]; break;
            case Code::divide: --top, top[-1] /= top[0]; break;
            case Code::power: --top, top[-1] = std::pow(top[-1], top[0]); break;
            case Code::function: {
                const Function& function = functions[step.function];
                if (function.n_arguments == 2) --top;
                top[-1] = function.value(top[-1], top[0]);
                break;
            }
        }
    }
    return top[-1];
}

}  // namespace knap
