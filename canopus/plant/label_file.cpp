#include "canopus/plant/label_file.hpp"

#include <algorithm>
#include <array>
#include <expected>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/text/csv.hpp"

namespace canopus::plant {

namespace {

constexpr std::size_t longest_label_file = 8'000'000;
constexpr std::size_t most_label_errors = 100;

// Columns by the begin of their titles, in small letters. German and Japanese ones are unverified.
using Titles = std::span<const std::string_view>;
constexpr std::array<std::string_view, 3> class_titles = {"class", "klasse", "クラス"};
constexpr std::array<std::string_view, 3> name_titles = {"label name", "labelname", "ラベル名"};
constexpr std::array<std::string_view, 3> type_titles = {"data type", "datentyp", "データ型"};
constexpr std::array<std::string_view, 3> constant_titles = {"constant", "konstante", "定数"};
constexpr std::array<std::string_view, 7> device_titles = {
    "device", "assign (device/label)", "assign", "operand", "zuweisung", "デバイス", "割付け"};
constexpr std::array<std::string_view, 3> comment_titles = {"comment", "kommentar", "コメント"};

std::optional<std::size_t> column_of(const std::vector<std::string>& titles, Titles wanted) {
  for (std::size_t i = 0; i < titles.size(); ++i)
    for (const std::string_view title : wanted)
      if (ascii::lower(titles[i]).starts_with(title)) return i;
  return std::nullopt;
}

/// "Word [Signed]" -> "INT", "String(32)" -> "STRING[32]"; a name of the language, or of the user, stays.
std::expected<std::string, std::string> label_type(const std::string& written) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 10> names = {
      {{"bit", "BOOL"},
       {"word [signed]", "INT"},
       {"double word [signed]", "DINT"},
       {"word [unsigned]/bit string [16-bit]", "WORD"},
       {"double word [unsigned]/bit string [32-bit]", "DWORD"},
       {"float [single precision]", "REAL"},
       {"float [double precision]", "LREAL"},
       {"string", "STRING"},
       {"time", "TIME"},
       {"retentive timer", "Retentive_Timer"}}};
  const std::string text = ascii::lower(written);
  for (const auto& [name, type] : names) {
    if (text == name) return std::string(type);
    if (!text.starts_with(name) || !text.ends_with(')') || text[name.size()] != '(') continue;
    const std::string_view inner =
        std::string_view(text).substr(name.size() + 1, text.size() - name.size() - 2);
    if (name == "string" && ascii::parse_number<unsigned>(inner)) return fmt::format("STRING[{}]", inner);
    const std::size_t dots = inner.find("..");
    if (dots != std::string_view::npos && ascii::parse_number<int>(inner.substr(0, dots)) &&
        ascii::parse_number<int>(inner.substr(dots + 2)))
      return fmt::format("ARRAY[{}] OF {}", inner, type);
  }
  const auto is_word = [](char c) {
    return ascii::is_digit(c) || c == '_' || (ascii::lower(c) >= 'a' && ascii::lower(c) <= 'z');
  };
  if (!written.empty() && std::ranges::all_of(written, is_word)) return written;
  return std::unexpected(
      fmt::format("data type \"{}\": expected one such as Bit, Word [Signed], String(32)", written));
}

/// A name, or a device: nothing else can hide in it.
bool is_plain_text(std::string_view text, std::string_view others) {
  return !text.empty() && std::ranges::all_of(text, [&](char c) {
    return ascii::is_digit(c) || c == '_' || (ascii::lower(c) >= 'a' && ascii::lower(c) <= 'z') ||
           static_cast<unsigned char>(c) >= 0x80 || others.contains(c);
  });
}

/// Types that Structured Text does not have: a list's label of it is a timer or a counter.
bool is_list_type(std::string_view type) {
  return ascii::equal_ignoring_case(type, "Timer") || ascii::equal_ignoring_case(type, "Counter") ||
         ascii::equal_ignoring_case(type, "Retentive_Timer");
}

/// "10" -> "K10", "16#FF" -> "HFF", "1.5" -> "E1.5"; empty: it is no number.
std::string constant_operand(std::string_view value) {
  if (ascii::parse_number<std::int64_t>(value)) return fmt::format("K{}", value);
  if (value.starts_with("16#") && ascii::parse_number<std::uint64_t>(value.substr(3), 16))
    return fmt::format("H{}", value.substr(3));
  if (ascii::parse_number<double>(value)) return fmt::format("E{}", value);
  return {};
}

struct LabelColumns {
  std::optional<std::size_t> kind, name, type, constant, device, comment;
};

class LabelReader {
 public:
  LabelReader(const std::string& file, LabelFile& to)
      : file_(file), program_(instruction_list::program_name(file)), to_(to) {}

