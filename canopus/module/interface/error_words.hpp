#pragma once
// Meaning of the words and registers of a module that show errors, as its manual explains it: facts of a model, in its folder.
// plant/catalogue/error_history.hpp makes sentences of them.

#include <cstdint>
#include <span>
#include <string_view>

#include "canopus/module/interface/module_types.hpp"

namespace canopus::module {

/// Of a code, or of a bit by its number.
struct ErrorText {
  std::uint16_t code = 0;
  std::string_view meaning{};
};

struct ErrorWords {
  enum class Kind : std::uint8_t {
    bits,        ///< a bit that is 1 is an error
    codes,       ///< a code other than 0 is one
    address,     ///< other than 0: the word that was written to
    node_bits,   ///< bits, a word for each node from 1 on
    node_pairs,  ///< bits 0-7 of an odd node, the same in bits 8-15 of the next one
    command,     ///< result of the last command, an error if it has a text; its class in the next word
  };
  enum class When : std::uint8_t { always, canopen, layer2 };  ///< function modes
  Kind kind{};
  BufferAddress first = 0;
  BufferAddress last = 0;
  std::string_view
      name{};  ///< "Error status"; of codes that are one of many "node", "message slot", the first is 1
  std::span<const ErrorText> texts{};
  std::span<const ErrorText> classes{};  ///< of a command
  When when = When::always;
};

struct ErrorTables {
  std::string_view prefix{};  ///< what stands before an address: "G", "BFM #", "SR"
  std::span<const ErrorWords> words{};
  /// Emergency error codes that the manual has beyond CiA 301; code + node-ID for 8F00H.
  std::span<const ErrorText> emergencies{};
};

}  // namespace canopus::module
