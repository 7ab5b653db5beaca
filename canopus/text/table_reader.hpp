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
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/text/file_error.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/text/table_schema.hpp"
#include "canopus/text/text_values.hpp"
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

/// What a key expects whose value is text that a parser understands, if something else was found: "expected a time
/// with a unit in quotes".
template <typename Value>
[[nodiscard]] std::string expected_text(const toml::node& found) {
  if constexpr (std::is_same_v<Value, can::Duration>) {
    return "expected a time with a unit in quotes, for example \"20ms\"";
  } else if constexpr (std::is_same_v<Value, ObjectName>) {
    return "expected an object in quotes, for example \"6000:01\"";
  } else if constexpr (std::is_same_v<Value, HostAndPort>) {
    return "expected an address in quotes, for example \"127.0.0.1:5007\"";
  } else if constexpr (std::is_same_v<Value, std::uint32_t>) {  // a buffer memory address
    return found.is_integer() ? fmt::format("expected \"G{}\"", found.as_integer()->get())
                              : "expected \"G10000\"";
  } else {
    return "expected text in quotes";
  }
}

/// The texts that a parser takes, as a pattern of JSON Schema; empty: it has none here.
template <typename Value>
[[nodiscard]] constexpr std::string_view pattern_of() noexcept {
  if constexpr (std::is_same_v<Value, can::Duration>) {
    return "^[0-9]*[.]?[0-9]+([eE][-+]?[0-9]+)? *(ns|us|ms|s|min|h)$";
  } else if constexpr (std::is_same_v<Value, ObjectName>) {
    return "^(0[xX])?[0-9A-Fa-f]{1,4}[hH]?(:(0[xX])?[0-9A-Fa-f]{1,2}[hH]?)?$";
  } else {
    return {};
  }
}

/// The key that people mean who write another tool's name for it.
[[nodiscard]] std::string_view usual_synonym(std::string_view key, const std::vector<std::string>& known);

