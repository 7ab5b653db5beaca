// Who lost an arbitration, and at which bit: the same whether frames are told as a whole or went bit by bit.

#include <chrono>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/sim/bus/wire/wire_observer.hpp"

#include "can/random_frame.hpp"
#include "sim/bus_station.hpp"

namespace canopus::sim::wire_arbitration_test {
namespace {

using namespace std::chrono_literals;
using can::Frame;
using can::Time;

/// Notes who sent each frame and who lost to it.
class ArbitrationNotes final : public WireObserver {
 public:
  explicit ArbitrationNotes(bool wants_bits) : wants_bits_(wants_bits) {}

  [[nodiscard]] bool needs_bits() const noexcept override { return wants_bits_; }
  void frame_passed(const WireFrame& frame) override { note(frame.frame, frame.start, frame.senders); }
  void arbitration_passed(const WireArbitration& arbitration) override {
    note(arbitration.frame, arbitration.start, arbitration.senders);
  }
  void level_changed(bool, Time) override {}
  void transmit_changed(const Port&, bool, Time) override {}
  void activity_changed(const Port&, bool, bool, Time) override {}

  std::vector<std::string> lines;

 private:
  void note(const Frame& frame, Time start, std::span<const WireFrame::Sender> senders) {
    std::string line =
        std::to_string(start.time_since_epoch().count()) + " ns, " + std::to_string(frame.identifier);
    for (const WireFrame::Sender& sender : senders) {
      const bool has_won = sender.lost_at == WireFrame::Sender::won;
      line += "; port " + std::to_string(sender.port) + " with " + std::to_string(sender.arbitration) +
              (has_won ? " won" : " lost at " + std::to_string(sender.lost_at));
    }
    lines.push_back(line);
  }
  bool wants_bits_;
};

using Sendings = std::vector<std::vector<std::pair<Time, Frame>>>;

std::vector<std::string> arbitrations(const Sendings& sendings, bool bit_by_bit,
                                      const std::vector<Fault>& faults = {}) {
  can::Timeline timeline;
  Bus bus("bus", 1'000'000, timeline);
  std::vector<std::unique_ptr<Station>> stations;
  for (const auto& of_station : sendings) {
    stations.push_back(std::make_unique<Station>(bus, timeline, std::to_string(stations.size())));
    for (const auto& [moment, frame] : of_station) stations.back()->send_at(moment, frame);
  }
  EXPECT_TRUE(bus.set_faults(faults, 1).has_value());
  ArbitrationNotes notes(bit_by_bit);
  bus.add_observer(static_cast<WireObserver&>(notes));
  timeline.run_until(Time(20ms));
  bus.remove_observer(static_cast<WireObserver&>(notes));
  return notes.lines;
}

TEST(WireArbitration, BitByBit_SaysWhoSentAndWhereTheOthersLost) {
  const Sendings sendings = {{{Time(100us), {.identifier = 2}}},
                             {{Time(100us), {.identifier = 1}}},
                             {{Time(100us), {.identifier = 1U << 18, .extended = true}}}};
  const std::vector<std::string> lines = arbitrations(sendings, true);
  ASSERT_EQ(lines.size(), 3U);
  // 1 and 2 differ in the tenth bit of the identifier; the extended frame's base is 1, too, and its SRR is bit 12.
  EXPECT_EQ(lines[0],
            "100000 ns, 1; port 0 with 4194304 lost at 10; port 1 with 2097152 won; port 2 with 3670016 lost "
            "at 12");
  EXPECT_EQ(lines, arbitrations(sendings, false));
}

TEST(WireArbitration, OfManyWithIdentifiersAlike_IsTheSameBothWays) {
  std::mt19937_64 random(2027);
  for (unsigned round = 0; round < 200; ++round) {
    Sendings sendings(2 + random() % 8);
    const Frame alike = can::random_frame(random);
    for (auto& of_station : sendings) {
      for (unsigned count = 0; count < 3; ++count) {
        Frame frame = random() % 4 == 0 ? can::random_frame(random) : alike;
        frame.identifier ^= 1U << random() % (frame.extended ? 29 : 11);
        of_station.emplace_back(Time(100us) + count * 300us, frame);
      }
    }
    const std::vector<std::string> bit_by_bit = arbitrations(sendings, true);
    // What only bits can tell, as two frames that share all that decides, goes bit by bit in the other run, too.
    ASSERT_EQ(arbitrations(sendings, false), bit_by_bit) << "round " << round;
  }
}

TEST(WireArbitration, AFrameThatIsRepeatedAfterAnError_HasTheLosersOfItsLastAttempt) {
  Fault fault;
  fault.kind = FaultKind::corrupt;
  fault.identifier = 1;
  fault.bit = 30;
  fault.count = 1;
  const Sendings sendings = {{{Time(100us), {.identifier = 2}}},
                             {{Time(100us), Frame{.identifier = 1, .dlc = 2}}},
                             {{Time(110us), {.identifier = 5}}}};
  const std::vector<std::string> lines = arbitrations(sendings, true, {fault});
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_NE(lines[0].find(
                "port 0 with 4194304 lost at 10; port 1 with 2097152 won; port 2 with 10485760 lost at 9"),
            std::string::npos)
      << lines[0];
  EXPECT_NE(lines[1].find(" ns, 2; port 0 with 4194304 won; port 2"), std::string::npos) << lines[1];
}

}  // namespace
}  // namespace canopus::sim::wire_arbitration_test
