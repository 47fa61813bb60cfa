#pragma once
// [study]: which runs of a scenario are compared, and by which numbers. SI throughout.
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace knap {

/// What a level divides: the step, the sizes of the mesh, or both.
enum class Refine { step, mesh, both };

/// A number that a run comes down to.
struct StudyQuantity {
    std::string name;                // for people
    std::string of;                  // of the summary; with one of the next, and otherwise if the summary has none, a column of a history
    std::optional<double> at;        // [s] its value then
    std::optional<double> reaches;   // the time [s] when it first reaches this
    std::string since;               // with `reaches`: a column too; the time since this one reached the same
    bool largest = false;            // its largest value
    std::optional<std::array<double, 2>> slope;  // [s] its mean slope between two times
    std::optional<double> exact;     // what it should be
    std::optional<double> scale;     // errors are parts of this; else of the reference, if that is not 0
    std::string unit;                // of the number itself; "" for none

    bool from_history() const { return at || reaches || largest || slope; }
};

/// A line of the diagram: a scheme, or any other variant of the scenario.
struct StudyLine {
    std::string name;              // empty: named by its scheme
    std::vector<std::string> set;  // KEY=VALUE
    std::vector<double> levels;
};

struct StudyOptions {
    Refine refine = Refine::step;
    int n_seeds = 0;  // 0: one run a level; else statistics over this many
    bool against_finest = false;   // also where an exact or an expected value is known
    std::vector<std::string> set;  // KEY=VALUE, in all runs
    std::vector<StudyLine> lines;  // one at least
    std::vector<StudyQuantity> quantities;
};

}  // namespace knap
