#pragma once
// Fields of an untrusted server's JSON: a field that is missing or of another type is empty.

#include <string>

#include "canopus/text/json.hpp"

namespace canopus::cli {

/// The text of a field, or its value as text; empty where there is none, or null.
[[nodiscard]] std::string field_text(const text::Json& object, const char* key);
/// The field where it is an array, else an empty one.
[[nodiscard]] const text::Json& field_list(const text::Json& object, const char* key);

}  // namespace canopus::cli
