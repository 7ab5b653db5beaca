#pragma once
// Text from outside (device files, plant files, other programs, the system) made fit to be printed: what
// would control the terminal or forge a line is shown as an escape, everything else stays as it is.

#include <cstddef>
#include <string>
#include <string_view>

namespace canopus::text {

/// The text with these written as escapes: C0 and DEL (`\x1B`, line feed and tabulator as `\n` and `\t`), C1
/// (`\u009B`), line and paragraph separator, the controls of bidirectional text (`\u202E`), and every octet
/// that is no UTF-8 (`\xE4`). A backslash stays a backslash.
[[nodiscard]] std::string printable(std::string_view text);

/// A JSON text with C1, DEL, the separators and the controls of bidirectional text as `\u....`: the same
/// value for a program, without control sequences for a terminal.
[[nodiscard]] std::string printable_json(std::string_view json);

/// The number of terminal columns of printable text: two for wide characters, none for combining ones.
[[nodiscard]] std::size_t columns_of(std::string_view printable_text);
/// The longest beginning of printable text that fits into this number of columns.
[[nodiscard]] std::string_view clipped(std::string_view printable_text, std::size_t columns);

}  // namespace canopus::text
