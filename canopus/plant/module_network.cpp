#include "canopus/plant/module_network.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/module/canopen/network_variables.hpp"

namespace canopus::plant {

/// One way of the process data. The slave's TPDOs become RPDOs of the module, and the other way round.
struct ModuleNetwork::Direction {
  bool receive;                        ///< seen from the module
  std::string_view slave_pdo;          ///< "TPDO"
  std::uint16_t slave_communication;   ///< 1800H or 1400H
  std::uint16_t slave_mapping;         ///< 1A00H or 1600H
  std::uint16_t module_communication;  ///< 1400H or 1800H
  std::uint16_t module_mapping;        ///< 1600H or 1A00H
  std::uint32_t module_cob_id_bits;    ///< bits above the identifier
  module::BufferAddress first_word;
  const module::VariableArea& words;  ///< objects behind the words
  const module::VariableArea& bytes;  ///< and behind their halves
};

namespace {

/// "G10000-G10003", of `count` words from number `word` on; "G18-G19, G100-G101" where they are not
/// consecutive.
std::string words_text(const module::DataExchangeLayout& layout, module::BufferAddress base,
                       std::uint32_t word, std::uint32_t count) {
  const module::BufferAddress first = layout.address(base, word);
  const module::BufferAddress last = layout.address(base, word + count - 1);
  if (count == 1) return fmt::format("G{}", first);
  if (last - first == count - 1) return fmt::format("G{}-G{}", first, last);
  const std::uint32_t before = static_cast<std::uint32_t>(layout.first_part) - word;
  return words_text(layout, base, word, before) + ", " +
         words_text(layout, base, word + before, count - before);
}

/// ", its G13000-G13003": the words of the slave's own buffer memory behind these mapping entries, if they are
/// process data of it.
std::string own_words(const module::CommunicationModule& slave, const std::vector<std::uint32_t>& mapped) {
  const module::DataExchangeLayout& layout = slave.program_interface().process_data;
  std::uint32_t first = UINT32_MAX;
  std::uint32_t last = 0;
  module::BufferAddress base = 0;
  for (const std::uint32_t entry : mapped) {
    const auto place =
        module::variable_place(static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8),
                               std::size_t{layout.words} * 2, layout.variables);
    if (!place) return {};
    base =
        place->direction == module::VariableDirection::input ? layout.transmit_first : layout.receive_first;
    first = std::min(first, std::uint32_t{place->offset} / 2U);
    last = std::max(last, (place->offset + place->size - 1U) / 2U);
  }
  return first > last ? std::string{} : ", its " + words_text(layout, base, first, last - first + 1);
}

}  // namespace

namespace {

/// The first PDOs with other numbers that a node uses, as a [[plc.module.slave]] names them.
std::string others_of(const SlaveDescription& description, std::uint8_t node_id) {
  constexpr std::uint64_t unused = canopen::CobId::invalid_bit | canopen::CobId::extended_bit;
  constexpr unsigned pdos = 0x200;
  constexpr std::size_t enough = 4;
  if (!description.value) return {};
  const auto used = [&](unsigned first) {
    std::vector<unsigned> numbers;
    for (unsigned pdo = 1; pdo < pdos && numbers.size() < enough; ++pdo) {
      const auto index = static_cast<std::uint16_t>(first + pdo);
      const auto mapped = description.value(static_cast<std::uint16_t>(index + 0x200), 0).value_or(0);
      if ((description.value(index, 1).value_or(unused) & unused) != 0 || mapped == 0 || mapped > 64)
        continue;
      numbers.push_back(pdo + 1);
    }
    return numbers;
  };
  const auto receive = used(0x1800);
  const auto send = used(0x1400);
  if (receive.empty() && send.empty()) return {};
  return fmt::format("; [[plc.module.slave]] with node = {}{}{} connects others", node_id,
                     receive.empty() ? "" : fmt::format(", receive = [{}]", fmt::join(receive, ", ")),
                     send.empty() ? "" : fmt::format(", send = [{}]", fmt::join(send, ", ")));
}

}  // namespace

void ModuleNetwork::preset(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length) {
  const auto code = module_.preset_object(index, sub, canopen::little_endian(value, length));
  if (code == canopen::AbortCode::none) return;
  refusals_.push_back(fmt::format("{} = {:X}H is refused: {}", canopen::object_text(index, sub), value,
                                  canopen::describe(code)));
}

SlaveDescription SlaveDescription::of(const eds::DeviceFile& file, std::uint8_t node_id,
                                      std::string_view name) {
  SlaveDescription description{.name = name, .identity = eds::identity(file)};
  description.value = [dictionary = file.dictionary, node_id](std::uint16_t index, std::uint8_t sub) {
    return eds::default_value(*dictionary, index, sub, node_id);
  };
  return description;
}

