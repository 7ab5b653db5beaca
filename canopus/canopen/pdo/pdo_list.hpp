#pragma once
// The PDOs of one direction, in order of number: those that the dictionary has a communication object for.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/canopen/pdo/pdo_mapping.hpp"

namespace canopus::canopen {

/// Makes them, each with its `number`. `first_communication`: 1400H or 1800H.
template <typename Pdo>
void make_pdos(std::vector<Pdo>& pdos, const DictionaryDescription& description,
               std::uint16_t first_communication) {
  const auto is_one = [&](const ObjectDescription& object) {
    return (object.index & ~pdo_number_mask) == first_communication;
  };
  const auto objects = description.objects();
  pdos.reserve(static_cast<std::size_t>(std::ranges::count_if(objects, is_one)));
  for (const ObjectDescription& object : objects) {
    if (is_one(object)) pdos.emplace_back().number = object.index & pdo_number_mask;
  }
}

/// The one of a communication or mapping object, or nullptr.
template <typename Pdo>
[[nodiscard]] Pdo* find_pdo(std::vector<Pdo>& pdos, std::uint16_t index) noexcept {
  const std::uint16_t number = index & pdo_number_mask;
  const auto number_of = [](const Pdo& pdo) -> std::uint16_t { return pdo.number; };
  const auto place = std::ranges::lower_bound(pdos, number, {}, number_of);
  return place != pdos.end() && place->number == number ? &*place : nullptr;
}

}  // namespace canopus::canopen
