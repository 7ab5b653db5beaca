// The scans of a CPU: X and Y are refreshed between two of them, and what SM and SD say of them.

#include "canopus/plc/rack/scan.hpp"

#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plc/rack/rack.hpp"

#include "plc/conversation.hpp"

namespace canopus::plc::scan_test {
namespace {

using module::CpuState;
using ::testing::ElementsAre;
using testing::FakeModule;
using ::testing::IsEmpty;
using ::testing::Pair;
using testing::Plc;
using namespace std::chrono_literals;

/// A rack whose scan takes 5 ms, on since 1 s, with a module at 20H.
struct ScannedRack {
  explicit ScannedRack(const CpuModel& model = r04cpu()) : rack(timeline, model, 5ms) {
    timeline.add(module);
    rack.insert(0x20, module);
    timeline.run_until(can::Time{1s});
    rack.power_on(can::Time{1s});
  }
  void run(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
  bool bit(Device device, std::uint32_t number) {
    std::uint8_t value = 2;
    EXPECT_TRUE(rack.read_bits(device, number, {&value, 1}, timeline.now()));
    return value == 1;
  }
  void bit(Device device, std::uint32_t number, bool on) {
    const std::uint8_t value = on ? 1 : 0;
    EXPECT_TRUE(rack.write_bits(device, number, {&value, 1}, timeline.now()));
  }
  std::uint16_t sd(std::uint32_t number) {
    std::uint16_t value = 0xDEAD;
    EXPECT_TRUE(rack.read_words(Device::sd, number, {&value, 1}, timeline.now()));
    return value;
  }

  can::Timeline timeline;
  FakeModule module;
  Rack rack;
};

TEST(ScannedRack, Y_ReachesItsModuleBetweenTwoScans) {
  ScannedRack plc;
  plc.bit(Device::y, 0x21, true);
  EXPECT_TRUE(plc.bit(Device::y, 0x21)) << "the CPU's memory has it at once";
  EXPECT_THAT(plc.module.edges, IsEmpty());
  plc.run(4999us);
  EXPECT_THAT(plc.module.edges, IsEmpty());
  plc.run(1us);
  EXPECT_THAT(plc.module.edges, ElementsAre(Pair(1, true)));
  EXPECT_EQ(plc.module.last_time, can::Time{1005ms});
  plc.run(20ms);
  EXPECT_EQ(plc.module.edges.size(), 1U) << "a level is no edge";
}

TEST(ScannedRack, Y_OfOneScan_GoOutAtOneMoment_AndAPulseWithinAScanDoesNot) {
  ScannedRack plc;
  plc.bit(Device::y, 0x22, true);
  plc.run(1ms);
  plc.bit(Device::y, 0x23, true);
  plc.bit(Device::y, 0x22, false);
  plc.run(1ms);
  plc.bit(Device::y, 0x20, true);
  plc.run(3ms);
  EXPECT_THAT(plc.module.edges, ElementsAre(Pair(0, true), Pair(3, true)));
}

TEST(ScannedRack, X_IsThatOfOneMoment) {
  ScannedRack plc;
  plc.module.x = 0b11;
  EXPECT_FALSE(plc.bit(Device::x, 0x20));
  plc.run(5ms);
  EXPECT_TRUE(plc.bit(Device::x, 0x20));
  plc.module.x = 0b10;
  plc.run(4ms);
  EXPECT_TRUE(plc.bit(Device::x, 0x20)) << "until the scan ends";
  plc.run(1ms);
  EXPECT_FALSE(plc.bit(Device::x, 0x20));
  EXPECT_TRUE(plc.bit(Device::x, 0x21));
}

TEST(ScannedRack, X_AtPowerOn_IsWhatTheModuleSaysThen) {
  ScannedRack plc;
  plc.rack.power_off(plc.timeline.now());
  EXPECT_FALSE(plc.bit(Device::x, 0x20));
  plc.module.x = 1;
  plc.rack.power_on(plc.timeline.now());
  EXPECT_TRUE(plc.bit(Device::x, 0x20));
}

TEST(ScannedRack, StopAndRun_SwitchYAtOnce) {
  ScannedRack plc;
  plc.bit(Device::y, 0x20, true);
  plc.run(6ms);
  plc.rack.set_cpu_state(CpuState::stop, plc.timeline.now());
  EXPECT_THAT(plc.module.edges, ElementsAre(Pair(0, true), Pair(0, false)));
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  EXPECT_EQ(plc.module.edges.back(), std::make_pair(0U, true));
}

/// Notes what it is asked for, and what the rack is like then.
struct NotedRequests final : EndProcessing::Requests {
  NotedRequests(ScannedRack& the_plc, std::string the_name, std::vector<std::string>& the_notes)
      : plc(the_plc), name(std::move(the_name)), notes(the_notes) {}
  void answer_requests(can::Time now) override {
    notes.push_back(name);
    EXPECT_EQ(now, plc.timeline.now());
    if (act) act();
  }
  ScannedRack& plc;
  std::string name;
  std::vector<std::string>& notes;
  std::function<void()> act;
};

TEST(ScannedRack, AtTheEnd_ModulesAreRefreshed_ThenX_ThenRequestsAnswered_ThenYGoOut) {
  struct Refresh final : RackListener {
    explicit Refresh(ScannedRack& the_plc, std::vector<std::string>& the_notes)
        : plc(the_plc), notes(the_notes) {}
    void supply_changed(bool /*on*/, can::Time /*now*/) override {}
    void cpu_changed(CpuState /*state*/, can::Time /*now*/) override {}
    void scan_ended(can::Time now) override {
      if (now != can::Time{1005ms}) return;
      notes.push_back("refresh");
      EXPECT_FALSE(plc.bit(Device::x, 0x20));
      plc.module.x = 1;
    }
    ScannedRack& plc;
    std::vector<std::string>& notes;
  };
  ScannedRack plc;
  std::vector<std::string> notes;
  Refresh refresh(plc, notes);
  plc.rack.add_listener(refresh);
  NotedRequests requests(plc, "asked", notes);
  requests.act = [&plc] {
    EXPECT_TRUE(plc.bit(Device::x, 0x20));
    EXPECT_THAT(plc.module.edges, IsEmpty());
    plc.bit(Device::y, 0x21, true);
  };
  EXPECT_TRUE(plc.rack.answers_at_end());
  plc.rack.end_processing().wait(requests);
  plc.rack.end_processing().wait(requests);
  plc.run(4999us);
  EXPECT_THAT(notes, IsEmpty());
  plc.run(1us);
  EXPECT_THAT(notes, ElementsAre("refresh", "asked"));
  EXPECT_THAT(plc.module.edges, ElementsAre(Pair(1, true)));
  plc.run(1s);
  EXPECT_EQ(notes.size(), 2U) << "each END is waited for";
}

TEST(ScannedRack, AnEnd_TakesTheRequestsInOrder_WithoutThoseThatHaveLeft_AndNotThoseThatWaitAgain) {
  ScannedRack plc;
  std::vector<std::string> notes;
  NotedRequests first(plc, "first", notes);
  NotedRequests second(plc, "second", notes);
  NotedRequests third(plc, "third", notes);
  NotedRequests fourth(plc, "fourth", notes);
  EndProcessing& end = plc.rack.end_processing();
  for (NotedRequests* each : {&first, &second, &third, &fourth}) end.wait(*each);
  first.act = [&] {
    end.wait(first);
    end.leave(third);
    plc.rack.reset_cpu(plc.timeline.now());  // no END of its own
  };
  end.leave(second);
  plc.run(5ms);
  EXPECT_THAT(notes, ElementsAre("first", "fourth"));
  first.act = {};
  plc.run(5ms);
  EXPECT_THAT(notes, ElementsAre("first", "fourth", "first"));
}

TEST(ScannedRack, WithoutSupplyOrScan_NobodyHasToWait) {
  ScannedRack plc;
  std::vector<std::string> notes;
  NotedRequests requests(plc, "asked", notes);
  plc.rack.end_processing().wait(requests);
  plc.rack.power_off(plc.timeline.now());
  EXPECT_THAT(notes, ElementsAre("asked"));
  EXPECT_FALSE(plc.rack.answers_at_end());
  plc.rack.power_on(plc.timeline.now());
  EXPECT_TRUE(plc.rack.answers_at_end());
  EXPECT_FALSE(Plc().rack.answers_at_end());
}

TEST(ScannedRack, WithoutSupply_NothingIsRefreshed) {
  ScannedRack plc;
  plc.bit(Device::y, 0x20, true);
  plc.rack.power_off(plc.timeline.now());
  plc.run(1s);
  EXPECT_THAT(plc.module.edges, IsEmpty());
  EXPECT_EQ(plc.timeline.next(), can::never);
}

TEST(ScannedRack, Sm402And403_AreThoseOfTheFirstScanAfterRun) {
  ScannedRack plc;
  const auto first = [&plc] { return plc.bit(Device::sm, 402) && !plc.bit(Device::sm, 403); };
  const auto later = [&plc] { return !plc.bit(Device::sm, 402) && plc.bit(Device::sm, 403); };
  EXPECT_TRUE(first());
  plc.run(4999us);
  EXPECT_TRUE(first());
  plc.run(1us);
  EXPECT_TRUE(later());
  plc.run(1s);
  EXPECT_TRUE(later());
  plc.rack.set_cpu_state(CpuState::stop, plc.timeline.now());
  EXPECT_FALSE(plc.bit(Device::sm, 402) || plc.bit(Device::sm, 403));
  plc.run(1s);
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  EXPECT_TRUE(first());
  plc.run(5ms);
  plc.rack.pause(plc.timeline.now());
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  EXPECT_TRUE(later()) << "PAUSE is no STOP";
}

TEST(ScannedRack, Sd420_CountsScansInRun) {
  ScannedRack plc;
  EXPECT_EQ(plc.sd(420), 0);
  plc.run(5ms * 7 + 1ms);
  EXPECT_EQ(plc.sd(420), 7);
  plc.rack.pause(plc.timeline.now());
  plc.run(1s);
  EXPECT_EQ(plc.sd(420), 7);
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  plc.run(5ms);
  EXPECT_EQ(plc.sd(420), 8) << "counts on after PAUSE";
  plc.rack.set_cpu_state(CpuState::stop, plc.timeline.now());
  plc.run(1s);
  EXPECT_EQ(plc.sd(420), 8);
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  EXPECT_EQ(plc.sd(420), 0) << "and anew after STOP";
  plc.run(5ms * 65537);
  EXPECT_EQ(plc.sd(420), 1) << "a word";
}

TEST(ScannedRack, ScanTimes_AreMillisecondsAndMicroseconds) {
  can::Timeline timeline;
  Rack q(timeline, q03udvcpu(), 2500us);
  Rack iqr(timeline, r04cpu(), 2500us);
  q.power_on({});
  iqr.power_on({});
  const auto words = [](Rack& rack, std::uint32_t first, can::Time now) {
    std::array<std::uint16_t, 8> found{};
    EXPECT_TRUE(rack.read_words(Device::sd, first, found, now));
    return found;
  };
  EXPECT_THAT(words(q, 520, can::Time{2ms}), ElementsAre(0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(words(q, 520, can::Time{3ms}), ElementsAre(2, 500, 2, 500, 2, 500, 2, 500));
  EXPECT_THAT(words(iqr, 518, can::Time{3ms}), ElementsAre(2, 500, 2, 500, 2, 500, 2, 500));
  EXPECT_EQ(words(iqr, 526, can::Time{3ms})[0], 0) << "END processing time: not known";
}

TEST(Rack, WithoutAScanOfItsOwn_YActsAtOnceAndScansAreCounted) {
  Plc plc;
  plc.bit(Device::y, 1, true);
  EXPECT_EQ(plc.module.edges.size(), 1U);
  EXPECT_TRUE(plc.bit(Device::sm, 402));
  plc.now += 1s;
  EXPECT_FALSE(plc.bit(Device::sm, 402));
  EXPECT_EQ(plc.word(Device::sd, 420), 100) << "10 ms each";
}

TEST(Scan, EndOf_IsOnTheGrid_AndNeverBeyondAllTime) {
  Scan scan(10ms);
  scan.start(can::Time{3ms});
  EXPECT_EQ(scan.end_of(1, can::Time{3ms}), can::Time{13ms});
  EXPECT_EQ(scan.end_of(1, can::Time{12ms}), can::Time{13ms});
  EXPECT_EQ(scan.end_of(1, can::Time{13ms}), can::Time{23ms});
  EXPECT_EQ(scan.end_of(5, can::Time{20ms}), can::Time{63ms});
  EXPECT_EQ(scan.end_of(UINT64_MAX, can::Time{20ms}), can::never);
  EXPECT_EQ(scan.end_of(std::uint64_t{1} << 63U, can::Time{20ms}), can::never);
  EXPECT_EQ(scan.ended(can::Time{12ms}), 0U);
  EXPECT_EQ(scan.ended(can::Time{13ms}), 1U);
}

}  // namespace
}  // namespace canopus::plc::scan_test
