#include "canopus/cli/plc/module_words.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {

namespace {

/// "EMCY message buffer, clear" -> "emcy_message_buffer_clear"
std::string as_written(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (ascii::is_letter(c) || ascii::is_digit(c)) {
      text += ascii::lower(c);
    } else if (!text.empty() && text.back() != '_') {
      text += '_';
    }
  }
  while (text.ends_with('_')) text.pop_back();
  return text;
}

struct Wanted {
  std::string name;
  std::uint32_t index = 0;
};

std::optional<Wanted> parse(std::string_view text) {
  Wanted wanted{.name = as_written(text.substr(0, text.find('['))), .index = 0};
  const std::size_t bracket = text.find('[');
  if (bracket == std::string_view::npos) return wanted;
  if (!text.ends_with(']')) return std::nullopt;
  const auto index = ascii::parse_number<std::uint32_t>(text.substr(bracket + 1, text.size() - bracket - 2));
  if (!index) return std::nullopt;
  wanted.index = *index;
  return wanted;
}

}  // namespace

std::vector<NamedWords> named_words(const plant::CatalogueEntry& entry) {
  std::vector<NamedWords> words;
  for (const module::BufferRow& row : entry.buffer_rows) {
    std::string name = as_written(row.name);
    if (std::ranges::find(words, name, &NamedWords::name) != words.end()) continue;
    words.push_back({std::move(name), row.first, row.last, row.stride});
  }
  return words;
}

std::expected<std::uint32_t, std::string> find_word(std::string_view name, std::string_view model) {
  const auto wanted = parse(name);
  if (!wanted) {
    return std::unexpected(
        fmt::format("'{}' is no name of words; expected for example nmt_state or nmt_state[4]", name));
  }
  if (!model.empty() && plant::find_module(model) == nullptr) {
    return std::unexpected(
        fmt::format("'{}' is no module; expected one of {}", model, plant::quoted_models()));
  }
  std::optional<std::uint32_t> found;
  std::vector<std::string> known;
  for (const plant::CatalogueEntry& entry : plant::module_catalogue()) {
    if (!model.empty() && &entry != plant::find_module(model)) continue;
    for (NamedWords& words : named_words(entry)) {
      if (words.name == wanted->name) {
        if (wanted->index >= words.count()) {
          return std::unexpected(fmt::format("'{}': {} has {}; expected [0] to [{}]", name, words.name,
                                             ascii::counted(words.count(), "word"), words.count() - 1));
        }
        const std::uint32_t address = words.first + wanted->index * words.stride;
        if (found && *found != address) {
          return std::unexpected(fmt::format(
              "'{}' is not at the same address in all modules; say which one with --module", name));
        }
        found = address;
      }
      known.push_back(std::move(words.name));
    }
  }
  if (found) return *found;
  const std::vector<std::string_view> names(known.begin(), known.end());
  const std::string_view near = text::nearest(wanted->name, names);
  return std::unexpected(
      fmt::format("no module has words named '{}'{}", name,
                  near.empty() ? "; canopus plc names lists them" : fmt::format("; did you mean {}?", near)));
}

}  // namespace canopus::cli
