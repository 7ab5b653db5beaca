#pragma once
// Fields of a stranger's JSON: a field that is missing or of another type is empty, and so are all fields of what is no object.

#include <string>
#include <string_view>

#include "canopus/text/json.hpp"

namespace canopus::text {

/// The field; null where there is none.
[[nodiscard]] const Json& field(const Json& object, std::string_view key);
/// The text of a field, or its value as text; empty where there is none, or null.
[[nodiscard]] std::string field_text(const Json& object, std::string_view key);
/// The field where it is a number, else 0.
[[nodiscard]] double field_number(const Json& object, std::string_view key);
/// The field where it is an array, else an empty one.
[[nodiscard]] const Json& field_list(const Json& object, std::string_view key);

}  // namespace canopus::text
