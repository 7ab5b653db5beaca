#include "canopus/eds/ini.hpp"

#include <algorithm>
#include <utility>

#include "canopus/ascii/words.hpp"
#include "canopus/eds/draft.hpp"
#include "canopus/eds/encoding.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using Severity = Problem::Severity;

constexpr std::size_t usual_items = 8;  // of a section: those of a sub-index

constexpr std::size_t usual_section = 80;  // characters
constexpr std::size_t most_reserved = 2000;

bool is_comment(std::string_view line) noexcept {
  return line.starts_with(';') || line.starts_with('#') || line.starts_with("//");
}

}  // namespace

std::string size_problem(std::size_t bytes, std::size_t most) {
  if (bytes <= most) return {};
  return "the file has " + std::to_string(bytes) + " bytes; expected at most " + std::to_string(most);
}

const Item* Section::find(std::string_view folded_key) const noexcept {
  const auto place = std::ranges::find(items, folded_key, &Item::folded_key);
  return place == items.end() ? nullptr : &*place;
}

const Item* Section::find_value(std::string_view folded_key) const noexcept {
  const Item* item = find(folded_key);
  return item != nullptr && !item->value.empty() ? item : nullptr;
}

IniFile::IniFile(std::string_view text, Problems& problems) {
  if (std::string problem = size_problem(text.size(), largest_ini_text); !problem.empty()) {
    problems.error(1, std::move(problem));
    return;
  }
  std::string converted;
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    converted = from_utf16(text.substr(2), text.starts_with("\xFE\xFF"));
    text = converted;
    problems.warning(1, "the file is UTF-16 text, EDS files are 8-bit text: converted");
  } else if (text.starts_with("\xEF\xBB\xBF")) {
    text.remove_prefix(3);
    problems.note(1, "the file begins with a UTF-8 byte order mark: skipped");
  } else if (!is_utf8(text)) {
    if (const auto encoding = find_encoding(text)) {
      converted = decode(text, *encoding).value_or(std::string(text));
      text = converted;
      problems.note(
          1, "bytes that are not UTF-8: read as " + std::string(encoding->name) + " text, as they look");
    }
  }
  has_bytes_to_skip_ =
      text.find('\0') != std::string_view::npos || text.find('\x1A') != std::string_view::npos;
  sections_.reserve(std::min(text.size() / usual_section, most_reserved));
  // A carriage return ends a line where there is no line feed at all; else it belongs to the line feed.
  const char line_end = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(line_end), text.size());
    read_line(text.substr(0, end), ++line_count_, problems);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

IniFile::IniFile(std::vector<Section> sections) : sections_(std::move(sections)) {
  for (std::size_t i = 0; i < sections_.size(); ++i)
    section_numbers_.try_emplace(sections_[i].folded_name, i);
}

void IniFile::read_line(std::string_view line, unsigned number, Problems& problems) {
  std::string cleaned;
  if (has_bytes_to_skip_ && line.find_first_of(std::string_view("\0\x1A", 2)) != std::string_view::npos) {
    cleaned = line;
    std::erase_if(cleaned, [](char c) { return c == '\0' || c == '\x1A'; });  // 1AH: a DOS end of file
    if (line.find('\0') != std::string_view::npos) {
      problems.repeated(Severity::warning, "zero bytes", number, "zero bytes in the text: skipped");
    }
    line = cleaned;
  }
  const std::string_view content = trim(line);
  if (content.empty() || is_comment(content)) return;
  if (!is_utf8(content)) {
    problems.repeated(Severity::note, "8-bit", number,
                      "bytes that are not UTF-8: read as Windows Latin text");
  }
  if (content.front() == '[') return begin_section(content, number, problems);
  const std::size_t equals = line.find('=');
  if (equals != std::string_view::npos && !trim(line.substr(0, equals)).empty() && current_ != 0) {
    return add_item(line, equals, number, problems);
  }
  if (strange_lines_++ == 0) first_strange_line_ = number;
  const auto object = current_ == 0 ? std::nullopt : object_section(sections_[current_ - 1].folded_name);
  const bool is_of_an_object = object && object->index >= 0x1000;
  problems.repeated(is_of_an_object ? Severity::loss : Severity::warning, "strange line", number,
                    (equals != std::string_view::npos && current_ == 0
                         ? "a key before the first [section]: skipped: \""
                         : "neither [section] nor Key=Value nor ;comment: skipped: \"") +
                        printable(content) + '"');
}

