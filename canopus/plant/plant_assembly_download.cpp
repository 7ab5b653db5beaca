// The download of a configuration tool for a module: the node list, with slaves by their EDS files.

#include <algorithm>
#include <utility>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/module/interface/download.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/plant_assembly.hpp"
#include "canopus/sim/device/behaviour.hpp"

namespace canopus::plant {

namespace {

/// 0: the same as no expectation.
std::optional<std::uint32_t> expected(const canopen::DictionaryDescription& dictionary, std::uint16_t index,
                                      std::uint8_t sub, std::uint8_t node) {
  const auto value = eds::default_value(dictionary, index, sub, node);
  if (!value || *value == 0) return std::nullopt;
  return static_cast<std::uint32_t>(*value);
}

class SlaveCompiler {
 public:
  SlaveCompiler(const DownloadSection::Slave& section, const canopen::DictionaryDescription& dictionary,
                text::FileErrors& errors)
      : section_(section), dictionary_(dictionary), errors_(errors) {}

  module::DownloadedSlave run() {
    module::DownloadedSlave slave{.node_id = section_.node};
    slave.device_type = expected(dictionary_, 0x1000, 0, section_.node);
    slave.vendor = expected(dictionary_, 0x1018, 1, section_.node);
    slave.product = expected(dictionary_, 0x1018, 2, section_.node);
    slave.heartbeat = section_.heartbeat.value_or(0);
    slave.heartbeat_time_out = section_.heartbeat_time_out.value_or(
        static_cast<std::uint16_t>(std::min(65535, 2 * slave.heartbeat)));
    for (const DownloadSection::Pdo& pdo : section_.rx_pdos) slave.rx_pdos.push_back(compile(pdo, false));
    for (const DownloadSection::Pdo& pdo : section_.tx_pdos) slave.tx_pdos.push_back(compile(pdo, true));
    for (const text::ObjectSetting& setting : section_.auto_sdos) compile(setting, slave);
    return slave;
  }

 private:
  module::DownloadedPdo compile(const DownloadSection::Pdo& section, bool transmit) {
    const auto parameters = static_cast<std::uint16_t>((transmit ? 0x1800 : 0x1400) + section.number - 1);
    const auto mapping = static_cast<std::uint16_t>(parameters + 0x200);
    module::DownloadedPdo pdo{.number = section.number,
                              .cob_id = section.cob_id,
                              .type = section.type,
                              .inhibit_time = section.inhibit_time,
                              .event_timer = section.event_timer};
    const auto name = fmt::format("{}PDO{}", transmit ? "Tx" : "Rx", section.number);
    if (dictionary_.find(parameters) == nullptr)
      errors_.add(section.place, "node {} has no {} ({})", section_.node, name,
                  canopen::object_name(parameters));
    const canopen::Entry count = dictionary_.find(mapping, 0);
    pdo.writes_mapping = count && canopen::is_writable(count.description->access);
    for (const DownloadSection::Object& mapped : section.objects) {
      const auto [index, sub] = mapped.object;
      const canopen::Entry entry = dictionary_.find(index, sub);
      if (!entry) {
        errors_.add(mapped.place, "node {} has no object {}", section_.node,
                    canopen::object_text(index, sub));
        continue;
      }
      if (!(transmit ? entry.description->tpdo_mappable : entry.description->rpdo_mappable)) {
        errors_.add(mapped.place, "{} of node {} cannot be mapped into {}", canopen::object_text(index, sub),
                    section_.node, transmit ? "a TxPDO" : "an RxPDO");
        continue;
      }
      pdo.objects.push_back({index, sub, static_cast<std::uint8_t>(8 * entry.description->length)});
    }
    return pdo;
  }

  void compile(const text::ObjectSetting& setting, module::DownloadedSlave& slave) {
    const auto [index, sub] = setting.object;
    const canopen::Entry entry = dictionary_.find(index, sub);
    if (!entry) {
      errors_.add(setting.place, "auto_sdo: node {} has no object {}", section_.node,
                  canopen::object_text(index, sub));
      return;
    }
    auto bytes = text::encode(setting.value, entry.description->type);
    if (!bytes) {
      errors_.add(setting.place, "auto_sdo: {}: {}", canopen::object_text(index, sub), bytes.error());
    } else {
      slave.auto_sdos.push_back({index, sub, std::move(*bytes)});
    }
  }

