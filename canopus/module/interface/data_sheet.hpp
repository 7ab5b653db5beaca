#pragma once
// What a module's manual says of it and no buffer memory word shows: identity in product lists, what it may
// be plugged into, connector, cable, standards. For display; the physical part changes nothing in the soft
// module.

#include <cstdint>
#include <span>
#include <string_view>

namespace canopus::module {

struct ConnectorPin {
  unsigned number = 0;
  std::string_view signal{};  ///< empty: reserved, not to be connected
  std::string_view meaning{};
};

struct BusLength {
  unsigned kbps = 0;
  unsigned metres = 0;  ///< longest bus at this rate; 0: the manual does not say
};

/// A standard the manual claims.
struct Standard {
  std::string_view name{};
  std::string_view version{};
  std::string_view about{};
};

struct FunctionMode {
  std::string_view value{};  ///< as selected
  std::string_view name{};
};

/// How many of the module a CPU, or remote head module, takes.
struct ModulesPerCpu {
  std::string_view kind{};
  std::string_view models{};
  unsigned modules = 0;  ///< 0: not applicable
};

struct Property {
  std::string_view name{};
  std::string_view value{};
};

struct DataSheet {
  std::string_view model{};
  std::string_view maker{};
  std::string_view manual{};
  std::string_view type{};    ///< in product lists: "Intelli."
  std::string_view series{};  ///< "Q"
  std::string_view serial_number{};
  std::string_view function_version{};
  unsigned points = 0;  ///< occupied I/O points
  std::string_view io_assignment{};
  std::string_view word_prefix = "G";  ///< what stands before the address of a word
  bool online_module_change = false;
  std::string_view multiple_cpu{};
  std::uint32_t flash_writes = 0;  ///< tolerated; 0: the manual does not say
  std::string_view connector{};
  std::span<const FunctionMode> modes{};
  std::span<const Standard> standards{};
  std::span<const ConnectorPin> pins{};
  std::span<const BusLength> bus_lengths{};
  std::span<const ModulesPerCpu> modules_per_cpu{};
  std::span<const Property> properties{};  ///< the rest: cable, supply, weight ...
};

/// One line of a CPU's product list.
struct ProductInformation {
  std::string_view type{};
  std::string_view series{};
  std::string_view model{};
  unsigned points = 0;
  std::string_view serial_number{};
  std::string_view version{};
};

}  // namespace canopus::module
