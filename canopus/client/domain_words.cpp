#include "canopus/client/domain_words.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/hex.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/trace/decode/object_facts.hpp"

namespace canopus::client {
namespace {

std::string counted_bytes(std::size_t count) { return ascii::counted(count, "byte"); }

std::string value_of(const manager::ConciseEntry& entry, canopen::DataType type) {
  constexpr std::size_t most_shown = 64;
  if (entry.data.empty()) return "no bytes";
  const auto shown = entry.data.first(std::min(entry.data.size(), most_shown));
  std::string text = trace::object_value_text(entry.index, entry.sub, shown, type);
  if (shown.size() < entry.data.size()) text += fmt::format(" ... ({} bytes)", entry.data.size());
  return text;
}

/// The dump of `bytes`, the first of them alone if there are too many.
void add_dump(DomainWords& words, std::span<const std::uint8_t> bytes, std::size_t first) {
  words.dump = hex_dump(bytes.first(std::min(bytes.size(), DomainWords::most_dumped)), first);
}

DomainWords concise_words(std::span<const std::uint8_t> bytes, const canopen::DictionaryDescription* device) {
  DomainWords words;
  manager::ConciseDcfReader reader(bytes);
  words.heading = fmt::format("concise DCF, {}, {} entr{}", counted_bytes(bytes.size()), reader.announced(),
                              reader.announced() == 1 ? "y" : "ies");
  while (words.entries.size() < DomainWords::most_entries) {
    const auto entry = reader.next();
    if (!entry) break;
    const trace::ObjectFacts facts = trace::object_facts(device, entry->index, entry->sub);
    words.entries.push_back({canopen::object_text(entry->index, entry->sub), text::printable(facts.name),
                             text::printable(value_of(*entry, facts.type))});
  }
  const auto rest = reader.rest();
  if (!reader.intact()) {
    words.problem = reader.damage();
  } else if (reader.remaining() != 0) {
    words.problem = fmt::format("only the first {} entries are shown", words.entries.size());
    return words;
  } else if (reader.announced() != 0 && !rest.empty()) {
    words.problem = fmt::format("{} behind the last entry", counted_bytes(rest.size()));
  }
  if (!words.problem.empty()) add_dump(words, rest, bytes.size() - rest.size());
  return words;
}

}  // namespace

std::string ascii_of(std::span<const std::uint8_t> bytes) {
  std::string shown;
  for (const std::uint8_t byte : bytes) shown += byte >= 0x20 && byte < 0x7F ? static_cast<char>(byte) : '.';
  return shown;
}

std::vector<std::string> hex_dump(std::span<const std::uint8_t> bytes, std::size_t first) {
  constexpr std::size_t in_line = 16;
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < bytes.size(); at += in_line) {
    const auto part = bytes.subspan(at, std::min(in_line, bytes.size() - at));
    std::string line = fmt::format("{:08X}  {}", first + at, ascii::hex_bytes(part, " "));
    line.append(3 * (in_line - part.size()), ' ');
    lines.push_back(fmt::format("{}  |{}|", line, ascii_of(part)));
  }
  return lines;
}

DomainWords domain_words(std::uint16_t index, std::span<const std::uint8_t> bytes,
                         const canopen::DictionaryDescription* device) {
  if (index == concise_dcf_object) return concise_words(bytes, device);
  DomainWords words;
  words.heading = counted_bytes(bytes.size());
  if (bytes.size() > DomainWords::most_dumped)
    words.heading += fmt::format(", the first {} of them", DomainWords::most_dumped);
  add_dump(words, bytes, 0);
  return words;
}

std::vector<std::string> lines_of(const DomainWords& words) {
  std::vector<std::string> lines{words.heading};
  std::size_t longest = 0;
  for (const auto& entry : words.entries)
    longest = std::max(longest, std::min<std::size_t>(entry.name.size(), 40));
  for (const auto& entry : words.entries)
    lines.push_back(fmt::format("  {}  {:{}}  {}", entry.object, entry.name, longest, entry.value));
  if (!words.problem.empty()) lines.push_back(fmt::format("  {}", words.problem));
  for (const std::string& line : words.dump) lines.push_back("  " + line);
  return lines;
}

text::Json json_of(const DomainWords& words) {
  text::Json json{{"heading", words.heading}};
  json["entries"] = text::Json::array();
  for (const auto& entry : words.entries) {
    json["entries"].push_back({{"object", entry.object}, {"name", entry.name}, {"value", entry.value}});
  }
  json["problem"] = words.problem;
  json["dump"] = words.dump;
  return json;
}

}  // namespace canopus::client
