#pragma once
// A JSON Schema of a TOML file, made by what reads the file: TableReader notes each key that is read, with its type and
// limits, while a SchemaRecording is on. What a key expects comes from the messages of the reader, which is given wrong
// values for that. So the schema cannot differ from the checks.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/text/file_error.hpp"
#include "canopus/text/json.hpp"

namespace canopus::text {

/// A table of the file, and those in it.
class TableSchema {
 public:
  enum class Type : std::uint8_t { text, integer, number, boolean, table, tables, entries, elements };
  /// Integers from `first` to `last`.
  struct Range {
    std::int64_t first = 0;
    std::int64_t last = 0;
  };
  struct Key {
    std::set<Type> types{};
    /// It is also read as it stands, so that other types may be right, too.
    bool is_open = false;
    std::optional<bool> required{};             ///< in every reading
    std::optional<std::int64_t> low{}, high{};  ///< of an integer
    std::vector<Range> ranges{};       ///< of an integer, in place of `low` and `high`; empty: those count
    std::string pattern{};             ///< of a text, as in JSON Schema
    std::string expected{};            ///< what the checks say that they expect
    std::vector<std::string> words{};  ///< of a text: no others
    bool ignores_case = false;         ///< of the words
    std::unique_ptr<TableSchema> inner{};  ///< of a table
    std::string context{};                 ///< TOML of other keys of the table that it needs
  };

  Key& note(std::string_view name, Type type);
  void note_open(std::string_view name);
  /// The table below, [name] or [[name]].
  TableSchema& table(std::string_view name, Type type);

  std::map<std::string, Key, std::less<>> keys{};
};

/// While it lives, tables that are read at the top of a file on this thread note their keys in `schema`.
class SchemaRecording {
 public:
  explicit SchemaRecording(TableSchema& schema) noexcept;
  ~SchemaRecording();
  SchemaRecording(const SchemaRecording&) = delete;
  SchemaRecording& operator=(const SchemaRecording&) = delete;
  /// nullptr: none.
  [[nodiscard]] static TableSchema* current() noexcept;

 private:
  TableSchema* before_;
};

/// Reads the text of a file; returns its mistakes.
using FileReader = std::function<std::vector<FileError>(const std::string& text)>;

/// The schema of what `read` reads, in all its variants: a key that is read beside kind = "noise" alone is in it, too.
[[nodiscard]] TableSchema schema_of(const FileReader& read);

/// As JSON Schema, draft 07, which editors take.
[[nodiscard]] Json json_schema(const TableSchema& schema, const std::string& title);

}  // namespace canopus::text
