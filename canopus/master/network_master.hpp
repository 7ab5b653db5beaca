#pragma once
// A CANopen master without a PLC: a node with the objects of CiA 302, an NmtMaster on it, and the slaves of a
// network file in its dictionary. A participant like any other: it runs on a real bus as well as on a
// simulated one.

#include <array>
#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "canopus/canopen/dictionary/object_stream.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/manager/nmt/master_node.hpp"
#include "canopus/master/network_file.hpp"

namespace canopus::master {

/// The events of the network, as they happen.
class NetworkObserver {
 public:
  /// The boot of a slave goes on: another step, or the same one with another object.
  virtual void boot_went_on(const NetworkSlave&, const manager::BootRecord&, can::Time) {}
  virtual void slave_booted(const NetworkSlave&, can::Time) {}
  virtual void slave_failed(const NetworkSlave&, const manager::BootRecord&, can::Time) {}
  virtual void state_changed(const NetworkSlave&, std::uint8_t /*node_state::...*/, can::Time) {}
  virtual void error_control_event(const NetworkSlave&, manager::ErrorControlEvent, can::Time) {}
  virtual void error_control_resolved(const NetworkSlave&, can::Time) {}
  /// A flying master: this node is the active master, or `master` is (0: none yet).
  virtual void master_changed(bool /*is_own*/, std::uint8_t /*master*/, can::Time) {}

 protected:
  ~NetworkObserver() = default;
};

class NetworkMaster final : public manager::MasterNode,
                            private manager::MasterListener,
                            private manager::ConfigurationSource {
 public:
  /// Opens the device files and programs. Errors name the line of the network file. `sink` and `observer`
  /// outlive it.
  [[nodiscard]] static std::expected<std::unique_ptr<NetworkMaster>, std::vector<text::FileError>> build(
      const NetworkFile& file, can::Sink& sink, NetworkObserver& observer);
  ~NetworkMaster() override = default;
  NetworkMaster(const NetworkMaster&) = delete;
  NetworkMaster& operator=(const NetworkMaster&) = delete;

  /// SDO requests of the start-up are given up after this.
  void set_sdo_time_out(can::Duration time_out) noexcept { master().options().sdo_time_out = time_out; }
  /// It has ended: halted by a mandatory slave, or all mandatory slaves are booted and every optional one is
  /// booted, failed or did not answer. Never while another flying master is the active one.
  [[nodiscard]] bool start_up_over() const;
  /// The result for a slave.
  enum class Result : std::uint8_t {
    booted,
    absent,                     ///< optional, does not answer
    given_up,                   ///< the start-up ended with another slave before this one was booted
    failed,                     ///< or mandatory and not booted
    left_to_the_active_master,  ///< this flying master stands by
  };
  [[nodiscard]] Result result(const NetworkSlave& slave) const;
  [[nodiscard]] std::span<const NetworkSlave> slaves() const noexcept { return file_.slaves; }
  /// The concise DCF that a slave is given.
  std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) override { return files_[node_id]; }
  manager::Program open_program(std::uint8_t node_id) override;

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;

 private:
  NetworkMaster(const NetworkFile& file, can::Sink& sink, NetworkObserver& observer);
  void store_flying(const manager::FlyingMasterTiming& timing);
  std::vector<text::FileError> prepare(const NetworkSlave& slave);
  /// A file whose name is relative to the network file. The error is a sentence.
  [[nodiscard]] std::expected<std::string, std::string> read_beside(const std::string& name) const;
  /// The device file's identity and configuration.
  std::expected<eds::Identity, std::vector<text::FileError>> prepare_device(const NetworkSlave& slave);
  void expect_configuration(std::uint8_t node_id);
  void report_master(can::Time now);
  void store(std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    stored_.push_back({index, sub, value});
  }
  [[nodiscard]] const NetworkSlave* find(std::uint8_t node_id) const;

  // manager::MasterNode
  void configure(canopen::ObjectDictionary& objects) override;
  // manager::MasterListener
  void start_up_finished(can::Time now) override;
  void boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) override;
  void slave_booted(std::uint8_t node_id, can::Time now) override;
  void slave_failed(std::uint8_t node_id, manager::BootError error, can::Time now) override;
  void error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event, can::Time now) override;
  void error_control_resolved(std::uint8_t node_id, can::Time now) override;
  void node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time now) override;

  struct Stored {
    std::uint16_t index;
    std::uint8_t sub;
    std::uint32_t value;
  };
  NetworkFile file_;
  NetworkObserver& observer_;
  std::vector<Stored> stored_;
  std::array<std::vector<std::uint8_t>, 128> files_;
  std::array<std::string, 128> programs_;
  std::array<canopen::MemorySource, 128> program_readers_;
  bool finished_ = false;
  std::uint8_t reported_master_ = 0;
  unsigned watched_ = 0;  // entries of 1016H in use
};

/// "node 2 (io-block)"
[[nodiscard]] std::string describe(const NetworkSlave& slave);

}  // namespace canopus::master
