#pragma once
#include <string>

namespace knap {

/// Every key of a scenario, for people.
std::string schema_text();

/// The same as JSON Schema (draft 2020-12), for editors.
std::string json_schema();

/// The same as a Markdown table.
std::string schema_markdown();

}  // namespace knap
