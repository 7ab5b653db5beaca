#pragma once
// The filter expression that a user types: "service=sdo,pdo node=3 !object=6000 position".

#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/trace/filter/message_filter.hpp"

namespace canopus::trace {

class FilterExpression {
 public:
  static constexpr std::size_t longest = 1000;  ///< bytes

  /// Terms separated by blanks must all hold. A term is KEY=VALUE or KEY=VALUE,VALUE (one of them) with the
  /// keys node, service, object, id, bus, from and to, which take what the options of `canopus trace show`
  /// take, and abort (an abort code of SDO in hexadecimal digits); `errors`: malformed messages, error frames, emergencies and SDO transfers that did not succeed; or anything else, in
  /// "quotes" with blanks: text of the line, in upper or lower case. `!` before a term negates it. The error
  /// is a sentence that begins with the term.
  [[nodiscard]] static std::expected<FilterExpression, std::string> parse(std::string_view text);

  /// `since`: from the beginning of the trace on. `line`: gives the text of the line; called only for a term
  /// with a text.
  template <typename Line>
  [[nodiscard]] bool wants(const Message& message, std::string_view bus, can::Duration since,
                           const Line& line) const {
    for (const Term& term : terms_) {
      const bool holds = term.text.empty() ? is_of(term, message, bus, since) : has(line(), term.text);
      if (holds == term.is_not) return false;
    }
    return true;
  }
  /// The same from the options; nothing after a mistake was printed on `err`.
  [[nodiscard]] static std::optional<FilterExpression> make(const FilterOptions& options, text::Output& err);
  [[nodiscard]] bool wants_all() const noexcept { return terms_.empty(); }

 private:
  struct Term {
    bool is_not = false;
    bool is_of_errors = false;
    std::string text{};  ///< lower case
    std::vector<std::string> buses{};
    MessageFilter filter{};
  };
  [[nodiscard]] static bool is_of(const Term& term, const Message& message, std::string_view bus,
                                  can::Duration since);
  /// Whether the line has this text, of lower case.
  [[nodiscard]] static bool has(std::string_view line, std::string_view text);
  [[nodiscard]] static std::expected<Term, std::string> parse_term(std::string_view text, bool is_quoted);

  std::vector<Term> terms_;
};

}  // namespace canopus::trace
