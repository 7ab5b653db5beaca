#pragma once
// What a PLC program needs of a module: which signals or bits request what, and where the process data
// lie. Facts of a model, in its folder.

#include <cstddef>
#include <cstdint>
#include <optional>

#include "canopus/module/interface/module_types.hpp"

namespace canopus::module {

/// A request of the program, and where the answer is.
struct ProgramRequest {
  enum class Kind : std::uint8_t {
    none,    ///< the module has no such request
    signal,  ///< Yn ON; Xn is ON when it is done, and OFF once Yn is
    bits,    ///< the bits are written as 1; the module takes them back to 0 when it is done
    write,   ///< the bits are written as 1 and that is all: read, they mean something else [FX2N-32CAN 4.2.2]
  };
  Kind kind = Kind::none;
  unsigned signal = 0;
  BufferAddress word = 0;
  std::uint16_t bits = 0;
};

/// How many network variables of a size an index of the object dictionary has [CiA 405; FX3U-CAN 5.9].
struct VariablesPerIndex {
  std::uint8_t of_8_bits = 254;
  std::uint8_t of_16_bits = 254;
  std::uint8_t of_32_bits = 254;

  [[nodiscard]] constexpr std::size_t of_bytes(std::size_t bytes) const noexcept {
    return bytes == 1 ? of_8_bits : bytes == 2 ? of_16_bits : of_32_bits;
  }
};

/// Where the process data lie in the buffer memory, and how much of them there is.
struct DataExchangeLayout {
  BufferAddress receive_first = 0;   ///< RPDO data
  BufferAddress transmit_first = 0;  ///< TPDO data
  std::size_t words = 0;             ///< each way
  std::uint16_t pdos = 0;            ///< RPDOs, and TPDOs
  VariablesPerIndex variables{};     ///< that show them in the object dictionary
  /// So many of the words lie there; the rest of both ways begins at `rest_first` [FX2N-32CAN 4.1, 4.3]. 0: all lie there.
  std::size_t first_part = 0;
  BufferAddress rest_first = 0;
  /// Every network variable shows the words; else those that a PDO maps [FX2N-32CAN 5.1, 5.2].
  bool all_variables = false;

  /// Address of word `word` of the way that begins at `first`.
  [[nodiscard]] constexpr BufferAddress address(BufferAddress first, std::size_t word) const noexcept {
    const bool is_rest = first_part != 0 && word >= first_part;
    return static_cast<BufferAddress>(is_rest ? rest_first + (word - first_part) : first + word);
  }
  /// The word that lies at `at`, if one does.
  [[nodiscard]] constexpr std::optional<std::size_t> word(BufferAddress first,
                                                          BufferAddress at) const noexcept {
    const std::size_t run = first_part == 0 ? words : first_part;
    if (at >= first && at - first < run) return at - first;
    if (first_part != 0 && at >= rest_first && at - rest_first < words - run) return at - rest_first + run;
    return std::nullopt;
  }
};

/// SDO write to the module's own object dictionary by its command interface: code, node (0 = own), index,
/// sub-index, length in bytes and data into the words from `first` on, then `execute`; the code's word reads
/// FFFFH while a command runs, then `success`.
struct ProgramCommand {
  BufferAddress first = 0;
  std::uint16_t sdo_write = 0;  ///< code; 0: the module has no command interface
  std::uint16_t success = 0;
  ProgramRequest execute{};
};

struct ProgramInterface {
  /// Data exchange.
  ProgramRequest exchange{};
  /// Layer 2 online: as long as the signal, or the bits, are 1. The word's other bits are requests of their
  /// own, written as 0.
  ProgramRequest online{};
  /// X signal that is ON while the module can be worked with; modules without signals have none.
  std::optional<unsigned> ready{};
  /// The bits of this word are 1 while the module initializes and takes no words; no bits: nothing shows it.
  BufferAddress status = 0;
  std::uint16_t initializing = 0;
  /// The bits are 0 then, instead [FX2N-32CAN 4.2.4].
  bool initializing_is_0 = false;
  DataExchangeLayout process_data{};
  ProgramCommand command{};
  /// Word of the node-ID.
  BufferAddress node_address = 0;
};

}  // namespace canopus::module
