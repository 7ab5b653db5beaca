#include "canopus/cli/run/table_keys.hpp"

#include <algorithm>
#include <optional>

namespace canopus::cli {
namespace {

constexpr char escape = 27;

/// A control sequence after its introducer [ECMA-48 5.4]: parameters, and a final byte from 40H to 7EH.
std::optional<TableKey> key_of_sequence(std::string_view parameters, char final) {
  switch (final) {
    case 'A': return TableKey::up;
    case 'B': return TableKey::down;
    case 'H': return TableKey::home;
    case 'F': return TableKey::end;
    case '~': break;
    default: return std::nullopt;
  }
  const std::string_view number = parameters.substr(0, parameters.find(';'));
  if (number == "1" || number == "7") return TableKey::home;
  if (number == "4" || number == "8") return TableKey::end;
  if (number == "5") return TableKey::page_up;
  if (number == "6") return TableKey::page_down;
  return std::nullopt;
}

std::optional<TableKey> key_of_character(char character) {
  switch (character) {
    case 'q':
    case 'Q': return TableKey::quit;
    case '?': return TableKey::help;
    default: return std::nullopt;
  }
}

/// Takes a sequence behind its escape off the front. Nothing: no key of the table.
std::optional<TableKey> next_sequence(std::string_view& rest) {
  if (rest.empty()) return std::nullopt;  // the key Esc
  const char introducer = rest.front();
  rest.remove_prefix(1);
  if (introducer == 'O') {  // the keypad's application mode: no parameters
    if (rest.empty()) return std::nullopt;
    const char final = rest.front();
    rest.remove_prefix(1);
    return key_of_sequence({}, final);
  }
  if (introducer != '[') return std::nullopt;  // Alt and a key
  const auto found = std::ranges::find_if(rest, [](char c) { return c >= 0x40 && c <= 0x7E; });
  const std::string_view parameters = rest.substr(0, static_cast<std::size_t>(found - rest.begin()));
  rest.remove_prefix(parameters.size());
  if (rest.empty()) return std::nullopt;  // not all of it came
  const char final = rest.front();
  rest.remove_prefix(1);
  return key_of_sequence(parameters, final);
}

}  // namespace

std::vector<TableKey> keys_in(std::string_view bytes) {
  std::vector<TableKey> keys;
  while (!bytes.empty()) {
    const char first = bytes.front();
    bytes.remove_prefix(1);
    if (const auto key = first == escape ? next_sequence(bytes) : key_of_character(first)) {
      keys.push_back(*key);
    }
  }
  return keys;
}

TableView after_key(TableView view, TableKey key, const TablePicture& shown) {
  const std::size_t first = shown.first;
  switch (key) {
    case TableKey::up: view.first = first - std::min<std::size_t>(first, 1); break;
    case TableKey::down: view.first = std::min(first + 1, shown.last); break;
    case TableKey::page_up: view.first = first - std::min(first, shown.page); break;
    case TableKey::page_down: view.first = std::min(first + shown.page, shown.last); break;
    case TableKey::home: view.first = 0; break;
    case TableKey::end: view.first = shown.last; break;
    case TableKey::help: view.help = !view.help; break;
    case TableKey::quit: break;
  }
  return view;
}

}  // namespace canopus::cli
