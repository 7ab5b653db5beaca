#include "canopus/module/models/as_fcopm/configuration.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "canopus/ascii/hex.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/module/models/as_fcopm/register_table.hpp"

namespace canopus::module::as_fcopm {

namespace {

constexpr std::uint32_t not_valid = 0x80000000;
constexpr std::uint16_t producer_heartbeat = 0x1017;
constexpr std::uint16_t identifiers_per_pdo = 0x100;

/// [10.3.3] PDO 1 to 4.
std::optional<std::uint16_t> cob_id_of(const SlavePdo& pdo, std::uint8_t node_id, bool transmit) {
  if (pdo.cob_id) return pdo.cob_id;
  if (pdo.number > 4) return std::nullopt;
  const unsigned first = transmit ? 0x180U : 0x200U;
  return static_cast<std::uint16_t>(first + identifiers_per_pdo * (pdo.number - 1U) + node_id);
}

std::string hexadecimal(unsigned number) { return ascii::hex(number, 3) + 'H'; }

struct Checker {
  std::vector<std::string> sentences{};
  std::set<unsigned> cob_ids{};

  static std::string text_of(std::string_view text) { return std::string(text); }
  static std::string text_of(std::size_t number) { return std::to_string(number); }
  /// Each {} is the next argument.
  template <typename... Arguments>
  void add(std::string_view text, const Arguments&... arguments) {
    std::string sentence(text);
    ((sentence.replace(sentence.find("{}"), 2, text_of(arguments))), ...);
    sentences.push_back(std::move(sentence));
  }

