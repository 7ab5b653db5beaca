#pragma once
// The standard functions by name [IEC 61131-3 6.6.2.5].

#include <string_view>

namespace canopus::structured_text {

/// Including conversions: INT_TO_REAL, TO_STRING.
[[nodiscard]] bool is_standard_function(std::string_view name);

/// SPLIT_DATE, SPLIT_TOD, SPLIT_DT: their calls are statements.
[[nodiscard]] bool is_split(std::string_view name);

}  // namespace canopus::structured_text
