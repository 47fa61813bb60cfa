#pragma once
// Reads a scenario. Throws UserError with every mistake at once.
#include "scenario/findings.hpp"
#include "scenario/scenario.hpp"
#include "scenario/values.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

struct ReadResult {
    Scenario scenario;
    std::vector<Diagnostic> warnings;
    Values values;  // every key with its value and origin
    Source source;  // the text as it was read
};

/// `overrides` are KEY=VALUE, as in mesh.size="0.25 mm" or mesh.size=0.25 mm.
ReadResult read_scenario(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text. `name` stands for the file in messages; file names in the scenario are relative to `directory`.
ReadResult read_scenario_text(const std::string& text, const std::string& name,
                              const std::vector<std::string>& overrides = {},
                              const std::filesystem::path& directory = {});

/// A file, or where there is no such file a built-in scenario of that name.
ReadResult open_scenario(const std::string& file_or_name, const std::vector<std::string>& overrides = {});

/// Names of the built-in scenarios, and the text of one (throws UserError for an unknown name).
std::vector<std::string> built_in_scenarios();
const std::string& built_in_scenario(const std::string& name);

/// A message's place: file, line, column, source line of a key, or of the nearest table above it. Severity, code and
/// message are left to the caller.
Diagnostic locate(const ReadResult& result, const std::string& key_path);

/// An error that was found later, at the place of a key.
UserError located(const ReadResult& result, const std::string& key_path, const UserError& error);

/// What geometry says about a shape, as an error about the scenario.
Diagnostic locate(const ReadResult& result, const ShapeError& error);

}  // namespace knap