SlaveDescription SlaveDescription::of(const module::CommunicationModule& module, std::uint8_t node_id,
                                      std::string_view name) {
  SlaveDescription description{.name = name, .module = &module};
  description.value = [&module, node_id](std::uint16_t index,
                                         std::uint8_t sub) -> std::optional<std::uint64_t> {
    const auto preset = module.object_preset(index, sub);
    if (!preset.empty() && preset.size() <= 8)
      return can::load_value(preset.data(), static_cast<unsigned>(preset.size()));
    return eds::default_value(module.node().dictionary().description(), index, sub, node_id);
  };
  const auto number = [&](std::uint16_t index, std::uint8_t sub) -> std::optional<std::uint32_t> {
    const auto value = description.value(index, sub);
    return value ? std::optional(static_cast<std::uint32_t>(*value)) : std::nullopt;
  };
  description.identity = {.device_type = number(0x1000, 0),
                          .vendor_id = number(0x1018, 1),
                          .product_code = number(0x1018, 2),
                          .revision = number(0x1018, 3),
                          .serial_number = number(0x1018, 4)};
  return description;
}

std::vector<text::FileError> ModuleNetwork::add_slave(const SlaveSection& slave,
                                                      const SlaveDescription& description, bool every_link) {
  namespace bit = manager::assignment_bit;
  constexpr std::uint32_t assigned = bit::slave | bit::boot_slave;
  const auto try_preset = [this](std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    return module_.preset_object(index, sub, canopen::little_endian(value, 4));
  };
  // Where slaves are not mandatory or optional, none is [FX2N-32CAN 8.2.2].
  const std::uint32_t mandatory = slave.mandatory ? bit::mandatory : 0;
  if (try_preset(0x1F81, slave.node, assigned | mandatory) != canopen::AbortCode::none)
    preset(0x1F81, slave.node, assigned, 4);
  const eds::Identity& identity = description.identity;
  const std::optional<std::uint32_t> expected[] = {identity.device_type, identity.vendor_id,
                                                   identity.product_code, identity.revision};
  for (std::size_t i = 0; i < std::size(expected); ++i) {
    const auto index = static_cast<std::uint16_t>(0x1F84 + i);
    if (!expected[i]) continue;
    const auto code = try_preset(index, slave.node, *expected[i]);
    const bool is_done = code == canopen::AbortCode::none || code == canopen::AbortCode::no_object;
    if (!is_done) preset(index, slave.node, *expected[i], 4);
  }
  using module::VariableDirection;
  const module::DataExchangeLayout& layout = module_.program_interface().process_data;
  const Direction receive{.receive = true,
                          .slave_pdo = "TPDO",
                          .slave_communication = 0x1800,
                          .slave_mapping = 0x1A00,
                          .module_communication = 0x1400,
                          .module_mapping = 0x1600,
                          .module_cob_id_bits = 0,
                          .first_word = layout.receive_first,
                          .words = variable_area(canopen::DataType::unsigned16, VariableDirection::output),
                          .bytes = variable_area(canopen::DataType::unsigned8, VariableDirection::output)};
  const Direction send{.receive = false,
                       .slave_pdo = "RPDO",
                       .slave_communication = 0x1400,
                       .slave_mapping = 0x1600,
                       .module_communication = 0x1800,
                       .module_mapping = 0x1A00,
                       .module_cob_id_bits = 0x4000'0000,
                       .first_word = layout.transmit_first,
                       .words = variable_area(canopen::DataType::unsigned16, VariableDirection::input),
                       .bytes = variable_area(canopen::DataType::unsigned8, VariableDirection::input)};
  std::vector<text::FileError> errors;
  std::string unconnected;
  bool any_connected = false;
  bool any_without_place = false;
  for (const Direction* direction : {&receive, &send}) {
    for (const SlaveSection::Link& link : direction->receive ? slave.receive : slave.send) {
      const auto refusal = connect(*direction, slave, link, description);
      any_connected = any_connected || !refusal;
      if (!refusal) continue;
      if (every_link) {
        errors.push_back({link.place, fmt::format("{}{} of node {}: {}", direction->slave_pdo, link.pdo,
                                                  slave.node, refusal->why)});
        continue;
      }
      any_without_place = any_without_place || !refusal->by_file;
      unconnected += fmt::format("{}{}{}: {}", unconnected.empty() ? "" : "; ", direction->slave_pdo,
                                 link.pdo, refusal->why);
    }
  }
  // An input device without outputs, and the like, is no news.
  if (!unconnected.empty() && (!any_connected || any_without_place)) {
    left_out_.push_back(fmt::format("connects {} of node {}{}: {}{}", any_connected ? "not all" : "nothing",
                                    slave.node,
                                    description.name.empty() ? "" : fmt::format(" ({})", description.name),
                                    unconnected, any_connected ? "" : others_of(description, slave.node)));
  }
  for (const std::string& refusal : refusals_) errors.push_back({slave.place, refusal});
  refusals_.clear();
  return errors;
}

