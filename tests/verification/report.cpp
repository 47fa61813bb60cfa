// tests/VERIFICATION.md from what the tests noted (support/verification_listener.hpp): verification_report CASES.tsv > VERIFICATION.md
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {

struct Number {
    std::string path, quantity, found, reference, kind;
    double deviation = 0, acc = 0, str = 0;
    bool meets_acc() const { return deviation <= acc; }
    bool meets_str() const { return deviation <= str; }
};

struct Test {
    std::string name;  // without the name of the case
    bool slow = false, failed = false;
    double seconds = 0;
    std::vector<std::string> texts, pictures;
    std::vector<Number> numbers;
};

/// "B3" is the third of B.
struct CaseName {
    char group;
    int number;
    auto operator<=>(const CaseName&) const = default;
    std::string text() const { return group + std::to_string(number); }
};

using Cases = std::map<CaseName, std::vector<Test>>;

std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::stringstream in(line);
    for (std::string field; std::getline(in, field, '\t');) fields.push_back(field);
    return fields;
}

Cases read(const std::string& file) {
    static const std::regex name("([A-EH])([0-9]+) (.*)");
    std::ifstream in(file);
    Cases cases;
    Test* test = nullptr;
    for (std::string line; std::getline(in, line);) {
        const std::vector<std::string> f = fields_of(line);
        if (f.empty()) continue;
        if (f[0] == "C") {
            std::smatch parts;
            test = nullptr;
            if (f.size() < 5 || !std::regex_match(f[1], parts, name)) continue;
            std::vector<Test>& tests = cases[{parts[1].str()[0], std::stoi(parts[2])}];
            tests.push_back({.name = parts[3],
                             .slow = f[2] == "slow",
                             .failed = f[4] != "0",
                             .seconds = std::stod(f[3]),
                             .texts = {},
                             .pictures = {},
                             .numbers = {}});
            test = &tests.back();
        } else if (test && f[0] == "T" && f.size() == 2) {
            test->texts.push_back(f[1]);
        } else if (test && f[0] == "P" && f.size() == 2) {
            test->pictures.push_back(f[1]);
        } else if (test && f[0] == "N" && f.size() == 9) {
            test->numbers.push_back({f[1], f[2], f[3], f[4], f[5], std::stod(f[6]), std::stod(f[7]), std::stod(f[8])});
        } else if (test) {
            std::cerr << "not understood: " << line << '\n';
            std::exit(2);
        }
    }
    for (auto& [which, tests] : cases)
        std::sort(tests.begin(), tests.end(), [](const Test& a, const Test& b) { return a.name < b.name; });
    return cases;
}

std::string text_of(double value, const char* format = "%.2g") {
    char text[40];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string met(int n, int of) {
    return n == of ? "met" : "**" + std::to_string(of - n) + " of " + std::to_string(of) + " not met**";
}

/// How many of all numbers of a case meet a tolerance.
template <class Criterion>
std::pair<int, int> count(const std::vector<Test>& tests, const Criterion& criterion) {
    int n = 0, of = 0;
    for (const Test& test : tests)
        for (const Number& number : test.numbers) n += criterion(number), ++of;
    return {n, of};
}

const auto acc = [](const Number& number) { return number.meets_acc(); };
const auto str = [](const Number& number) { return number.meets_str(); };

std::string paths_of(const std::vector<Test>& tests) {
    std::vector<std::string> paths;
    for (const Test& test : tests)
        for (const Number& number : test.numbers)
            if (!number.path.empty() && std::find(paths.begin(), paths.end(), number.path) == paths.end())
                paths.push_back(number.path);
    std::sort(paths.begin(), paths.end());
    std::string text;
    for (const std::string& path : paths) text += (text.empty() ? "" : "; ") + path;
    return text.empty() ? "-" : text;
}

double seconds_of(const std::vector<Test>& tests) {
    double sum = 0;
    for (const Test& test : tests) sum += test.seconds;
    return sum;
}

void print_overview(const Cases& cases) {
    int n_acc = 0, n_str = 0;
    double quick = 0, slow = 0;
    for (const auto& [name, tests] : cases) {
        const auto [a, of] = count(tests, acc);
        n_acc += a == of;
        n_str += count(tests, str).first == of;
        for (const Test& test : tests) (test.slow ? slow : quick) += test.seconds;
    }
    std::printf(
        "%d of %zu cases meet ACC in every number, %d meet STR in every number. Processor time: quick tests %.0f s, "
        "slow ones %.0f s.\n\n",
        n_acc, cases.size(), n_str, quick, slow);
    std::printf("| case | | bulk, cohesion | numbers | ACC | STR | processor time |\n|---|---|---|---|---|---|---|\n");
    for (const auto& [name, tests] : cases) {
        const auto [a, of] = count(tests, acc);
        const int s = count(tests, str).first;
        std::printf("| [%s](#%c%d) | %s | %s | %d | %s | %s | %.2g s |\n", name.text().c_str(), name.group - 'A' + 'a',
                    name.number, tests.front().name.c_str(), paths_of(tests).c_str(), of, met(a, of).c_str(),
                    s == of ? "met" : (std::to_string(s) + " of " + std::to_string(of)).c_str(), seconds_of(tests));
    }
}

void print(const CaseName& name, const std::vector<Test>& tests) {
    std::printf("\n## %s\n", name.text().c_str());
    for (const Test& test : tests) {
        std::printf("\n**%c%s** (%s%.2g s%s)\n", std::toupper(test.name.front()), test.name.substr(1).c_str(),
                    test.slow ? "slow, " : "", test.seconds, test.failed ? ", **FAILS**" : "");
        for (const std::string& text : test.texts) std::printf("\n%s\n", text.c_str());
        std::printf(
            "\n| quantity | bulk, cohesion | knap | reference | deviation | ACC | STR "
            "|\n|---|---|---|---|---|---|---|\n");
        for (const Number& n : test.numbers) {
            const bool is_bound = n.acc == 0;
            std::printf("| %s | %s | %s | %s | %s | %s | %s |\n", n.quantity.c_str(),
                        n.path.empty() ? "-" : n.path.c_str(), n.found.c_str(), n.reference.c_str(),
                        is_bound ? "" : (text_of(n.deviation) + " " + n.kind).c_str(),
                        n.meets_acc() ? (is_bound ? "met" : ("met, " + text_of(n.acc)).c_str())
                                      : ("**not met**, " + text_of(n.acc)).c_str(),
                        is_bound ? "" : ((n.meets_str() ? "met, " : "not met, ") + text_of(n.str)).c_str());
        }
        for (const std::string& picture : test.pictures)
            std::printf("\n![%s](verification/%s)\n", name.text().c_str(), picture.c_str());
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: verification_report CASES.tsv\n");
        return 2;
    }
    const Cases cases = read(argv[1]);
    if (cases.empty()) {
        std::fprintf(stderr, "%s has no cases\n", argv[1]);
        return 1;
    }
    std::printf(
        "# Verification\n\n"
        "Written by `tools/verify` from runs of the tests; nothing in here is typed by hand. Each number is found, and "
        "held against its reference, by the test of that name, and the\n"
        "test fails where ACC is not met. ACC is what a correct program must reach, STR what a good one does (a tenth "
        "of ACC where the case names nothing else). A deviation is\n"
        "relative to the reference, or absolute in the unit of the quantity (a dimensionless one where none is named), "
        "as its line says. The quick tests run with `tools/test`, the slow ones with `tools/test --slow`.\n\n");
    print_overview(cases);
    for (const auto& [name, tests] : cases) print(name, tests);
    return 0;
}
