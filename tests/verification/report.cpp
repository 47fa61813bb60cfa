// From what the tests noted (support/verification_listener.hpp): FOLDER/verification/numbers.csv, a line a number; cases.csv, a line a test; and
// the table of FOLDER/VERIFICATION.md, between its two comments. verification_report CASES.tsv FOLDER MADE, e.g. "2026-11-28, revision 6cb7cba"
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
    bool is_bound() const { return acc == 0; }
    bool meets_acc() const { return deviation <= acc; }
    bool meets_str() const { return deviation <= str; }
};

struct Test {
    std::string name;  // without the name of the case
    bool slow = false, failed = false;
    double seconds = 0;
    std::string text;  // what it is
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
                             .text = {},
                             .numbers = {}});
            test = &tests.back();
        } else if (test && f[0] == "T" && f.size() == 2) {
            test->text += (test->text.empty() ? "" : " ") + f[1];
        } else if (test && f[0] == "P") {
            // a picture, which the page shows
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

std::string text_of(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.2g", value);
    return text;
}

std::string seconds(double value) { return value < 10 ? text_of(value) : std::to_string(std::lround(value)); }

/// A field of a csv file.
std::string field(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    return '"' + std::regex_replace(text, std::regex("\""), "\"\"") + '"';
}

const char* yes(bool it_is) { return it_is ? "yes" : "no"; }

std::string numbers_csv(const Cases& cases, const std::string& made) {
    std::string csv =
        "# Every number of the reference cases (tests/VERIFICATION.md). Written by tools/verify, " + made +
        ".\n# A deviation is relative to the reference or absolute, in the unit of the quantity. A bound has none.\n"
        "case,test,schemes,quantity,found,reference,deviation,kind,ACC,ACC met,STR,STR met\n";
    for (const auto& [name, tests] : cases)
        for (const Test& test : tests)
            for (const Number& n : test.numbers) {
                csv += name.text() + ',' + field(test.name) + ',' + field(n.path) + ',' + field(n.quantity) + ',' +
                       field(n.found) + ',' + field(n.reference) + ',';
                csv += n.is_bound() ? ",,," : text_of(n.deviation) + ',' + n.kind + ',' + text_of(n.acc) + ',';
                csv += yes(n.meets_acc());
                csv += n.is_bound() ? ",," : ',' + text_of(n.str) + ',' + yes(n.meets_str());
                csv += '\n';
            }
    return csv;
}

struct Count {
    std::size_t of = 0, acc = 0, str = 0;
    double nearest = 0;  // largest deviation over ACC
    double seconds = 0;
    bool slow = false, failed = false;
};

Count count(const std::vector<Test>& tests) {
    Count c;
    for (const Test& test : tests) {
        c.seconds += test.seconds;
        c.slow = c.slow || test.slow;
        c.failed = c.failed || test.failed;
        for (const Number& n : test.numbers) {
            ++c.of;
            c.acc += n.meets_acc();
            c.str += n.meets_str();
            if (!n.is_bound()) c.nearest = std::max(c.nearest, n.deviation / n.acc);
        }
    }
    return c;
}

std::string cases_csv(const Cases& cases, const std::string& made) {
    std::string csv = "# The tests of the reference cases (tests/VERIFICATION.md). Written by tools/verify, " + made +
                      ".\ncase,test,speed,processor time [s],numbers,meet ACC,meet STR,what it is\n";
    for (const auto& [name, tests] : cases)
        for (const Test& test : tests) {
            const Count c = count({test});
            csv += name.text() + ',' + field(test.name) + ',' + (test.slow ? "slow" : "quick") + ',' +
                   seconds(test.seconds) + ',' + std::to_string(c.of) + ',' + std::to_string(c.acc) + ',' +
                   std::to_string(c.str) + ',' + field(test.text) + '\n';
        }
    return csv;
}

std::string table(const Cases& cases, const std::string& made) {
    std::size_t n_acc = 0, n_str = 0;
    double quick = 0, slow = 0;
    std::string rows;
    for (const auto& [name, tests] : cases) {
        const Count c = count(tests);
        const std::string text = name.text();
        n_acc += c.acc == c.of;
        n_str += c.str == c.of;
        for (const Test& test : tests) (test.slow ? slow : quick) += test.seconds;
        rows += "| <a id=\"" + std::string(1, static_cast<char>(std::tolower(text[0]))) + text.substr(1) + "\"></a>" +
                text + " | " + tests.front().name + " | " + std::to_string(c.of) + " | " +
                (c.acc == c.of && !c.failed
                     ? text_of(c.nearest)
                     : "**" + std::to_string(c.of - c.acc) + " not met" + (c.failed ? ", fails" : "") + "**") +
                " | " + (c.str == c.of ? "all" : std::to_string(c.str)) + " | " + seconds(c.seconds) + " s" +
                (c.slow ? ", slow" : "") + " |\n";
    }
    char summary[200];
    std::snprintf(
        summary, sizeof summary,
        "%zu of %zu cases meet ACC in every number, %zu meet STR in every number. Processor time: quick tests "
        "%.0f s, slow ones %.0f s.",
        n_acc, cases.size(), n_str, quick, slow);
    return made + ": " + summary +
           "\n\n| case | | numbers | largest deviation over ACC | meet STR | processor time "
           "|\n|---|---|---|---|---|---|\n" +
           rows;
}

std::string text_of_file(const std::string& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

void write(const std::string& file, const std::string& text) {
    std::ofstream out(file);
    if (out << text && out.flush()) return;
    std::cerr << file << " cannot be written\n";
    std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fprintf(stderr, "usage: verification_report CASES.tsv FOLDER MADE\n");
        return 2;
    }
    const Cases cases = read(argv[1]);
    const std::string folder = argv[2], made = argv[3], page = folder + "/VERIFICATION.md", begin = "<!-- cases -->\n";
    std::string text = text_of_file(page);
    const std::size_t from = text.find(begin), to = text.find("<!-- end of cases -->");
    if (cases.empty() || from == std::string::npos || to == std::string::npos) {
        std::fprintf(stderr, "%s has no cases, or %s no place for their table\n", argv[1], page.c_str());
        return 1;
    }
    write(folder + "/verification/numbers.csv", numbers_csv(cases, made));
    write(folder + "/verification/cases.csv", cases_csv(cases, made));
    const std::size_t start = from + begin.size();
    write(page, text.replace(start, to - start, table(cases, made)));
    return 0;
}
