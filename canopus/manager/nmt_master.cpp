#include "canopus/manager/nmt_master.hpp"

#include <utility>

#include "canopus/manager/nmt_master_engine.hpp"

namespace canopus::manager {

NmtMaster::NmtMaster(canopen::Node& node, can::Sink& sink, MasterOptions options)
    : engine_(std::make_unique<Engine>(node, sink, options)) {}

NmtMaster::~NmtMaster() = default;

void NmtMaster::set_listener(MasterListener* listener) noexcept {
  static class : public MasterListener {
  } nobody;
  engine_->listener_ = listener != nullptr ? listener : &nobody;
}

void NmtMaster::set_configuration_source(ConfigurationSource* source) noexcept { engine_->source_ = source; }

MasterOptions& NmtMaster::options() noexcept { return engine_->options_; }

void NmtMaster::start(can::Time now) { engine_->start(now); }
void NmtMaster::stop(can::Time now) { engine_->stop(now); }
void NmtMaster::receive(const can::Frame& frame, can::Time now) { engine_->receive(frame, now); }
void NmtMaster::transmitted(const can::Frame& frame, can::Time now) { engine_->transmitted(frame, now); }
void NmtMaster::tick(can::Time now) { engine_->tick(now); }
can::Time NmtMaster::deadline() const noexcept { return engine_->deadline(); }

void NmtMaster::own_state_changed(canopen::NmtState, can::Time now) { engine_->own_state_changed(now); }

void NmtMaster::heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) {
  engine_->heartbeat_received(node_id, state, now);
}

void NmtMaster::heartbeat_lost(std::uint8_t node_id, can::Time now) { engine_->heartbeat_lost(node_id, now); }

bool NmtMaster::active() const noexcept { return engine_->active(); }
std::uint8_t NmtMaster::active_master() const noexcept { return engine_->active_master(); }
bool NmtMaster::starting() const noexcept { return engine_->starting(); }
bool NmtMaster::halted() const noexcept { return engine_->halted(); }
bool NmtMaster::waits_for_own_start() const noexcept { return engine_->waits_for_own_start(); }

std::uint8_t NmtMaster::node_state(std::uint8_t node_id) const noexcept {
  return engine_->node_state(node_id);
}

std::uint16_t NmtMaster::error_control(std::uint8_t node_id) const noexcept {
  return engine_->error_control(node_id);
}

void NmtMaster::clear_error_control(std::uint8_t node_id, can::Time now) {
  engine_->clear_error_control(node_id, now);
}

const BootRecord& NmtMaster::boot_record(std::uint8_t node_id) const noexcept {
  static const BootRecord never_booted;
  const BootSlave* boot = engine_->boot(node_id);
  return boot != nullptr ? boot->record() : never_booted;
}

bool NmtMaster::lss_configured(std::uint8_t node_id) const noexcept {
  return engine_->lss_configured(node_id);
}

bool NmtMaster::lss_active() const noexcept { return engine_->lss_active(); }

bool NmtMaster::sdo_channel_busy(std::uint8_t node_id) const noexcept {
  const BootSlave* boot = engine_->boot(node_id);
  return (boot != nullptr && boot->sdo_busy()) || engine_->requests_.busy(node_id);
}

bool NmtMaster::configuring(std::uint8_t node_id) const noexcept {
  const BootSlave* boot = engine_->boot(node_id);
  return boot != nullptr && boot->configuring();
}

canopen::AbortCode NmtMaster::request_nmt(std::uint8_t node_id, std::uint8_t value, can::Time now) {
  const canopen::AbortCode refusal = engine_->check_nmt_request(node_id, value);
  if (refusal == canopen::AbortCode::none) engine_->perform_nmt_request(node_id, value, now);
  return refusal;
}

canopen::AbortCode NmtMaster::request_guarding(std::uint8_t node_id, std::uint8_t value, can::Time now) {
  const canopen::AbortCode refusal = engine_->check_guarding_request(node_id, value);
  if (refusal == canopen::AbortCode::none) engine_->perform_guarding_request(node_id, value, now);
  return refusal;
}

bool NmtMaster::guarding(std::uint8_t node_id) const noexcept { return engine_->guarding(node_id); }

canopen::AbortCode NmtMaster::request_configuration(std::uint8_t node_id, can::Time now) {
  return engine_->request_configuration(node_id, now);
}

canopen::AbortCode NmtMaster::read_object(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                                          SdoRequests::Done done, can::Time now,
                                          const SdoRequestOptions& options) {
  const canopen::AbortCode refusal = engine_->check_sdo_request(node_id);
  if (refusal == canopen::AbortCode::none) {
    engine_->requests_.upload(node_id, index, sub, std::move(done), now, options);
  }
  return refusal;
}

canopen::AbortCode NmtMaster::write_object(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                                           std::span<const std::uint8_t> value, SdoRequests::Done done,
                                           can::Time now, const SdoRequestOptions& options) {
  const canopen::AbortCode refusal = engine_->check_sdo_request(node_id);
  if (refusal == canopen::AbortCode::none) {
    engine_->requests_.download(node_id, index, sub, value, std::move(done), now, options);
  }
  return refusal;
}

std::size_t NmtMaster::pending_requests(std::uint8_t node_id) const noexcept {
  return engine_->requests_.pending(node_id);
}

void NmtMaster::cancel_requests(std::uint8_t node_id, can::Time now) {
  engine_->requests_.cancel(node_id, canopen::AbortCode::local_control, now);
}

}  // namespace canopus::manager
