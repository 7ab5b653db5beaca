#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/waveform/waveform.hpp"

#include "can/random_frame.hpp"
#include "can/slow_frame.hpp"
#include "sim/bus_station.hpp"

namespace canopus::sim::bus_waveform_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::Frame;
using can::Time;

struct Scene {
  explicit Scene(std::uint32_t bit_rate) : bus("line 1", bit_rate, timeline) {}
  /// Runs to the end with a waveform and returns its text.
  std::string record(Time end) {
    std::string text;
    Waveform waveform(bus, timeline.now(), [&](std::string_view piece) { text += piece; });
    timeline.run_until(end);
    waveform.flush(end);
    return text;
  }
  can::Timeline timeline;
  Bus bus;
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
};

/// The text without its numbers: TEC, REC and fields.
std::string signals_alone(const std::string& text) {
  std::istringstream in(text);
  std::string kept;
  std::string moment;  // a time is kept only with a change behind it
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("r") || line.starts_with("$comment") || line.starts_with("$var real")) continue;
    if (line.starts_with("#") && line != "#0") {
      moment = line + '\n';
      continue;
    }
    kept += std::exchange(moment, "") + line + '\n';
  }
  return kept;
}

TEST(Waveform, OfAFrameWithoutData_IsThisText) {
  // 0 11111(0)11111(0)1 0 0 0 00(1)00: SOF, identifier, RTR, IDE, r0, DLC. Bits of 10 us with the sample point at 8.75 us.
  Scene scene(100'000);
  scene.a.send_at(Time(1ms), data_frame(0x7FF));
  const std::string text = signals_alone(scene.record(Time(1'200us)));
  EXPECT_EQ(text,
            "$version Canopus $end\n"
            "$timescale 10 ns $end\n"
            "$scope module line_1 $end\n"
            "$var wire 1 ! can $end\n"
            "$var wire 1 \" a_tx $end\n"
            "$var wire 1 # a_flag $end\n"
            "$var wire 1 $ a_arb $end\n"
            "$var wire 1 % b_tx $end\n"
            "$var wire 1 & b_flag $end\n"
            "$var wire 1 ' b_arb $end\n"
            "$upscope $end\n"
            "$enddefinitions $end\n"
            "#0\n"
            "$dumpvars\n1!\n1\"\n0#\n0$\n1%\n0&\n0'\n$end\n"
            "#100000\n0\"\n1$\n0!\n"  // SOF
            "#101000\n1\"\n1!\n"      // five recessive bits of the identifier
            "#106000\n0\"\n0!\n"      // stuff bit
            "#107000\n1\"\n1!\n"
            "#112000\n0\"\n0!\n"
            "#113000\n1\"\n1!\n"  // the last bit of the identifier
            "#114000\n0\"\n0!\n"  // RTR
            "#115000\n0$\n"       // IDE: arbitration is over
            "#119000\n1\"\n1!\n"  // stuff bit
            "#120000\n0\"\n0!\n");
}

bool have_sigrok() { return std::system("command -v sigrok-cli >/dev/null 2>&1") == 0; }

/// What sigrok's CAN decoder says of the wire `can`, a line each, without its prefix.
std::vector<std::string> judge(const std::string& text, std::uint32_t bit_rate, const std::string& classes) {
  const std::string path = ::testing::TempDir() + "canopus_wire.vcd";
  std::ofstream(path) << text;
  const std::string command =
      "sigrok-cli -i '" + path +
      "' -I vcd:downsample=125 -P can:can_rx=can:nominal_bitrate=" + std::to_string(bit_rate) +
      ":sample_point=75 -A can=" + classes + " 2>/dev/null";
  std::vector<std::string> lines;
  std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  if (!pipe) return lines;
  char line[512];
  while (std::fgets(line, sizeof line, pipe.get()) != nullptr) {
    std::string one = line;
    while (!one.empty() && one.back() == '\n') one.pop_back();
    if (one.rfind("can-1: ", 0) == 0) lines.push_back(one.substr(7));
  }
  std::remove(path.c_str());
  return lines;
}

std::string hex(std::uint32_t value, int width = 0) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%0*x", width, value);
  return text;
}

/// The lines that sigrok prints of a frame, stuff bits aside.
std::vector<std::string> expected_lines(const Frame& frame) {
  std::vector<std::string> lines;
  const auto identifier = [&](const char* name, std::uint32_t value) {
    lines.push_back(name + std::to_string(value) + " (" + hex(value) + ")");
  };
  // A rule of CAN 2.0 that ISO 11898-1 dropped.
  constexpr const char* old_rule = "Identifier bits 10..4 must not be all recessive";
  const std::string request =
      std::string("Remote transmission request: ") + (frame.remote ? "remote" : "data") + " frame";
  if (frame.extended) {
    identifier("Identifier: ", frame.identifier >> 18);
    if (frame.identifier >> 22 == 0x7F) lines.emplace_back(old_rule);
    lines.push_back("Identifier extension bit: extended frame");
    identifier("Full Identifier: ", frame.identifier);
  } else {
    identifier("Identifier: ", frame.identifier);
    if (frame.identifier >> 4 == 0x7F) lines.emplace_back(old_rule);
    lines.push_back("Identifier extension bit: standard frame");
  }
  lines.push_back(request);
  lines.push_back("Data length code: " + std::to_string(frame.dlc));
  for (std::size_t byte = 0; byte < frame.length(); ++byte) {
    lines.push_back("Data byte " + std::to_string(byte) + ": " + hex(frame.data[byte], 2));
  }
  lines.push_back("CRC-15 sequence: " + hex(can::slow::crc(can::slow::before_crc(frame)), 4));
  lines.push_back("ACK slot: ACK");
  lines.push_back("End of frame");
  return lines;
}

// sigrok's decoder (libsigrokdecode 0.5.3) expects data in remote frames and takes DLC 9 to 15 for CAN FD
// lengths: remote frames have DLC 0 here, data frames at most 8.
TEST(Waveform, TenThousandRandomFrames_AreReadBySigrokAsSent) {
  if (!have_sigrok()) GTEST_SKIP() << "sigrok-cli is not installed";
  constexpr std::uint32_t bit_rate = 1'000'000;
  std::mt19937_64 random(2026);
  Scene scene(bit_rate);
  std::vector<Frame> frames;
  while (frames.size() < 10'000) {
    Frame frame = can::random_frame(random);
    if (frame.remote) frame.dlc = 0;
    if (frame.dlc > 8) continue;
    scene.a.send_at(Time(200us * static_cast<std::int64_t>(frames.size() + 1)), frame);
    frames.push_back(frame);
  }
  const std::string text = scene.record(Time(200us * 10'002));
  ASSERT_EQ(scene.b.heard.size(), frames.size());
  const auto lines =
      judge(text, bit_rate, "id:full-id:ide:rtr:dlc:data:crc-sequence:ack-slot:eof:stuff-bit:warnings");
  std::size_t line = 0;
  for (std::size_t number = 0; number < frames.size(); ++number) {
    std::vector<std::string> seen;
    std::size_t stuff_bits = 0;
    while (line < lines.size()) {
      const std::string& one = lines[line++];
      if (one == "0" || one == "1") {
        ++stuff_bits;
      } else {
        seen.push_back(one);
      }
      if (one == "End of frame") break;
    }
    // Bits of a frame without stuffing: 44 or 64, and its data.
    const std::size_t plain = (frames[number].extended ? 64U : 44U) + 8 * frames[number].length();
    ASSERT_EQ(seen, expected_lines(frames[number])) << "frame " << number;
    ASSERT_EQ(stuff_bits, can::slow::wire(frames[number]).size() - plain) << "frame " << number;
  }
  EXPECT_EQ(line, lines.size());
}

// sigrok's decoder reads what follows the DLC of a remote frame as data: told apart from a mistake of the wire by its
// bits, which are those of the CRC.
TEST(Waveform, ARemoteFrameWithADlc_IsMisreadBySigrok_AsDataMadeOfItsCrc) {
  if (!have_sigrok()) GTEST_SKIP() << "sigrok-cli is not installed";
  const Frame frame = can::remote_frame(0x2A5, 1);
  const std::uint32_t crc = can::slow::crc(can::slow::before_crc(frame));
  Scene scene(1'000'000);
  scene.a.send_at(Time(100us), frame);
  const auto lines = judge(scene.record(Time(300us)), 1'000'000, "id:rtr:dlc:data");
  EXPECT_EQ(scene.b.frames(), (std::vector<Frame>{frame}));
  EXPECT_EQ(lines,
            (std::vector<std::string>{"Identifier: 677 (0x2a5)", "Remote transmission request: remote frame",
                                      "Data length code: 1", "Data byte 0: " + hex(crc >> 7, 2)}));
}

/// The warnings and acknowledgements sigrok sees when bit `bit` of one frame is inverted.
std::vector<std::string> warnings_for(unsigned bit) {
  Scene scene(1'000'000);
  EXPECT_TRUE(scene.bus.set_faults({{.kind = FaultKind::corrupt, .count = 1, .bit = bit}}, 1).has_value());
  scene.a.send_at(Time(100us), data_frame(0x123, {0x55}));  // 53 bits
  const std::string text = scene.record(Time(1ms));
  EXPECT_EQ(scene.b.heard.size(), 1U);
  return judge(text, 1'000'000, "warnings");
}

TEST(Waveform, ErrorFrames_AreSeenAsErrorsBySigrok) {
  if (!have_sigrok()) GTEST_SKIP() << "sigrok-cli is not installed";
  EXPECT_EQ(warnings_for(43).at(0), "CRC delimiter must be a recessive bit");
  EXPECT_EQ(warnings_for(45).at(0), "ACK delimiter must be a recessive bit");
  EXPECT_EQ(warnings_for(48).at(0), "End of frame (EOF) must be 7 recessive bits");
}

TEST(Waveform, MissingAcknowledgement_IsSeenBySigrok) {
  if (!have_sigrok()) GTEST_SKIP() << "sigrok-cli is not installed";
  Scene scene(1'000'000);
  scene.b.port.plug(false);
  scene.a.send_at(Time(100us), data_frame(0x123, {0x55}));
  const auto lines = judge(scene.record(Time(160us)), 1'000'000, "ack-slot");
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0], "ACK slot: NACK");
}

TEST(Waveform, FlagsAndArbitration_AreSignalsOfTheirOwn) {
  Scene scene(1'000'000);
  EXPECT_TRUE(scene.bus.set_faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "a", .bit = 21}}, 1)
                  .has_value());
  scene.a.send_at(Time(100us), data_frame(0x123, {0x55}));
  const std::string text = signals_alone(scene.record(Time(1ms)));
  // a sends its flag in bits 22 to 27, b in bits 28 to 33; unit 1 ns... see BusErrors for the same walk.
  EXPECT_NE(text.find("#122000\n0\"\n1#\n"), std::string::npos) << text;
  EXPECT_NE(text.find("#128000\n1\"\n0#\n0%\n1&\n"), std::string::npos);
  EXPECT_NE(text.find("#134000\n1%\n0&\n1!\n"), std::string::npos);
}

