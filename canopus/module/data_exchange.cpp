#include "canopus/module/data_exchange.hpp"

#include <algorithm>
#include <cstring>

#include "canopus/module/network_variables.hpp"

namespace canopus::module {

namespace {

constexpr std::uint16_t rpdo_mapping = 0x1600;
constexpr std::uint16_t tpdo_mapping = 0x1A00;
constexpr std::uint8_t most_entries = 64;

// Calls use(index, sub) for each object that a PDO maps.
template <typename Use>
void for_each_mapped(const canopen::ObjectDictionary& dictionary, std::uint16_t mapping_index, Use use) {
  const std::uint8_t count = dictionary.get<std::uint8_t>(mapping_index, 0);
  for (std::uint8_t entry = 1; entry <= count && entry <= most_entries; ++entry) {
    const auto mapped = dictionary.get<std::uint32_t>(mapping_index, entry);
    use(static_cast<std::uint16_t>(mapped >> 16), static_cast<std::uint8_t>(mapped >> 8 & 0xFF));
  }
}

}  // namespace

void DataExchange::rpdo_received(const canopen::ObjectDictionary& dictionary, std::uint16_t number) {
  for_each_mapped(dictionary, static_cast<std::uint16_t>(rpdo_mapping + number),
                  [&](std::uint16_t index, std::uint8_t sub) { take(dictionary, index, sub); });
}

void DataExchange::after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                               can::Time) {
  take(dictionary, entry.index, entry.sub);
}

void DataExchange::take(const canopen::ObjectDictionary& dictionary, std::uint16_t index, std::uint8_t sub) {
  const auto place = variable_place(index, sub, received_.size());
  if (!place || place->direction != VariableDirection::output) return;
  const canopen::Entry entry = dictionary.description().find(index, sub);
  if (!entry) return;
  std::ranges::copy(dictionary.bytes(entry), received_.begin() + place->offset);
}

void DataExchange::snapshot() {
  const auto words = memory_->written(layout_.transmit_first, layout_.words);
  for (std::size_t i = 0; i < words.size(); ++i) {
    to_send_[2 * i] = static_cast<std::uint8_t>(words[i] & 0xFF);
    to_send_[2 * i + 1] = static_cast<std::uint8_t>(words[i] >> 8);
  }
}

void DataExchange::exchange(canopen::ObjectDictionary& dictionary) {
  for (std::uint16_t number = 0; number < layout_.pdos; ++number) {
    for_each_mapped(dictionary, static_cast<std::uint16_t>(tpdo_mapping + number),
                    [&](std::uint16_t index, std::uint8_t sub) {
                      const auto place = variable_place(index, sub, to_send_.size());
                      if (!place || place->direction != VariableDirection::input) return;
                      const canopen::Entry entry = dictionary.description().find(index, sub);
                      if (!entry) return;
                      dictionary.assign(entry, std::span(to_send_).subspan(place->offset, place->size));
                    });
  }
  for (std::size_t i = 0; i < layout_.words; ++i) {
    memory_->set_word(layout_.receive_first + static_cast<BufferAddress>(i),
                      static_cast<std::uint16_t>(received_[2 * i] | received_[2 * i + 1] << 8));
  }
}

void DataExchange::reset() {
  std::ranges::fill(received_, std::uint8_t{0});
  std::ranges::fill(to_send_, std::uint8_t{0});
}

}  // namespace canopus::module
