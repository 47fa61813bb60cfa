#pragma once
// Reads a scenario. Throws UserError with every mistake at once.
#include "scenario/built_in.hpp"
#include "scenario/findings.hpp"
#include "scenario/scenario.hpp"
#include "scenario/values.hpp"

#include <filesystem>

namespace knap {

struct ReadResult {
    Scenario scenario;
    std::vector<Diagnostic> warnings;
    Values values;  // every key with its value and origin
    Source source;  // the text of the file

    /// A message with the place (file, line, column, source line) of a key, or of the nearest table above it; or, of
    /// "traces[0] (line 12)", in the file of the traces.
    Diagnostic at(const std::string& key_path, Diagnostic message) const;
    /// A message about a line of the file that a key names; 0: about all of it.
    Diagnostic in_file(const std::string& key_path, int line, Diagnostic message) const;
    /// Errors of the mesher about parts of the shape, at the keys of these parts.
    std::vector<Diagnostic> at_shapes(const ShapeError& error) const;
};

/// `overrides` are KEY=VALUE, as in mesh.size="0.25 mm" or mesh.size=0.25 mm.
ReadResult read_scenario(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text. `name` replaces the file name in messages; files named in the scenario are relative to
/// `directory`.
ReadResult read_scenario_text(const std::string& text, const std::string& name,
                              const std::vector<std::string>& overrides = {},
                              const std::filesystem::path& directory = {});

/// A file or, if there is none of that name, a built-in scenario.
ReadResult open_scenario(const std::string& file_or_name, const std::vector<std::string>& overrides = {});

/// Names of the built-in scenarios, and one of them by its name or the beginning of it (throws UserError).
std::vector<std::string> built_in_scenarios();
const BuiltIn& built_in_scenario(const std::string& name);

}  // namespace knap
