#include "canopus/canopen/dictionary/dictionary_draft.hpp"

#include <algorithm>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>

namespace canopus::canopen {

// Lengths have seven bits to a byte, the lowest ones first; bit 7: another byte follows.
std::uint32_t DictionaryDescription::Draft::add_name(std::string_view name) {
  if (name == highest_sub_name) return highest_sub_name_number;
  if (text.empty()) text.push_back('\0');  // no name has number 0
  const auto number = static_cast<std::uint32_t>(text.size());
  std::size_t length = name.size();
  for (; length > 0x7F; length >>= 7U) text.push_back(static_cast<char>(0x80U | (length & 0x7FU)));
  text.push_back(static_cast<char>(length));
  text += name;
  return number;
}

// Entries that are there already, one after another as these, are not added again.
std::uint32_t DictionaryDescription::Draft::add_entries(
    const std::vector<EntryDescription>& added, std::unordered_multimap<std::size_t, std::uint32_t>& known) {
  std::size_t hash = added.size();
  for (const EntryDescription& entry : added) {
    const std::size_t what = std::size_t{entry.offset} << 32U | entry.name;
    const std::size_t how = std::size_t{entry.limits} << 16U | static_cast<std::size_t>(entry.type) << 8U |
                            static_cast<std::size_t>(entry.access);
    hash = (hash ^ what ^ how << 8U) * 0x9E37'79B9'7F4A'7C15U;
    hash ^= hash >> 32U;
  }
  const auto [first, last] = known.equal_range(hash);
  for (auto place = first; place != last; ++place) {
    const auto there = std::span(entries).subspan(place->second);
    if (there.size() >= added.size() && std::ranges::equal(there.first(added.size()), added))
      return place->second;
  }
  const auto number = static_cast<std::uint32_t>(entries.size());
  entries.insert(entries.end(), added.begin(), added.end());
  known.emplace(hash, number);
  return number;
}

// Half as many places again as there are objects, and as many behind them as the last objects need: a look-up never
// goes on in front. Of a few multipliers the one that lets the look-ups end soonest is taken: most objects are then
// found at the first place.
DictionaryDescription::Draft::Hash DictionaryDescription::Draft::index_objects() const {
  constexpr std::uint32_t candidates = 32;
  const std::size_t places = objects.size() + objects.size() / 2 + 1;
  Hash best{.positions = {}, .multiplier = 0, .places = static_cast<std::uint32_t>(places)};
  std::vector<std::uint16_t> table(places + objects.size() + 1);
  std::size_t fewest = SIZE_MAX;
  std::uint32_t candidate = 0x9E37'79B1;
  for (std::uint32_t i = 0; i < candidates && fewest != 0;
       ++i, candidate = candidate * 0x2C11'87F5 + 0x1234'5672) {
    std::ranges::fill(table, no_position);
    std::size_t extra = 0;
    std::size_t end = places;  // behind the last place that is taken, or that a look-up begins at
    for (std::size_t position = 0; position < objects.size() && extra < fewest; ++position) {
      std::size_t place = first_place(objects[position].index, candidate, best.places);
      for (; table[place] != no_position; ++place) ++extra;
      table[place] = static_cast<std::uint16_t>(position);
      end = std::max(end, place + 1);
    }
    if (extra >= fewest) continue;
    fewest = extra;
    best.multiplier = candidate;
    best.positions.assign(table.begin(), table.begin() + static_cast<std::ptrdiff_t>(end + 1));
  }
  return best;
}

std::shared_ptr<const DictionaryDescription::Layout> DictionaryDescription::Draft::pack() const {
  static_assert(std::is_trivially_destructible_v<Layout> && std::is_trivially_copyable_v<Limits>);
  const Hash hash = index_objects();
  Layout layout;
  layout.multiplier = hash.multiplier;
  layout.places = hash.places;
  layout.communication_block_size = static_cast<std::uint32_t>(communication_block_size);
  layout.communication_slot_count = static_cast<std::uint32_t>(communication_slot_count);
  layout.pdo_values_begin = static_cast<std::uint32_t>(pdo_values_begin);
  layout.pdo_values_end = static_cast<std::uint32_t>(pdo_values_end);
  layout.marks_stored = marks_stored;
  std::vector<std::uint32_t> slot_ends;
  std::vector<std::uint8_t> slot_bytes;
  for (const auto& slot : slots) {
    slot_bytes.insert(slot_bytes.end(), slot.begin(), slot.end());
    slot_ends.push_back(static_cast<std::uint32_t>(slot_bytes.size()));
  }
  // Those with the strictest alignment first, so that nothing is lost between them.
  std::size_t size = sizeof(Layout);
  const auto for_each_table = [&](auto&& visit) {
    visit(layout.limits, limits);
    visit(layout.objects, objects);
    visit(layout.entries, entries);
    visit(layout.node_id_defaults, node_id_defaults);
    visit(layout.slot_ends, slot_ends);
    visit(layout.positions, hash.positions);
    visit(layout.image, image);
    visit(layout.slot_bytes, slot_bytes);
    visit(layout.text, text);
  };
  for_each_table([&size]<typename T>(Table<T>& table, const auto& content) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignof(std::uint64_t));
    size = (size + alignof(T) - 1) / alignof(T) * alignof(T);
    table = {static_cast<std::uint32_t>(size), static_cast<std::uint32_t>(content.size())};
    size += content.size() * sizeof(T);
  });
  struct alignas(std::uint64_t) Piece {
    std::byte bytes[sizeof(std::uint64_t)];
  };
  auto memory = std::make_shared<Piece[]>((size + sizeof(Piece) - 1) / sizeof(Piece));
  auto* const start = reinterpret_cast<std::byte*>(memory.get());
  const auto* const placed = new (start) Layout(layout);
  for_each_table([start]<typename T>(Table<T>& table, const auto& content) {
    if (!content.empty()) std::memcpy(start + table.begin, content.data(), content.size() * sizeof(T));
  });
  return {std::move(memory), placed};
}

}  // namespace canopus::canopen
