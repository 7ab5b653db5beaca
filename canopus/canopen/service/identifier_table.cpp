#include "canopus/canopen/service/identifier_table.hpp"

#include <algorithm>
#include <bit>

namespace canopus::canopen {

constexpr std::array<IdentifierTable::Slot, 2> IdentifierTable::nothing{};

namespace {

constexpr std::size_t base_identifiers = can::max_base_identifier + 1;
// A large table of scattered identifiers has ways as long.
constexpr std::size_t farthest_neighbour = 8;

}  // namespace

/// How far the farthest one is from its place.
std::size_t IdentifierTable::fill(std::span<const Route> routes) {
  std::size_t farthest = 0;
  for (const Route& route : routes) {
    std::size_t way = 0;
    std::size_t place = start(route.key);
    for (; slots_[place].key != empty; place = (place + 1) & mask_, ++way) {
      if (slots_[place].key == route.key) slots_[place].found = ServiceKind::several;
    }
    slots_[place] = {.key = route.key, .found = route.kind, .kind = route.kind, .number = route.number};
    farthest = std::max(farthest, way);
  }
  return farthest;
}

void IdentifierTable::build(std::span<const Route> routes) {
  const std::size_t size = std::bit_ceil(routes.size() * 2 + 4);
  // Nearly all of a large table's identifiers are base ones: with a place for each of them they lie in their order.
  const bool has_order = size >= base_identifiers / 2;
  const std::size_t places = has_order ? std::max(size, base_identifiers) : size;
  slots_ = std::make_unique<Slot[]>(places);
  mask_ = static_cast<std::uint32_t>(places - 1);
  shift_ = 32U - static_cast<unsigned>(std::countr_zero(places));
  factor_ = has_order ? 1U << shift_ : scattering;
  if (fill(routes) > farthest_neighbour && has_order) {  // such as many of 29 bits that end alike
    slots_ = std::make_unique<Slot[]>(places);
    factor_ = scattering;
    fill(routes);
  }
  places_ = slots_.get();
}

}  // namespace canopus::canopen
