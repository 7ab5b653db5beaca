// When frames begin and are repeated after errors: each controller by its own bits, whatever the others are still
// doing. A reference controller (slow_bus.hpp) judges; the cases that matter most are also walked through by hand.
// Numbers are bits at 1 Mbit/s.
//
// CANOPUS_SEEDS: so many random scripts instead of 150, or of 500 in ./check --all; RC_PARAMS=seed=N: others.

#include "sim/bus_repeat.hpp"

#include "support/random_cases.hpp"

namespace canopus::sim::bus_repeat_test {
namespace {

using namespace repeat;

struct Log : BusObserver {
  void frame_completed(const Frame& frame, Time start, Time end) override {
    frames.push_back(std::to_string(frame.identifier) + " " + at(start) + " " + at(end));
  }
  void error_detected(const Port& port, BusError error, Time now) override {
    constexpr const char* names[] = {"none", "bit", "stuff", "crc", "form", "ack"};
    errors.push_back(port.name() + " " + names[static_cast<int>(error)] + " " + at(now));
  }
  [[nodiscard]] std::string at(Time time) const { return std::to_string((time - zero) / 1us); }
  void begin(Time time) {
    zero = time;
    frames.clear();
    errors.clear();
  }
  Time zero{};
  std::vector<std::string> frames;
  std::vector<std::string> errors;
};

/// When a station begins to send: its frame is in arbitration from then on.
struct Starts final : WireObserver {
  explicit Starts(const Log& the_log) : log(the_log) {}
  void level_changed(bool, Time) override {}
  void transmit_changed(const Port&, bool, Time) override {}
  void activity_changed(const Port& port, bool flagging, bool arbitrating, Time now) override {
    if (arbitrating) lines.push_back(port.name() + " starts " + log.at(now));
    if (flagging) lines.push_back(port.name() + " flags " + log.at(now));
  }
  const Log& log;
  std::vector<std::string> lines;
};

struct BusRepeatTest : ::testing::Test {
  BusRepeatTest() { bus.add_observer(static_cast<BusObserver&>(log)); }
  ~BusRepeatTest() override { bus.remove_observer(static_cast<WireObserver&>(starts)); }
  void faults(const std::vector<Fault>& list) { ASSERT_TRUE(bus.set_faults(list, 1).has_value()); }
  /// b finds a CRC error where there is none until its REC is beyond 127. Ends on an idle bus.
  void make_b_passive() {
    faults({{.kind = FaultKind::corrupt, .count = 16, .receiver = "b", .bit = 22}});
    a.port.send(data_frame(0x123, {0x55}));
    timeline.run_until(Time(5ms));
    ASSERT_EQ(b.port.error_state(), can::ErrorState::error_passive);
    ASSERT_EQ(a.port.error_state(), can::ErrorState::error_active);
  }
  /// Numbers count from now on.
  void begin() {
    log.begin(timeline.now());
    starts.lines.clear();
    bus.add_observer(static_cast<WireObserver&>(starts));
  }
  void run_for(can::Duration duration) { timeline.run_until(timeline.now() + duration); }

  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  Log log;
  Starts starts{log};
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
  Station c{bus, timeline, "c"};
};

using Lines = std::vector<std::string>;

// 0 00100100011 0 0 0 00(1)01 01010101 010001101100011 1 1 1 1111111
// 0 1        11 12 .. 15   19 20    27 28           42 43 44 45 46..52
const Frame frame_of_53_bits = data_frame(0x123, {0x55});
// 44 bits and three stuff bits: 0 11100000(1)000 0 0(1)0 0000(1) ...
const Frame frame_of_47_bits = data_frame(0x700);

TEST_F(BusRepeatTest, ActiveTransmitter_DoesNotWaitForAPassiveReceiversLongerErrorFrame) {
  make_b_passive();
  c.port.plug(false);
  run_for(1ms);
  faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "a", .bit = 21}});
  begin();
  a.port.send(frame_of_53_bits);
  run_for(45us);
  // a flags in bits 22 to 27, and b sees the sixth dominant bit in 27. Delimiter of a 28 to 35, intermission 36 to
  // 38. The passive flag of b is 28 to 33, its delimiter 34 to 41: it sees the SOF in the middle of it.
  EXPECT_EQ(starts.lines, (Lines{"a starts 0", "a flags 22", "b flags 28", "a starts 39", "b flags 40"}));
  EXPECT_EQ(log.errors, (Lines{"a bit 21", "b stuff 27", "b form 39"}));
}

TEST_F(BusRepeatTest, Transmitter_DoesNotWaitForTheFlagOfAListenOnlyStation) {
  b.port.set_listen_only(true);
  run_for(1ms);
  faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "b", .bit = 22}});
  begin();
  a.port.send(frame_of_53_bits);
  a.port.send(frame_of_47_bits);
  run_for(200us);
  // b alone finds a CRC error. Its flag, which nobody sees, is 46 to 51, its delimiter would end with 59: the SOF is in
  // it. Another flag is 57 to 62, its delimiter begins at the stuff bit 65 and is broken by 66, and so on.
  // EOF ends with bit 52, intermission with 55.
  EXPECT_EQ(log.frames, (Lines{"291 0 53", "1792 56 103"}));
  EXPECT_EQ(log.errors, (Lines{"b crc 45", "b form 56", "b form 66", "b form 80", "b form 88"}));
  EXPECT_TRUE(b.heard.empty());
  EXPECT_EQ(c.frames(), (std::vector<Frame>{frame_of_53_bits, frame_of_47_bits}));
}

