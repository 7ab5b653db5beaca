// Objects of a node by number or name.

#include <algorithm>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/network_project/network_project.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::network_project {
namespace {

template <typename Number>
std::optional<Number> hexadecimal(std::string_view text) {
  return ascii::parse_hexadecimal<Number>(eds::trim(text));
}

/// "6000:01", "1017"; nothing: it is none.
canopen::Entry find_by_number(const canopen::DictionaryDescription& dictionary, std::string_view text) {
  const std::size_t colon = text.find(':');
  const auto index = hexadecimal<std::uint16_t>(text.substr(0, colon));
  const auto sub = colon == std::string_view::npos ? std::optional<std::uint8_t>(0)
                                                   : hexadecimal<std::uint8_t>(text.substr(colon + 1));
  if (!index || !sub) return {};
  return dictionary.find(*index, *sub);
}

/// Accepted spellings of a name: "A: B", "A.B", "A/B".
std::string comparable(std::string_view text) {
  std::string result;
  for (const char c : ascii::lower(text)) {
    if (c == ':' || c == '.' || c == '/') {
      while (result.ends_with(' ')) result.pop_back();
      result += ':';
    } else if (c != ' ' || (!result.empty() && result.back() != ' ' && result.back() != ':')) {
      result += c;
    }
  }
  return result;
}

constexpr std::size_t most_named = 6;

std::string listed(const canopen::DictionaryDescription& dictionary,
                   const std::vector<canopen::Entry>& entries) {
  std::string text;
  for (std::size_t i = 0; i < entries.size() && i < most_named; ++i) {
    if (i != 0) text += ", ";
    text += fmt::format("{} ({})", eds::object_text(entries[i].index, entries[i].sub),
                        eds::printable(object_title(dictionary, entries[i])));
  }
  if (entries.size() > most_named) text += fmt::format(" and {} more", entries.size() - most_named);
  return text;
}

}  // namespace

std::string object_title(const eds::DeviceFile& file, const canopen::Entry& entry) {
  return object_title(*file.dictionary, entry);
}

std::string object_title(const canopen::DictionaryDescription& dictionary, const canopen::Entry& entry) {
  const auto* object = dictionary.find(entry.index);
  const std::string name(dictionary.name(*object));
  const bool is_one =
      object->code == canopen::ObjectCode::variable || object->code == canopen::ObjectCode::domain;
  if (is_one) return name;
  const std::string_view own = dictionary.name(entry);
  return own.empty() || own == name ? fmt::format("{} {}", name, entry.sub)
                                    : fmt::format("{}: {}", name, own);
}

std::expected<canopen::Entry, std::string> find_object(const ProjectNode& node, std::string_view text) {
  if (node.device == nullptr)
    return std::unexpected(fmt::format("{}: {}", node.shown_name(), node.trouble()));
  return find_object(*node.device->dictionary, node.shown_name(), text);
}

std::expected<canopen::Entry, std::string> find_object(const canopen::DictionaryDescription& dictionary,
                                                       std::string_view owner, std::string_view text) {
  if (const canopen::Entry entry = find_by_number(dictionary, text)) return entry;
  const std::string wanted = comparable(eds::trim(text));
  std::vector<canopen::Entry> exact;
  std::vector<canopen::Entry> near;
  std::vector<canopen::Entry> all;
  std::vector<std::string> titles;
  for (const canopen::ObjectDescription& object : dictionary.objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const canopen::Entry entry = dictionary.find(object, static_cast<std::uint8_t>(sub));
      if (!entry) continue;
      all.push_back(entry);
      titles.push_back(object_title(dictionary, entry));
      const std::string title = comparable(titles.back());
      const bool is_it = title == wanted || comparable(dictionary.name(entry)) == wanted;
      if (is_it) exact.push_back(entry);
      if (!is_it && wanted.size() >= 3 && title.find(wanted) != std::string::npos) near.push_back(entry);
    }
  }
  if (exact.size() == 1) return exact.front();
  const std::string_view shown = text;
  if (!exact.empty()) {
    return std::unexpected(
        fmt::format("{}: \"{}\" is the name of {}", owner, eds::printable(shown), listed(dictionary, exact)));
  }
  if (near.empty()) {  // a mistyped one
    const std::vector<std::string_view> known(titles.begin(), titles.end());
    const auto meant = std::ranges::find(known, text::nearest(shown, known));
    if (meant != known.end()) near.push_back(all[static_cast<std::size_t>(meant - known.begin())]);
  }
  std::string message = fmt::format("{} has no object \"{}\"", owner, eds::printable(shown));
  message += near.empty() ? "; expected index:sub-index in hexadecimal, for example 6000:01, or its name"
                          : "; did you mean " + listed(dictionary, near) + "?";
  return std::unexpected(std::move(message));
}

}  // namespace canopus::network_project
