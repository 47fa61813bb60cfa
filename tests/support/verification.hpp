#pragma once
// Reference cases have one home, the test that runs them. A number is held against its reference by verify(), which makes the test fail beyond
// the tolerance ACC and, when a report is requested (KNAP_VERIFICATION names a folder), notes the number for tests/verification/numbers.csv.
// The case is the first word of the test's name: "B3 four openings and three impacts" is about B3.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace knap::tests {

/// ACC: what a correct program reaches. STR: what a good one does; a tenth of ACC where nothing else is given.
struct Tolerance {
    double acc;
    double str = std::numeric_limits<double>::quiet_NaN();
    double stretch() const { return std::isnan(str) ? 0.1 * acc : str; }
};

struct Verified {
    std::string path;  // bulk and cohesion that found it; empty where there is no choice
    std::string quantity;
    std::string found, reference;  // as text
    std::string kind;  // of the deviation: "relative", or "absolute" in the unit of the quantity; empty for a bound
    double deviation;
    double acc, str;  // largest deviations
};

/// What the running test has noted so far.
struct VerificationNotes {
    std::vector<std::string> texts;  // what the case is
    std::vector<Verified> numbers;
    std::vector<std::string> pictures;  // file names
    std::string path;
};

inline VerificationNotes& verification_notes() {
    static VerificationNotes notes;
    return notes;
}

/// Where the report gathers its parts, if one is requested.
inline std::optional<std::filesystem::path> verification_folder() {
    const char* folder = std::getenv("KNAP_VERIFICATION");
    return folder ? std::optional<std::filesystem::path>(folder) : std::nullopt;
}

/// A sentence or two for the report: the set-up and where its reference comes from.
inline void describe(const std::string& text) { verification_notes().texts.push_back(text); }

/// What follows was computed by these schemes of bulk and cohesion, e.g. "explicit, implicit".
inline void on_path(const std::string& path) { verification_notes().path = path; }

inline std::string digits(double value, int n = 9) {
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", n, value);
    return text;
}

namespace detail {
inline void note(const std::string& quantity, std::string found, std::string reference, const std::string& kind,
                 double deviation, double acc, double str) {
    VerificationNotes& notes = verification_notes();
    CHECK_MESSAGE(deviation <= acc, quantity, notes.path.empty() ? "" : " (" + notes.path + ")", ": ", found,
                  " against ", reference, ", off by ", deviation, " and may be by ", acc);
    notes.numbers.push_back({notes.path, quantity, std::move(found), std::move(reference), kind, deviation, acc, str});
}
}  // namespace detail

/// Relative to the reference.
inline void verify(const std::string& quantity, double found, double reference, const Tolerance& tolerance) {
    detail::note(quantity, digits(found), digits(reference), "relative", std::abs(found / reference - 1), tolerance.acc,
                 tolerance.stretch());
}

/// In the unit of the quantity.
inline void verify_near(const std::string& quantity, double found, double reference, const Tolerance& tolerance) {
    detail::note(quantity, digits(found), digits(reference), "absolute", std::abs(found - reference), tolerance.acc,
                 tolerance.stretch());
}

/// An error or a residual, 0 at best.
inline void verify_small(const std::string& quantity, double found, const Tolerance& tolerance) {
    detail::note(quantity, digits(found, 3), "0", "absolute", std::abs(found), tolerance.acc, tolerance.stretch());
}

/// A number that may have any value up to a bound.
inline void verify_at_most(const std::string& quantity, double found, double bound) {
    detail::note(quantity, digits(found), "at most " + digits(bound), "",
                 std::max(found - bound, found <= bound ? 0.0 : found), 0, 0);
}

inline void verify_at_least(const std::string& quantity, double found, double bound) {
    detail::note(quantity, digits(found), "at least " + digits(bound), "",
                 std::max(bound - found, found >= bound ? 0.0 : bound), 0, 0);
}

inline void verify_that(const std::string& what, bool is_so) {
    detail::note(what, is_so ? "yes" : "no", "yes", "", is_so ? 0 : 1, 0, 0);
}

/// Where to draw a picture of this case, if a report is requested.
inline std::optional<std::filesystem::path> picture(const std::string& name) {
    const auto folder = verification_folder();
    if (!folder) return std::nullopt;
    verification_notes().pictures.push_back(name);
    return *folder / name;
}

}  // namespace knap::tests
