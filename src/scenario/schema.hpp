#pragma once
#include <string>

namespace knap {

/// Every key of a scenario, for people.
std::string schema_text();

/// The same as JSON Schema (draft 2020-12), for editors.
std::string json_schema();

/// The same as Markdown (scenarios/KEYS.md): for each block a heading with an anchor, an example and a table of keys.
std::string schema_markdown();

}  // namespace knap
