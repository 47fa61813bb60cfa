#pragma once
// Scenarios that the tests of this folder read.
#include "base/error.hpp"
#include "scenario/read_scenario.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace knap::samples {

/// The least that is a scenario; one key a line, so that a test can take out or change a line.
inline const std::string least = R"(knap = 1
[domain]
shape = "rectangle"
size = [0.1, 0.04]
[mesh]
size = 0.001
[material.glass]
density = 2450
E = 32e9
nu = 0.2
[interface.default]
sigma_c = 3.08e6
G_c = 3
[time]
end = 80e-6
)";

/// `least` with one stretch of text put in the place of another.
inline std::string changed(const std::string& from, const std::string& to, std::string text = least) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) throw std::logic_error("sample without " + from);
    return text.replace(at, from.size(), to);
}

inline ReadResult read(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return read_scenario_text(text, "sample.toml", overrides);
}

/// What is wrong with what `read` reads; empty when it is read without an error.
template <class Read>
std::vector<Diagnostic> mistakes_of(const Read& read) {
    try {
        read();
    } catch (const UserError& error) {
        return error.diagnostics;
    }
    return {};
}
/// The same of a text.
inline std::vector<Diagnostic> mistakes(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return mistakes_of([&] { read(text, overrides); });
}

}  // namespace knap::samples
