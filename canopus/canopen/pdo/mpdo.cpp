#include "canopus/canopen/pdo/mpdo.hpp"

#include <algorithm>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/service/emcy_code.hpp"

namespace canopus::canopen {
namespace {

constexpr std::uint32_t address(std::uint16_t index, std::uint8_t sub) {
  return std::uint32_t{index} << 8 | sub;
}

// Calls visit(value) for each used entry of the lists first..last.
template <typename Number, typename Visit>
void for_each_entry(const ObjectDictionary& dictionary, std::uint16_t first, std::uint16_t last,
                    Visit&& visit) {
  for (const ObjectDescription& object : dictionary.description().objects(first, last)) {
    const auto count = std::min(dictionary.get<std::uint8_t>(object.index, 0), object.highest_sub);
    for (unsigned sub = 1; sub <= count; ++sub) {
      const auto value = dictionary.get<Number>(object.index, static_cast<std::uint8_t>(sub));
      if (value != 0) visit(value);
    }
  }
}

}  // namespace

AbortCode check_mpdo(std::uint8_t transmission_type, bool valid) noexcept {
  if (valid) return AbortCode::device_state;
  return transmission_type < 0xFE ? AbortCode::parameter_incompatible : AbortCode::none;
}

std::uint64_t mpdo_data(std::uint8_t addressing, std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                        std::span<const std::uint8_t> value) noexcept {
  std::uint64_t data = node_id | (addressing == destination_addressing ? 0x80U : 0U) |
                       std::uint64_t{index} << 8 | std::uint64_t{sub} << 24;
  for (std::size_t i = 0; i < value.size() && i < 4; ++i) data |= std::uint64_t{value[i]} << (32 + 8 * i);
  return data;
}

MpdoConsumer::MpdoConsumer(NodeContext& node) : node_(node) { node.dictionary.attach(0x1FD0, 0x1FFF, *this); }

void MpdoConsumer::start() {
  dispatches_.clear();
  for_each_entry<std::uint64_t>(node_.dictionary, 0x1FD0, 0x1FFF, [this](std::uint64_t value) {
    const auto block_size = static_cast<std::uint8_t>(value >> 56);
    const auto producer = static_cast<std::uint32_t>((value & 0xFF) << 24 | (value >> 8 & 0xFF'FFFF));
    dispatches_.push_back({producer, static_cast<std::uint16_t>(value >> 40),
                           static_cast<std::uint8_t>(value >> 32), std::max(block_size, std::uint8_t{1})});
  });
  std::ranges::sort(dispatches_, {}, &Dispatch::producer);
  destination_missing_ = false;
}

AbortCode MpdoConsumer::put(std::uint16_t index, std::uint8_t sub, const can::Frame& frame, can::Time now) {
  const auto entry = node_.dictionary.find(index, sub);
  if (!entry) return entry.error();
  const std::uint8_t length = entry->description->length;
  if (length == 0 || length > 4) return AbortCode::not_mappable;
  return node_.dictionary.write(index, sub, {&frame.data[4], length}, now);
}

bool MpdoConsumer::receive(const can::Frame& frame, std::uint8_t addressing, can::Time now) {
  if (frame.length() != 8) return false;
  const bool has_destination = (frame.data[0] & 0x80) != 0;
  const std::uint8_t node_id = frame.data[0] & 0x7F;
  const auto index = can::load_as<std::uint16_t>(&frame.data[1]);
  const std::uint8_t sub = frame.data[3];
  if (has_destination != (addressing == destination_addressing)) return false;
  if (has_destination) {
    if (node_id != 0 && node_id != node_.node_id) return false;
    const AbortCode code = put(index, sub, frame, now);
    const bool is_missing = code == AbortCode::no_object || code == AbortCode::no_sub_index ||
                            code == AbortCode::write_of_read_only;
    if (is_missing != destination_missing_) {
      destination_missing_ = is_missing;
      const CommunicationError error{.code = emcy_code::mpdo_destination};
      is_missing ? node_.error_began(error, now) : node_.error_ended(error, now);
    }
    return code == AbortCode::none;
  }
  const std::uint32_t wanted = std::uint32_t{node_id} << 24 | address(index, sub);
  auto place = std::ranges::upper_bound(dispatches_, wanted, {}, &Dispatch::producer);
  if (node_id == 0 || place == dispatches_.begin()) return false;
  --place;
  const std::uint32_t distance = wanted - place->producer;
  if (distance >= place->block_size) return false;
  const auto local_sub = static_cast<std::uint8_t>(place->local_sub + distance);
  return put(place->local_index, local_sub, frame, now) == AbortCode::none;
}

MpdoScanner::MpdoScanner(NodeContext& node) : node_(node) { node.dictionary.attach(0x1FA0, 0x1FCF, *this); }

void MpdoScanner::start() {
  ranges_.clear();
  for_each_entry<std::uint32_t>(node_.dictionary, 0x1FA0, 0x1FCF, [this](std::uint32_t value) {
    const std::uint32_t block_size = std::max(value >> 24, 1U);
    const std::uint32_t first = value & 0xFF'FFFF;
    ranges_.push_back({first, first + block_size - 1});
  });
  std::ranges::sort(ranges_, {}, &Range::first);
}

bool MpdoScanner::holds(std::uint16_t index, std::uint8_t sub) const noexcept {
  const std::uint32_t wanted = address(index, sub);
  const auto place = std::ranges::upper_bound(ranges_, wanted, {}, &Range::first);
  return place != ranges_.begin() && wanted <= std::prev(place)->last;
}

}  // namespace canopus::canopen
