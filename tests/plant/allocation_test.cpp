// A plant that runs allocates nothing: three devices on a simulated bus and an ME3CAN1-Q that produces SYNC
// and exchanges data, with PDOs, heartbeats, SDO transfers and MC protocol reads going on. The program's
// operator new counts.

#include <string>

#include <gtest/gtest.h>

#include "canopus/can/bus.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plc/melsec/session.hpp"

#include "paths.hpp"
#include "support/counted_allocations.hpp"

namespace canopus::plant::allocation_test {
namespace {

using namespace std::chrono_literals;

std::string plant_text() {
  const std::string devices = CANOPUS_SOURCE_DIR "/examples/devices/";
  const auto device = [&](int node, const std::string& kind, const std::string& moving,
                          const std::string& objects) {
    return "[[device]]\nnode = " + std::to_string(node) + "\neds = \"" + devices + kind +
           ".eds\"\nobjects = { \"1017:00\" = 50" + objects + " }\n[[device.behaviour]]\nobject = \"" +
           moving + "\"\nkind = \"counter\"\nhigh = 100\nperiod = \"10ms\"\n";
  };
  return "[[bus]]\nname = \"line1\"\nbit_rate = 1_000_000\n" + device(2, "io-block", "6000:01", "") +
         device(3, "encoder", "6004:00", "") + device(4, "drive", "606C:00", ", \"1800:02\" = 1") +
         "[[plc]]\nlisten = \"off\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nnode = 1\nmaster = true\n"
         "exchange = \"10ms\"\nslaves = \"all\"\nobjects = { \"1005:00\" = 0x40000080, \"1006:00\" = 10000, "
         "\"1017:00\" = 50 }\n";
}

/// A tool on the bus that reads an object of node 2 again and again.
class Reader final : public can::Participant, canopen::SdoClientListener {
 public:
  Reader(can::Bus& bus, can::Timeline& timeline) : port_(bus.add_port("tool")), client_(port_) {
    client_.set_server(2);
    alarm().add_part(client_.alarm());
    timeline.add(*this);
    port_.connect(*this);
  }
  void read(can::Time now) { client_.upload(0x1000, 0, *this, now); }  // nothing while one is going on
  void receive(const can::Frame& frame, can::Time now) override {
    client_.receive(frame, now);
    ++frames[frame.identifier & 0x7FF];
  }
  void tick(can::Time now) override { client_.tick(now); }
  void sdo_finished(canopen::SdoClient& done, can::Time) override {
    good += done.abort_code() == canopen::AbortCode::none ? 1 : 0;
  }
  int good = 0;
  std::array<int, 2048> frames{};

 private:
  can::Port& port_;
  canopen::SdoClient client_;
};

TEST(Allocation, APlantThatRuns_AllocatesNothing) {
  const PlantReading reading = read_plant(plant_text(), "test.toml");
  ASSERT_TRUE(reading.errors.empty());
  struct Nobody final : PlantObserver {
  } nobody;
  auto plant = Plant::build(reading.plant, nobody);
  ASSERT_TRUE(plant);
  can::Timeline& timeline = (*plant)->timeline();
  Reader reader((*plant)->bus(0), timeline);
  plc::melsec::Session session((*plant)->rack(0));
  // U0\G10000, 64 words: 3E with device extension.
  const std::uint8_t request[] = {0x50, 0, 0, 0xFF, 0xFF, 3, 0,    19, 0, 16, 0, 1,    4,  0x80,
                                  0,    0, 0, 0x10, 0x27, 0, 0xAB, 0,  0, 0,  0, 0xF8, 64, 0};
  std::uint64_t answered = 0;
  const auto run_for = [&](int rounds) {
    for (int round = 0; round < rounds; ++round) {
      timeline.run_until(timeline.now() + 1ms);
      reader.read(timeline.now());
      std::ranges::copy(request, session.space().begin());
      session.received(sizeof request);
      answered += session.process(timeline.now());
      session.sent(session.output().size());
    }
  };
  (*plant)->power_on();
  run_for(10'000);
  for (const NodeStatus& node : (*plant)->nodes()) ASSERT_EQ(node.state, canopen::NmtState::operational);
  run_for(1000);

  const std::size_t before = counted::allocations;
  const auto frames_before = reader.frames;
  const int good_before = reader.good;
  const std::uint64_t answered_before = answered;
  run_for(1000);
  EXPECT_EQ(counted::allocations, before);

  const auto frames = [&](std::uint32_t identifier) {
    return reader.frames[identifier] - frames_before[identifier];
  };
  EXPECT_EQ(frames(0x080), 100) << "SYNC every 10 ms";
  EXPECT_EQ(frames(0x184), 100) << "node 4 answers every SYNC with its TPDO1";
  EXPECT_GT(frames(0x182) + frames(0x183), 50) << "event-driven TPDOs";
  EXPECT_GT(frames(0x702) + frames(0x703) + frames(0x704) + frames(0x701), 70) << "heartbeats every 50 ms";
  EXPECT_GT(reader.good - good_before, 900) << "SDO transfers";
  EXPECT_EQ(answered - answered_before, 1000U) << "MC protocol reads";
}

}  // namespace
}  // namespace canopus::plant::allocation_test
