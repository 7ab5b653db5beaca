#include "canopus/text/table_schema.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"

namespace canopus::text {
namespace {

using Type = TableSchema::Type;

thread_local TableSchema* current_schema = nullptr;

/// A key and the tables that it is in, outermost first.
struct KeyPlace {
  struct Step {
    std::string name;
    bool is_array = false;
    std::string context;
  };
  std::vector<Step> tables;
  std::string context;  ///< of the key's own table
  std::string key;
};

/// The file with this key alone, and what it needs.
std::string file_with(const KeyPlace& place, std::string_view value, std::uint32_t& line) {
  std::string text;
  std::string path;
  for (const KeyPlace::Step& step : place.tables) {
    path += (path.empty() ? "" : ".") + step.name;
    text += step.is_array ? fmt::format("[[{}]]\n", path) : fmt::format("[{}]\n", path);
    text += step.context;
  }
  text += place.context;
  line = static_cast<std::uint32_t>(std::ranges::count(text, '\n')) + 1;
  return text + fmt::format("{} = {}\n", place.key, value);
}

std::string unquoted(std::string_view word) {
  while (word.starts_with(' ') || word.starts_with('"')) word.remove_prefix(1);
  while (word.ends_with(' ') || word.ends_with('"')) word.remove_suffix(1);
  return std::string(word);
}

/// The words of "expected one of a, b", "expected \"a\" or \"b\"" and their like; fewer than two: it is no choice.
std::vector<std::string> words_of(std::string_view expected) {
  constexpr std::string_view one_of = "expected one of ";
  constexpr std::string_view quoted = "expected \"";
  std::string list;
  if (expected.starts_with(one_of)) {
    list = expected.substr(one_of.size());
  } else if (expected.starts_with(quoted)) {
    list = expected.substr(quoted.size() - 1);
  }
  for (std::size_t at = 0; (at = list.find(" or ", at)) != std::string::npos;) list.replace(at, 4, ", ");
  std::vector<std::string> words;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find(", ", at), list.size());
    words.push_back(unquoted(std::string_view(list).substr(at, end - at)));
    at = end + 2;
  }
  const bool is_choice = words.size() > 1 && std::ranges::none_of(words, &std::string::empty);
  return is_choice ? words : std::vector<std::string>{};
}

/// "SINE" for "sine", "me3can1-q" for "ME3CAN1-Q".
std::string in_other_case(const std::string& word) {
  std::string other = ascii::lower(word);
  if (other != word) return other;
  for (char& c : other) {
    if (ascii::is_letter(c)) c = static_cast<char>(c & ~0x20);
  }
  return other;
}

class Prober {
 public:
  explicit Prober(const FileReader& read) : read_(read) {
    record({});
    probe(schema_, {});
  }
  TableSchema release() { return std::move(schema_); }

 private:
  void record(const std::string& text) {
    const SchemaRecording recording(schema_);
    (void)read_(text);
  }

  /// What the reader expects in place of this value; empty: it takes it.
  std::string refusal(const KeyPlace& place, std::string_view value) {
    const SchemaRecording recording(schema_);  // what is required without this key may not be so beside it
    std::uint32_t line = 0;
    for (const FileError& error : read_(file_with(place, value, line))) {
      const std::string begin = place.key + " = ";
      if (error.place.line == line && error.message.starts_with(begin)) {
        const std::string_view shown = value.starts_with('"') ? value : std::string_view();
        std::string_view message = std::string_view(error.message).substr(begin.size());
        if (!shown.empty() && message.starts_with(shown)) message.remove_prefix(shown.size());
        while (message.starts_with(':') || message.starts_with(' ')) message.remove_prefix(1);
        if (const std::size_t at = message.find("; expected "); at != std::string_view::npos)
          message.remove_prefix(at + 2);
        return std::string(message);
      }
    }
    return {};
  }

  void probe(TableSchema& table, const std::vector<KeyPlace::Step>& tables) {
    std::set<std::string, std::less<>> done;
    while (true) {  // a word of a choice may bring further keys
      const auto next =
          std::ranges::find_if(table.keys, [&](const auto& item) { return !done.contains(item.first); });
      if (next == table.keys.end()) break;
      done.insert(next->first);
      probe(next->first, next->second, table, tables);
    }
    for (auto& [name, key] : table.keys) {
      if (key.inner == nullptr || tables.size() >= deepest) continue;
      auto inner = tables;
      inner.push_back({name, key.types.contains(Type::tables), key.context});
      probe(*key.inner, inner);
    }
  }

  void probe(const std::string& name, TableSchema::Key& key, TableSchema& table,
             const std::vector<KeyPlace::Step>& tables) {
    const KeyPlace place{.tables = tables, .context = key.context, .key = name};
    if (!key.types.contains(Type::text)) return;
    key.expected = refusal(place, "\"?\"");
    if (!key.pattern.empty() || key.is_open) return;
    key.words = words_of(key.expected);
    if (key.words.empty()) return;
    key.ignores_case = refusal(place, '"' + in_other_case(key.words.front()) + '"').empty();
    for (const std::string& word : key.words) add_keys_beside(name, word, table, place);
  }

  void add_keys_beside(const std::string& name, const std::string& word, TableSchema& table,
                       const KeyPlace& place) {
    std::set<std::string, std::less<>> before;
    for (const auto& [key, value] : table.keys) before.insert(key);
    std::uint32_t line = 0;
    record(file_with(place, '"' + word + '"', line));
    for (auto& [key, value] : table.keys) {
      if (!before.contains(key)) value.context = place.context + fmt::format("{} = \"{}\"\n", name, word);
    }
  }

