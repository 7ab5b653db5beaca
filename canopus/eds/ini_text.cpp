#include "canopus/eds/ini_text.hpp"

#include <algorithm>
#include <utility>

#include "canopus/eds/ini.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

// Characters that IniFile takes for blanks around a value, and those that it skips.
constexpr std::string_view skipped("\0\x1A \t\v\f\r", 7);
constexpr std::string_view unreadable("\0\x1A\r\n", 4);

std::string_view without_end(std::string_view line) noexcept {
  if (line.ends_with('\n')) line.remove_suffix(1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

bool is_ascii(std::string_view text) noexcept {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

std::string refusal(std::string_view what, std::string_view text, std::string_view why) {
  return std::string(what) + " \"" + printable(text) + "\" " + std::string(why);
}

/// Why IniFile would not read this name again as it is; empty: it would.
std::string name_problem(std::string_view what, std::string_view name, std::string_view forbidden) {
  if (folded(name).empty()) return std::string(what) + " has no letters or digits";
  if (trim(name) != name) return refusal(what, name, "has blanks around it");
  if (name.find_first_of(unreadable) != std::string_view::npos || !is_ascii(name)) {
    return refusal(what, name, "has characters that are not printable ASCII");
  }
  if (name.find_first_of(forbidden) != std::string_view::npos || name.starts_with("//")) {
    return refusal(what, name, "has characters that mean something else in such a file");
  }
  return {};
}

}  // namespace

IniText::IniText(std::string_view text) {
  problem_ = size_problem(text.size(), largest_ini_text);
  std::string decoded;
  if (problem_.empty() && !is_utf8(text)) {
    if (const auto encoding = find_encoding(text)) {
      if (auto whole = decode(text, *encoding)) {
        encoding_ = encoding;
        decoded = *std::move(whole);
      } else {
        problem_ = "the file is not the " + std::string(encoding->name) +
                   " text that it begins as: save it as UTF-8 text";
      }
    }
  }
  if (!problem_.empty()) {
    tail_ = text;
    return;
  }
  if (encoding_) text = decoded;
  if (text.starts_with("\xEF\xBB\xBF")) {
    mark_ = text.substr(0, 3);
    text.remove_prefix(3);
  }
  // As IniFile has it; in a text of one line alone the new ends decide.
  end_character_ =
      text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos ? '\r' : '\n';
  const std::size_t last = text.find_last_not_of(std::string_view("\0\x1A\r\n \t", 6));
  const std::size_t end_of_file = text.find('\x1A', last == std::string_view::npos ? 0 : last + 1);
  if (end_of_file != std::string_view::npos) {
    tail_ = text.substr(end_of_file);
    text = text.substr(0, end_of_file);
  }
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(end_character_), text.size() - 1) + 1;
    lines_.emplace_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  read_places();
}

std::string IniText::decoded_text() const {
  std::string result = mark_;
  for (const std::string& line : lines_) result += line;
  return result + tail_;
}

std::string IniText::text() const {
  std::string text = decoded_text();
  return encoding_ ? encode(text, *encoding_).value_or("")
                   : text;  // encoded() has let in what can be written alone
}

std::string IniText::encoding_note() const {
  if (!mark_.empty()) return "the file begins with a UTF-8 byte order mark: skipped";
  if (encoding_ && !encoding_->is_guess)
    return "the file is " + std::string(encoding_->name) + " text: converted";
  if (!encoding_ && is_utf8_) return {};
  return "bytes that are not UTF-8: read as " +
         (encoding_ ? std::string(encoding_->name) : std::string("Windows Latin")) + " text";
}

void IniText::read_places() {
  const std::string whole = decoded_text();
  is_utf8_ = is_utf8(whole);
  sections_.clear();
  section_names_.clear();
  Problems unheard;
  const IniFile file(whole, unheard);
  for (const eds::Section& read : file.sections()) {
    Section section;
    section.header = section.last = read.line - 1;
    for (const Item& item : read.items) {
      section.lines.emplace(item.folded_key, item.line - 1);
      section.last = std::max<std::size_t>(section.last, item.line - 1);
    }
    section_names_.push_back(read.folded_name);
    sections_.emplace(read.folded_name, std::move(section));
  }
}

const std::size_t* IniText::find(std::string_view section, std::string_view key) const {
  const auto place = sections_.find(folded(section));
  if (place == sections_.end()) return nullptr;
  const auto item = place->second.lines.find(folded(key));
  return item == place->second.lines.end() ? nullptr : &item->second;
}

bool IniText::has_section(std::string_view section) const { return sections_.contains(folded(section)); }

unsigned IniText::section_line(std::string_view section) const {
  const auto place = sections_.find(folded(section));
  return place == sections_.end() ? 0 : static_cast<unsigned>(place->second.header + 1);
}

unsigned IniText::line(std::string_view section, std::string_view key) const {
  const std::size_t* place = find(section, key);
  return place == nullptr ? 0 : static_cast<unsigned>(*place + 1);
}

std::vector<std::string> IniText::keys(std::string_view section) const {
  const auto place = sections_.find(folded(section));
  if (place == sections_.end()) return {};
  std::vector<std::pair<std::size_t, std::string>> by_line;
  for (const auto& [key, line] : place->second.lines) by_line.emplace_back(line, key);
  std::ranges::sort(by_line);
  std::vector<std::string> keys;
  for (auto& [line, key] : by_line) keys.push_back(std::move(key));
  return keys;
}

IniText::Span IniText::value_span(std::string_view line) noexcept {
  const std::string_view content = without_end(line);
  const std::size_t equals = content.find('=');
  const std::size_t begin = content.find_first_not_of(skipped, equals + 1);
  if (begin != std::string_view::npos) return {begin, content.find_last_not_of(skipped) + 1};
  const std::size_t empty = std::min(content.find_first_not_of(" \t", equals + 1), content.size());
  return {empty, empty};
}

std::optional<std::string> IniText::value(std::string_view section, std::string_view key) const {
  const std::size_t* place = find(section, key);
  if (place == nullptr) return std::nullopt;
  const Span span = value_span(lines_[*place]);
  std::string text = lines_[*place].substr(span.begin, span.end - span.begin);
  std::erase_if(text, [](char c) { return c == '\0' || c == '\x1A'; });
  return to_utf8(text);
}

std::string_view IniText::line_end() const noexcept {
  if (end_character_ == '\r') return "\r";
  const bool is_unix = !lines_.empty() && lines_.front().ends_with('\n') && !lines_.front().ends_with("\r\n");
  return is_unix ? "\n" : "\r\n";
}

bool IniText::give_end(std::string& line) const {
  if (line.ends_with(end_character_)) return false;
  line += line.ends_with('\r') ? "\n" : line_end();
  return true;
}

std::expected<std::string, std::string> IniText::encoded(std::string_view value) const {
  if (trim(value) != value || value.find_first_of(unreadable) != std::string_view::npos) {
    return std::unexpected(refusal("value", value, "has blanks around it or a line end in it"));
  }
  if (!is_utf8(value)) return std::unexpected(refusal("value", value, "is not UTF-8 text"));
  const auto lacks = [&](std::string_view encoding) {
    return std::unexpected(
        refusal("value", value, "has letters that " + std::string(encoding) + ", as the file is in, lacks"));
  };
  if (encoding_ && !encode(value, *encoding_)) return lacks(encoding_->name);
  if (is_utf8_ || is_ascii(value)) return std::string(value);
  auto latin = to_latin(value);
  if (!latin) return lacks("Windows Latin");
  if (to_utf8(*latin) != value) {
    return std::unexpected(
        refusal("value", value, "would be read as UTF-8 in this file of Windows Latin text"));
  }
  return *std::move(latin);
}

std::expected<void, std::string> IniText::accept(IniText changed) {
  const std::string bytes = changed.text();
  const auto encoding = is_utf8(bytes) ? std::nullopt : find_encoding(bytes);
  const auto name_of = [](const std::optional<Encoding>& one) {
    return one ? one->name : std::string_view();
  };
  if (!is_ascii(bytes) && name_of(encoding) != name_of(encoding_)) {
    return std::unexpected(
        "with this change the file would be read in another encoding: save it as UTF-8 text before");
  }
  *this = std::move(changed);
  return {};
}

std::expected<void, std::string> IniText::set(std::string_view section, std::string_view key,
                                              std::string_view value) {
  if (!is_guessed()) return set_value(section, key, value);
  IniText changed = *this;
  if (auto done = changed.set_value(section, key, value); !done) return done;
  return accept(std::move(changed));
}

std::expected<void, std::string> IniText::remove(std::string_view section, std::string_view key) {
  if (!is_guessed()) return remove_lines(section, key);
  IniText changed = *this;
  if (auto done = changed.remove_lines(section, key); !done) return done;
  return accept(std::move(changed));
}

std::expected<void, std::string> IniText::set_value(std::string_view section, std::string_view key,
                                                    std::string_view value) {
  if (!problem_.empty()) return std::unexpected(problem_);
  std::expected<std::string, std::string> bytes = encoded(value);
  if (!bytes) return std::unexpected(std::move(bytes.error()));
  if (const std::size_t* place = find(section, key)) {
    std::string& line = lines_[*place];
    const Span span = value_span(line);
    const std::string_view old = std::string_view(line).substr(span.begin, span.end - span.begin);
    std::size_t length = old.size();
    if (const std::string_view number = trim(without_comment(old));
        number.size() != old.size() && read_number(number) && read_number(value)) {
      length = number.size();
    }
    line.replace(span.begin, length, *bytes);
    return {};
  }
  std::string problem = name_problem("section", section, "[]");
  if (problem.empty()) problem = name_problem("key", key, "=[]#;");
  if (!problem.empty()) return std::unexpected(std::move(problem));
  std::string line = std::string(key) + '=' + *bytes;
  const auto place = sections_.find(folded(section));
  if (place == sections_.end()) {
    append_section(section, std::move(line));
    return {};
  }
  const std::size_t position = place->second.last + 1;
  insert(position, std::move(line));
  Section& changed = place->second;
  changed.lines.emplace(folded(key), position);
  changed.last = position;
  return {};
}

// The last line of a file may have no end: it gets one, and the new last line has none.
void IniText::insert(std::size_t position, std::string line) {
  if (!give_end(lines_[position - 1])) line += line_end();
  lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(position), std::move(line));
  for (auto& [name, section] : sections_) {
    if (section.header >= position) ++section.header;
    if (section.last >= position) ++section.last;
    for (auto& [key, at] : section.lines) at += at >= position ? 1 : 0;
  }
}

void IniText::append_section(std::string_view name, std::string first_line) {
  const std::string end(line_end());
  if (!lines_.empty()) {
    give_end(lines_.back());
    if (!trim(without_end(lines_.back())).empty()) lines_.push_back(end);
  }
  lines_.push_back('[' + std::string(name) + ']' + end);
  lines_.push_back(std::move(first_line) + end);
  read_places();
}

std::expected<void, std::string> IniText::remove_lines(std::string_view section, std::string_view key) {
  if (!problem_.empty()) return std::unexpected(problem_);
  if (find(section, key) == nullptr) return {};
  const std::string folded_section = folded(section);
  const std::string folded_key = folded(key);
  std::string current;
  std::erase_if(lines_, [&](const std::string& line) {
    Problems unheard;
    const IniFile header('\n' + line + '\n', unheard);  // no mark of an encoding where the file has none
    if (!header.sections().empty()) {
      current = header.sections().front().folded_name;
      return false;
    }
    if (current != folded_section) return false;
    const IniFile item("[A]\n" + line + '\n', unheard);
    return item.find("a")->find(folded_key) != nullptr;
  });
  read_places();
  return {};
}

}  // namespace canopus::eds
