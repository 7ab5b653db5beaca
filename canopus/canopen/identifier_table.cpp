#include "canopus/canopen/identifier_table.hpp"

#include <bit>

namespace canopus::canopen {

void IdentifierTable::build(std::span<const Route> routes) {
  const std::size_t size = std::bit_ceil(routes.size() * 2 + 4);
  slots_.assign(size, Route{.key = empty});
  mask_ = size - 1;
  shift_ = 32U - static_cast<unsigned>(std::countr_zero(size));
  for (const Route& route : routes) {
    std::size_t place = start(route.key);
    while (slots_[place].key != empty) place = (place + 1) & mask_;
    slots_[place] = route;
  }
}

}  // namespace canopus::canopen