/// When `name` has which number: "1000=5".
std::vector<std::string> changes_of(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  std::vector<std::string> changes;
  std::string code;
  std::string moment;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string a, b, c, d, e;
    words >> a >> b >> c >> d >> e;
    if (a == "$var" && e == name) code = d;
    if (line.starts_with("#")) moment = line.substr(1);
    if (line.starts_with("r") && b == code) changes.push_back(moment + "=" + a.substr(1));
  }
  return changes;
}

TEST(Waveform, CountersAndFields_AreNumbers) {
  Scene scene(1'000'000);
  EXPECT_TRUE(scene.bus.set_faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "a", .bit = 21}}, 1)
                  .has_value());
  scene.a.send_at(Time(100us), data_frame(0x123, {0x55}));
  const std::string text = scene.record(Time(300us));
  // The transmitter's error at the sample point of bit 21, its success 53 bits and the error frame later.
  EXPECT_EQ(changes_of(text, "a_tec"), (std::vector<std::string>{"0=0", "121875=8", "197875=7"}));
  EXPECT_EQ(changes_of(text, "b_rec"), (std::vector<std::string>{"0=0", "127875=1", "189875=0"}));
  // SOF, ID.28-21, ID.20-18, RTR, IDE, r0, DLC, data, active error flag, superposition, delimiter, intermission.
  const auto fields = changes_of(text, "field");
  ASSERT_GE(fields.size(), 14U);
  EXPECT_EQ(std::vector<std::string>(fields.begin(), fields.begin() + 14),
            (std::vector<std::string>{"0=0", "100000=1", "101000=2", "109000=3", "112000=4", "113000=5",
                                      "114000=11", "115000=12", "120000=13", "122000=21", "128000=24",
                                      "135000=25", "142000=19", "145000=1"}));
  EXPECT_NE(text.find("-1 as field, 0 idle, 1 SOF,"), std::string::npos);
  EXPECT_NE(text.find("12 DLC, 13 data, 14 CRC,"), std::string::npos);
  // The other one is on its own where it does not know of the error yet, and where it still sends its flag.
  EXPECT_EQ(changes_of(text, "a_field"), (std::vector<std::string>{"0=-1"}));
  EXPECT_EQ(changes_of(text, "b_field"),
            (std::vector<std::string>{"0=-1", "122000=13", "128000=21", "134000=-1"}));
}

