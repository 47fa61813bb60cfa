// Every piece of a scenario that a README or the list of keys shows can be read: laid over a scenario that has what it
// names.
#include "samples.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <regex>
#include <utility>

namespace readme_test {

using namespace knap;

namespace {

/// What the examples speak of; a table that an example has itself is left out.
const std::pair<const char*, const char*> context[] = {
    {"[domain]",
     "shape = \"polygon\"\npoints = [[0, 0], [0.1, 0], [0.1, 0.04], [0.05, 0.04], [0, 0.04]]\nsides = [\"bottom\", "
     "\"right\", \"top\", \"sides\", \"left\"]\n"},
    {"[mesh]", "size = \"1 mm\"\n"},
    {"[material.rock]", "density = 2650\nE = \"40 GPa\"\nnu = 0.2\n"},
    {"[material.quartz]", "density = 2650\nE = \"90 GPa\"\nnu = 0.1\n"},
    {"[material.mica]", "density = 2850\nE = \"80 GPa\"\nnu = 0.2\n"},
    {"[interface.default]", "sigma_c = \"8 MPa\"\nG_c = 20\n"},
    {"[[obstacle]]",
     "name = \"upper platen\"\nshape = \"half plane\"\nat = [0, 0.05]\nnormal = [0, -1]\nvelocity = [0, -0.01]\n"},
    {"[[probe]]", "name = \"lower gauge\"\nat = [0, 0.02]\n[[probe]]\nname = \"upper gauge\"\nat = [0.1, 0.02]\n"},
    {"[time]", "end = \"20 us\"\n"},
};

struct Example {
    std::string file;
    int line = 0;
    std::string text;
};

/// Indented by four blanks, with the header of a table or the version in them.
std::vector<Example> examples() {
    std::vector<Example> found;
    for (const char* file : {"README.md", "scenarios/README.md", "scenarios/KEYS.md"}) {
        std::ifstream in(std::string(KNAP_SOURCE_DIR) + "/" + file);
        Example now;
        int number = 0;
        const auto end = [&] {
            if (now.text.starts_with("[") || now.text.starts_with("knap = ") ||
                now.text.find("\n[") != std::string::npos)
                found.push_back(now);
            now = {};
        };
        for (std::string line; std::getline(in, line);) {
            ++number;
            if (!line.starts_with("    ")) end();
            else if (now.text.empty()) now = {file, number, line.substr(4) + "\n"};
            else now.text += line.substr(4) + "\n";
        }
        end();
    }
    return found;
}

/// A table that is shown in part gets what it cannot be without.
std::string completed(std::string text) {
    const auto add = [&](const std::string& header, const char* key_that_is_there, const char* key) {
        const std::size_t at = text.find(header + "\n");
        if (at == std::string::npos) return;
        const std::string table = text.substr(at + 1, text.find("\n[", at + 1) - at - 1);
        if (!std::regex_search(table, std::regex(key_that_is_there))) text.insert(at + header.size() + 1, key);
    };
    add("[time]", "\nend *=", "end = \"20 us\"\n");
    add("[mesh]", "\n(size|file) *=", "size = \"1 mm\"\n");
    const bool has_body = text.find("[domain]\n") != std::string::npos || text.find("[[bod") != std::string::npos ||
                          std::regex_search(text, std::regex("\\[mesh\\]\n(.*\n)*file"));
    for (const auto& [header, keys] : context) {
        const bool is_body = std::string(header) == "[domain]";
        if (std::string(header) == "[[obstacle]]" && text.find("[adapt]") != std::string::npos) continue;  // refused
        if (is_body ? has_body : header[1] != '[' && text.find(std::string(header) + "\n") != std::string::npos)
            continue;
        text += "\n" + std::string(header) + "\n" + keys;
        if (is_body && text.find("[contact]") != std::string::npos) text += "rotation = \"large\"\n";
    }
    return (text.find("knap ") == 0 ? "" : "knap = 1\n") + text;
}

}  // namespace

TEST_CASE("the examples of the READMEs and of the list of keys are scenarios") {
    const std::vector<Example> all = examples();
    REQUIRE(all.size() >= 28);
    for (const Example& example : all) {
        const std::string text = completed(example.text);
        std::string wrong;
        for (const Diagnostic& d : samples::mistakes(text))
            if (d.code != "missing-file") wrong += format(d);  // a mesh or a picture of the reader's own
        CHECK_MESSAGE(wrong.empty(), example.file << ":" << example.line << "\n" << wrong);
    }
}

}  // namespace readme_test