  void pdos(const SlaveSetting& slave, const std::vector<SlavePdo>& list, bool transmit) {
    const char* const kind = transmit ? "TxPDO" : "RxPDO";
    std::set<unsigned> numbers;
    for (const SlavePdo& pdo : list) {
      if (pdo.number < 1 || pdo.number > 512)
        add("node {}: {}{}: a PDO's number is 1 to 512", slave.node_id, kind, pdo.number);
      if (!numbers.insert(pdo.number).second)
        add("node {}: {}{} is there already", slave.node_id, kind, pdo.number);
      if (pdo.type > 240 && pdo.type < 254) {
        add("node {}: {}{}: transmission type {}; expected 0 to 240, 254 or 255", slave.node_id, kind,
            pdo.number, pdo.type);
      }
      const bool sizes_are_good = std::ranges::all_of(pdo.objects, [](const MappedObject& object) {
        return object.bits == 8 || object.bits == 16 || object.bits == 32 || object.bits == 64;
      });
      if (!sizes_are_good)
        add("node {}: {}{}: objects of 8, 16, 32 and 64 bits can be mapped", slave.node_id, kind, pdo.number);
      if (pdo.bytes() < 1 || pdo.bytes() > 8) {
        add("node {}: {}{} has {} bytes; expected 1 to 8", slave.node_id, kind, pdo.number, pdo.bytes());
      }
      const auto cob_id = cob_id_of(pdo, slave.node_id, transmit);
      if (!cob_id) {
        add("node {}: {}{} has no COB-ID of the predefined connection set; cob_id is missing", slave.node_id,
            kind, pdo.number);
      } else if (*cob_id <= 0x180 || *cob_id > 0x57F) {
        add("node {}: {}{}: COB-ID {}; expected 181H to 57FH", slave.node_id, kind, pdo.number,
            hexadecimal(*cob_id));
      } else if (!cob_ids.insert(*cob_id).second) {
        add("node {}: {}{}: COB-ID {} is another PDO's already", slave.node_id, kind, pdo.number,
            hexadecimal(*cob_id));
      }
    }
  }
};

unsigned padded_bytes(const std::vector<SlavePdo>& pdos) {
  unsigned bytes = 0;
  for (const SlavePdo& pdo : pdos) bytes += (pdo.bytes() + 1) / 2 * 2;
  return bytes;
}

void place(const SlaveSetting& slave, const std::vector<SlavePdo>& pdos, bool transmit,
           std::vector<PdoPlace>& places) {
  for (const SlavePdo& pdo : pdos) {
    const std::size_t first = places.empty() ? 0 : places.back().first_word + (places.back().bytes + 1) / 2;
    places.push_back({.node_id = slave.node_id,
                      .pdo = &pdo,
                      .first_word = first,
                      .bytes = pdo.bytes(),
                      .cob_id = cob_id_of(pdo, slave.node_id, transmit).value_or(0)});
  }
}

void write_pdo(manager::ConciseDcfWriter& file, const SlavePdo& pdo, std::uint8_t node_id, bool transmit) {
  const auto parameters = static_cast<std::uint16_t>((transmit ? 0x1800 : 0x1400) + pdo.number - 1);
  const auto mapping = static_cast<std::uint16_t>(parameters + 0x200);
  const std::uint32_t cob_id = cob_id_of(pdo, node_id, transmit).value_or(0);
  file.add(parameters, 1, not_valid | cob_id, 4);
  file.add(parameters, 2, pdo.type, 1);
  if (pdo.inhibit_time && transmit) file.add(parameters, 3, *pdo.inhibit_time, 2);
  if (pdo.event_timer && transmit) file.add(parameters, 5, *pdo.event_timer, 2);
  if (pdo.writes_mapping) {
    file.add(mapping, 0, 0, 1);
    std::uint8_t sub = 0;
    for (const MappedObject& object : pdo.objects) {
      const std::uint32_t entry =
          std::uint32_t{object.index} << 16 | std::uint32_t{object.sub} << 8 | object.bits;
      file.add(mapping, ++sub, entry, 4);
    }
    file.add(mapping, 0, pdo.objects.size(), 1);
  }
  file.add(parameters, 1, cob_id, 4);
}

}  // namespace

std::vector<std::string> check(const Configuration& configuration) {
  Checker errors;
  if (configuration.node_id < 1 || configuration.node_id > 127)
    errors.add("node-ID {}; expected 1 to 127", configuration.node_id);
  if (std::ranges::find(bit_rates, configuration.bit_rate) == bit_rates.end()) {
    std::string known;
    for (const std::uint16_t rate : bit_rates) known += (known.empty() ? "" : ", ") + std::to_string(rate);
    errors.add("{} kbit/s; expected one of {}", configuration.bit_rate, known);
  }
  if (configuration.work_mode == WorkMode::slave) {
    if (!configuration.slaves.empty()) errors.add("a slave has no node list");
    return errors.sentences;
  }
  if (configuration.slaves.size() > most_slaves)
    errors.add("{} slaves; expected at most {}", configuration.slaves.size(), most_slaves);
  std::set<unsigned> nodes;
  std::size_t received = 0, sent = 0;
  unsigned received_bytes = 0, sent_bytes = 0;
  for (const SlaveSetting& slave : configuration.slaves) {
    if (slave.node_id < 1 || slave.node_id > most_slaves)
      errors.add("node {}: the nodes of slaves are 1 to {}", slave.node_id, most_slaves);
    if (!nodes.insert(slave.node_id).second) errors.add("node {} is in the node list already", slave.node_id);
    if (slave.auto_sdos.size() > most_auto_sdos) {
      errors.add("node {}: {} auto SDOs; expected at most {}", slave.node_id, slave.auto_sdos.size(),
                 most_auto_sdos);
    }
    if (slave.heartbeat != 0 && slave.heartbeat_time_out <= slave.heartbeat)
      errors.add("node {}: the heartbeat's time-out must be longer than its time", slave.node_id);
    errors.pdos(slave, slave.rx_pdos, false);
    errors.pdos(slave, slave.tx_pdos, true);
    received += slave.tx_pdos.size();
    sent += slave.rx_pdos.size();
    received_bytes += padded_bytes(slave.tx_pdos);
    sent_bytes += padded_bytes(slave.rx_pdos);
  }
  if (received > most_pdos) errors.add("{} TxPDOs; expected at most {}", received, most_pdos);
  if (sent > most_pdos) errors.add("{} RxPDOs; expected at most {}", sent, most_pdos);
  if (received_bytes > most_process_bytes)
    errors.add("the TxPDOs take {} bytes; expected at most {}", received_bytes, most_process_bytes);
  if (sent_bytes > most_process_bytes)
    errors.add("the RxPDOs take {} bytes; expected at most {}", sent_bytes, most_process_bytes);
  return errors.sentences;
}

std::vector<std::string> check_download(Configuration configuration) {
  configuration.node_id = 1;
  return check(configuration);
}

Layout lay_out(const Configuration& configuration) {
  Layout layout;
  for (const SlaveSetting& slave : configuration.slaves) {
    place(slave, slave.tx_pdos, true, layout.received);
    place(slave, slave.rx_pdos, false, layout.sent);
  }
  return layout;
}

std::vector<std::uint8_t> concise_dcf(const SlaveSetting& slave) {
  manager::ConciseDcfWriter file;
  for (const SlavePdo& pdo : slave.rx_pdos) write_pdo(file, pdo, slave.node_id, false);
  for (const SlavePdo& pdo : slave.tx_pdos) write_pdo(file, pdo, slave.node_id, true);
  if (slave.heartbeat != 0) file.add(producer_heartbeat, 0, slave.heartbeat, 2);
  for (const AutoSdo& sdo : slave.auto_sdos) file.add(sdo.index, sdo.sub, sdo.value);
  return file.file();
}

WrittenFor written_for(const SlaveSetting& slave, std::uint16_t index, std::uint8_t sub) {
  const bool is_pdo = index >= 0x1400 && index < 0x1C00;
  const auto belongs = [&](const std::vector<SlavePdo>& pdos, std::uint16_t first) {
    return std::ranges::any_of(pdos, [&](const SlavePdo& pdo) {
      const auto parameters = static_cast<std::uint16_t>(first + pdo.number - 1);
      return index == parameters || index == parameters + 0x200;
    });
  };
  if (is_pdo && (belongs(slave.rx_pdos, 0x1400) || belongs(slave.tx_pdos, 0x1800)))
    return WrittenFor::pdo_parameter;
  if (index == producer_heartbeat && sub == 0 && slave.heartbeat != 0) return WrittenFor::error_control;
  return WrittenFor::auto_sdo;
}

}  // namespace canopus::module::as_fcopm
