#pragma once
// Sets a master module up for the network around it, as an engineer with the configuration software would:
// slave assignment and identification (1F80H, 1F81H, 1F84H-1F87H) and the PDOs that carry the slaves' data to
// and from the buffer memory. All of it lands in the module's own objects; nothing happens behind its back.

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/data_type.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/plant/file/plant_file.hpp"

namespace canopus::plant {

/// A slave's description for its master's configuration: from its device file, or from the settings of
/// another module.
struct SlaveDescription {
  std::string_view name{};
  eds::Identity identity{};
  /// The value of a sub-index of fixed length that the slave starts with; empty: it does not exist, or nothing
  /// is known of the slave.
  std::function<std::optional<std::uint64_t>(std::uint16_t index, std::uint8_t sub)> value{};
  const module::CommunicationModule* module = nullptr;  ///< it is this one

  [[nodiscard]] static SlaveDescription of(const eds::DeviceFile& file, std::uint8_t node_id,
                                           std::string_view name);
  /// By the presets of the plant file so far, not by what the module has saved. It must outlive the description.
  [[nodiscard]] static SlaveDescription of(const module::CommunicationModule& module, std::uint8_t node_id,
                                           std::string_view name);
};

class ModuleNetwork {
 public:
  ModuleNetwork(module::CommunicationModule& module, std::string slot)
      : module_(module), slot_(std::move(slot)) {}

  /// Assigns a slave and connects its PDOs. Without `every_link` what cannot be connected is no error;
  /// left_out() has it.
  [[nodiscard]] std::vector<text::FileError> add_slave(const SlaveSection& slave,
                                                       const SlaveDescription& description, bool every_link);
  /// The same; `file` is the slave's, as configured.
  [[nodiscard]] std::vector<text::FileError> add_slave(const SlaveSection& slave, const eds::DeviceFile& file,
                                                       std::string_view name, bool every_link) {
    return add_slave(slave, SlaveDescription::of(file, slave.node, name), every_link);
  }
  /// 1F80H bit 0: the module is the NMT master. Call it last.
  void become_master();
  /// The connections made, a line each.
  [[nodiscard]] const std::vector<std::string>& connections() const noexcept { return connections_; }
  /// Slaves of which nothing was connected, and PDOs that the module has no place for, with the reason.
  [[nodiscard]] const std::vector<std::string>& left_out() const noexcept { return left_out_; }

 private:
  struct Direction;
  /// Why a PDO cannot be connected.
  struct Refusal {
    std::string why;
    bool by_file = false;  ///< the slave has no such PDO, or none in use
  };
  std::optional<Refusal> connect(const Direction& direction, const SlaveSection& slave,
                                 const SlaveSection::Link& link, const SlaveDescription& description);
  void preset(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length);

  module::CommunicationModule& module_;
  std::string slot_;
  std::vector<std::string> connections_;
  std::vector<std::string> left_out_;
  std::vector<std::string> refusals_;
  unsigned receive_pdos_ = 0;  // used so far
  unsigned send_pdos_ = 0;
  std::uint32_t next_receive_word_ = 0;
  std::uint32_t next_send_word_ = 0;
};

}  // namespace canopus::plant
