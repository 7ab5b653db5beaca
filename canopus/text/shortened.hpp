#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace canopus::text {

/// Shortens an external text: one of more than `most` bytes is cut between two characters of UTF-8, with a
/// mark: "abc... (cut, 2000000 bytes in all)".
[[nodiscard]] std::string shortened(std::string_view text, std::size_t most);

}  // namespace canopus::text