TEST(Waveform, APortThatIsSwitchedOff_IsIdleFromTheFirstFrameOn_AndAsTheBusAgainWithTheFirstItHears) {
  Scene scene(1'000'000);
  Station c(scene.bus, scene.timeline, "c");
  c.port.set_power(false);
  for (const auto moment : {100us, 300us, 600us}) scene.a.send_at(Time(moment), data_frame(0x123, {0x55}));
  c.on_change = [](Time) {};
  scene.b.on_receive = [&](const Frame&, Time now) {
    if (now > Time(300us)) c.port.set_power(true);
  };
  const std::string text = scene.record(Time(1ms));
  EXPECT_EQ(changes_of(text, "c_field"), (std::vector<std::string>{"0=-1", "101000=0", "601000=-1"}));
  EXPECT_EQ(changes_of(text, "b_field"), (std::vector<std::string>{"0=-1"}));
}

TEST(Waveform, TheSuspensionOfAPassiveTransmitter_IsItsOwnField) {
  Scene scene(1'000'000);
  EXPECT_TRUE(scene.bus.set_faults({{.kind = FaultKind::corrupt, .count = 16, .receiver = "a", .bit = 21}}, 1)
                  .has_value());
  scene.a.send_at(Time(100us), data_frame(0x123, {0x55}));
  const std::string text = scene.record(Time(3ms));
  EXPECT_EQ(scene.a.port.error_state(), can::ErrorState::error_active);
  const auto fields = changes_of(text, "a_field");
  EXPECT_NE(std::find_if(fields.begin(), fields.end(), [](const auto& one) { return one.ends_with("=20"); }),
            fields.end());
  for (const std::string& one : changes_of(text, "field")) EXPECT_FALSE(one.ends_with("=20")) << one;
}

