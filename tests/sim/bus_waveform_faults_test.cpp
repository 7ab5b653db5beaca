// Waveforms of wires that are stuck or cut.

#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "canopus/sim/bus/waveform/waveform.hpp"

#include "sim/bus_station.hpp"
#include "sim/waveform_reading.hpp"

namespace canopus::sim::bus_waveform_faults_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::Time;

struct TwoStations {
  /// Runs to the end with a waveform and returns its text.
  std::string record(Time end) {
    std::string text;
    Waveform waveform(bus, timeline.now(), [&](std::string_view piece) { text += piece; });
    timeline.run_until(end);
    waveform.flush(end);
    return text;
  }
  can::Timeline timeline;
  Bus bus{"line 1", 1'000'000, timeline};
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
};

TEST(WaveformFaults, StuckPort_ShowsWhatItDrives) {
  TwoStations scene;
  EXPECT_TRUE(scene.bus
                  .set_faults({{.kind = FaultKind::stuck_dominant,
                                .from = Time(100us),
                                .until = Time(200us),
                                .ports = {"b"}}},
                              1)
                  .has_value());
  const std::string text = scene.record(Time(1ms));
  EXPECT_NE(text.find("#100000\n0%\n0!\n"), std::string::npos) << text;
  EXPECT_NE(text.find("#200000\n1%\n"), std::string::npos);
}

TEST(WaveformFaults, StuckPortThatIsReleasedWithinABit_ShowsItAtOnce) {
  TwoStations scene;
  EXPECT_TRUE(scene.bus
                  .set_faults({{.kind = FaultKind::stuck_dominant,
                                .from = Time(100us),
                                .until = Time(200'300ns),
                                .ports = {"b"}}},
                              1)
                  .has_value());
  const auto read = waveform_reading::read(scene.record(Time(1ms)));
  EXPECT_EQ(read.moments.at(100'000).at("b_tx"), 0);
  EXPECT_EQ(read.moments.at(200'300).at("b_tx"), 1);
}

TEST(WaveformFaults, IfAllAreOnTheFarSideOfACut_TheirFramesAreThere) {
  TwoStations scene;
  EXPECT_TRUE(scene.bus.set_faults({{.kind = FaultKind::cut, .from = Time(50us), .ports = {"a", "b"}}}, 1)
                  .has_value());
  scene.a.send_at(Time(100us), data_frame(0x123, {0x55}));
  const auto read = waveform_reading::read(scene.record(Time(1ms)));
  EXPECT_EQ(scene.b.heard.size(), 1U);
  EXPECT_EQ(read.moments.at(100'000).at("can_far"), 0);
  for (const auto& [time, values] : read.moments) EXPECT_TRUE(time == 0 || !values.contains("can")) << time;
}

TEST(WaveformFaults, FarSideOfACut_HasALineOfItsOwn) {
  TwoStations scene;
  Station c(scene.bus, scene.timeline, "c");
  Station d(scene.bus, scene.timeline, "d");
  EXPECT_TRUE(scene.bus.set_faults({{.kind = FaultKind::cut, .from = Time(50us), .ports = {"c", "d"}}}, 1)
                  .has_value());
  c.send_at(Time(100us), data_frame(0x123, {0x55}));
  const std::string text = scene.record(Time(1ms));
  EXPECT_NE(text.find("$var wire 1 ; can_far $end\n"), std::string::npos) << text;
  EXPECT_NE(text.find("#100000\n0(\n1*\n0;\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("\n0!\n"), std::string::npos);  // nothing on the near side
  EXPECT_EQ(d.heard.size(), 1U);
}

}  // namespace
}  // namespace canopus::sim::bus_waveform_faults_test