std::optional<ModuleNetwork::Refusal> ModuleNetwork::connect(const Direction& direction,
                                                             const SlaveSection& slave,
                                                             const SlaveSection::Link& link,
                                                             const SlaveDescription& description) {
  if (!module_.presets_free_pdos()) {
    return Refusal{
        "in the module's function mode its PDOs are those of a device profile, with their own COB-IDs"};
  }
  if (!description.value) {
    return Refusal{"nothing is known of the node's PDOs; expected eds = its EDS or DCF file"};
  }
  const auto slave_value = [&](std::uint16_t base, std::uint8_t sub) {
    return description.value(static_cast<std::uint16_t>(base + link.pdo - 1), sub);
  };
  const auto cob_id = slave_value(direction.slave_communication, 1);
  if (!cob_id) return Refusal{"the device has no such PDO", true};
  if ((*cob_id & 0x8000'0000) != 0) {
    return Refusal{"the device's file leaves this PDO switched off (COB-ID bit 31)", true};
  }
  if ((*cob_id & 0x2000'0000) != 0) {
    return Refusal{"the PDO has a 29-bit identifier, which the module does not take"};
  }
  if (canopen::is_restricted(canopen::CobId{static_cast<std::uint32_t>(*cob_id)})) {
    return Refusal{fmt::format("CiA 301 restricts its CAN-ID {:03X}H", *cob_id & 0x7FF), true};
  }
  const auto entries = slave_value(direction.slave_mapping, 0).value_or(0);
  if (entries > 64) return Refusal{"the PDO is a multiplex PDO"};
  unsigned bits = 0;  // the bytes of the file, no more: the default TPDO1 may be shorter than four words
  std::vector<std::uint32_t> mapped;
  for (std::uint8_t i = 1; i <= entries; ++i) {
    mapped.push_back(static_cast<std::uint32_t>(slave_value(direction.slave_mapping, i).value_or(0)));
    bits += mapped.back() & 0xFF;
  }
  const unsigned length = (bits + 7) / 8;
  if (length == 0) return Refusal{"nothing is mapped into the PDO", true};
  if (length > 8) return Refusal{"more than 8 bytes are mapped into the PDO", true};
  const std::uint32_t words = (length + 1) / 2;

  const module::DataExchangeLayout& layout = module_.program_interface().process_data;
  std::uint32_t& next_word = direction.receive ? next_receive_word_ : next_send_word_;
  unsigned& used = direction.receive ? receive_pdos_ : send_pdos_;
  const auto wanted = link.address ? layout.word(direction.first_word, *link.address) : next_word;
  if (!wanted || *wanted + words > layout.words) {
    return Refusal{fmt::format("G{} is no place for {}; expected G{} to G{}",
                               link.address.value_or(layout.address(direction.first_word, next_word)),
                               ascii::counted(words, "word"), direction.first_word,
                               layout.address(direction.first_word, layout.words - words))};
  }
  if (used == layout.pdos) return Refusal{fmt::format("the module has no more than {} PDOs", layout.pdos)};
  const auto first = static_cast<std::uint32_t>(*wanted);
  next_word = std::max(next_word, first + 4);  // PDOs of up to 8 bytes line up on four words
  const auto communication = static_cast<std::uint16_t>(direction.module_communication + used);
  const auto mapping = static_cast<std::uint16_t>(direction.module_mapping + used);
  ++used;

  const auto identifier = static_cast<std::uint32_t>(*cob_id & 0x7FF);
  preset(communication, 1, 0x8000'0000 | direction.module_cob_id_bits | identifier, 4);
  preset(mapping, 0, 0, 1);
  std::uint8_t count = 0;
  for (std::uint32_t i = 0; i < length / 2; ++i) {
    preset(mapping, ++count, variable_mapping(direction.words, first + i, layout.variables), 4);
  }
  if (length % 2 != 0)
    preset(mapping, ++count,
           variable_mapping(direction.bytes, 2 * std::size_t{first + length / 2}, layout.variables), 4);
  preset(mapping, 0, count, 1);
  preset(communication, 1, direction.module_cob_id_bits | identifier, 4);
  std::string name(description.name);
  if (description.module != nullptr) name += own_words(*description.module, mapped);
  connections_.push_back(fmt::format("{}\\{} {} {}{} of node {}{}, {:03X}H, {}", slot_,
                                     words_text(layout, direction.first_word, first, words),
                                     direction.receive ? "<-" : "->", direction.slave_pdo, link.pdo,
                                     slave.node, name.empty() ? "" : fmt::format(" ({})", name), identifier,
                                     ascii::counted(length, "byte")));
  return std::nullopt;
}

void ModuleNetwork::become_master() { preset(0x1F80, 0, manager::start_up_bit::nmt_master, 4); }

}  // namespace canopus::plant
