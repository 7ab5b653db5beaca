#pragma once
// The head line of a trace that is a table: which column is what.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::trace {

enum class CsvColumn : std::uint8_t {
  time,
  channel,
  direction,
  identifier,
  extended,
  remote,
  error,
  fd,
  dlc,
  data,  ///< of all bytes, or of one of them
  other,
};
inline constexpr std::size_t csv_columns = static_cast<std::size_t>(CsvColumn::other) + 1;

struct CsvHead {
  std::vector<CsvColumn> columns{};
  char separator = ',';
  std::int64_t time_unit = 1'000'000'000;  ///< ns
  int identifier_base = 16;
  bool is_base64 = false;         ///< data of python-can
  bool is_gvret = false;          ///< of SavvyCAN and GVRET: times in us, buses by number
  bool has_byte_columns = false;  ///< D1, D2 ...

  [[nodiscard]] bool has(CsvColumn column) const noexcept;
  /// "seconds", "ms", "us" or "ns".
  [[nodiscard]] std::string_view time_unit_name() const noexcept;
};

/// Nothing if the line names no identifier and no data, or has more than 96 columns.
[[nodiscard]] std::optional<CsvHead> parse_csv_head(std::string_view line);
/// Takes the first field off the row; quotation marks around it are gone, doubled ones inside single.
[[nodiscard]] std::string take_csv_field(std::string_view& row, char separator);

}  // namespace canopus::trace