  const DownloadSection::Slave& section_;
  const canopen::DictionaryDescription& dictionary_;
  text::FileErrors& errors_;
};

/// An object that has another value every few milliseconds, as a velocity has.
bool changes_fast(const DeviceSection& device, const text::ObjectName& object) {
  constexpr auto fast = std::chrono::milliseconds(100);
  if (device.drive && (object.index == 0x6064 || object.index == 0x606C)) return true;  // position, velocity
  return std::ranges::any_of(device.behaviours, [&](const BehaviourSection& moving) {
    if (moving.object.index != object.index || moving.object.sub != object.sub) return false;
    if (moving.kind == "sine" || moving.kind == "ramp") return true;
    const bool steps = moving.kind == "counter" || moving.kind == "noise";
    return steps && moving.period.value_or(sim::Behaviour{}.period) <= fast;
  });
}

/// A TxPDO that is sent at each change, of an object that changes fast: "otherwise, the bus is busy with it" [AS-FCOPM 10.6].
void advise_synchronous(const DownloadSection::Slave& slave, const DeviceSection& device,
                        std::vector<text::FileWarning>& warnings) {
  constexpr std::uint8_t last_synchronous = 240;
  for (const DownloadSection::Pdo& pdo : slave.tx_pdos) {
    if (pdo.type <= last_synchronous || pdo.inhibit_time.value_or(0) != 0) continue;
    const auto found = std::ranges::find_if(
        pdo.objects, [&](const auto& mapped) { return changes_fast(device, mapped.object); });
    if (found == pdo.objects.end()) continue;
    warnings.push_back(
        {pdo.place, fmt::format("node {}: TxPDO{} of type {} is sent at each change of {}, which changes "
                                "all the time; a synchronous type (1 to 240) keeps the bus free",
                                slave.node, pdo.number, pdo.type,
                                canopen::object_text(found->object.index, found->object.sub))});
  }
}

}  // namespace

module::Download module_parameters(const module::DataSheet& data_sheet, const ModuleSection& section,
                                   const BusSection& bus) {
  module::Download parameters;
  if (section.node != 0) parameters.node_id = section.node;
  if (std::ranges::binary_search(bit_rates_of(data_sheet),
                                 bus.bit_rate))  // preset_words() reports another one
    parameters.bit_rate = static_cast<std::uint16_t>(bus.bit_rate / 1000);
  if (!section.download) return parameters;
  const DownloadSection& download = *section.download;
  if (download.is_slave) parameters.work_mode = module::Download::WorkMode::slave;
  parameters.node_id = download.wrong_node_id.value_or(static_cast<std::uint8_t>(parameters.node_id));
  parameters.cycle_period = download.cycle_period.value_or(parameters.cycle_period);
  parameters.master_heartbeat = download.master_heartbeat.value_or(parameters.master_heartbeat);
  return parameters;
}

void Assembly::add_download(ModuleInRack& seat) {
  const ModuleSection& section = seat.section();
  const CatalogueEntry& entry = *find_module(section.model);
  if (!section.download || entry.download == nullptr) return;
  const auto bus = std::ranges::find(parts_.file.buses, section.bus, &BusSection::name);
  module::Download download = module_parameters(*entry.data_sheet, section, *bus);
  text::FileErrors found;
  bool complete = true;
  for (const DownloadSection::Slave& slave : section.download->slaves) {
    const auto* dictionary =
        dictionary_of(section, {slave.place, slave.node, slave.eds, slave.eds_place, "download"});
    const auto is_empty = [](const DownloadSection::Pdo& pdo) { return pdo.objects.empty(); };  // reported
    complete = complete && dictionary != nullptr && std::ranges::none_of(slave.rx_pdos, is_empty) &&
               std::ranges::none_of(slave.tx_pdos, is_empty);
    if (dictionary != nullptr) download.slaves.push_back(SlaveCompiler(slave, *dictionary, found).run());
    const auto device = std::ranges::find_if(parts_.file.devices, [&](const DeviceSection& each) {
      return each.bus == section.bus && each.node == slave.node;
    });
    if (device != parts_.file.devices.end()) advise_synchronous(slave, *device, parts_.warnings);
  }
  if (section.download->wrong_node_id) {
    warn(section.download->place, "download: node_id = {} is no node-ID: the {} stays off the bus",
         *section.download->wrong_node_id, section.model);
  }
  if (complete && found.empty()) {
    if (section.download->again_at) seat.download_again(download, *section.download->again_at);
    for (const std::string& error : entry.download(seat.module(), std::move(download), {}))
      found.add(section.download->place, "download: {}", error);
  }
  errors_.add(found.release());
}

}  // namespace canopus::plant
