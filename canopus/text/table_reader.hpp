#pragma once
// Reading one table of a plant file: every key is read by name, with the type it must have. A key that was
// never read is a mistake: a misspelt one must not pass in silence. Mistakes are collected with line and
// column.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/text/file_error.hpp"
#include "canopus/text/toml.hpp"

namespace canopus::text {

/// "a string", "the integer 128": what was found instead.
[[nodiscard]] inline std::string describe_found(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string: return fmt::format("\"{}\"", node.as_string()->get());
    case toml::node_type::integer: return fmt::format("{}", node.as_integer()->get());
    case toml::node_type::floating_point: return fmt::format("{}", node.as_floating_point()->get());
    case toml::node_type::boolean: return node.as_boolean()->get() ? "true" : "false";
    case toml::node_type::array: return "an array";
    case toml::node_type::table: return "a table";
    default: return "a date or time";
  }
}

class TableReader {
 public:
  TableReader(const toml::table& table, std::string what, std::vector<FileError>& errors)
      : table_(table), what_(std::move(what)), errors_(errors) {
    known_.reserve(usual_keys);
  }

  /// The table as TOML, a key a line, without comments.
  [[nodiscard]] std::string as_text() const {
    std::ostringstream text;
    text << toml::toml_formatter(table_);
    return text.str();
  }
  [[nodiscard]] Place place() const { return place_of(table_.source()); }
  [[nodiscard]] Place place(std::string_view key) const {
    const toml::node* node = table_.get(key);
    return node == nullptr ? place() : place_of(node->source());
  }
  void error(Place place, std::string message) { errors_.push_back({place, std::move(message)}); }
  void error(std::string_view key, std::string_view expected) {
    wrong_.emplace(key);
    const toml::node* node = table_.get(key);
    error(place(key), node == nullptr ? fmt::format("{}: {} is missing; {}", what_, key, expected)
                                      : fmt::format("{} = {}: {}", key, describe_found(*node), expected));
  }

  const toml::node* find(std::string_view key) {
    if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
    return table_.get(key);
  }
  std::optional<std::string> text(std::string_view key, bool required = false) {
    const toml::node* node = find(key);
    if (node == nullptr) {
      if (required) error(key, "expected a string");
      return std::nullopt;
    }
    if (const auto* value = node->as_string(); value != nullptr && !(required && value->get().empty())) {
      return value->get();
    }
    error(key, required ? "expected a string that is not empty" : "expected a string");
    return std::nullopt;
  }
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t low, std::int64_t high,
                                      std::string_view expected, bool required = false) {
    const toml::node* node = find(key);
    if (node == nullptr) {
      if (required) error(key, expected);
      return std::nullopt;
    }
    const auto* value = node->as_integer();
    if (value == nullptr || value->get() < low || value->get() > high) {
      error(key, expected);
      return std::nullopt;
    }
    return value->get();
  }
  std::optional<double> number(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    if (const auto value = node->value<double>(); value && !node->is_boolean() && std::isfinite(*value)) {
      return *value;
    }
    error(key, "expected a number");
    return std::nullopt;
  }
  std::optional<bool> boolean(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    if (const auto* value = node->as_boolean()) return value->get();
    error(key, "expected true or false");
    return std::nullopt;
  }
  /// A string that `parse` understands.
  template <typename Parse>
  auto parsed(std::string_view key, Parse parse, bool required = false)
      -> std::optional<typename decltype(parse(std::string_view{}))::value_type> {
    const auto value = text(key, required);
    if (!value) return std::nullopt;
    auto result = parse(*value);
    if (!result) {
      wrong_.emplace(key);
      error(place(key), fmt::format("{} = {}", key, result.error()));
      return std::nullopt;
    }
    return *result;
  }
  /// The one table of this name ([key]), if it is there.
  void table(std::string_view key, std::string what, std::string_view expected,
             const std::function<void(TableReader&)>& read) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto* table = node->as_table();
    if (table == nullptr) return error(key, expected);
    TableReader reader(*table, std::move(what), errors_);
    read(reader);
    reader.finish();
  }
  /// Every table of an array of tables ([[key]]).
  void tables(std::string_view key, const std::string& what, const std::function<void(TableReader&)>& read) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto* array = node->as_array();
    if (array == nullptr) return error(key, fmt::format("expected tables, written as [[{}]]", what));
    for (const toml::node& element : *array) {
      const auto* table = element.as_table();
      if (table == nullptr) {
        error(place_of(element.source()),
              fmt::format("{}: found {}, expected a table", key, describe_found(element)));
        continue;
      }
      TableReader reader(*table, what, errors_);
      read(reader);
      reader.finish();
    }
  }
  /// Every element of an array, or the single value in place of an array.
  void elements(std::string_view key, const std::function<void(const toml::node&)>& read) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    if (const auto* array = node->as_array()) {
      for (const toml::node& element : *array) read(element);
    } else {
      read(*node);
    }
  }
  /// Every key and value of a table with arbitrary keys.
  void entries(std::string_view key,
               const std::function<void(std::string_view, const toml::node&, Place)>& read,
               std::string_view example = "{ \"1017:00\" = 1000 }") {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto* table = node->as_table();
    if (table == nullptr) return error(key, fmt::format("expected a table, for example {}", example));
    for (const auto& [name, value] : *table) read(name.str(), value, place_of(name.source()));
  }
  /// Reports every key that was never read.
  void finish() {
    for (const auto& [key, value] : table_) {
      if (std::ranges::find(known_, key.str()) != known_.end()) continue;
      std::ranges::sort(known_);
      error(place_of(key.source()),
            fmt::format("{}: unknown key {}; expected one of {}", what_, key.str(), fmt::join(known_, ", ")));
    }
  }
  /// A mistake was found in the value of this key, or it is missing.
  [[nodiscard]] bool is_wrong(std::string_view key) const { return wrong_.contains(key); }
  std::vector<FileError>& errors() { return errors_; }

 private:
  static constexpr std::size_t usual_keys = 24;

  const toml::table& table_;
  std::string what_;
  std::vector<FileError>& errors_;
  std::vector<std::string> known_;  // not many
  std::set<std::string, std::less<>> wrong_;
};

}  // namespace canopus::text
