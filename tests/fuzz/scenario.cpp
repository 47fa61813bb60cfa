// Any text as a scenario. A valid one is written with all defaults, and reading that gives the same scenario.
#include "target.hpp"

#include "base/error.hpp"
#include "scenario/read_scenario.hpp"
#include "scenario/write_scenario.hpp"

#include <algorithm>

using namespace knap;
using tests::require;

namespace {

void check(const UserError& error, const std::string& text) {
    require(!error.diagnostics.empty(), "an error says something");
    const auto n_lines = 1 + std::count(text.begin(), text.end(), '\n');
    for (const Diagnostic& d : error.diagnostics) {
        require(!format(d).empty(), "it is shown");
        if (d.file == "input.toml") require(d.line >= 0 && d.line <= n_lines, "it stands in the file");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::string beside =
        KNAP_SOURCE_DIR "/tests/fuzz/beside";  // the files that scenarios of the corpus name
    const std::string text = tests::text_of(data, size);
    try {
        const ReadResult read = read_scenario_text(text, "input.toml", {}, beside);
        require(!full_listing(read).empty(), "all keys are listed");
        if (!read.scenario.files.empty()) return 0;  // written in full it names the copies of a run
        const std::string whole = resolved_toml(read);
        std::string again;
        try {
            again = resolved_toml(read_scenario_text(whole, "input.toml"));
        } catch (const UserError& error) {
            for (const Diagnostic& d : error.diagnostics) std::fputs(format(d).c_str(), stderr);
            require(false, "what was written in full can be read");
        }
        if (whole != again) std::fprintf(stderr, "%s\n----\n%s\n", whole.c_str(), again.c_str());
        require(whole == again, "what was written in full says the same");
    } catch (const UserError& error) {
        check(error, text);
    }
    return 0;
}
