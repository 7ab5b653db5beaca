#pragma once
// Where the PLC program's requests come from and their answers go. The engine (module_engine.hpp) owns the port
// of its model and knows no other way to the program:
//
//   by signals        Yn requests, Xn answers                             signal_port.hpp
//   by bits of words  bits written as 1 request and go back to 0          word_port.hpp
//   by registers      an area of the model's own: it is a port, too   RegisterAccess
//
// A port calls the requests of the engine; the engine calls the functions here. A port overrides what it needs.

#include <cstddef>
#include <cstdint>

#include "canopus/module/interface/module.hpp"

namespace canopus::canopen {
struct Emergency;
}
namespace canopus::manager {
struct BootRecord;
}

namespace canopus::module {

/// What a program requests and waits for.
enum class Request : std::uint8_t { data_exchange, command, save_restore, set_clock, read_clock };

/// What a signal pair (Yn of the program, Xn of the module) or bits of a word are for.
enum class RequestUse : std::uint8_t {
  none,
  ready,  ///< X only: a program may use the module
  // The module answers Y with X when it is done; X goes OFF with Y.
  data_exchange,
  restart,
  set_clock,
  read_clock,
  command,
  save_restore,
  // Y requests as long as it is ON; X shows the state.
  online,
  transmit_trigger,
  // X shows that there is something; Y clears it, and keeps it clear while ON.
  error,
  nmt_error,
  emergency,
};
inline constexpr std::size_t request_uses = static_cast<std::size_t>(RequestUse::emergency) + 1;

class RequestPort {
 public:
  RequestPort() = default;
  RequestPort(const RequestPort&) = delete;
  RequestPort& operator=(const RequestPort&) = delete;
  virtual ~RequestPort() = default;

  /// X and Y, if this is the way. It lives as long as the port.
  [[nodiscard]] virtual SignalAccess* signals() noexcept { return nullptr; }
  virtual void set_observer(ModuleObserver* /*observer*/) {}

  // --- requests
  /// The program wrote a word, and it was accepted: the request that it makes is to be carried out.
  virtual void serve(can::Time /*now*/) {}
  /// The request is carried out.
  virtual void done(Request /*request*/, can::Time /*now*/) {}

  // --- the module's life
  /// The supply comes on; initialization_begins() follows.
  virtual void power_on(can::Time /*now*/) {}
  virtual void power_off(can::Time /*now*/) {}
  virtual void initialization_begins(can::Time /*now*/) {}
  /// It has ended, the module works. `by_restart`: it was ModuleEngine::begin_restart()'s.
  virtual void initialized(bool /*by_restart*/, can::Time /*now*/) {}
  /// Layer 2 is offline without the program's request.
  virtual void went_offline() {}
  /// A hardware fault was found.
  virtual void fault_found(can::Time /*now*/) {}
  /// After every event: something may have changed that the program sees.
  virtual void show(can::Time /*now*/) {}

  // --- reports of the network, for areas of the model's own
  virtual void emergency_received(const canopen::Emergency& /*message*/, can::Time /*now*/) {}
  virtual void boot_went_on(std::uint8_t /*node_id*/, const manager::BootRecord&, can::Time /*now*/) {}
  /// NmtMaster::error_control(node_id) changed.
  virtual void error_control_changed(std::uint8_t /*node_id*/, std::uint16_t /*bits*/, can::Time /*now*/) {}

  virtual void tick(can::Time /*now*/) {}
  /// When tick() is wanted; the port sets it.
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  can::Alarm alarm_;
};

}  // namespace canopus::module
