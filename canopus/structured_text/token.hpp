#pragma once
// The tokens of Structured Text [IEC 61131-3 6.1, 6.3].

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/program/program.hpp"

namespace canopus::structured_text {

using program::SourcePosition;

struct Token {
  enum class Kind : std::uint8_t {
    end,
    name,     ///< identifier, keyword, device: `text` in capitals
    integer,  ///< `number`
    real,
    string,         ///< '...'
    wide_string,    ///< "..."
    typed_literal,  ///< INT#5, T#1s, Color#red: `prefix` in capitals and `text` as written
    symbol,         ///< := + ( ...
    wrong           ///< no token; was reported
  };
  Kind kind = Kind::end;
  SourcePosition at{};
  std::string_view text{};  ///< of a name in capitals; of a string without quotes, still with its $ escapes
  std::string_view written{};  ///< as it stands in the source
  std::string_view prefix{};
  std::uint64_t number = 0;
  double real = 0;
  bool is_based = false;      ///< 16#FF: a bit pattern
  bool follows_blank = true;  ///< something is between it and the token before
};

/// A mistake in the source, for people.
struct SourceError {
  SourcePosition at{};
  std::string message{};
};

/// A source cut into tokens, the last of them `end`. The tokens refer to both texts, of which `capitals` is `source` in capitals.
[[nodiscard]] std::vector<Token> tokens_of(std::string_view source, std::string_view capitals,
                                           std::uint16_t file, std::vector<SourceError>& errors);

}  // namespace canopus::structured_text
