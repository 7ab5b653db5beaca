#pragma once
// The objects of nodes on a bus, one node at a time, with progress on a terminal.

#include <string>

#include "canopus/client/sdo_transfer_on_bus.hpp"
#include "canopus/master/device_configuration.hpp"

namespace canopus::cli {

class BusObjects final : public master::ObjectAccess {
 public:
  BusObjects(link::BusLoop& bus, std::uint8_t node_id, can::Duration time_out)
      : node_id_(node_id), sdo_(bus, node_id, time_out, false) {}

  std::expected<std::vector<std::uint8_t>, Failure> read(text::ObjectName object,
                                                         canopen::DataType type) override;
  std::expected<void, Failure> write(text::ObjectName object, std::span<const std::uint8_t> value) override;

 private:
  std::uint8_t node_id_;
  client::SdoOnBus sdo_;
};

/// "node 5 (Drive): 12 of 40 objects" on a terminal's stderr, once it takes longer than a moment.
class ObjectProgress {
 public:
  ObjectProgress(const link::BusLoop& bus, std::string what);
  ~ObjectProgress();
  ObjectProgress(const ObjectProgress&) = delete;
  ObjectProgress& operator=(const ObjectProgress&) = delete;

  [[nodiscard]] master::Progress function();

 private:
  const link::BusLoop& bus_;
  std::string what_;
  can::Time next_;
  bool is_shown_ = false;
};

}  // namespace canopus::cli
