// A bus does the same at the same times whether somebody records a waveform of it, looks at its bits, or does neither; and
// the error counters in the waveform change when the events say so.
//
// CANOPUS_SEEDS: so many scripts instead of 40; RC_PARAMS=seed=N: others.

#include <iomanip>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "canopus/sim/bus/waveform/waveform.hpp"

#include "sim/bus_run.hpp"
#include "sim/waveform_reading.hpp"

namespace canopus::sim::bus_watched_test {
namespace {

using namespace random_script;

struct NeedsBits final : WireObserver {
  void level_changed(bool, Time) override {}
  void transmit_changed(const Port&, bool, Time) override {}
  void activity_changed(const Port&, bool, bool, Time) override {}
};

/// Everything that a bus reports of its frames, errors and controllers, a line each, in its order.
class Events final : public BusObserver {
 public:
  struct Counters {
    Time at;
    std::string port;
    int transmit_errors;
    int receive_errors;
  };

  void frame_completed(const Frame& frame, Time start, Time end) override {
    lines.push_back("frame " + std::to_string(frame.identifier) + " from " + nanoseconds(start) + " to " +
                    nanoseconds(end));
    start_of_last_frame = start;
  }
  void error_detected(const Port& port, BusError error, Time now) override {
    lines.push_back(nanoseconds(now) + " error of " + port.name() + ": " + std::string(can::name(error)));
  }
  void errors_reported(std::span<const can::BusErrorReport> reports, Time now) override {
    for (const can::BusErrorReport& one : reports) {
      lines.push_back(nanoseconds(now) + " " + one.port->name() + ": " + std::string(can::name(one.error)) +
                      " in " + std::string(can::name(one.field)) + ", bit " + std::to_string(one.bit) +
                      (one.first ? ", first" : "") + counters(one));
    }
  }
  void controller_changed(const can::ControllerReport& one, Time now) override {
    lines.push_back(nanoseconds(now) + " " + one.port->name() + ": state " +
                    std::to_string(static_cast<int>(one.before)) + " to " +
                    std::to_string(static_cast<int>(one.state)) + (one.warning ? ", warning" : "") +
                    counters(one));
    changes.push_back({now, one.port->name(), one.transmit_errors, one.receive_errors});
  }
  void inspect(const Port& port, Time now) {
    lines.push_back(nanoseconds(now) + " " + port.name() + " has TEC " +
                    std::to_string(port.transmit_error_counter()) + ", REC " +
                    std::to_string(port.receive_error_counter()));
  }

  std::vector<std::string> lines;
  std::vector<Counters> changes;
  Time start_of_last_frame{};