void IniFile::begin_section(std::string_view line, unsigned number, Problems& problems) {
  const std::size_t end = line.find(']');
  std::string_view name = trim(line.substr(1, end == std::string_view::npos ? end : end - 1));
  if (end == std::string_view::npos) {
    name = trim(name.substr(0, name.find(';')));
    problems.warning(number, "section \"" + printable(line) + "\" has no closing bracket");
  } else if (const auto rest = trim(line.substr(end + 1)); !rest.empty() && !is_comment(rest)) {
    problems.warning(number, "text behind the section's bracket: skipped: \"" + printable(rest) + '"');
  }
  Section section;
  section.folded_name = folded(name);
  section.name = printable(name);
  section.line = number;
  item_numbers_.clear();
  const auto [place, is_new] = section_numbers_.try_emplace(section.folded_name, sections_.size());
  current_ = place->second + 1;
  if (is_new) {
    sections_.push_back(std::move(section));
    return;
  }
  const Section& first = sections_[place->second];
  problems.repeated(Severity::warning, "section again", number,
                    "section [" + first.name + "] was in line " + std::to_string(first.line) +
                        " before: only what is new in it counts");
}

// Most sections have a handful of keys: they are compared one by one, and only those of long ones are looked up.
const Item* IniFile::known_item(const Section& section, std::string_view folded_key) {
  constexpr std::size_t many = 24;
  if (section.items.size() < many) return section.find(folded_key);
  for (std::size_t i = item_numbers_.size(); i < section.items.size(); ++i) {
    item_numbers_.emplace(section.items[i].folded_key, i);
  }
  const auto known = item_numbers_.find(folded_key);
  return known == item_numbers_.end() ? nullptr : &section.items[known->second];
}

void IniFile::add_item(std::string_view line, std::size_t equals, unsigned number, Problems& problems) {
  Section& section = sections_[current_ - 1];
  if (section.items.empty()) section.items.reserve(usual_items);
  Item item;
  const std::string_view key = trim(line.substr(0, equals));
  item.key = printable(key);
  item.folded_key = folded(key);
  const std::string_view value = trim(line.substr(equals + 1));
  item.value = value;
  item.line = number;
  item.column = static_cast<unsigned>(value.empty() ? equals + 2 : value.data() - line.data() + 1);
  if (item.folded_key.size() != key.size() && std::ranges::any_of(key, ascii::is_blank)) {
    problems.repeated(Severity::note, "blank in key " + item.folded_key, number,
                      "key \"" + item.key + "\" is written with a blank");
  }
  const Item* const known = known_item(section, item.folded_key);
  if (known == nullptr) {
    section.items.push_back(std::move(item));
    return;
  }
  const Item& first = *known;
  if (first.value == item.value) {
    problems.repeated(Severity::note, "key again", number,
                      item.key + " is in [" + section.name + "] twice, with the same value");
    return;
  }
  problems.repeated(Severity::warning, "key again otherwise", number,
                    item.key + '=' + printable(item.value) + " in [" + section.name + "]: line " +
                        std::to_string(first.line) + " says " + printable(first.value) + ", which counts");
}

const Section* IniFile::find(std::string_view folded_name) const noexcept {
  const auto place = section_numbers_.find(folded_name);
  return place == section_numbers_.end() ? nullptr : &sections_[place->second];
}

const Section* IniFile::find_or_misspelt(std::string_view folded_name, std::string_view shown,
                                         Problems& problems) const {
  if (const Section* section = find(folded_name)) return section;
  for (const Section& section : sections_) {
    if (!is_misspelt(section.folded_name, folded_name)) continue;
    problems.warning(section.line, "section [" + section.name + "] is read as [" + std::string(shown) + ']');
    return &section;
  }
  return nullptr;
}

}  // namespace canopus::eds