  void row(std::uint32_t line, const std::vector<std::string>& fields) {
    if (line <= 3 && !columns_.name) {
      if (fields.size() < 2 || !column_of(fields, name_titles)) return;
      columns_ = {column_of(fields, class_titles),  column_of(fields, name_titles),
                  column_of(fields, type_titles),   column_of(fields, constant_titles),
                  column_of(fields, device_titles), column_of(fields, comment_titles)};
      if (!columns_.type) error(line, "expected a column \"Data Type\"");
      return;
    }
    if (columns_.name && columns_.type) label(line, fields);
  }
  void end() {
    if (!columns_.name)
      error(1, "expected a row of titles with \"Label Name\" and \"Data Type\" in the first three lines");
  }

  void error(std::uint32_t line, std::string message) {
    if (to_.errors.size() < most_label_errors) to_.errors.push_back({file_, line, 1, std::move(message)});
  }

 private:
  static std::string field(const std::vector<std::string>& fields, std::optional<std::size_t> column) {
    return column && *column < fields.size() ? std::string(ascii::trim(fields[*column])) : std::string();
  }

  void label(std::uint32_t line, const std::vector<std::string>& fields) {
    const std::string name = field(fields, columns_.name);
    const std::string written = field(fields, columns_.type);
    if (name.empty() && written.empty()) return;
    if (!is_plain_text(name, ""))
      return error(line, fmt::format("label name \"{}\": expected letters, digits and _", name));
    const auto type = label_type(written);
    if (!type) return error(line, type.error());
    const std::string device = field(fields, columns_.device);
    const std::string constant = field(fields, columns_.constant);
    if (!device.empty() && !is_plain_text(device, "\\.%"))
      return error(line, fmt::format("device \"{}\": expected one such as D100", device));
    if (constant.find_first_of(";(*/\n") != std::string::npos)
      return error(line, "constant: expected one value");
    const std::string kind = ascii::upper(field(fields, columns_.kind));
    const bool is_local = kind.starts_with("VAR") && !kind.starts_with("VAR_GLOBAL");
    const bool is_constant = kind.ends_with("CONSTANT");
    const std::string comment = field(fields, columns_.comment);
    if (is_local) {
      const std::string value = is_constant ? constant_operand(constant) : device;
      if (is_constant && value.empty())
        return error(line, "constant: expected a number, such as 10 or 16#FF");
      to_.list_labels.push_back({program_, name, *type, value});
      if (is_constant) return;
      if (device.empty())
        to_.comments.push_back({program_ + '.' + name, comment});
      else
        to_.labels.push_back({program_ + '.' + name, *type, ascii::upper(device), comment});
      return;
    }
    if (!device.empty()) to_.list_labels.push_back({"", name, *type, device});
    if (is_list_type(*type)) return;
    to_.text += fmt::format("VAR_GLOBAL{}{} {}{} : {}{}; END_VAR", is_constant ? " CONSTANT" : "",
                            kind.ends_with("RETAIN") && device.empty() ? " RETAIN" : "", name,
                            device.empty() ? "" : " AT " + device, *type,
                            constant.empty() || !device.empty() ? "" : " := " + constant);
    if (device.empty())
      to_.comments.push_back({name, comment});
    else
      to_.labels.push_back({name, *type, ascii::upper(device), comment});
  }

  const std::string& file_;
  std::string program_;  // whose labels the local ones are
  LabelFile& to_;
  LabelColumns columns_;
};

}  // namespace

LabelFile read_labels(const std::string& file, std::string_view bytes) {
  LabelFile made;
  if (bytes.size() > longest_label_file) {
    made.errors.push_back({file, 1, 1, fmt::format("expected at most {} bytes", longest_label_file)});
    return made;
  }
  const auto text = text::utf8_of(bytes);
  if (!text) {
    made.errors.push_back({file, 1, 1, text.error()});
    return made;
  }
  LabelReader reader(file, made);
  text::CsvReader rows(*text);
  while (!rows.is_at_end()) {
    const std::uint32_t line = rows.line();
    std::string wrong;
    const std::vector<std::string> fields = rows.row(wrong);
    if (wrong.empty())
      reader.row(line, fields);
    else
      reader.error(line, std::move(wrong));
    made.text.append(rows.line() - line, '\n');
  }
  reader.end();
  return made;
}

}  // namespace canopus::plant