class TableReader {
 public:
  TableReader(const toml::table& table, std::string what, std::vector<FileError>& errors)
      : TableReader(table, std::move(what), errors, SchemaRecording::current()) {}
  TableReader(const toml::table& table, std::string what, std::vector<FileError>& errors, TableSchema* schema)
      : table_(table), what_(std::move(what)), errors_(errors), schema_(schema) {
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

  /// The value as it stands, of whatever type.
  const toml::node* find(std::string_view key) {
    if (schema_ != nullptr) schema_->note_open(key);
    return look_up(key);
  }
  std::optional<std::string> text(std::string_view key, bool required = false) {
    note(key, TableSchema::Type::text, required);
    const toml::node* node = look_up(key);
    if (node == nullptr) {
      if (required) error(key, "expected text in quotes");
      return std::nullopt;
    }
    if (const auto* value = node->as_string(); value != nullptr && !(required && value->get().empty())) {
      return value->get();
    }
    error(key, required ? "expected text in quotes that is not empty" : "expected text in quotes");
    return std::nullopt;
  }
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t low, std::int64_t high,
                                      std::string_view expected, bool required = false) {
    if (TableSchema::Key* const noted = note(key, TableSchema::Type::integer, required); noted != nullptr) {
      noted->low = low;
      noted->high = high;
      noted->expected = expected;
    }
    const toml::node* node = look_up(key);
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
  /// An integer of a closed set, such as bit rates, in ranges of one value or several. `unknown`: what is expected in place of
  /// another integer, if that is not `expected`.
  std::optional<std::int64_t> integer_of(std::string_view key, std::vector<TableSchema::Range> ranges,
                                         std::string_view expected, std::string_view unknown = {},
                                         bool required = false) {
    const auto value = integer(key, INT64_MIN, INT64_MAX, expected, required);
    const bool is_known = !value || std::ranges::any_of(ranges, [&](const TableSchema::Range& range) {
      return *value >= range.first && *value <= range.last;
    });
    if (schema_ != nullptr) schema_->note(key, TableSchema::Type::integer).ranges = std::move(ranges);
    if (is_known) return value;
    error(key, unknown.empty() ? expected : unknown);
    return std::nullopt;
  }
  std::optional<double> number(std::string_view key) {
    note(key, TableSchema::Type::number);
    const toml::node* node = look_up(key);
    if (node == nullptr) return std::nullopt;
    if (const auto value = node->value<double>(); value && !node->is_boolean() && std::isfinite(*value)) {
      return *value;
    }
    error(key, "expected a number");
    return std::nullopt;
  }
  std::optional<bool> boolean(std::string_view key) {
    note(key, TableSchema::Type::boolean);
    const toml::node* node = look_up(key);
    if (node == nullptr) return std::nullopt;
    if (const auto* value = node->as_boolean()) return value->get();
    error(key, "expected true or false");
    return std::nullopt;
  }
  /// A string that `parse` understands.
  template <typename Parse>
  auto parsed(std::string_view key, Parse parse, bool required = false)
      -> std::optional<typename decltype(parse(std::string_view{}))::value_type> {
    using Value = typename decltype(parse(std::string_view{}))::value_type;
    if (TableSchema::Key* const noted = note(key, TableSchema::Type::text, required); noted != nullptr)
      noted->pattern = pattern_of<Value>();
    if (const toml::node* node = look_up(key); node != nullptr && !node->is_string()) {
      error(key, expected_text<Value>(*node));
      return std::nullopt;
    }
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
    const toml::node* node = look_up(key);
    if (node == nullptr) return note_table(key, TableSchema::Type::table, what, read);
    const auto* table = node->as_table();
    if (node->is_array_of_tables()) {
      return error(place_of(node->source()),
                   fmt::format("[[{0}]] must be written [{0}]: there is only one", what));
    }
    if (table == nullptr) return error(key, expected);
    TableReader reader(*table, std::move(what), errors_, schema_of(key, TableSchema::Type::table));
    read(reader);
    reader.finish();
  }
  /// Every table of an array of tables ([[key]]).
  void tables(std::string_view key, const std::string& what, const std::function<void(TableReader&)>& read) {
    const toml::node* node = look_up(key);
    if (node == nullptr) return note_table(key, TableSchema::Type::tables, what, read);
    if (const auto* single = node->as_table()) {  // its own mistakes are reported, too
      error(place_of(node->source()),
            fmt::format("[{0}] must be written [[{0}]]: there can be several", what));
      TableReader reader(*single, what, errors_, schema_of(key, TableSchema::Type::tables));
      read(reader);
      return reader.finish();
    }
    const auto* array = node->as_array();
    if (array == nullptr) return error(key, fmt::format("expected tables, written as [[{}]]", what));
    for (const toml::node& element : *array) {
      const auto* table = element.as_table();
      if (table == nullptr) {
        error(place_of(element.source()),
              fmt::format("{}: found {}, expected a table", key, describe_found(element)));
        continue;
      }
      TableReader reader(*table, what, errors_, schema_of(key, TableSchema::Type::tables));
      read(reader);
      reader.finish();
    }
  }
  /// Every element of an array, or the single value in place of an array.
  void elements(std::string_view key, const std::function<void(const toml::node&)>& read) {
    note(key, TableSchema::Type::elements);
    const toml::node* node = look_up(key);
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
    note(key, TableSchema::Type::entries);
    const toml::node* node = look_up(key);
    if (node == nullptr) return;
    const auto* table = node->as_table();
    if (table == nullptr) return error(key, fmt::format("expected a table, for example {}", example));
    for (const auto& [name, value] : *table) read(name.str(), value, place_of(name.source()));
  }
  /// Reports every key that was never read.
  void finish() {
    for (const auto& [key, value] : table_) {
      if (std::ranges::find(known_, key.str()) != known_.end()) continue;
      error(place_of(key.source()), unknown_key(key.str()));
    }
  }
  /// A mistake was found in the value of this key, or it is missing.
  [[nodiscard]] bool is_wrong(std::string_view key) const { return wrong_.contains(key); }
  std::vector<FileError>& errors() { return errors_; }

 private:
  static constexpr std::size_t usual_keys = 24;

  const toml::node* look_up(std::string_view key) {
    if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
    return table_.get(key);
  }
  TableSchema::Key* note(std::string_view key, TableSchema::Type type, bool required = false) {
    if (schema_ == nullptr) return nullptr;
    TableSchema::Key& noted = schema_->note(key, type);
    noted.required = noted.required.value_or(true) && required;
    return &noted;
  }
  TableSchema* schema_of(std::string_view key, TableSchema::Type type) {
    return schema_ == nullptr ? nullptr : &schema_->table(key, type);
  }
  /// The keys of a table that is not there.
  void note_table(std::string_view key, TableSchema::Type type, const std::string& what,
                  const std::function<void(TableReader&)>& read) {
    if (schema_ == nullptr) return;
    const toml::table none;
    TableReader reader(none, what, errors_, schema_of(key, type));
    read(reader);
  }

  std::string unknown_key(std::string_view key) {
    std::ranges::sort(known_);
    const std::vector<std::string_view> names(known_.begin(), known_.end());
    std::string_view meant = usual_synonym(key, known_);
    if (meant.empty()) meant = nearest(key, names);
    if (!meant.empty()) return fmt::format("{}: unknown key {}; did you mean {}?", what_, key, meant);
    return fmt::format("{}: unknown key {}; expected one of {}", what_, key, fmt::join(known_, ", "));
  }

  const toml::table& table_;
  std::string what_;
  std::vector<FileError>& errors_;
  TableSchema* schema_;             // nullptr: nothing is recorded
  std::vector<std::string> known_;  // not many
  std::set<std::string, std::less<>> wrong_;
};

}  // namespace canopus::text