TEST(Waveform, InTheMiddleOfAFrame_FlushHandsOverWhatThereIsOfIt) {
  Scene scene(1'000'000);
  scene.a.send_at(Time(100us), data_frame(0x123, {0x55}));
  const std::string text = scene.record(Time(110us));
  EXPECT_EQ(changes_of(text, "field"), (std::vector<std::string>{"0=0", "100000=1", "101000=2", "109000=3"}));
}

TEST(Waveform, Resolution_DividesTheBitsOfAllPorts) {
  for (const std::uint32_t rate : {1'000'000U, 800'000U, 500'000U, 250'000U, 125'000U, 100'000U, 10'000U}) {
    Scene scene(rate);
    std::string text;
    const Waveform waveform(scene.bus, Time{}, [&](std::string_view piece) { text += piece; });
    EXPECT_EQ(can::bit_time(1, rate) % waveform.resolution(), 0ns) << rate;
    EXPECT_LE(waveform.resolution() * 10, can::bit_time(1, rate)) << rate;
  }
  Scene scene(10'000);
  scene.b.port.restart(800'000);
  const Waveform waveform(scene.bus, Time{}, [](std::string_view) {});
  EXPECT_EQ(waveform.resolution(), 1ns);  // 1.25 us, sampled 156 ns before its end
}

TEST(Waveform, Resolution_DividesSamplePointsAndTimesOfFaults) {
  const auto resolution = [](std::uint32_t rate, const std::vector<Fault>& faults, can::Duration grid) {
    Scene scene(rate);
    EXPECT_TRUE(scene.bus.set_faults(faults, 1).has_value());
    return Waveform(
               scene.bus, Time{}, [](std::string_view) {}, grid)
        .resolution();
  };
  EXPECT_EQ(resolution(1'000'000, {}, 1us), 1ns);  // 125 ns from the sample point to the end of the bit
  EXPECT_EQ(resolution(500'000, {}, 1us), 10ns);   // 250 ns
  EXPECT_EQ(resolution(250'000, {}, 1us), 100ns);  // 500 ns
  EXPECT_EQ(resolution(10'000, {}, 1us), 100ns);   // 12.5 us
  EXPECT_EQ(resolution(250'000, {}, 1ns), 1ns);
  EXPECT_EQ(resolution(250'000, {{.kind = FaultKind::late, .delay = 330ns, .ports = {"a"}}}, 1us), 10ns);
  EXPECT_EQ(resolution(250'000, {{.kind = FaultKind::termination, .resistors = 1}}, 1us), 1ns);
}

TEST(Waveform, AtItsEnd_TheBusWorksFrameByFrameAgain) {
  Scene scene(1'000'000);
  (void)scene.record(Time(1ms));
  scene.a.send_at(Time(2ms), data_frame(0x123, {0x55}));
  scene.timeline.run_until(Time(2ms));
  EXPECT_EQ(scene.timeline.next(), Time(2ms) + 53us);
}

TEST(Waveform, PortsOfOneName_AreToldApart) {
  Scene scene(1'000'000);
  Station again(scene.bus, scene.timeline, "a");
  Station odd(scene.bus, scene.timeline, "slave #3/x");
  const std::string text = scene.record(Time(1ms));
  EXPECT_NE(text.find(" a_tx $end\n"), std::string::npos);
  EXPECT_NE(text.find(" a_2_tx $end\n"), std::string::npos);
  EXPECT_NE(text.find(" slave__3_x_tx $end\n"), std::string::npos);
}

}  // namespace
}  // namespace canopus::sim::bus_waveform_test
