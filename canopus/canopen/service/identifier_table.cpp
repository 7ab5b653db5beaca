#include "canopus/canopen/service/identifier_table.hpp"

#include <bit>

namespace canopus::canopen {

constexpr std::array<IdentifierTable::Slot, 2> IdentifierTable::nothing{};

void IdentifierTable::build(std::span<const Route> routes) {
  const std::size_t size = std::bit_ceil(routes.size() * 2 + 4);
  slots_ = std::make_unique<Slot[]>(size);
  mask_ = static_cast<std::uint32_t>(size - 1);
  shift_ = 32U - static_cast<unsigned>(std::countr_zero(size));
  for (const Route& route : routes) {
    std::size_t place = start(route.key);
    for (; slots_[place].key != empty; place = (place + 1) & mask_) {
      if (slots_[place].key == route.key) slots_[place].found = ServiceKind::several;
    }
    slots_[place] = {.key = route.key, .found = route.kind, .kind = route.kind, .number = route.number};
  }
  places_ = slots_.get();
}

}  // namespace canopus::canopen
