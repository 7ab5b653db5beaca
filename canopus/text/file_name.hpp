#pragma once
// Names that people give to things, as names of files.

#include <string>
#include <string_view>

namespace canopus::text {

/// The name as part of a file's name: letters, digits, '-' and '_' stay, every other octet becomes "%2F" as in
/// a URL. So two names never become one, and none leads out of a folder. Longer ones than 80 characters are
/// cut, and end with a checksum of the whole.
[[nodiscard]] std::string file_name_of(std::string_view name);

}  // namespace canopus::text