 private:
  template <typename Report>
  static std::string counters(const Report& report) {
    return ", TEC " + std::to_string(report.transmit_errors) + ", REC " +
           std::to_string(report.receive_errors);
  }
};

/// The first line in which they differ, with some before it; empty: they are the same.
std::string difference(const Events& one, const Events& other) {
  const auto [left, right] = std::ranges::mismatch(one.lines, other.lines);
  if (left == one.lines.end() && right == other.lines.end()) return {};
  std::string text;
  for (auto line = left - std::min<std::ptrdiff_t>(left - one.lines.begin(), 5); line != left; ++line)
    text += *line + "\n";
  return text + "one: " + (left == one.lines.end() ? "end" : *left) +
         "\nother: " + (right == other.lines.end() ? "end" : *right);
}

/// The first change of a controller that the waveform does not have at its time; empty: it has all.
std::string missing_in(const waveform_reading::Read& wave, const Events& events) {
  waveform_reading::Values before;
  waveform_reading::Values at;
  std::int64_t tick = -1;
  auto moment = wave.moments.begin();
  for (const Events::Counters& change : events.changes) {
    const std::int64_t of_change = change.at.time_since_epoch() / wave.unit;
    if (of_change != tick) before = at;
    tick = of_change;
    for (; moment != wave.moments.end() && moment->first <= tick; ++moment) {
      for (const auto& [name, value] : moment->second) at[name] = value;
      if (moment->first < tick) before = at;
    }
    const std::string tec = change.port + "_tec";
    const std::string rec = change.port + "_rec";
    if (!at.contains(tec)) continue;  // it came after the head was written
    const std::string what = change.port + " at " + nanoseconds(change.at);
    if (at[tec] != change.transmit_errors || at[rec] != change.receive_errors)
      return what + ": other counters";
    if (at[tec] == before[tec] && at[rec] == before[rec]) return what + ": counters that were there before";
  }
  return {};
}

enum class Watch : std::uint8_t { nobody, waveform, bits };

struct Watched {
  Events events;
  waveform_reading::Read wave;
};

Watched watch(const Script& script, Watch how) {
  Run run(script, false);
  Watched watched;
  std::string text;
  NeedsBits bits;
  std::optional<Waveform> waveform;
  run.bus().add_observer(static_cast<BusObserver&>(watched.events));
  run.inspect = [&](const Port& port) { watched.events.inspect(port, run.now()); };
  if (how == Watch::bits) run.bus().add_observer(static_cast<WireObserver&>(bits));
  if (how == Watch::waveform)
    waveform.emplace(
        run.bus(), run.now(), [&text](std::string_view piece) { text += piece; }, 1ns);
  (void)run();
  if (waveform) waveform->flush(run.now());
  waveform.reset();
  watched.wave = waveform_reading::read(text);
  if (how == Watch::bits) run.bus().remove_observer(static_cast<WireObserver&>(bits));
  return watched;
}

void check_scripts(bool rough) {
  const auto property = [rough] {
    const Script one = *script(rough);
    const Watched alone = watch(one, Watch::nobody);
    const Watched recorded = watch(one, Watch::waveform);
    RC_ASSERT(difference(alone.events, recorded.events) == "");
    RC_ASSERT(difference(alone.events, watch(one, Watch::bits).events) == "");
    RC_ASSERT(missing_in(recorded.wave, recorded.events) == "");
  };
  rc::detail::TestParams params = rc::detail::configuration().testParams;
  const char* wanted = std::getenv("CANOPUS_SEEDS");
  params.maxSuccess = wanted != nullptr ? std::atoi(wanted) : 40;
  const auto result = rc::detail::checkTestable(property, rc::detail::TestMetadata{}, params);
  std::ostringstream text;
  rc::detail::printResultMessage(result, text);
  EXPECT_TRUE(result.is<rc::detail::SuccessResult>()) << text.str();
}

TEST(WatchedBus, CalmScripts_HaveTheSameEventsWhoeverWatches) { check_scripts(false); }
TEST(WatchedBus, RoughScripts_HaveTheSameEventsWhoeverWatches) { check_scripts(true); }

/// What the bus reports when these frames are sent at one moment, by a port each, and a bit of the first attempt is inverted.
std::vector<std::string> events_of(const std::vector<Frame>& frames, unsigned bit, bool is_observed) {
  can::Timeline timeline;
  Bus bus("bus", 1'000'000, timeline);
  Events events;
  NeedsBits bits;
  bus.add_observer(static_cast<BusObserver&>(events));
  if (is_observed) bus.add_observer(static_cast<WireObserver&>(bits));
  std::vector<std::unique_ptr<Station>> stations;
  for (const Frame& frame : frames) {
    stations.push_back(std::make_unique<Station>(bus, timeline, std::to_string(stations.size())));
    stations.back()->send_at(Time(100us), frame);
  }
  EXPECT_TRUE(bus.set_faults({{.kind = FaultKind::corrupt, .count = 1, .bit = bit}}, 1).has_value());
  timeline.run_until(Time(2ms));
  for (const auto& station : stations) events.inspect(station->port, timeline.now());
  bus.remove_observer(static_cast<WireObserver&>(bits));
  return events.lines;
}

// An extended frame loses to a remote frame of the same base identifier by IDE alone, which is no bit of its arbitration field.
TEST(WatchedBus, ACorruptedBitOfAnArbitration_HasTheSameEventsWhoeverWatches) {
  Frame remote = can::data_frame(0x2A5);
  remote.remote = true;
  Frame extended = can::data_frame(0x2A5U << 18, {0x5A});
  extended.extended = true;
  const std::vector<Frame> frames = {remote, extended, can::data_frame(0x2A6, {1, 2, 3})};
  for (unsigned bit = 0; bit < 70; ++bit) {
    EXPECT_EQ(events_of(frames, bit, false), events_of(frames, bit, true)) << "bit " << bit;
  }
}

/// Drive and encoder at 500 kbit/s: the drive sends its boot-up 703#00 at 0, then 703#05 each millisecond.
struct DriveAndEncoder {
  explicit DriveAndEncoder(const Fault& fault) {
    bus.add_observer(static_cast<BusObserver&>(events));
    EXPECT_TRUE(bus.set_faults({fault}, 1).has_value());
    drive.send_at(Time{}, can::data_frame(0x703, {0x00}));
    for (int number = 1; number <= 40; ++number)
      drive.send_at(Time(number * 1ms), can::data_frame(0x703, {0x05}));
  }
  /// The changes of a counter in the waveform: "us=value".
  std::vector<std::string> record(const std::string& signal) {
    std::string text;
    Waveform waveform(bus, Time{}, [&](std::string_view piece) { text += piece; });
    timeline.run_until(Time(41ms));
    waveform.flush(Time(41ms));
    const waveform_reading::Read read = waveform_reading::read(text);
    std::vector<std::string> changes;
    for (const auto& [tick, values] : read.moments) {
      const auto found = values.find(signal);
      if (found == values.end()) continue;
      std::ostringstream change;
      change << std::fixed << std::setprecision(2) << static_cast<double>((tick * read.unit).count()) / 1000.0
             << "=" << found->second;
      changes.push_back(change.str());
    }
    return changes;
  }
  can::Timeline timeline;
  Bus bus{"line", 500'000, timeline};
  Station drive{bus, timeline, "drive"};
  Station encoder{bus, timeline, "encoder"};
  Events events;
};

const Fault twenty_bad_bits{.kind = FaultKind::corrupt, .sender = "drive", .count = 20, .bit = 25};

// 703#05 is 0 1110000(1)0011 0 0 0 0(1)001 00000(1)101 011110100011010 with its stuff bits as they fall: 45 bits, then CRC
// delimiter, ACK slot (bit 46), ACK delimiter, EOF (bits 48 to 54). A bit is 2 us, its sample point at 1.75 us. Four errors
// as a passive transmitter bring TEC to 160; the 33rd success, the frame that begins at 32,000 us, to 127.
TEST(WatchedBus, ADriveOfTwentyErrors_IsErrorActiveAgainAtTheSampleOfTheLastBitOfEof) {
  DriveAndEncoder unwatched(twenty_bad_bits);
  unwatched.timeline.run_until(Time(41ms));
  const Time expected(32'000us + 54 * 2us + 1750ns);
  ASSERT_FALSE(unwatched.events.changes.empty());
  EXPECT_EQ(nanoseconds(unwatched.events.changes.back().at), nanoseconds(expected));
  EXPECT_EQ(unwatched.events.changes.back().transmit_errors, 127);

  DriveAndEncoder recorded(twenty_bad_bits);
  const auto tec = recorded.record("drive_tec");
  EXPECT_EQ(recorded.events.lines, unwatched.events.lines);
  EXPECT_NE(std::ranges::find(tec, "32109.75=127"), tec.end());
}

TEST(WatchedBus, CountersThatAreReadWithinAFrame_AreThoseOfItsBits) {
  // The frame that begins at 10,000 us is the eleventh success: REC was 20, TEC 160.
  for (const bool is_recorded : {false, true}) {
    DriveAndEncoder one(twenty_bad_bits);
    std::optional<Waveform> waveform;
    if (is_recorded) waveform.emplace(one.bus, Time{}, [](std::string_view) {});
    const Time acknowledged(10'000us + 46 * 2us + 1750ns);
    const Time sent(10'000us + 54 * 2us + 1750ns);
    const auto counters_at = [&](Time moment) {
      one.timeline.run_until(moment);
      return std::pair<int, int>(one.drive.port.transmit_error_counter(),
                                 one.encoder.port.receive_error_counter());
    };
    EXPECT_EQ(counters_at(acknowledged - 1ns), std::pair(150, 10));
    EXPECT_EQ(counters_at(acknowledged), std::pair(150, 9));
    EXPECT_EQ(counters_at(sent - 1ns), std::pair(150, 9));
    EXPECT_EQ(counters_at(sent), std::pair(149, 9));
    EXPECT_EQ(counters_at(sent + 1us), std::pair(149, 9));
  }
}

TEST(WatchedBus, RecInTheWaveform_FallsAtTheSampleOfTheAckSlot) {
  DriveAndEncoder recorded(twenty_bad_bits);
  const auto rec = recorded.record("encoder_rec");
  EXPECT_NE(std::ranges::find(rec, "10093.75=9"), rec.end());
  EXPECT_EQ(rec.back(), "19093.75=0");
}

// Each error that the encoder alone sees costs it 1, and 8 because the drive's flag follows its own: 135 after fifteen.
TEST(WatchedBus, AnEncoderOfFifteenErrors_IsErrorActiveAgainAtTheSampleOfTheAckSlot) {
  const Fault fault{.kind = FaultKind::corrupt,
                    .sender = "drive",
                    .first = 2,
                    .count = 15,
                    .receiver = "encoder",
                    .bit = 25};
  DriveAndEncoder one(fault);
  one.timeline.run_until(Time(1ms));
  const std::size_t before = one.events.changes.size();
  while (one.encoder.port.receive_error_counter() < 135) one.timeline.run_until(one.timeline.next());
  while (one.encoder.port.error_state() != can::ErrorState::error_active)
    one.timeline.run_until(one.timeline.next());
  const Time changed = one.timeline.now();
  EXPECT_EQ(one.encoder.port.receive_error_counter(), 127);
  EXPECT_GT(one.events.changes.size(), before);
  EXPECT_EQ(nanoseconds(one.events.changes.back().at), nanoseconds(changed));
  one.timeline.run_until(changed + 50us);  // the frame is over by now
  EXPECT_EQ(nanoseconds(one.events.start_of_last_frame + 46 * 2us + 1750ns), nanoseconds(changed));
}

TEST(WatchedBus, CountersOfAControllerThatIsSwitchedOff_AreZeroInTheWaveformAtOnce) {
  DriveAndEncoder one(twenty_bad_bits);
  Event off;
  off.happens = [&](Time) { one.encoder.port.set_power(false); };
  off.alarm() = Time(10'050us);
  one.timeline.add(off);
  EXPECT_EQ(one.record("encoder_rec").back(), "10050.00=0");
}

/// The load at the end of the first and of the second second of a bus of 500 kbit/s on which a node sends 703#05 at this moment.
std::vector<double> loads(Time sent, const std::vector<Fault>& faults, Watch how) {
  can::Timeline timeline;
  Bus bus("line", 500'000, timeline);
  Station drive(bus, timeline, "drive");
  const Station encoder(bus, timeline, "encoder");
  NeedsBits bits;
  std::optional<Waveform> waveform;
  EXPECT_TRUE(bus.set_faults(faults, 1).has_value());
  if (how == Watch::bits) bus.add_observer(static_cast<WireObserver&>(bits));
  if (how == Watch::waveform) waveform.emplace(bus, Time{}, [](std::string_view) {});
  drive.send_at(sent, can::data_frame(0x703, {0x05}));
  std::vector<double> shares;
  for (const Time second : {Time(1s), Time(2s)}) {
    timeline.run_until(second - 1ns);
    shares.push_back(bus.load(second - 1ns).now);
    timeline.run_until(second);
    shares.insert(shares.end(), {bus.load(second).now, bus.load(second).peak});
  }
  waveform.reset();
  if (how == Watch::bits) bus.remove_observer(static_cast<WireObserver&>(bits));
  return shares;
}

TEST(WatchedBus, AFrameAcrossTheSecond_IsOfBothWhoeverWatches) {
  for (int bit = -70; bit <= 2; ++bit) {
    const Time sent = Time(1s) + bit * 2us;
    // The boot-up is none of it. 703#05 takes 55 bits and the 3 of the intermission.
    const double first = std::clamp(-bit, 0, 58) * 2e-6;
    const double second = 58 * 2e-6 - first;
    const auto alone = loads(sent, {}, Watch::nobody);
    EXPECT_THAT(alone, testing::Pointwise(testing::DoubleNear(1e-12),
                                          {0.0, first, first, first, second, std::max(first, second)}))
        << bit;
    EXPECT_EQ(alone, loads(sent, {}, Watch::waveform)) << bit;
    EXPECT_EQ(alone, loads(sent, {}, Watch::bits)) << bit;
    const auto faulty = loads(sent, {twenty_bad_bits}, Watch::nobody);
    EXPECT_EQ(faulty, loads(sent, {twenty_bad_bits}, Watch::waveform)) << bit;
    EXPECT_EQ(faulty, loads(sent, {twenty_bad_bits}, Watch::bits)) << bit;
  }
}

}  // namespace
}  // namespace canopus::sim::bus_watched_test