TEST_F(BusRepeatTest, PassiveTransmitter_SuspendsAndOthersStartAfterTheirIntermission) {
  faults({{.kind = FaultKind::corrupt, .sender = "a", .count = 16, .bit = 21}});
  a.port.send(frame_of_53_bits);
  run_for(16 * 45us + 500us);
  ASSERT_EQ(a.port.transmit_error_counter(), 127);  // it got through at last, and is active again
  faults({{.kind = FaultKind::corrupt, .sender = "a", .count = 1, .receiver = "a", .bit = 21},
          {.kind = FaultKind::corrupt, .sender = "a", .first = 2, .count = 1, .receiver = "a", .bit = 21}});
  begin();
  a.port.send(frame_of_53_bits);
  run_for(10us);
  b.port.send(frame_of_47_bits);
  run_for(300us);
  // The active flag that makes a passive is 22 to 27, those of the others 28 to 33, delimiter 34 to 41, intermission
  // 42 to 44. b starts; a, which has the lower identifier, would have waited until 53.
  EXPECT_EQ(starts.lines[0], "a starts 0");
  EXPECT_EQ(starts.lines[1], "a flags 22");
  EXPECT_EQ(starts.lines[4], "b starts 45");
  EXPECT_EQ(log.frames.at(0), "1792 45 92");
  EXPECT_EQ(starts.lines[5], "a starts 95");
  EXPECT_EQ(log.errors.at(3), "a bit 116");
  EXPECT_TRUE(log.frames.at(1).starts_with("291 "));
}

TEST_F(BusRepeatTest, PassiveTransmitterAlone_SuspendsEightBits) {
  faults({{.kind = FaultKind::corrupt, .sender = "a", .count = 16, .bit = 21}});
  begin();
  a.port.send(frame_of_53_bits);
  run_for(16 * 45us + 200us);
  // 16 attempts of 43 bits, flags, delimiter and intermission included; the next one is eight bits later.
  EXPECT_EQ(log.frames, (Lines{"291 696 749"}));
}

TEST_F(BusRepeatTest, DominantLastBitOfEof_IsAnOverloadFrameAndTheRepeatFollowsIt) {
  faults({{.kind = FaultKind::duplicate, .count = 1}});
  begin();
  a.port.send(frame_of_53_bits);
  run_for(200us);
  // Flags of all 53 to 58, delimiter 59 to 66, intermission 67 to 69.
  EXPECT_EQ(log.errors, (Lines{"a bit 52"}));
  EXPECT_EQ(log.frames, (Lines{"291 0 53", "291 70 123"}));
  EXPECT_EQ(b.port.receive_error_counter(), 0);
}

TEST_F(BusRepeatTest, FrameThatBeginsInTheErrorFrameOfAnother_HasItsOwnFaultsAndCounts) {
  b.port.set_listen_only(true);
  run_for(1ms);
  const BusLoad before = bus.load(timeline.now());
  faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "b", .bit = 22},
          {.kind = FaultKind::corrupt, .first = 2, .count = 1, .receiver = "a", .bit = 30}});
  log.begin(timeline.now());
  a.port.send(frame_of_53_bits);
  a.port.send(frame_of_47_bits);
  run_for(56us + 40us);
  // The second frame begins at 56, within the error frame of b, which finds an error in its SOF.
  EXPECT_EQ(log.errors.at(0), "b crc 45");
  EXPECT_EQ(log.errors.at(1), "b form 56");
  EXPECT_EQ(std::count(log.errors.begin(), log.errors.end(), "a bit 86"), 1);
  run_for(1ms);
  const BusLoad after = bus.load(timeline.now());
  EXPECT_EQ(log.frames.at(0), "291 0 53");
  EXPECT_EQ(log.frames.size(), 2U);
  EXPECT_EQ(after.frames - before.frames, 2U);
  EXPECT_EQ(after.error_frames - before.error_frames, 2U);  // of the first frame, and of the second
  // Every bit from the first SOF to the end of the last intermission once.
  const long last_end = std::stol(log.frames.at(1).substr(log.frames.at(1).rfind(' ')));
  EXPECT_EQ(after.bits - before.bits, static_cast<std::uint64_t>(last_end + 3));
}

TEST(BusRepeat, RandomErrors_TheWireIsTheReferences) {
  const auto property = [] {
    const Script one = *script();
    RC_ASSERT(verdict(one) == "");
  };
  support::expect_property(property, 150, 500);
}

}  // namespace
}  // namespace canopus::sim::bus_repeat_test
