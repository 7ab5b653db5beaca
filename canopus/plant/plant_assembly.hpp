#pragma once
// The inside of assemble(): what makes the parts of a plant from its file. Only its sources include this.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/eds/device_file.hpp"
#include "canopus/module/interface/download.hpp"
#include "canopus/plant/module_network.hpp"
#include "canopus/plant/plant_parts.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::plant {

/// Gives a module the settings that its section of the plant file names, as factory settings. What it does not take is
/// reported with its place in the file; the module's rules are its own. Bit rate of the bus, node-ID and words; and whether
/// the built-in PLC program can do what it is asked for.
[[nodiscard]] std::vector<text::FileError> preset_words(module::CommunicationModule& module,
                                                        const module::DataSheet& data_sheet,
                                                        const ModuleSection& section, const BusSection& bus);
/// Sets its objects; this overrides earlier settings.
[[nodiscard]] std::vector<text::FileError> preset_objects(module::CommunicationModule& module,
                                                          const ModuleSection& section);
/// Words and objects of the engineering tools' parameters, and whether refresh fits.
[[nodiscard]] std::vector<text::FileError> give_parameters(module::CommunicationModule& module,
                                                           const ModuleSection& section);
/// The settings of another node as a concise DCF: PDOs are switched off first, their COB-IDs come last.
[[nodiscard]] std::vector<std::uint8_t> concise_dcf_of(const ParametersSection::Node& node,
                                                       const canopen::DictionaryDescription& dictionary,
                                                       text::FileErrors& errors);

/// The bit rates of a module, bit/s, rising.
[[nodiscard]] std::vector<unsigned> bit_rates_of(const module::DataSheet& data_sheet);
/// The module's own parameters of its download, without the node list. A bit rate that the module does not have is left out.
[[nodiscard]] module::Download module_parameters(const module::DataSheet& data_sheet,
                                                 const ModuleSection& section, const BusSection& bus);

/// Builds a plant's parts, collecting every error on the way.
class Assembly {
 public:
  Assembly(Plant::Parts& parts, PlantObserver& observer, std::uint64_t seed, BusOpener* opener)
      : parts_(parts),
        observer_(observer),
        seed_(seed),
        opener_(opener),
        folder_(std::filesystem::path(parts.file.path).parent_path()),
        stores_(parts.stores.emplace(folder_)) {}

  std::vector<text::FileError> run();

 private:
  using File = std::shared_ptr<const eds::DeviceFile>;

  File load(const std::string& eds, text::Place place);
  File configured(const File& file, const DeviceSection& section);
  void add_device(const DeviceSection& section, std::size_t number);
  std::uint8_t node_id(const DeviceSection& section, const eds::DeviceFile& file);
  can::Port& add_port(const DeviceSection& section, std::uint8_t node_id, std::size_t number);
  void give_memory(const DeviceSection& section, std::uint8_t node_id, DeviceOnBus& seat);
  void give_drive(const DriveSection& section, DeviceOnBus& seat);
  void move_values(const DeviceSection& section, std::size_t number, DeviceOnBus& seat);
  void play_back(const PlaybackSection& section, sim::Device& device);
  /// The rack of a PLC, with its program.
  void add_rack(const PlcSection& plc, std::size_t number);
  void add_module(const PlcSection& plc, std::size_t plc_number, const ModuleSection& section);
  /// A slave of a master, as written in the plant file, or by slaves = "all".
  struct WantedSlave {
    SlaveSection slave{};
    const SlaveSection* written = nullptr;  // nullptr: by slaves = "all"
  };
  static std::optional<WantedSlave> wanted_slave(const ModuleSection& master, const NodeLabel& node);
  /// Concise DCFs of the other nodes' settings, and the CPU's refresh.
  void add_parameters(const ModuleSection& section, std::size_t plc_number,
                      module::CommunicationModule& module);
  /// A node that a section of the plant file is about.
  struct WantedNode {
    text::Place place{};
    std::uint8_t node = 0;
    std::string eds{};  ///< of one outside of the plant
    text::Place eds_place{};
    std::string_view what{};  ///< the section
  };
  const canopen::DictionaryDescription* dictionary_of(const ModuleSection& section, const WantedNode& node);
  /// The node list that CANopen Builder has downloaded.
  void add_download(ModuleInRack& seat);
  void configure_network(const ModuleSection& section, module::CommunicationModule& module);
  void add_outside_slave(const ModuleSection& master, const SlaveSection& slave, ModuleNetwork& network);
  void add_bus(const BusSection& section);
  void add_bridge(const BridgeSection& section);
  void set_faults(const BusSection& section, sim::Bus& bus);
  void set_line(const BusSection& section, sim::Bus* bus);
  void review_buses();
  NodeRegistry& watch(const can::Bus& bus);
  /// The part of the plant that a bus of the plant file belongs to.
  [[nodiscard]] std::size_t partition_of(std::string_view bus) const;
  can::Timeline& timeline_of(std::string_view bus) { return parts_.timeline_of(partition_of(bus)); }
  PlantObserver& observer_of(std::string_view bus) { return *parts_.events[partition_of(bus)]; }
  void divide();
  template <typename... T>
  void warn(text::Place place, fmt::format_string<T...> text, T&&... arguments) {
    parts_.warnings.push_back({place, fmt::format(text, std::forward<T>(arguments)...)});
  }

  Plant::Parts& parts_;
  PlantObserver& observer_;
  std::uint64_t seed_;
  BusOpener* opener_;
  std::filesystem::path folder_;
  PlantStores& stores_;
  std::map<std::string, File> files_;
  std::map<std::string, File>
      configured_;  // of them with values of the plant file: by the file and the values
  std::set<std::pair<std::string, std::uint8_t>> nodes_;  // bus, node-ID
  std::vector<std::pair<const DeviceSection*, DeviceOnBus*>> device_sections_;
  std::vector<std::pair<const ModuleSection*, ModuleInRack*>> module_sections_;
  std::vector<std::size_t> module_plcs_;  // of each module
  bool complete_ = true;                  // nothing had to be left out
  text::FileErrors errors_;
};

}  // namespace canopus::plant