  static constexpr std::size_t deepest = 8;
  const FileReader& read_;
  TableSchema schema_;
};

/// "^([Mm][Ee]3)$"
std::string pattern_ignoring_case(const std::vector<std::string>& words) {
  std::string pattern;
  for (const std::string& word : words) {
    pattern += pattern.empty() ? "^(" : "|";
    for (const char c : word) {
      if (ascii::is_letter(c)) {
        pattern += fmt::format("[{}{}]", ascii::lower(c), static_cast<char>(c & ~0x20));
      } else if (ascii::is_digit(c)) {
        pattern += c;
      } else {
        pattern += fmt::format("[{}]", c);
      }
    }
  }
  return pattern + ")$";
}

Json table_json(const TableSchema& schema);

Json scalar_types() { return Json::array({"string", "integer", "number", "boolean"}); }

/// Of a key that is read in more than one form.
Json open_json(const TableSchema::Key& key) {
  if (key.inner == nullptr) {
    Json json = Json::object();
    if (key.low) json["minimum"] = *key.low;  // of a number; a text may be right, too
    if (key.high && *key.high != INT64_MAX) json["maximum"] = *key.high;
    return json;
  }
  Json list{{"type", "array"},
            {"items", {{"anyOf", Json::array({table_json(*key.inner), Json{{"type", scalar_types()}}})}}}};
  Json single{{"type", scalar_types()}};
  return Json{{"anyOf", Json::array({std::move(list), std::move(single)})}};
}

Json text_json(const TableSchema::Key& key) {
  Json json{{"type", "string"}};
  if (!key.pattern.empty()) json["pattern"] = key.pattern;
  if (key.words.empty()) return json;
  if (!key.ignores_case) {
    json["enum"] = key.words;
    return json;
  }
  Json any{{"type", "string"}, {"pattern", pattern_ignoring_case(key.words)}};
  return Json{{"anyOf", Json::array({Json{{"enum", key.words}}, std::move(any)})}};
}

/// A list of numbers, or ranges side by side.
Json ranges_json(const std::vector<TableSchema::Range>& ranges) {
  using Range = TableSchema::Range;
  Json numbers = Json::array();
  Json any = Json::array();
  for (const Range& range : ranges) {
    numbers.push_back(range.first);
    any.push_back(Json{{"minimum", range.first}, {"maximum", range.last}});
  }
  const auto is_one = [](const Range& range) { return range.first == range.last; };
  const bool is_list = std::ranges::all_of(ranges, is_one);
  Json json{{"type", "integer"}};
  json[is_list ? "enum" : "anyOf"] = is_list ? std::move(numbers) : std::move(any);
  return json;
}

Json integer_json(const TableSchema::Key& key) {
  if (!key.ranges.empty()) return ranges_json(key.ranges);
  Json json{{"type", "integer"}};
  if (key.low) json["minimum"] = *key.low;
  if (key.high && *key.high != INT64_MAX) json["maximum"] = *key.high;
  return json;
}

Json key_json(const TableSchema::Key& key) {
  Json json;
  if (key.is_open) {
    json = open_json(key);
  } else if (key.types.size() != 1) {
    json = Json::object();
  } else {
    switch (*key.types.begin()) {
      case Type::text: json = text_json(key); break;
      case Type::integer: json = integer_json(key); break;
      case Type::number: json = Json{{"type", "number"}}; break;
      case Type::boolean: json = Json{{"type", "boolean"}}; break;
      case Type::table: json = table_json(*key.inner); break;
      case Type::tables: json = Json{{"type", "array"}, {"items", table_json(*key.inner)}}; break;
      case Type::entries: json = Json{{"type", "object"}}; break;
      case Type::elements: json = Json::object(); break;
    }
  }
  if (!key.expected.empty()) json["description"] = key.expected;
  return json;
}

Json table_json(const TableSchema& schema) {
  Json json{{"type", "object"}, {"additionalProperties", false}};
  Json properties = Json::object();
  Json required = Json::array();
  for (const auto& [name, key] : schema.keys) {
    properties[name] = key_json(key);
    if (key.required.value_or(false) && key.context.empty()) required.push_back(name);
  }
  json["properties"] = std::move(properties);
  if (!required.empty()) json["required"] = std::move(required);
  return json;
}

}  // namespace

TableSchema::Key& TableSchema::note(std::string_view name, Type type) {
  Key& key = keys.try_emplace(std::string(name)).first->second;
  key.types.insert(type);
  return key;
}

void TableSchema::note_open(std::string_view name) {
  keys.try_emplace(std::string(name)).first->second.is_open = true;
}

TableSchema& TableSchema::table(std::string_view name, Type type) {
  Key& key = note(name, type);
  if (key.inner == nullptr) key.inner = std::make_unique<TableSchema>();
  return *key.inner;
}

SchemaRecording::SchemaRecording(TableSchema& schema) noexcept
    : before_(std::exchange(current_schema, &schema)) {}
SchemaRecording::~SchemaRecording() { current_schema = before_; }
TableSchema* SchemaRecording::current() noexcept { return current_schema; }

TableSchema schema_of(const FileReader& read) { return Prober(read).release(); }

Json json_schema(const TableSchema& schema, const std::string& title) {
  Json json{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  const Json table = table_json(schema);
  for (const auto& [name, value] : table.items()) json[name] = value;
  return json;
}

}  // namespace canopus::text
