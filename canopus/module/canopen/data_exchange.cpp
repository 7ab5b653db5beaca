#include "canopus/module/canopen/data_exchange.hpp"

#include <algorithm>
#include <cstring>

namespace canopus::module {

namespace {

constexpr std::uint16_t first_rpdo_mapping = 0x1600;
constexpr std::uint16_t first_tpdo_mapping = 0x1A00;
constexpr std::uint8_t most_entries = 64;

}  // namespace

// Adds copies for what this PDO maps; neighbours on both sides join the one before, back to copy `first`.
void DataExchange::add_copies(const canopen::ObjectDictionary& dictionary, std::uint16_t mapping_index,
                              VariableDirection direction, std::size_t first,
                              std::vector<Copy>& copies) const {
  const std::uint8_t count = std::min(dictionary.get<std::uint8_t>(mapping_index, 0), most_entries);
  for (std::uint8_t number = 1; number <= count; ++number) {
    const auto mapped = dictionary.get<std::uint32_t>(mapping_index, number);
    const auto index = static_cast<std::uint16_t>(mapped >> 16);
    const auto sub = static_cast<std::uint8_t>(mapped >> 8 & 0xFF);
    const auto place = variable_place(index, sub, received_.size(), layout_.variables);
    if (!place || place->direction != direction) continue;
    const canopen::Entry entry = dictionary.description().find(index, sub);
    if (!entry) continue;
    if (copies.size() > first && copies.back().offset + copies.back().bytes == entry.offset &&
        copies.back().place + copies.back().bytes == place->offset) {
      copies.back().bytes = static_cast<std::uint16_t>(copies.back().bytes + place->size);
    } else {
      copies.push_back({entry.offset, place->offset, place->size});
    }
  }
}

void DataExchange::check_mappings(const canopen::Node& node) {
  revision_ = node.identifiers_revision();
  receive_.clear();
  receive_first_.clear();
  transmit_.clear();
  if (layout_.all_variables) find_areas(node.dictionary().description());
  for (std::uint16_t number = 0; number < layout_.pdos; ++number) {
    receive_first_.push_back(static_cast<std::uint32_t>(receive_.size()));
    add_copies(node.dictionary(), static_cast<std::uint16_t>(first_rpdo_mapping + number),
               VariableDirection::output, receive_first_.back(), receive_);
    if (layout_.all_variables) continue;
    add_copies(node.dictionary(), static_cast<std::uint16_t>(first_tpdo_mapping + number),
               VariableDirection::input, 0, transmit_);
  }
  for (const std::uint32_t area : input_areas_)
    transmit_.push_back({area, 0, static_cast<std::uint16_t>(to_send_.size())});
  receive_first_.push_back(static_cast<std::uint32_t>(receive_.size()));
}

// One index each: the words of such a device are no more than that.
void DataExchange::find_areas(const canopen::DictionaryDescription& description) {
  input_areas_.clear();
  output_areas_.clear();
  for (const VariableArea& area : variable_areas) {
    const canopen::Entry entry = description.find(area.first_index, 1);
    if (!entry) continue;
    (area.direction == VariableDirection::input ? input_areas_ : output_areas_).push_back(entry.offset);
  }
}

void DataExchange::show_in_all(std::span<std::uint8_t> block, std::size_t place,
                               std::size_t bytes) const noexcept {
  for (const std::uint32_t area : output_areas_) std::memcpy(&block[area + place], &received_[place], bytes);
}

void DataExchange::rpdo_received(canopen::Node& node, std::uint16_t number) {
  if (number >= layout_.pdos) return;
  follow(node);
  const auto block = node.dictionary().block();
  const auto last = receive_.begin() + receive_first_[number + 1U];
  for (auto step = receive_.begin() + receive_first_[number]; step != last; ++step) {
    std::memcpy(&received_[step->place], block.data() + step->offset, step->bytes);
    if (layout_.all_variables) show_in_all(block, step->place, step->bytes);
  }
}

void DataExchange::after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                               can::Time) {
  const auto place = variable_place(entry.index, entry.sub, received_.size(), layout_.variables);
  if (!place || place->direction != VariableDirection::output) return;
  std::ranges::copy(dictionary.bytes(entry), received_.begin() + place->offset);
  if (!layout_.all_variables) return;
  if (output_areas_.empty()) find_areas(dictionary.description());
  show_in_all(dictionary.block(), place->offset, place->size);
}

void DataExchange::snapshot() {
  const std::size_t run = layout_.first_part == 0 ? layout_.words : layout_.first_part;
  const auto words = memory_->written(layout_.transmit_first, run);
  std::memcpy(to_send_.data(), words.data(), words.size_bytes());
  if (run == layout_.words) return;
  const auto rest = memory_->written(layout_.rest_first, layout_.words - run);
  std::memcpy(&to_send_[2 * run], rest.data(), rest.size_bytes());
}

void DataExchange::put_words(BufferAddress first, std::span<const std::uint8_t> bytes) {
  const std::size_t run = layout_.first_part == 0 ? layout_.words : layout_.first_part;
  memory_->set_words(first, bytes.first(2 * run));
  if (run != layout_.words) memory_->set_words(layout_.rest_first, bytes.subspan(2 * run));
}

void DataExchange::exchange(canopen::Node& node) {
  follow(node);
  std::uint8_t* const block = node.dictionary().block().data();
  for (const Copy& step : transmit_) std::memcpy(block + step.offset, &to_send_[step.place], step.bytes);
  put_words(layout_.receive_first, received_);
}

void DataExchange::clear() {
  reset();
  put_words(layout_.receive_first, received_);
  put_words(layout_.transmit_first, to_send_);
}

void DataExchange::reset() {
  std::ranges::fill(received_, std::uint8_t{0});
  std::ranges::fill(to_send_, std::uint8_t{0});
}

}  // namespace canopus::module
