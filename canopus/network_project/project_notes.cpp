#include "canopus/network_project/project_notes.hpp"

#include <vector>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/text/toml.hpp"

namespace canopus::network_project {
namespace {

constexpr std::string_view made_header =
    "# Notes of the network's nodes, by node-ID: CiA 306 has no key for them.\n";

std::optional<std::uint8_t> node_id_of(std::string_view key) {
  const auto number = ascii::parse_number<std::uint8_t>(key);
  return number && *number <= 127 && !key.starts_with('0') ? number : std::nullopt;
}

/// A string of TOML on one line.
std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (byte < 0x20 || byte == 0x7F) {
      result += fmt::format("\\u{:04X}", byte);
    } else {
      result += c;
    }
  }
  return result + '"';
}

/// The lines of a file, each with its end.
struct Lines {
  explicit Lines(std::string_view text) {
    while (!text.empty()) {
      const std::size_t length = std::min(text.find('\n'), text.size() - 1) + 1;
      lines.emplace_back(text.substr(0, length));
      text.remove_prefix(length);
    }
    end = !lines.empty() && lines.front().ends_with("\r\n") ? "\r\n" : "\n";
  }
  /// Puts one behind line `number`, from 1; 0: before all.
  void insert(std::size_t number, const std::string& line) {
    if (number > 0 && !lines[number - 1].ends_with('\n')) lines[number - 1] += end;
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(number), line + end);
  }
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const std::string& line : lines) text += line;
    return text;
  }
  std::vector<std::string> lines{};
  std::string end;
};

/// The byte position of a line's character of this number, from 1.
std::size_t byte_of(std::string_view line, std::size_t column) {
  std::size_t byte = line.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  while (column > 1 && byte < line.size()) {
    ++byte;
    while (byte < line.size() && (static_cast<unsigned char>(line[byte]) & 0xC0) == 0x80) ++byte;
    --column;
  }
  return byte;
}

/// The text with another value in the place of this one.
std::string replaced(const std::string& text, const toml::source_region& old, const std::string& value) {
  Lines lines(text);
  std::string& first = lines.lines.at(old.begin.line - 1);
  const std::string& last = lines.lines.at(old.end.line - 1);
  first =
      first.substr(0, byte_of(first, old.begin.column)) + value + last.substr(byte_of(last, old.end.column));
  for (std::size_t line = old.begin.line; line < old.end.line; ++line) lines.lines[line].clear();
  return lines.text();
}

std::string without(const std::string& text, const toml::key& key, const toml::node& value) {
  Lines lines(text);
  for (std::size_t line = key.source().begin.line; line <= value.source().end.line; ++line)
    lines.lines.at(line - 1).clear();
  return lines.text();
}

}  // namespace

std::string notes_path(std::string_view list_path) {
  const std::size_t slash = list_path.rfind('/');
  const std::size_t dot = list_path.rfind('.');
  const bool has_extension =
      dot != std::string_view::npos && (slash == std::string_view::npos || dot > slash + 1) && dot != 0;
  return std::string(has_extension ? list_path.substr(0, dot) : list_path) + ".notes.toml";
}

ProjectNotes::ProjectNotes(std::optional<std::string> text, std::size_t network)
    : text_(std::move(text)), table_(network == 0 ? "notes" : fmt::format("notes{}", network + 1)) {
  read();
}

ProjectNotes ProjectNotes::unreadable(std::string reason) {
  ProjectNotes notes(std::nullopt, 0);
  notes.problem_ = std::move(reason);
  return notes;
}

void ProjectNotes::read() {
  notes_.clear();
  problem_.clear();
  line_ = 0;
  if (!text_) return;
  const auto file = text::parse_toml(*text_);
  if (!file) {
    line_ = file.error().place.line;
    problem_ = fmt::format("this cannot be read as TOML: {}", file.error().message);
    return;
  }
  const toml::node* const node = file->get(table_);
  if (node == nullptr) return;
  if (!node->is_table()) {
    line_ = node->source().begin.line;
    problem_ = fmt::format("{} is no table; expected [{}] and lines such as 5 = \"text\"", table_, table_);
    return;
  }
  for (const auto& [key, value] : *node->as_table()) {
    const auto id = node_id_of(key.str());
    if (!id || *id == 0 || !value.is_string()) {
      line_ = key.source().begin.line;
      problem_ = fmt::format("[{}] has something else than notes; expected a node-ID, = and a text in quotes",
                             table_);
      notes_.clear();
      return;
    }
    notes_[*id] = value.as_string()->get();
  }
}

std::string ProjectNotes::note(std::uint8_t node_id) const {
  const auto found = notes_.find(node_id);
  return found == notes_.end() ? std::string() : found->second;
}

std::expected<void, std::string> ProjectNotes::set(std::uint8_t node_id, std::string_view note) {
  if (this->note(node_id) == note) return {};
  if (!problem_.empty())
    return std::unexpected(line_ == 0 ? problem_ : fmt::format("line {}: {}", line_, problem_));
  if (note.size() > longest)
    return std::unexpected(fmt::format("the note has {} bytes; {} at most", note.size(), longest));
  std::string text = text_.value_or(std::string(made_header));
  const std::string key = std::to_string(node_id);
  const auto file = text::parse_toml(text);
  if (!file)
    return std::unexpected(fmt::format("line {}: {}", file.error().place.line, file.error().message));
  const toml::table* const table = (*file)[table_].as_table();
  const auto place = table == nullptr ? toml::table::const_iterator{} : table->find(key);
  const std::string line = key + " = " + quoted(note);
  if (table == nullptr) {
    Lines lines(text);
    if (text != made_header) lines.insert(lines.lines.size(), "");
    lines.insert(lines.lines.size(), "[" + table_ + "]");
    lines.insert(lines.lines.size(), line);
    text = lines.text();
  } else if (place == table->end()) {
    // Behind the last of those before it, or the table's head.
    std::size_t behind = table->source().begin.line;
    for (const auto& [other, value] : *table) {
      if (node_id_of(other.str()).value_or(0) < node_id)
        behind = std::max<std::size_t>(behind, value.source().end.line);
    }
    Lines lines(text);
    lines.insert(behind, line);
    text = lines.text();
  } else if (note.empty()) {
    text = without(text, place->first, place->second);
  } else {
    text = replaced(text, place->second.source(), quoted(note));
  }
  ProjectNotes changed = *this;
  changed.text_ = std::move(text);
  changed.read();
  Notes wanted = notes_;
  if (note.empty()) {
    wanted.erase(node_id);
  } else {
    wanted[node_id] = note;
  }
  // A file of another hand may be written in ways that are not foreseen here, and a note may be no UTF-8.
  if (!changed.problem_.empty() || changed.notes_ != wanted) {
    return std::unexpected(
        std::string("the note cannot be put into the file: it is not UTF-8 text, or the file is "
                    "written in another way than [notes] and lines such as 5 = \"text\""));
  }
  const std::string made_table = std::string(made_header) + "[" + table_ + "]\n";
  if (wanted.empty() && changed.text_ == made_table) changed.text_ = std::nullopt;
  *this = std::move(changed);
  return {};
}

}  // namespace canopus::network_project
