// Receivers in lockstep, without a bus: which ports one of them samples for, and that each is where it would be alone.

#include "canopus/sim/bus/bitwise/lockstep.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::sim::lockstep_test {
namespace {

using Ports = std::vector<BusPort*>;

struct BareWire final : Wire {
  using Wire::Wire;
  void before_change() override {}
  void after_change() override {}
  [[nodiscard]] can::FaultConfinement counters_of(const BusPort& port) const noexcept override {
    return port.faults;
  }
  [[nodiscard]] bool may_begin_bitwise(const BusPort&, can::Time) const noexcept override { return false; }
};

/// What a port would send next: 18 bits of arbitration and control, 8 of data.
const can::Frame frame = can::data_frame(0x2A5, {0x5A});

/// Ports of which the first transmits `frame`; bits are sampled one by one, without times.
struct Receivers : BusSchedule {
  explicit Receivers(std::uint32_t count) {
    for (std::uint32_t index = 0; index < count; ++index) {
      core.acceptance.resize(index + 1);
      core.ports.push_back(std::make_unique<BusPort>(core, wire, index, std::to_string(index)));
      wire.members.push_back(core.ports.back().get());
    }
    lockstep.update_members();
    port(0).bits.transmit(frame);
  }
  void deadline_changed() noexcept override {}
  [[nodiscard]] BusPort& port(std::size_t index) { return *core.ports[index]; }

  /// So many bits pass for the ports that sample by themselves.
  void run(unsigned bits) {
    while (bits-- > 0) {
      bool dominant = false;
      for (const BusPort* one : lockstep.sampling()) dominant = dominant || one->bits.drives_dominant();
      for (BusPort* one : lockstep.sampling()) {
        one->phase.sampled = dominant;
        one->bits.sample(dominant);
      }
    }
  }

