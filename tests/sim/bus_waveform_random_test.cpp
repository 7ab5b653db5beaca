// Waveforms of random scripts: what their text says is what the bus reports bit by bit, whether the bus works bit by bit
// for somebody else or tells whole frames.
//
// CANOPUS_SEEDS: so many scripts instead of 40, or of 200 in ./check --all; RC_PARAMS=seed=N: others.

#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "canopus/sim/bus/waveform/waveform.hpp"

#include "can/random_frame.hpp"
#include "sim/bus_run.hpp"
#include "sim/waveform_reading.hpp"
#include "support/random_cases.hpp"

namespace canopus::sim::bus_waveform_random_test {
namespace {

using namespace random_script;

struct NeedsBits final : WireObserver {
  void level_changed(bool, Time) override {}
  void transmit_changed(const Port&, bool, Time) override {}
  void activity_changed(const Port&, bool, bool, Time) override {}
};

/// The waveform of a script, with somebody who needs bits or without.
std::string waveform_of(const Script& script, bool bit_by_bit) {
  Run run(script, false);
  std::string text;
  NeedsBits other;
  if (bit_by_bit) run.bus().add_observer(static_cast<WireObserver&>(other));
  std::optional<Waveform> waveform;
  waveform.emplace(run.bus(), run.now(), [&text](std::string_view piece) { text += piece; });
  (void)run();
  waveform->flush(run.now());
  waveform.reset();
  if (bit_by_bit) run.bus().remove_observer(static_cast<WireObserver&>(other));
  return text;
}

/// The lines of each moment in order: receivers that go through the bits together are told of one after the other.
std::string in_order(const std::string& text) {
  std::string all;
  std::vector<std::string> lines;
  std::istringstream in(text);
  const auto end_moment = [&] {
    std::ranges::sort(lines);
    for (const std::string& line : lines) all += line + "\n";
    lines.clear();
  };
  for (std::string line; std::getline(in, line); lines.push_back(line)) {
    if (line.starts_with("#")) end_moment();
  }
  end_moment();
  return all;
}

/// The first line in which they differ, with some before it.
std::string first_different_line(const std::string& frame_by_frame, const std::string& bit_by_bit) {
  const std::string one = in_order(frame_by_frame);
  const std::string other = in_order(bit_by_bit);
  const auto at = static_cast<std::size_t>(
      std::mismatch(one.begin(), one.end(), other.begin(), other.end()).first - one.begin());
  if (at == one.size() && at == other.size()) return {};
  const std::size_t from = at < 100 ? 0 : at - 100;
  return "frame by frame:\n" + one.substr(from, 200) + "\nbit by bit:\n" + other.substr(from, 200);
}

void check_waveforms(bool rough) {
  const auto property = [rough] {
    const Script one = *script(rough);
    const std::string frame_by_frame = waveform_of(one, false);
    RC_ASSERT(first_different_line(frame_by_frame, waveform_of(one, true)) == "");
    const waveform_reading::Read read = waveform_reading::read(frame_by_frame);
    Run run(one, false);
    waveform_reading::Report report(run.bus(), read.unit, run.now());
    run.bus().add_observer(static_cast<WireObserver&>(report));
    (void)run();
    run.bus().remove_observer(static_cast<WireObserver&>(report));
    RC_ASSERT(waveform_reading::difference(read.moments, report.moments()) == "");
  };
  support::expect_property(property, 40, 200);
}

/// Runs stations that send at times, with faults, and returns the waveform.
std::string waveform_of(const std::vector<std::vector<std::pair<Time, Frame>>>& sendings,
                        const std::vector<Fault>& faults, bool bit_by_bit, Time end) {
  can::Timeline timeline;
  Bus bus("bus", 1'000'000, timeline);
  std::vector<std::unique_ptr<Station>> stations;
  for (const auto& of_station : sendings) {
    stations.push_back(std::make_unique<Station>(bus, timeline, std::to_string(stations.size())));
    for (const auto& [moment, frame] : of_station) stations.back()->send_at(moment, frame);
  }
  EXPECT_TRUE(bus.set_faults(faults, 1).has_value());
  std::string text;
  NeedsBits other;
  if (bit_by_bit) bus.add_observer(static_cast<WireObserver&>(other));
  Waveform waveform(bus, timeline.now(), [&text](std::string_view piece) { text += piece; });
  timeline.run_until(end);
  waveform.flush(end);
  return text;
}

TEST(WaveformRandom, ArbitrationOfManyWithIdentifiersAlike_SaysWhatItSaysBitByBit) {
  std::mt19937_64 random(2026);
  for (unsigned round = 0; round < 200; ++round) {
    std::vector<std::vector<std::pair<Time, Frame>>> sendings(2 + random() % 8);
    const Frame alike = can::random_frame(random);
    for (auto& of_station : sendings) {
      for (unsigned count = 0; count < 3; ++count) {
        Frame frame = random() % 4 == 0 ? can::random_frame(random) : alike;
        frame.identifier ^= 1U << random() % (frame.extended ? 29 : 11);
        of_station.emplace_back(Time(100us) + count * 300us, frame);
      }
    }
    const Time end = Time(100us) + Duration(random() % 3'000'000);
    ASSERT_EQ(
        first_different_line(waveform_of(sendings, {}, false, end), waveform_of(sendings, {}, true, end)), "")
        << "round " << round;
  }
}

TEST(WaveformRandom, AFaultAtAnyMomentOfAFrameAndBehindIt_SaysWhatItSaysBitByBit) {
  const std::vector<std::vector<std::pair<Time, Frame>>> sendings = {
      {{Time(100us), can::data_frame(0x123, {0x55})}, {Time(100us), can::data_frame(0x456)}},
      {{Time(120us), can::data_frame(0x124)}},
      {}};
  for (Duration at = 99us; at < 280us; at += 317ns) {
    const std::vector<Fault> faults = {
        {.kind = FaultKind::stuck_dominant, .from = Time(at), .until = Time(at + 1500ns), .ports = {"2"}}};
    const Time end(500us);
    ASSERT_EQ(first_different_line(waveform_of(sendings, faults, false, end),
                                   waveform_of(sendings, faults, true, end)),
              "")
        << at.count() << " ns";
  }
}

TEST(WaveformRandom, CalmScripts_SayWhatTheBusReports) { check_waveforms(false); }
TEST(WaveformRandom, RoughScripts_SayWhatTheBusReports) { check_waveforms(true); }

}  // namespace
}  // namespace canopus::sim::bus_waveform_random_test
