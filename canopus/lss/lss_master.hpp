#pragma once
// LSS master [CiA 305]: one service at a time, each ends with LssMasterListener::lss_finished(). Requests go on
// 7E5H, answers come on 7E4H. Services without an answer end at once (in the next tick()).
//
// Only the active NMT master of a network may be its LSS master. Services other than switch state, identify
// and fastscan are for exactly one slave in configuration state: else their answers collide.

#include <chrono>
#include <cstdint>
#include <initializer_list>

#include "canopus/can/controller.hpp"
#include "canopus/lss/lss.hpp"

namespace canopus::lss {

enum class LssResult : std::uint8_t {
  done,     ///< answered (or nothing to answer)
  silence,  ///< no answer in time: no such slave
  refused,  ///< the slave answered with an error: LssMaster::error()
  lost,     ///< fastscan, slow scan: the slave stopped answering in the middle
};

class LssMaster;

class LssMasterListener {
 public:
  /// The service ended; the next one may be begun from inside.
  virtual void lss_finished(LssMaster& master, LssResult result, can::Time now) = 0;

 protected:
  ~LssMasterListener() = default;
};

class LssMaster {
 public:
  struct Options {
    can::Duration time_out = std::chrono::milliseconds(100);  ///< for an answer
    can::Duration pause = std::chrono::milliseconds(1);       ///< between frames of one service
  };

  LssMaster(can::Sink& sink, LssMasterListener& listener) : LssMaster(sink, listener, Options{}) {}
  LssMaster(can::Sink& sink, LssMasterListener& listener, Options options)
      : sink_(&sink), listener_(&listener), options_(options) {}

  /// For an answer, from the next service on.
  void set_time_out(can::Duration time_out) noexcept { options_.time_out = time_out; }

  // All return false while busy().
  /// All slaves to configuration state (true) or waiting.
  bool switch_global(bool configuration, can::Time now);
  /// The slave with this address to configuration state.
  bool select(const LssAddress& address, can::Time now);
  bool configure_node_id(std::uint8_t node_id, can::Time now);
  /// `index` of table 0 (lss::bit_rate_index), or of a manufacturer's table, 128..255.
  bool configure_bit_timing(std::uint8_t index, can::Time now, std::uint8_t table = 0);
  /// All slaves in configuration state change over: `delay` of silence, the new rate, the same again. The own
  /// controller must be changed after `delay` as well, and nothing sent before 2 x `delay` are over.
  bool activate_bit_timing(std::chrono::milliseconds delay, can::Time now);
  bool store(can::Time now);
  /// part 0 vendor, 1 product, 2 revision, 3 serial: value().
  bool inquire(unsigned part, can::Time now);
  bool inquire_node_id(can::Time now);
  /// Is there a slave without a node-ID?
  bool identify_unconfigured(can::Time now);
  /// Is there a slave of this vendor and product, with revision and serial number in these ranges?
  bool identify(const LssAddress& low, const LssAddress& high, can::Time now);
  /// Finds one slave without a node-ID and switches it to configuration state: address(). silence: there is
  /// none (any longer).
  bool fastscan(can::Time now) { return fastscan({}, {}, now); }
  /// The same among slaves whose address matches `known` in the bits of `mask`; these bits are not scanned.
  /// lost: no such slave, or it stopped answering.
  bool fastscan(const LssAddress& known, const LssAddress& mask, can::Time now);
  /// Finds the slave with the lowest revision, and among those the lowest serial number, in these ranges, and
  /// switches it to configuration state: address(). Vendor and product (of `low`) have to be known. For
  /// slaves without fastscan: halves the ranges by identify remote slave, 65 times at most; slaves that have
  /// a node-ID answer as well. silence: there is none.
  bool slow_scan(const LssAddress& low, const LssAddress& high, can::Time now);
  /// Gives the running service up; the listener is not notified.
  void cancel() noexcept;

  [[nodiscard]] bool busy() const noexcept { return service_ != Service::none; }
  [[nodiscard]] std::uint32_t value() const noexcept { return value_; }  ///< of inquire
  [[nodiscard]] std::uint8_t error() const noexcept { return error_; }   ///< of a refusal: byte 1
  [[nodiscard]] std::uint8_t specific_error() const noexcept { return specific_error_; }  ///< byte 2
  [[nodiscard]] const LssAddress& address() const noexcept {
    return address_;
  }  ///< of fastscan and slow scan

  void receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept { return alarm_.deadline(); }
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  enum class Service : std::uint8_t { none, unanswered, single, sequence, fastscan, slow_scan };

  bool begin(Service service, std::uint8_t expected);
  bool single(const can::Frame& request, can::Time now);
  void send_step(can::Time now);
  void send_scan(can::Time now);
  void scan_answered(bool answered, can::Time now);
  void scan_below(unsigned bit);
  void begin_sequence(std::uint8_t first_command, std::initializer_list<std::uint32_t> numbers,
                      can::Time now);
  void request_range(const LssAddress& low, const LssAddress& high, can::Time now);
  void slow_scan_answered(bool answered, can::Time now);
  void request_lower_half(can::Time now);
  void finish(LssResult result, can::Time now);

  can::Sink* sink_;
  LssMasterListener* listener_;
  Options options_;
  Service service_ = Service::none;
  std::uint8_t expected_ = 0;  // command specifier of the answer
  std::uint8_t first_command_ = 0;
  unsigned step_ = 0;
  unsigned steps_ = 0;
  std::uint32_t numbers_[6]{};
  bool answered_ = false;
  LssAddress address_;
  enum class Scan : std::uint8_t { reset, bit, confirm };
  Scan scan_ = Scan::reset;
  LssAddress mask_;     // fastscan: bits of address_ that are known
  LssAddress highest_;  // slow scan: the remaining range is address_ to this
  bool halving_ = false;
  unsigned part_ = 0;
  unsigned bit_ = 0;
  std::uint32_t value_ = 0;
  std::uint8_t error_ = 0;
  std::uint8_t specific_error_ = 0;
  can::Alarm alarm_;
};

}  // namespace canopus::lss
