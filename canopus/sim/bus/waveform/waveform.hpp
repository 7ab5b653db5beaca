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
//   field         which field of a frame the present bit belongs to: a number, likewise; the names stand in a comment
//                 of the file. That of most controllers; idle only when no port is in a frame
//   NAME_field    -1: as `field`, which is what a controller is when nothing is wrong; else in which field it is itself.
//                 An idle receiver knows of a SOF only when that is over and is still "as field" then
//
// Characters of NAME other than letters, digits and _ become _, a second port of a name gets its number.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/bus/controller/bit_stream.hpp"
#include "canopus/sim/bus/waveform/waveform_fields.hpp"
#include "canopus/sim/bus/waveform/waveform_text.hpp"

namespace canopus::sim {

class Waveform final : public WireObserver {
 public:
  using Sink = WaveformText::Sink;

  /// Writes the head, with the ports the bus has now, and begins to watch. `sink` takes text in pieces of any length,
  /// that of a frame when it is complete; bus and sink must outlive this. Participants act at multiples of `grid`.
  Waveform(Bus& bus, can::Time now, Sink sink, can::Duration grid = std::chrono::microseconds(1));
  /// Hands over what has been written, and lets the bus go.
  ~Waveform();
  Waveform(const Waveform&) = delete;
  Waveform& operator=(const Waveform&) = delete;

  /// Unit of the times in the dump: at least ten to a bit, and a whole number of them to Bus::time_grid() and `grid`, so
  /// that no time is rounded.
  [[nodiscard]] can::Duration resolution() const noexcept { return text_.resolution(); }
  /// Hands everything up to `now`, the present, to the sink.
  void flush(can::Time now);

  [[nodiscard]] bool needs_bits() const noexcept override { return false; }
  void frame_passed(const WireFrame& frame) override;
  void level_changed(bool dominant, can::Time now) override;
  void far_level_changed(bool dominant, can::Time now) override;
  void transmit_changed(const Port& port, bool dominant, can::Time now) override;
  void activity_changed(const Port& port, bool flagging, bool arbitrating, can::Time now) override;
  void field_changed(const Port& port, can::FrameField field, can::Time now) override;
  void counters_changed(const Port& port, can::Time now) override;

 private:
  enum Signal : std::size_t { tx, flag, arbitration_part, signals_per_port };
  enum Value : std::size_t { tec, rec, field, values_per_port };  // numbers

  // The signals: the wire, those of the ports; then numbers: the bus's field, those of the ports; then the far side.
  [[nodiscard]] static constexpr std::size_t signal(std::size_t port, Signal kind) noexcept {
    return 1 + signals_per_port * port + kind;
  }
  [[nodiscard]] std::size_t bus_field() const noexcept { return signal(ports_.size(), tx); }
  [[nodiscard]] std::size_t value(std::size_t port, Value kind) const noexcept {
    return bus_field() + 1 + values_per_port * port + kind;
  }
  [[nodiscard]] std::size_t far_side() const noexcept { return value(ports_.size(), tec); }

  void write_head();
  void write_first_values();
  /// Which of the ports of the dump; their count: none.
  [[nodiscard]] std::size_t number_of(const Port& port) const noexcept;
  void change_level(std::size_t signal, bool high, can::Time now);
  void change_number(std::size_t signal, unsigned value, can::Time now);
  /// Whatever comes next happens at `now`, which is not before what came last.
  void advance(can::Time now);
  void begin_change(can::Time now);
  void settle_fields();

  // waveform_frame.cpp
  /// The lines of all that acknowledge.
  struct Acknowledgement {
    std::string lines;
    std::vector<std::size_t> begins;  // per port: where its line begins, or would
  };
  struct Contender {
    std::size_t port = 0;
    unsigned lost_at = 0;
    bool drives = false;
  };
  void write_level(std::size_t signal, bool high, can::Time now) {
    text_.time(now);
    text_.level(high, codes_[signal]);
  }
  void update_members(const WireFrame& frame);
  void begin_arbitration(const WireFrame& frame);
  void write_arbitration(BitStream::Bit bit, unsigned plain, bool is_over, can::Time now);
  void write_acknowledgement(const WireFrame& frame, bool dominant, can::Time now);
  void enter_field(const WireFrame& frame, can::FrameField entered, can::Time now);
  void write_received(const WireFrame& frame, can::Time now);

  Bus& bus_;
  std::vector<const Port*> ports_;
  mutable std::size_t last_ = 0;  // of the ports, asked for last
  bool has_far_side_;
  std::vector<WaveformText::Code> codes_;  // per signal
  std::vector<std::uint16_t> values_;      // per signal, fields aside
  WaveformText text_;
  WaveformFields fields_;
  can::Time moment_;                // of the last change
  can::Time idle_at_ = can::never;  // end of the intermission of a frame that was reported as a whole
  std::vector<Contender> contenders_;
  unsigned next_lost_at_ = 0;        // the first of them
  std::uint64_t membership_ = 0;     // of the frame that was reported last
  bool all_are_members_ = false;     // all ports of the dump, of it
  Acknowledgement acknowledged_[2];  // recessive, dominant
};

}  // namespace canopus::sim
