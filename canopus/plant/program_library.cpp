#include "canopus/plant/program_library.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/plant/file/plant_file.hpp"

namespace canopus::plant {

namespace {

bool has_head_address(plc::CpuFamily family) {
  return family == plc::CpuFamily::q || family == plc::CpuFamily::iqr;
}

/// "U4": the module's number in the rack, as its buffer memory is named.
std::string unit_of(const ModuleSection& module) { return fmt::format("U{:X}", module.head / 16U); }

/// The module of "canopen@U4", or without a unit the PLC's only one.
std::expected<const ModuleSection*, std::string> module_for(std::string_view unit, const PlcSection& plc) {
  if (unit.empty()) {
    if (plc.modules.size() == 1) return &plc.modules.front();
    return std::unexpected(plc.modules.empty()
                               ? "expected a module in the PLC's rack"
                               : "expected @ and the unit of a module, such as \"lib:canopen@" +
                                     unit_of(plc.modules.front()) + "\": the rack has several");
  }
  const auto found = std::ranges::find(plc.modules, unit, unit_of);
  if (found == plc.modules.end()) return std::unexpected(fmt::format("the rack has no module at {}", unit));
  return &*found;
}

/// Of "canopen/lift.fx3u-can.st" the models are between the points.
bool is_for(std::string_view path, std::string_view model) {
  std::string_view models = path.substr(path.find('.') + 1);
  if (models == "st") return true;
  for (std::size_t point = models.find('.'); point != std::string_view::npos; point = models.find('.')) {
    if (ascii::lower(model) == models.substr(0, point)) return true;
    models.remove_prefix(point + 1);
  }
  return false;
}

bool is_of_word(char c) { return ascii::is_letter(c) || ascii::is_digit(c) || c == '_'; }

/// Calls each(word) for what is a name or number, and other(c) for every other character.
template <typename Each, typename Other>
void for_each_word(std::string_view text, Each each, Other other) {
  for (std::size_t at = 0; at < text.size();) {
    const auto begin = text.begin() + static_cast<std::ptrdiff_t>(at);
    const auto length = static_cast<std::size_t>(std::find_if_not(begin, text.end(), is_of_word) - begin);
    if (length > 0)
      each(text.substr(at, length));
    else
      other(text[at]);
    at += std::max<std::size_t>(length, 1);
  }
}

/// Functions, function blocks and global variables that a file of the library declares.
void add_declared_names(std::string_view text, std::set<std::string, std::less<>>& names) {
  std::string_view before;
  bool is_global = false;
  bool is_name = false;  // of a variable: behind the begin of its line
  for_each_word(
      text,
      [&](std::string_view word) {
        if (before == "FUNCTION" || before == "FUNCTION_BLOCK" || (is_global && is_name)) names.emplace(word);
        if (word == "VAR_GLOBAL") is_global = true;
        if (word == "END_VAR") is_global = false;
        is_name = false;
        before = word;
      },
      [&](char c) {
        if (c == '\n' || c == ',') is_name = true;
        if (c == ':' || c == '(') is_name = false;
      });
  for (const std::string_view keyword : {"END_VAR", "CONSTANT"}) names.erase(std::string(keyword));
}

/// These names with the unit behind them.
std::string renamed(std::string_view text, const std::set<std::string, std::less<>>& names,
                    std::string_view unit) {
  std::string made;
  for_each_word(
      text,
      [&](std::string_view word) {
        made += word;
        if (names.contains(word)) made.append("_").append(unit);
      },
      [&](char c) { made += c; });
  return made;
}

/// Lines stay where they are.
std::string without_types(std::string_view text) {
  std::string made;
  bool is_type = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    const std::string_view line = text.substr(0, end);
    is_type = is_type || line.starts_with("TYPE");
    made += is_type ? std::string_view("\n") : line;
    if (line.starts_with("END_TYPE")) is_type = false;
    text.remove_prefix(end);
  }
  return made;
}

/// The text with the devices of the first place, U0\\ and X00 to Y1F, moved to the module's.
std::string moved_to(const ModuleSection& module, plc::CpuFamily family, std::string_view text) {
  std::string moved;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = static_cast<std::size_t>(
        std::find_if_not(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), is_of_word) -
        text.begin());
    const std::string_view word = text.substr(at, end - at);
    const auto high = word.size() == 3 ? ascii::hex_value(word[1]) : std::nullopt;
    const auto low = word.size() == 3 ? ascii::hex_value(word[2]) : std::nullopt;
    const bool is_signal = (word.starts_with('X') || word.starts_with('Y')) && high && low;
    if (word == "U0" && end < text.size() && text[end] == '\\') {
      moved += unit_of(module);
    } else if (is_signal && has_head_address(family)) {
      moved += fmt::format("{}{:02X}", word[0], module.head + 16U * *high + *low);
    } else {
      moved += word;
    }
    if (end < text.size()) moved += text[end];
    at = end + 1;
  }
  return moved;
}

}  // namespace

std::expected<std::vector<structured_text::Source>, std::string> library_sources(
    std::string_view file, const PlcSection& plc, std::span<const structured_text::Source> before) {
  const std::string_view name = file.substr(ProgramFile::library.size());
  const std::size_t at = std::min(name.find('@'), name.size());
  const std::string folder = std::string(name.substr(0, at)) + '/';
  const auto belongs = [&folder](const LibraryFile& each) { return each.path.starts_with(folder); };
  if (std::ranges::none_of(library_files(), belongs)) return std::unexpected("expected \"lib:canopen\"");
  const auto module = module_for(name.substr(std::min(at + 1, name.size())), plc);
  if (!module) return std::unexpected(module.error());
  const std::string unit = unit_of(**module);
  const bool is_further = !before.empty();
  const auto name_of = [&](const LibraryFile& each, const std::string& place) {
    return std::string(ProgramFile::library) + std::string(each.path) + place;
  };
  const auto has = [&](const LibraryFile& each) {
    return std::ranges::any_of(before, [&](const structured_text::Source& source) {
      return source.name.starts_with(name_of(each, ""));
    });
  };
  std::vector<structured_text::Source> sources;
  std::set<std::string, std::less<>> names;
  for (const LibraryFile& each : library_files()) {
    if (!belongs(each) || !is_for(each.path, (*module)->model)) continue;
    std::string text = moved_to(**module, plc.cpu_model.family, each.content);
    if (is_further) add_declared_names(text, names);
    if (has(each)) text = without_types(text);
    sources.push_back({name_of(each, is_further ? " @" + unit : ""), std::move(text)});
  }
  if (is_further)
    for (structured_text::Source& source : sources) source.text = renamed(source.text, names, unit);
  return sources;
}

}  // namespace canopus::plant
