#include "canopus/client/sdo_transfer_on_bus.hpp"

namespace canopus::client {

SdoOnBus::SdoOnBus(BusLoop& bus, std::uint8_t node_id, can::Duration time_out, bool block)
    : bus_(bus), transfer_(bus, node_id, time_out, block) {
  alarm().add_part(transfer_.alarm());
  bus_.add(*this);
}

SdoOnBus::~SdoOnBus() {
  transfer_.cancel();
  bus_.remove(*this);
}

std::expected<std::vector<std::uint8_t>, SdoFailure> SdoOnBus::wait(bool started) {
  if (!started) return std::unexpected(SdoFailure{.reason = std::string(bus_takes_no_frame)});
  switch (bus_.run([this] { return transfer_.is_finished(); })) {
    case BusLoop::End::done: return transfer_.result();
    case BusLoop::End::interrupted:
      transfer_.cancel();
      return std::unexpected(SdoFailure{.reason = "interrupted"});
    default: return std::unexpected(SdoFailure{.reason = bus_.failure()});
  }
}

std::expected<std::vector<std::uint8_t>, SdoFailure> SdoOnBus::read(text::ObjectName object) {
  return wait(transfer_.read(object, bus_.now()));
}

std::expected<void, SdoFailure> SdoOnBus::write(text::ObjectName object,
                                                std::span<const std::uint8_t> value) {
  const auto written = wait(transfer_.write(object, value, bus_.now()));
  if (!written) return std::unexpected(written.error());
  return {};
}

}  // namespace canopus::client
