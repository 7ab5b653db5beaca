#include "canopus/network_project/pdo.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/eds/problems.hpp"

namespace canopus::network_project {
namespace {

constexpr std::uint16_t pdo_count = 512;

class ValueReader {
 public:
  ValueReader(const eds::DeviceFile& file, std::uint8_t node_id)
      : dictionary_(*file.dictionary), node_id_(node_id) {}

  [[nodiscard]] std::optional<std::uint64_t> value(std::uint16_t index, std::uint8_t sub) const {
    return eds::default_value(dictionary_, index, sub, node_id_);
  }
  [[nodiscard]] bool can_be_written(std::uint16_t index, std::uint8_t sub) const {
    const canopen::Entry entry = dictionary_.find(index, sub);
    return entry && is_writable(entry.description->access);
  }

  [[nodiscard]] std::optional<Pdo> pdo(bool transmit, unsigned number) const {
    Pdo pdo{.transmit = transmit, .number = number};
    const std::uint16_t index = pdo.communication_index();
    if (dictionary_.find(index) == nullptr) return std::nullopt;
    pdo.cob_id.raw = static_cast<std::uint32_t>(value(index, 1).value_or(canopen::CobId::invalid_bit));
    pdo.can_change_cob_id = can_be_written(index, 1);
    pdo.transmission_type = static_cast<std::uint8_t>(value(index, 2).value_or(0xFF));
    const auto time = [&](std::uint8_t sub) -> std::optional<std::uint16_t> {
      const auto found = value(index, sub);
      return found ? std::optional(static_cast<std::uint16_t>(*found)) : std::nullopt;
    };
    pdo.inhibit_time = transmit ? time(3) : std::nullopt;
    pdo.event_timer = time(5);
    read_mapping(pdo);
    return pdo;
  }

 private:
  void read_mapping(Pdo& pdo) const {
    const std::uint16_t index = pdo.mapping_index();
    const auto* object = dictionary_.find(index);
    if (object == nullptr) return;
    constexpr unsigned most = 64;  // more are codes of MPDOs
    pdo.most_objects = std::min<unsigned>(object->highest_sub, most);
    pdo.can_change_mapping = can_be_written(index, 0) && pdo.most_objects != 0 && can_be_written(index, 1);
    const auto count = value(index, 0).value_or(0);
    for (unsigned sub = 1; sub <= pdo.most_objects && sub <= count && count <= most; ++sub) {
      const auto mapped =
          static_cast<std::uint32_t>(value(index, static_cast<std::uint8_t>(sub)).value_or(0));
      if (mapped == 0) continue;
      pdo.mapping.push_back({.index = static_cast<std::uint16_t>(mapped >> 16),
                             .sub = static_cast<std::uint8_t>(mapped >> 8),
                             .bits = static_cast<std::uint8_t>(mapped)});
    }
  }

  const canopen::DictionaryDescription& dictionary_;
  std::uint8_t node_id_;
};

}  // namespace

unsigned Pdo::bits() const noexcept {
  unsigned sum = 0;
  for (const MappedObject& object : mapping) sum += object.bits;
  return sum;
}

std::string Pdo::name() const { return fmt::format("{}PDO{}", transmit ? 'T' : 'R', number); }

std::vector<Pdo> read_pdos(const eds::DeviceFile& file, std::uint8_t node_id) {
  const ValueReader reader(file, node_id);
  std::vector<Pdo> pdos;
  for (const bool transmit : {false, true}) {
    for (unsigned number = 1; number <= pdo_count; ++number) {
      if (auto pdo = reader.pdo(transmit, number)) pdos.push_back(std::move(*pdo));
    }
  }
  return pdos;
}

std::string describe_mapping(const Pdo& pdo) {
  std::string text;
  for (const MappedObject& object : pdo.mapping) {
    if (!text.empty()) text += ", ";
    text += object.is_dummy() ? fmt::format("{} unused bits", object.bits)
                              : eds::object_text(object.index, object.sub);
  }
  return text;
}

std::string describe_can_id(canopen::CobId cob_id) {
  return cob_id.is_extended() ? fmt::format("{:08X}H", cob_id.identifier())
                              : fmt::format("{:03X}H", cob_id.identifier());
}

std::string describe_transmission_type(std::uint8_t type, bool transmit) {
  if (type == 0) return transmit ? "synchronous, after a change" : "synchronous";
  if (type <= 240) {
    if (!transmit || type == 1) return "synchronous";
    return fmt::format("synchronous, every {} SYNCs", type);
  }
  switch (type) {
    case 252: return "remote frame, sampled at SYNC";
    case 253: return "remote frame";
    case 254: return "event-driven, of the manufacturer";
    case 255: return "event-driven, of the profile";
    default: return fmt::format("reserved ({})", type);
  }
}

}  // namespace canopus::network_project
