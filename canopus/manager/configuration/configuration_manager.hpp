#pragma once
// Configuration manager [CiA 302-3]: the concise DCFs of the slaves as the objects 1F22H (the files), their
// programs as 1F58H, and 1F25H (request: "conf" = 666E6F63H configures a node now, sub-index 80H all that
// have a file). It is the ConfigurationSource of its NmtMaster, which downloads the files while it boots
// slaves.
//
// A request for the own node does nothing and is no error; one for a node without a file ends with no_data. A
// request for all does nothing where no other node has a file; a node that is not the active master refuses it. A
// slave that is being booted meanwhile is left out: it gets its file in the course of the boot, if it needs
// it.
//
// The files themselves must outlive the node's resets and, in a device, power cuts: a ConfigurationStore
// keeps them. Flash needs its time; while it is busy, writes are refused.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/manager/nmt/nmt_master.hpp"

namespace canopus::manager {

/// Where files are put to last.
class ConfigurationStore {
 public:
  /// Keeps the file of a node; an empty one: there is none any longer. False: it could not be written.
  virtual bool store(std::uint8_t node_id, std::span<const std::uint8_t> file) = 0;
  /// The same for a node's program [1F58H].
  virtual bool store_program(std::uint8_t /*node_id*/, std::span<const std::uint8_t> /*program*/) {
    return true;
  }

 protected:
  ~ConfigurationStore() = default;
};

struct ConfigurationOptions {
  unsigned maximum_files = 127;
  std::size_t maximum_size = 0;          ///< bytes of one file; 0 = no limit
  std::size_t maximum_program_size = 0;  ///< bytes of one program; 0 = no limit
  /// A file must be deleted before another is written in its place [ME3CAN1-Q 4.8.12].
  bool delete_first = false;
  /// A file must be a concise DCF through and through; else 06090030H. If not, the download to the slave
  /// finds out.
  bool check_files = true;
  can::Duration write_time{};  ///< the store is busy so long after a write
  can::Duration erase_time{};  ///< and after a deletion
  canopen::AbortCode busy = canopen::AbortCode::hardware_error;
  canopen::AbortCode in_use = canopen::AbortCode::write_of_read_only;  ///< see delete_first
  canopen::AbortCode in_download = canopen::AbortCode::device_state;   ///< the file is on its way to its node
  canopen::AbortCode too_long = canopen::AbortCode::length_mismatch;
  canopen::AbortCode no_room = canopen::AbortCode::out_of_memory;  ///< more than maximum_files
};

class ConfigurationManager final : public ConfigurationSource, public canopen::ObjectHandler {
 public:
  /// Attaches itself to 1F22H, 1F25H and 1F58H (as far as they exist) and becomes the master's configuration
  /// source. All must outlive it.
  ConfigurationManager(canopen::Node& node, NmtMaster& master, ConfigurationStore* store,
                       ConfigurationOptions options = {});

  [[nodiscard]] ConfigurationOptions& options() noexcept { return options_; }
  /// What the store held at power-on; not checked, not stored again. An empty file removes one.
  void load(std::uint8_t node_id, std::span<const std::uint8_t> file);
  /// The same for a program.
  void load_program(std::uint8_t node_id, std::span<const std::uint8_t> program);
  /// Number of files.
  [[nodiscard]] unsigned files() const noexcept;
  /// The store is busy with something else until then.
  void occupy_store(can::Time until) noexcept { busy_until_ = until; }
  /// The store is busy.
  [[nodiscard]] bool busy(can::Time now) const noexcept { return now < busy_until_; }

  /// Of a node; empty: there is none.
  [[nodiscard]] std::span<const std::uint8_t> file(std::uint8_t node_id) const noexcept {
    return node_id < files_.size() ? std::span<const std::uint8_t>(files_[node_id])
                                   : std::span<const std::uint8_t>{};
  }
  std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) override { return file(node_id); }
  Program open_program(std::uint8_t node_id) override;

 private:
  canopen::AbortCode before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                 can::Time now) override;
  canopen::AbortCode before_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                  std::span<const std::uint8_t> value, can::Time now) override;
  void after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                   can::Time now) override;
  [[nodiscard]] canopen::AbortCode store_file(std::uint8_t node_id, std::span<const std::uint8_t> file,
                                              can::Time now);
  [[nodiscard]] canopen::AbortCode store_program(std::uint8_t node_id, std::span<const std::uint8_t> program,
                                                 can::Time now);
  [[nodiscard]] canopen::AbortCode request(std::uint8_t sub, std::span<const std::uint8_t> value,
                                           can::Time now);

  NmtMaster* master_;
  ConfigurationStore* store_;
  ConfigurationOptions options_;
  std::array<std::vector<std::uint8_t>, 128> files_;
  std::array<std::vector<std::uint8_t>, 128> programs_;
  std::array<canopen::MemorySource, 128> readers_;  // of the programs
  can::Time busy_until_{};
};

}  // namespace canopus::manager
