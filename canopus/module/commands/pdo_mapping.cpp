#include "canopus/module/commands/pdo_mapping.hpp"

namespace canopus::module {

namespace {

constexpr std::uint16_t rpdo_communication = 0x1400, rpdo_mapping = 0x1600;
constexpr std::uint16_t tpdo_communication = 0x1800, tpdo_mapping = 0x1A00;
constexpr std::uint32_t invalid = 0x8000'0000U;
constexpr unsigned last_communication_sub = 5;
constexpr unsigned last_mapping_sub = 8;
constexpr unsigned pdos_per_node = 4, mode_a_nodes = 8;

/// COB-ID of PDO `number` (from 0) in the pre-defined connection set, which has four; `first`: of the first, without node-ID.
std::uint32_t predefined(std::uint32_t first, unsigned number, std::uint8_t node_id) {
  return number < pdos_per_node ? first + 0x100U * number + node_id : invalid;
}

/// COB-ID of RPDO `number` (from 0) in a mapping mode.
std::uint32_t rpdo_cob_id(PdoMapping mapping, unsigned number, std::uint8_t node_id) {
  switch (mapping) {
    case PdoMapping::mode_0: return predefined(0x200, number, node_id);
    case PdoMapping::mode_b: return invalid;
    case PdoMapping::mode_a: break;
  }
  if (number >= pdos_per_node * mode_a_nodes) return invalid;
  return 0x180U + 0x100U * (number % pdos_per_node) + number / pdos_per_node + 1;
}

class Writer {
 public:
  Writer(canopen::ObjectDictionary& dictionary, const canopen::ObjectDictionary& factory, can::Time now)
      : dictionary_(dictionary), factory_(factory), now_(now) {}

  void number(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned bytes) {
    (void)dictionary_.write(index, sub, canopen::little_endian(value, bytes), now_);
  }
  /// The factory's value, if there is such an object that can be written.
  void factory(std::uint16_t index, std::uint8_t sub) {
    const auto entry = factory_.find(index, sub);
    if (entry) (void)dictionary_.write(index, sub, factory_.bytes(*entry), now_);
  }

 private:
  canopen::ObjectDictionary& dictionary_;
  const canopen::ObjectDictionary& factory_;
  can::Time now_;
};

}  // namespace

// Off, then everything else, then on: no other order is allowed [CiA 301 7.5.2.36].
void set_pdo_mapping(canopen::ObjectDictionary& dictionary, const canopen::ObjectDictionary& factory,
                     std::uint8_t node_id, std::uint16_t pdos, PdoMapping mapping, can::Time now) {
  Writer write(dictionary, factory, now);
  const auto set = [&](std::uint16_t communication, std::uint16_t entries, std::uint32_t cob_id) {
    write.number(communication, 1, dictionary.get<std::uint32_t>(communication, 1) | invalid, 4);
    for (unsigned sub = 2; sub <= last_communication_sub; ++sub)
      write.factory(communication, static_cast<std::uint8_t>(sub));
    write.number(entries, 0, 0, 1);
    for (unsigned sub = 1; sub <= last_mapping_sub; ++sub)
      write.factory(entries, static_cast<std::uint8_t>(sub));
    write.factory(entries, 0);
    write.number(communication, 1, cob_id | invalid, 4);
    if ((cob_id & invalid) == 0) write.number(communication, 1, cob_id, 4);
  };
  for (unsigned number = 0; number < pdos; ++number) {
    const auto rpdo = static_cast<std::uint16_t>(rpdo_communication + number);
    set(rpdo, static_cast<std::uint16_t>(rpdo_mapping + number), rpdo_cob_id(mapping, number, node_id));
    const auto tpdo = static_cast<std::uint16_t>(tpdo_communication + number);
    set(tpdo, static_cast<std::uint16_t>(tpdo_mapping + number), predefined(0x180, number, node_id));
  }
}

std::optional<PdoFrame> rpdo_frame(const canopen::ObjectDictionary& dictionary, std::uint16_t number) {
  const auto index = static_cast<std::uint16_t>(rpdo_communication + number);
  const auto cob_id = dictionary.get<std::uint32_t>(index, 1, invalid);
  if ((cob_id & invalid) != 0) return std::nullopt;
  const auto mapping = static_cast<std::uint16_t>(rpdo_mapping + number);
  unsigned bits = 0;
  const auto count = dictionary.get<std::uint8_t>(mapping, 0);
  for (std::uint8_t sub = 1; sub <= count && sub <= last_mapping_sub; ++sub)
    bits += dictionary.get<std::uint32_t>(mapping, sub) & 0xFF;
  return PdoFrame{.identifier = cob_id & 0x7FF, .length = static_cast<std::uint8_t>((bits + 7) / 8)};
}

}  // namespace canopus::module
