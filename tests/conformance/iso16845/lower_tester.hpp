#pragma once
// The lower tester of ISO 16845-1: it alone is on the wire with the implementation under test (IUT), by the bit driver. Bits
// are numbered from the one where it begins; 0 is dominant, 1 recessive (released), R forced recessive. What is expected
// comes from the rules of ISO 11898-1; frames come from slow_frame.hpp, which knows nothing of the program.

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/sim/bus/bus.hpp"

#include "can/slow_frame.hpp"
#include "sim/bus_station.hpp"

namespace canopus::sim::iso16845 {

using namespace std::chrono_literals;
using can::data_frame;
using can::ErrorState;
using can::Frame;
using can::Time;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// `text` so many times.
inline std::string times(std::size_t count, std::string_view text) {
  std::string all;
  while (count-- > 0) all += text;
  return all;
}

class LowerTester : private WireObserver {
 public:
  LowerTester() { bus.add_observer(static_cast<WireObserver&>(*this)); }
  ~LowerTester() { bus.remove_observer(static_cast<WireObserver&>(*this)); }
  LowerTester(const LowerTester&) = delete;
  LowerTester& operator=(const LowerTester&) = delete;

  /// Puts the levels on the wire; at bit 0 the IUT is given what it has to send. Then `after` recessive bits. `step`:
  /// time of a level.
  void run(std::string_view bits, const std::vector<Frame>& to_send = {}, int after = 40,
           can::Duration step = bit) {
    const auto levels = parse_levels(bits);
    ASSERT_TRUE(levels.has_value()) << levels.error();
    ASSERT_TRUE(
        bus.set_faults({{.kind = FaultKind::drive, .from = begin, .levels = *levels, .bit_time = step}}, 1)
            .has_value());
    for (const Frame& frame : to_send) iut.send_at(begin, frame);
    timeline.run_until(begin + step * static_cast<int>(levels->size()) + bit * after);
  }
  /// What the IUT drives from one bit to before another: 0 and 1.
  [[nodiscard]] std::string driven(int from, int to) const {
    std::string text;
    for (int number = from; number < to; ++number) {
      const auto change = levels_.upper_bound(begin + bit * number + bit / 2);
      text += change != levels_.begin() && std::prev(change)->second ? '0' : '1';
    }
    return text;
  }
  /// Where it drives dominant: "44 46-51".
  [[nodiscard]] std::string dominant(int from = 0, int to = 3000) const {
    const std::string text = driven(from, to);
    std::string runs;
    for (std::size_t first = text.find('0'); first != std::string::npos;) {
      const std::size_t end = std::min(text.find('1', first), text.size());
      if (!runs.empty()) runs += ' ';
      runs += std::to_string(from + static_cast<int>(first));
      if (end - first > 1) runs += '-' + std::to_string(from + static_cast<int>(end) - 1);
      first = text.find('0', end);
    }
    return runs;
  }
  [[nodiscard]] int tec() const { return iut.port.transmit_error_counter(); }
  [[nodiscard]] int rec() const { return iut.port.receive_error_counter(); }

  static constexpr auto bit = 1us;
  static constexpr Time begin{100us};
  can::Timeline timeline;
  Bus bus{"bus", 1'000'000, timeline};
  Station iut{bus, timeline, "IUT"};

 private:
  void level_changed(bool, Time) override {}
  void transmit_changed(const Port&, bool dominant, Time now) override { levels_[now] = dominant; }
  void activity_changed(const Port&, bool, bool, Time) override {}
  std::map<Time, bool> levels_;
};

// 0 00100100011 0 0 0 00(1)01 01010101 010001101100011 1 1 1 1111111
// SOF 0, identifier 1-11, RTR 12, IDE 13, r0 14, DLC 15-19 with a stuff bit at 17, data 20-27, CRC 28-42, CRC delimiter 43,
// ACK slot 44, ACK delimiter 45, EOF 46-52, intermission 53-55.
inline const Frame frame_of_53_bits = data_frame(0x123, {0x55});
inline const std::string wire_of_53_bits = can::slow::wire(frame_of_53_bits);

/// `wire` with another level at a bit.
inline std::string with(std::string wire, std::size_t bit, char level) {
  wire.at(bit) = level;
  return wire;
}

// Six dominant bits: a stuff error at the sixth, the IUT's flag, a dominant bit after it, delimiter, intermission: 24 bits in
// which a receiver's REC grows by 9.
inline const std::string nine_receive_errors =
    "000000"
    "111111"
    "0"
    "11111111"
    "111";
// A recessive r0 in place of the dominant one, the flag, delimiter, intermission: 32 bits in which a transmitter of
// frame_of_53_bits has TEC + 8; error passive it waits for 8 bits more.
inline const std::string eight_transmit_errors = times(14, "1") + "R" + times(17, "1");
inline const std::string eight_transmit_errors_passive = eight_transmit_errors + times(8, "1");
/// So that the IUT is error passive as a receiver: REC 135, 360 bits.
inline const std::string to_passive_receiver = times(15, nine_receive_errors);
/// So that it is error passive as a transmitter: TEC 128, 520 bits; then it begins once more.
inline const std::string to_passive_transmitter = times(16, eight_transmit_errors) + times(8, "1");

}  // namespace canopus::sim::iso16845
