#include "canopus/canopen/service/identifier_table.hpp"

#include <bit>

namespace canopus::canopen {

void IdentifierTable::build(std::span<const Route> routes) {
  const std::size_t size = std::bit_ceil(routes.size() * 2 + 4);
  slots_.assign(size, Slot{});
  mask_ = size - 1;
  shift_ = 32U - static_cast<unsigned>(std::countr_zero(size));
  for (const Route& route : routes) {
    std::size_t place = start(route.key);
    for (; slots_[place].key != empty; place = (place + 1) & mask_) {
      if (slots_[place].key == route.key) slots_[place].more = true;
    }
    slots_[place] = {.key = route.key, .kind = route.kind, .number = route.number};
  }
}

}  // namespace canopus::canopen
