#pragma once
// The card as master: the node list, its process data, and requests of the program [AS-FCOPM 10.4, 10.5, 10.6].

#include <array>
#include <cstdint>
#include <vector>

#include "canopus/manager/nmt/nmt_master.hpp"
#include "canopus/module/models/as_fcopm/codes.hpp"
#include "canopus/module/models/as_fcopm/emergency_log.hpp"
#include "canopus/module/models/as_fcopm/message_requests.hpp"
#include "canopus/module/models/as_fcopm/role.hpp"

namespace canopus::module::as_fcopm {

/// What the master shows of each node: its code at SR830 on, its flag at SR826 on [AS-FCOPM 10.5.1].
///
/// Several causes may be there at once; each comes and goes by itself, and the register shows the gravest. The manual
/// prints no order: what keeps the slave out of the network comes first, then what keeps it from being started, then
/// its PDOs, then its emergency message.
class NodeStates {
 public:
  static constexpr unsigned nodes = 64;

  void clear() noexcept { causes_.fill(0); }
  void set(std::uint8_t node_id, NodeCode cause, bool there) noexcept {
    if (node_id < 1 || node_id > nodes) return;
    std::uint16_t& causes = causes_[node_id - 1U];
    const auto bit = static_cast<std::uint16_t>(1U << (static_cast<unsigned>(cause) & 0xFU));
    causes = static_cast<std::uint16_t>(there ? causes | bit : causes & ~bit);
  }
  [[nodiscard]] bool has(std::uint8_t node_id, NodeCode cause) const noexcept {
    return node_id >= 1 && node_id <= nodes &&
           (causes_[node_id - 1U] >> (static_cast<unsigned>(cause) & 0xFU) & 1U) != 0;
  }
  /// SR830 + node_id - 1, node 1..64.
  [[nodiscard]] std::uint16_t code(std::uint8_t node_id) const noexcept {
    for (const NodeCode cause : order)
      if (has(node_id, cause)) return static_cast<std::uint16_t>(cause);
    return 0;
  }
  /// SR826 + `word`, 0..3.
  [[nodiscard]] std::uint16_t flags(unsigned word) const noexcept {
    unsigned flags = 0;
    for (unsigned bit = 0; bit < 16; ++bit)
      if (causes_[16 * word + bit] != 0) flags |= 1U << bit;
    return static_cast<std::uint16_t>(flags);
  }

 private:
  static constexpr std::array order{NodeCode::same_node_id,  NodeCode::not_there,     NodeCode::error_control,
                                    NodeCode::key_parameter, NodeCode::pdo_parameter, NodeCode::auto_sdo,
                                    NodeCode::pdo_length,    NodeCode::pdo_missing,   NodeCode::emergency};
  std::array<std::uint16_t, nodes> causes_{};
};

class MasterRole final : public Role,
                         private canopen::NodeListener,
                         private manager::MasterListener,
                         private manager::ConfigurationSource {
 public:
  /// A configuration that check() finds good. `sink` must outlive it; `observer` is where the owner keeps its own.
  MasterRole(Configuration configuration, can::Sink& sink, const Profile& profile,
             ModuleObserver* const& observer);

  [[nodiscard]] const canopen::Node& node() const noexcept override { return node_; }
  void start(can::Time now) override;
  void stop(can::Time now) override;
  [[nodiscard]] std::uint16_t read(BufferAddress address) const noexcept override;
  void write(BufferAddress address, std::uint16_t value, can::Time now) override;
  [[nodiscard]] OwnCode code() const noexcept override {
    return receives_unlisted_ ? OwnCode::not_in_node_list : OwnCode::none;
  }
  [[nodiscard]] OwnCode download_code() const noexcept override { return OwnCode::downloading; }
  [[nodiscard]] StartUp start_up() const noexcept override;
  [[nodiscard]] std::vector<SlaveBootRecord> boots() const override;
  [[nodiscard]] std::vector<canopen::Emergency> emergency_history() const override {
    return emergencies_.all();
  }

  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;

 private:
  /// A PDO from a slave, and when it is missed.
  struct Received {
    PdoPlace place;
    can::Duration patience{};  // 0: its period is unknown
    can::Time due = can::never;
    bool is_missing = false;
    bool is_wrong = false;      // its length
    bool taken_longer = false;  // its data come although there were more
  };
  struct Sent {
    PdoPlace place;
    std::array<std::uint8_t, 8> there{};  // what the slave has
    bool was_sent = false;                // since the slave was booted
    bool is_due = false;                  // the slave may have missed it
  };

  // NodeListener
  void reset_requested(canopen::NmtCommand, can::Time now) override { master_.stop(now); }
  void reset_done(canopen::NmtCommand, can::Time now) override { master_.start(now); }
  void nmt_state_changed(canopen::NmtState state, can::Time now) override;
  void rpdo_received(std::uint16_t number, can::Time now) override;
  void rpdo_length_wrong(std::uint16_t number, std::uint16_t code, can::Time now) override;
  void emergency_received(const canopen::Emergency& message, can::Time now) override;
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) override {
    master_.heartbeat_received(node_id, state, now);
  }
  void heartbeat_lost(std::uint8_t node_id, can::Time now) override { master_.heartbeat_lost(node_id, now); }
  // MasterListener
  void boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) override;
  void error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event, can::Time now) override;
  void node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time now) override;
  // ConfigurationSource
  std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) override;

  void boot_failed(std::uint8_t node_id, const manager::BootRecord& record);
  void send_changes(can::Time now);
  void watch(Received& pdo, can::Time now);
  void end_watch(std::uint8_t node_id);
  void check_missing(can::Time now);
  void show_pdos_of(std::uint8_t node_id);
  /// It has what it was to be configured with: what its PDOs carry is what the registers are for.
  [[nodiscard]] bool is_configured(std::uint8_t node_id) const noexcept {
    return master_.boot_record(node_id).step == manager::BootStep::booted;
  }
  [[nodiscard]] bool operates(std::uint8_t node_id) const noexcept {
    return node_.state() == canopen::NmtState::operational && is_configured(node_id) &&
           master_.node_state(node_id) == manager::node_state::operational;
  }

  const Configuration configuration_;
  ModuleObserver* const& observer_;
  std::vector<Received> received_;
  std::vector<Sent> sent_;
  std::array<std::vector<std::uint8_t>, most_slaves + 1> files_;  // by node-ID; empty: not in the list
  std::array<const SlaveSetting*, most_slaves + 1> slaves_{};
  canopen::Node node_;
  manager::NmtMaster master_;
  NodeStates states_;
  EmergencyLog emergencies_;
  MessageRequests requests_;
  std::array<std::uint16_t, message_words> request_{};
  std::array<std::uint16_t, process_words> inputs_{};
  std::array<std::uint16_t, process_words> outputs_{};
  bool receives_unlisted_ = false;
  can::Alarm next_scan_;
  can::Alarm next_missing_;  // no PDO is missed before
};

}  // namespace canopus::module::as_fcopm
