#pragma once
// The errors of a module in the words of its manual: those that its words and registers show now, and what it keeps of past ones. For
// display: no access of the program, nothing on the bus.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/interface/error_words.hpp"

namespace canopus::plant {

struct CatalogueEntry;

struct ErrorLine {
  std::string where;              ///< "G29 bit 3", "node 5"
  std::string code;               ///< "8130H"; empty: it is a bit
  std::string meaning;            ///< of the manual
  std::optional<can::Time> at{};  ///< when, where the module keeps that
};

struct ErrorGroup {
  std::string_view
      title;  ///< "errors now", "event history", "emergencies received", "emergencies sent (1003H)"
  std::vector<ErrorLine> lines;  ///< the newest first; errors of words by address
};

/// Words of a module that is reached in some way: the value of one of `tables`.
using ErrorWordReader = std::function<std::uint16_t(std::uint32_t address)>;

/// Decodes the present words. `function_mode`: as selected, 405, 417, 11 or 29; words of other modes are not
/// read. A code without a text is shown, too.
[[nodiscard]] std::vector<ErrorLine> errors_in_words(const module::ErrorTables& tables,
                                                     std::uint16_t function_mode,
                                                     const ErrorWordReader& read);

/// "life guard error or heartbeat error", of a module's own codes by its manual.
[[nodiscard]] std::string emergency_meaning(const module::ErrorTables& tables, std::uint16_t code);

/// The error history of a module of this plant that is on; groups without a line are left out.
[[nodiscard]] std::vector<ErrorGroup> error_history(const CatalogueEntry& entry,
                                                    module::CommunicationModule& module, can::Time now);

}  // namespace canopus::plant
