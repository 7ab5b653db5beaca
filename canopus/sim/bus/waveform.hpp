#pragma once
// The wire as a waveform: a Value Change Dump (IEEE 1364) that PulseView, GTKWave and sigrok-cli open. One
// scope with the name of the bus; in it
//
//   can           the level of the wire, 1 = recessive; under a cut that of its near side
//   can_far       that of the far side, if a fault of the bus cuts the wire
//   NAME_tx       what the controller NAME drives, 1 = recessive
//   NAME_flag     1 while it sends an error or overload flag
//   NAME_arb      1 while its frame takes part in arbitration
//   NAME_tec      its transmit error counter, a real number (sigrok-cli knows no vectors)
//   NAME_rec      its receive error counter, likewise
//   NAME_field    which field of a frame its present bit belongs to: a number, likewise; the names stand in a
//                 comment of the file
//
// Characters of NAME other than letters, digits and _ become _, a second port of a name gets its number.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/sim/bus/bus.hpp"

namespace canopus::sim {

class Waveform final : public WireObserver {
 public:
  using Sink = std::function<void(std::string_view)>;

  /// Writes the head, with the ports the bus has now, and begins to watch: the bus works bit by bit from here
  /// on. `sink` takes text in pieces of any length; bus and sink must outlive this.
  Waveform(Bus& bus, can::Time now, Sink sink);
  /// Flushes, and lets the bus go.
  ~Waveform();
  Waveform(const Waveform&) = delete;
  Waveform& operator=(const Waveform&) = delete;

  /// Unit of the times in the dump: at least ten to a bit, and a whole number of them to every port's bit.
  [[nodiscard]] can::Duration resolution() const noexcept { return resolution_; }
  /// Hands everything up to `now` to the sink.
  void flush(can::Time now);

  void level_changed(bool dominant, can::Time now) override;
  void far_level_changed(bool dominant, can::Time now) override;
  void transmit_changed(const Port& port, bool dominant, can::Time now) override;
  void activity_changed(const Port& port, bool flagging, bool arbitrating, can::Time now) override;
  void field_changed(const Port& port, can::FrameField field, can::Time now) override;
  void bit_sampled(const Port& port, can::Time now) override;

 private:
  enum Signal : std::size_t { tx, flag, arbitration_part, signals_per_port };
  enum Value : std::size_t { tec, rec, field, values_per_port };  // numbers, after the signals of all ports

  void write_head();
  /// Which of the ports of the dump; their count: none.
  [[nodiscard]] std::size_t number_of(const Port& port) const noexcept;
  /// Number of the port's first signal; 0 (that of the wire): the port is not in the dump.
  [[nodiscard]] std::size_t first_signal(const Port& port) const noexcept;
  /// The port's first number; 0 as above.
  [[nodiscard]] std::size_t first_value(const Port& port) const noexcept;
  [[nodiscard]] std::size_t signals() const noexcept { return 1 + signals_per_port * ports_.size(); }
  void change(std::size_t signal, unsigned value, can::Time now);
  void write_value(std::size_t signal);
  void write_time(can::Time now);
  [[nodiscard]] static std::string code(std::size_t signal);

  Bus& bus_;
  Sink sink_;
  std::vector<const Port*> ports_;
  mutable std::size_t last_ = 0;       // of the ports, asked for last
  std::size_t far_;                    // signal of the far side of a cut, 0: the wire is never cut
  std::vector<std::uint16_t> values_;  // per signal
  can::Duration resolution_;
  std::int64_t written_time_ = -1;
  std::string text_;
};

}  // namespace canopus::sim
