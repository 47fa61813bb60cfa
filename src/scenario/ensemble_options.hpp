#pragma once
// [study] and [sweep]: which runs of a scenario are made, and by which numbers they are compared. SI throughout.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace knap {

/// The quantity that a level of a study divides: the step, the sizes of the mesh, or both.
enum class Refine { step, mesh, both };

/// A number that is compared between runs.
struct StudyQuantity {
    std::string name;  // title of its table and figures
    std::string of;    // a number of the summary; a column of a history if from_history() or if there is no such number
    std::optional<double> at;                    // [s] the value of the column at this time
    std::optional<double> reaches;               // the time [s] at which the column first reaches this value
    std::string since;                           // with `reaches`: the time since this column reached the value
    bool largest = false;                        // the largest value of the column
    std::optional<std::array<double, 2>> slope;  // [s] the mean slope of the column between two times
    std::optional<double> exact;                 // the exact value
    std::optional<double> scale;                 // unit of errors; none: the reference value
    std::string unit;                            // of the number itself; "" for none

    bool from_history() const { return at || reaches || largest || slope; }
};

/// A line of the diagram: a scheme, or any other variant of the scenario.
struct StudyLine {
    std::string name;              // empty: named by its scheme
    std::vector<std::string> set;  // KEY=VALUE
    std::vector<double> levels;
};

/// A search for the factor of safety: the largest F at which the body stands although c and tan phi of some laws are
/// divided by it.
struct SafetyOptions {
    enum class Criterion { rest, runaway };
    std::vector<std::string> laws;        // names; empty: all that may break or slide
    std::array<double, 2> factors{1, 3};  // [-] between which F is searched
    double tolerance = 0.005;             // [-] of the last bracket, over F
    Criterion criterion = Criterion::rest;
    double runaway = 0;  // [m] displacement from which on the body does not stand; 0: of its size
};

struct StudyOptions {
    Refine refine = Refine::step;
    int n_seeds = 0;               // 0: one run per level; otherwise statistics over this many
    bool against_finest = false;   // errors from the finest run even if an exact or expected value is known
    std::vector<std::string> set;  // KEY=VALUE, in all runs
    std::vector<StudyLine> lines;  // at least one
    std::vector<StudyQuantity> quantities;
    SafetyOptions safety;
};

/// A key that every member of a sweep draws anew, from one distribution.
struct RandomKey {
    std::string key;  // of a number, such as "body.boulder.velocity.x"
    enum class Distribution { uniform, normal, lognormal, choice } distribution = Distribution::uniform;
    std::array<double, 2> of{};  // its ends, or its mean and standard deviation; in the unit of the key
    std::optional<std::array<double, 2>> within;  // values outside are drawn again
    std::vector<std::string> choices;             // as after KEY=
    bool whole = false;                           // whole numbers
    std::string unit;                             // of the key
    std::string stream = {};  // of random numbers; keys of one stream draw the same place in their choices; "": its own

    /// The value of a member as after KEY=. It depends on seed, stream and member only, not on others.
    std::string drawn(std::uint64_t seed, int member) const;
};

struct RandomMembers {
    int n = 0;  // 0: none
    std::uint64_t seed = 1;
    std::vector<RandomKey> keys;
};

struct SweepOptions {
    std::vector<std::string> set;         // KEY=VALUE,VALUE,...
    int n_seeds = 0;                      // 0: the seed of the scenario
    std::vector<std::string> quantities;  // numbers of the summary that the table shows
    std::string show = "cracks";          // subject of the contact sheet; empty: none is drawn
    RandomMembers random;                 // members of every combination
};

}  // namespace knap
