#pragma once
// The keys of the live table.

#include <cstdint>
#include <string_view>
#include <vector>

#include "canopus/cli/run/table_layout.hpp"

namespace canopus::cli {

enum class TableKey : std::uint8_t { up, down, page_up, page_down, home, end, help, quit };

/// The keys in one input of a terminal; other sequences are skipped.
[[nodiscard]] std::vector<TableKey> keys_in(std::string_view bytes);

/// The view after the key; `view` and `shown`: before it. `quit` changes nothing.
[[nodiscard]] TableView after_key(TableView view, TableKey key, const TablePicture& shown);

}  // namespace canopus::cli