  can::Timeline timeline;
  BusCore core{"bus", 1'000'000, timeline, *this};
  BareWire wire{core, true};
  Lockstep lockstep{wire};
};

/// What decides about a controller's next bits.
std::string state_of(const BusPort& port) {
  const BitController::Position at = port.bits.position();
  return "state " + std::to_string(static_cast<int>(at.state)) + ", field " +
         std::to_string(static_cast<int>(at.field())) + ", bit " + std::to_string(at.number) + ", row " +
         std::to_string(at.row) + ", payload " + std::to_string(at.payload) +
         (port.bits.drives_dominant() ? ", dominant" : "") + ", received " +
         std::to_string(port.bits.frame().identifier);
}

TEST(Lockstep, ReceiversOfAFrame_AreSampledByTheFirstOfThem) {
  Receivers four(4);
  four.run(1);  // SOF
  four.lockstep.form_lockstep();
  EXPECT_EQ(four.lockstep.leaders(), Ports{&four.port(1)});
  EXPECT_EQ(four.lockstep.sampling(), (Ports{&four.port(0), &four.port(1)}));
  EXPECT_FALSE(Lockstep::is_follower(four.port(1)));
  EXPECT_TRUE(Lockstep::is_follower(four.port(2)));
  EXPECT_TRUE(Lockstep::is_follower(four.port(3)));
}

TEST(Lockstep, ASingleReceiver_NeedsNone) {
  Receivers two(2);
  two.run(1);
  two.lockstep.form_lockstep();
  EXPECT_TRUE(two.lockstep.leaders().empty());
  EXPECT_EQ(two.lockstep.sampling(), (Ports{&two.port(0), &two.port(1)}));
}

TEST(Lockstep, AtEveryBitOfAFrame_ASplitLeavesEachReceiverWhereItWouldBeAlone) {
  constexpr unsigned bits = 60;  // the frame, its intermission, and some more
  for (unsigned together = 1; together <= bits; ++together) {
    Receivers alone(4);
    Receivers joined(4);
    alone.run(1);
    joined.run(1);
    joined.lockstep.form_lockstep();
    alone.run(together);
    joined.run(together);
    joined.lockstep.split_lockstep();
    EXPECT_TRUE(joined.lockstep.leaders().empty());
    ASSERT_EQ(joined.lockstep.sampling().size(), 4U);
    for (unsigned bit = together; bit <= bits; ++bit) {
      for (std::size_t index = 0; index < 4; ++index) {
        ASSERT_FALSE(Lockstep::is_follower(joined.port(index)));
        ASSERT_EQ(state_of(joined.port(index)), state_of(alone.port(index)))
            << "port " << index << ", split after " << together << " bits, bit " << bit;
      }
      alone.run(1);
      joined.run(1);
    }
    EXPECT_EQ(joined.port(3).bits.frame(), frame);
  }
}

struct Difference {
  std::string what;
  std::function<void(Receivers&)> make;  // to port 2
};

TEST(Lockstep, AReceiverThatIsOrWillBeDifferent_StaysOutside) {
  const std::vector<Difference> differences = {
      {"another bit rate", [](Receivers& all) { all.port(2).rate = 500'000; }},
      {"another sample point", [](Receivers& all) { all.port(2).phase.next = can::Time(can::Duration(5)); }},
      {"another start of its bit", [](Receivers& all) { all.port(2).phase.bit_start += can::Duration(1); }},
      {"another last sample", [](Receivers& all) { all.port(2).phase.sampled ^= true; }},
      {"error passive",
       [](Receivers& all) {
         for (int error = 0; error < 16; ++error) all.port(2).faults.transmitter_error();
       }},
      {"stuck recessive", [](Receivers& all) { all.port(2).stuck_recessive = true; }},
      {"late", [](Receivers& all) { all.port(2).lateness = can::Duration(100); }},
      {"noise", [](Receivers& all) { all.port(2).inverted = true; }},
      {"listens only", [](Receivers& all) { all.port(2).bits.set_listen_only(true); }},
      {"asks for overload frames", [](Receivers& all) { all.port(2).bits.set_overload_frames(1); }},
      {"a corruption to come",
       [](Receivers& all) {
         all.wire.faults.corruptions = 1;
         all.wire.faults.corruption[0] = {.bit = 30, .at = &all.port(2)};
       }},
      {"has seen another bit", [](Receivers& all) { all.port(2).bits.sample(true); }},
  };
  for (const Difference& difference : differences) {
    SCOPED_TRACE(difference.what);
    Receivers all(4);
    all.run(1);
    difference.make(all);
    all.lockstep.form_lockstep();
    EXPECT_EQ(all.lockstep.leaders(), Ports{&all.port(1)});
    EXPECT_EQ(all.lockstep.sampling(), (Ports{&all.port(0), &all.port(1), &all.port(2)}));
    EXPECT_TRUE(Lockstep::is_follower(all.port(3)));
  }
}

TEST(Lockstep, AFollowerOfAnotherErrorState_GoesOnByItself) {
  Receivers all(4);
  all.run(1);
  all.lockstep.form_lockstep();
  all.lockstep.split_by_error_state();
  EXPECT_EQ(all.lockstep.sampling(), (Ports{&all.port(0), &all.port(1)}));
  for (int error = 0; error < 16; ++error) all.port(3).faults.transmitter_error();
  all.lockstep.split_by_error_state();
  EXPECT_EQ(all.lockstep.sampling(), (Ports{&all.port(0), &all.port(1), &all.port(3)}));
  EXPECT_TRUE(Lockstep::is_follower(all.port(2)));
  EXPECT_FALSE(Lockstep::is_follower(all.port(3)));
}

TEST(Lockstep, ADeadlineThatMovesTheLeader_MovesItsFollowers) {
  Receivers all(4);
  all.run(1);
  all.lockstep.form_lockstep();
  all.port(0).phase.next = can::Time(can::Duration(3));
  all.port(1).phase.next = can::Time(can::Duration(7));
  all.lockstep.copy_deadline(all.port(1));
  EXPECT_EQ(all.port(0).phase.next, can::Time(can::Duration(3)));
  EXPECT_EQ(all.port(2).phase.next, can::Time(can::Duration(7)));
  EXPECT_EQ(all.port(3).phase.next, can::Time(can::Duration(7)));
}

// Rules a, b and h of ISO 11898-1: an error of a receiver costs 1, one that a dominant bit follows 8, success gives 1 back.
TEST(Lockstep, WhatTheLeaderCounted_IsCountedByEachFollowerFromItsOwnCounter) {
  using enum BitController::Counted;
  const std::vector<std::pair<BitController::Counted, int>> counted = {
      {nothing, 10}, {success, 9}, {error, 11}, {severe_error, 18}};
  for (const auto& [what, expected] : counted) {
    can::FaultConfinement faults;
    for (int errors = 0; errors < 10; ++errors) faults.receiver_error();
    Lockstep::count(faults, what);
    EXPECT_EQ(faults.receive_errors(), expected) << static_cast<int>(what);
  }
}

struct Outputs final : WireObserver {
  void level_changed(bool, can::Time) override {}
  void transmit_changed(const can::Port& port, bool dominant, can::Time) override {
    lines.push_back(port.name() + (dominant ? " dominant" : " recessive"));
  }
  void activity_changed(const can::Port&, bool, bool, can::Time) override {}
  void field_changed(const can::Port&, can::FrameField, can::Time) override { ++fields; }
  std::vector<std::string> lines;
  int fields = 0;
};

TEST(Lockstep, ABitOfTheLeader_IsReportedOfItsFollowersWhenItDiffersFromTheLast) {
  Receivers all(4);
  Outputs outputs;
  all.core.wire_observers.push_back(&outputs);
  all.run(1);
  all.lockstep.form_lockstep();
  const auto report = [&all](bool dominant) {
    all.port(1).phase.set_output(dominant);
    all.lockstep.report_bit(all.port(1), can::Time{});
  };
  report(false);
  EXPECT_EQ(outputs.fields, 2);  // of the two followers, which have just joined
  report(false);
  EXPECT_EQ(outputs.fields, 2);
  report(true);
  report(true);
  report(false);
  EXPECT_EQ(outputs.lines,
            (std::vector<std::string>{"2 dominant", "3 dominant", "2 recessive", "3 recessive"}));
}

}  // namespace
}  // namespace canopus::sim::lockstep_test
