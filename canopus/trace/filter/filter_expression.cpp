#include "canopus/trace/filter/filter_expression.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::trace {

namespace {

constexpr std::array<std::string_view, 8> filter_keys{"node",  "service", "object", "id",
                                                      "abort", "bus",     "from",   "to"};
constexpr FilterNames term_names{.node = "node=",
                                 .service = "service=",
                                 .object = "object=",
                                 .identifier = "id=",
                                 .abort = "abort=",
                                 .from = "from: ",
                                 .to = "to: "};

std::vector<std::string> split_values(std::string_view text) {
  std::vector<std::string> values;
  while (true) {
    const std::size_t comma = text.find(',');
    values.emplace_back(text.substr(0, comma));
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

bool is_in_errors(const Message& message) {
  using enum Service;
  return message.is_malformed || message.service == error_frame || message.service == emcy ||
         message.abort_code.has_value() || (message.is_transfer && message.end != TransferEnd::done);
}

}  // namespace

std::expected<FilterExpression::Term, std::string> FilterExpression::parse_term(std::string_view text,
                                                                                bool is_quoted) {
  Term term;
  if (!is_quoted && text == "errors") {
    term.is_of_errors = true;
    return term;
  }
  const std::size_t equals = is_quoted ? std::string_view::npos : text.find('=');
  if (equals == std::string_view::npos) {
    term.text = ascii::lower(text);
    return term;
  }
  const std::string_view key = text.substr(0, equals);
  const auto shown = [&] { return text::printable(text); };
  if (std::ranges::find(filter_keys, key) == filter_keys.end()) {
    return std::unexpected(fmt::format(
        "{}: expected node, service, object, id, abort, bus, from or to before the \"=\"{}; text stands in "
        "\"quotes\"",
        shown(),
        text::suggestion(std::string(key),
                         std::vector<std::string_view>(filter_keys.begin(), filter_keys.end()))));
  }
  auto values = split_values(text.substr(equals + 1));
  if (std::ranges::any_of(values, &std::string::empty)) {
    return std::unexpected(fmt::format("{}: expected a value behind the \"=\" and each comma", shown()));
  }
  if (key == "bus") {
    term.buses = std::move(values);
    return term;
  }
  FilterOptions options;
  if (key == "from" || key == "to") {
    if (values.size() != 1) return std::unexpected(fmt::format("{}: expected one time", shown()));
    (key == "from" ? options.from : options.to) = values.front();
  } else {
    auto& list = key == "node"      ? options.nodes
                 : key == "service" ? options.services
                 : key == "object"  ? options.objects
                 : key == "abort"   ? options.aborts
                                    : options.identifiers;
    list = std::move(values);
  }
  auto filter = MessageFilter::read(options, term_names);
  if (!filter) return std::unexpected(text::printable(filter.error()));
  term.filter = std::move(*filter);
  return term;
}

std::expected<FilterExpression, std::string> FilterExpression::parse(std::string_view text) {
  if (text.size() > longest) {
    return std::unexpected(fmt::format("the filter has {} bytes; expected at most {}", text.size(), longest));
  }
  FilterExpression expression;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    if (text.empty()) return expression;
    const bool is_not = text.front() == '!';
    if (is_not) text.remove_prefix(1);
    const bool is_quoted = text.starts_with('"');
    if (is_quoted) text.remove_prefix(1);
    const std::size_t end = text.find_first_of(is_quoted ? "\"" : " \t");
    if (is_quoted && end == std::string_view::npos) {
      return std::unexpected(fmt::format("\"{}: expected a second quote", text::printable(text)));
    }
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(word.size() + (is_quoted ? 1 : 0), text.size()));
    if (word.empty())
      return std::unexpected(is_not ? "!: expected a term behind it" : "\"\": expected a text");
    auto term = parse_term(word, is_quoted);
    if (!term) return std::unexpected(term.error());
    term->is_not = is_not;
    expression.terms_.push_back(std::move(*term));
  }
}

std::optional<FilterExpression> FilterExpression::make(const FilterOptions& options, text::Output& err) {
  auto expression = parse(options.expression);
  if (expression) return std::move(*expression);
  err.line("canopus: --filter: {}", expression.error());
  return std::nullopt;
}

bool FilterExpression::is_of(const Term& term, const Message& message, std::string_view bus,
                             can::Duration since) {
  if (term.is_of_errors) return is_in_errors(message);
  if (!term.buses.empty()) return std::ranges::find(term.buses, bus) != term.buses.end();
  return term.filter.wants(message, since);
}

bool FilterExpression::has(std::string_view line, std::string_view text) {
  return ascii::contains_ignoring_case(line, text);
}

}  // namespace canopus::trace
