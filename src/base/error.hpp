#pragma once
// The three kinds of failure. A user's mistake throws UserError (exit 2); a run that cannot continue throws
// SimulationError (exit 3); a bug is an assert. Nothing calls exit.
#include <stdexcept>
#include <string>
#include <vector>

namespace knap {

/// One message about the user's input, with its place.
struct Diagnostic {
    enum class Severity { error, warning };
    Severity severity = Severity::error;
    std::string code;          // short and stable, e.g. "unknown-key"
    std::string message;       // one line: what is wrong
    std::string file;          // empty when the message is about no file
    int line = 0, column = 0;  // from 1; 0 = unknown
    int length = 0;            // characters underlined in the source line
    std::string source_line;   // the text of that line
    std::string hint;          // shown under the marks: "did you mean `sigma_c`?"
    std::string note;          // what is allowed
};

/// The message as text: `error[code]: message`, place, source line, marks, note.
std::string format(const Diagnostic& diagnostic);

/// All mistakes in the user's input together.
class UserError : public std::runtime_error {
public:
    explicit UserError(std::vector<Diagnostic> found);
    explicit UserError(const std::string& code, const std::string& message, const std::string& note = {});
    std::vector<Diagnostic> diagnostics;
};

/// A run that cannot continue: what happened, where and when, and what to change.
class SimulationError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Writing fails, as on a full disk: the run itself is sound and can continue from its last checkpoint.
class OutputError : public SimulationError {
public:
    using SimulationError::SimulationError;
};

}  // namespace knap
