#pragma once
// One SDO transfer at a time over a bus of the command line, waited for.

#include <cstdint>
#include <expected>
#include <span>
#include <utility>
#include <vector>

#include "canopus/client/sdo_transfer.hpp"
#include "canopus/link/bus_loop.hpp"

namespace canopus::client {

using link::BusLoop;

class SdoOnBus final : public can::Participant {
 public:
  using Progress = SdoTransfer::Progress;

  /// As SdoTransfer.
  SdoOnBus(BusLoop& bus, std::uint8_t node_id, can::Duration time_out, bool block);
  ~SdoOnBus() override;
  SdoOnBus(const SdoOnBus&) = delete;
  SdoOnBus& operator=(const SdoOnBus&) = delete;

  void set_limit(std::size_t bytes) noexcept { transfer_.set_limit(bytes); }
  void set_progress(Progress progress) { transfer_.set_progress(std::move(progress)); }
  std::expected<std::vector<std::uint8_t>, SdoFailure> read(text::ObjectName object);
  std::expected<void, SdoFailure> write(text::ObjectName object, std::span<const std::uint8_t> value);

  /// Of the last transfer that succeeded.
  [[nodiscard]] const SdoSpeed& speed() const noexcept { return transfer_.speed(); }

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override { transfer_.receive(frame, now); }
  void tick(can::Time now) override { transfer_.tick(now); }

 private:
  std::expected<std::vector<std::uint8_t>, SdoFailure> wait(bool started);

  BusLoop& bus_;
  SdoTransfer transfer_;
};

}  // namespace canopus::client
