// Plants whose buses are bridged, played back, or not simulated.

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <fmt/format.h>

#include "canopus/link/linked_bus.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/serve/linked_buses.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::cli::linked_plant_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

constexpr std::string_view two_buses =
    "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n[[bus]]\nname = \"b\"\nbit_rate = 500_000\n";

std::string device(std::string_view bus, unsigned node) {
  return fmt::format("[[device]]\nbus = \"{}\"\nnode = {}\neds = \"{}/examples/devices/io-block.eds\"\n", bus,
                     node, CANOPUS_SOURCE_DIR);
}
std::string master(std::string_view bus, std::string_view slave) {
  return fmt::format(
      "[[plc]]\nlisten = \"off\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nbus = \"{}\"\nnode = 1\nmaster = "
      "true\n"
      "restart_time = \"100ms\"\nexchange = \"10ms\"\n{}",
      bus, slave);
}

/// What came by on each bus.
struct Heard final : can::BusObserver {
  void frame_completed(const can::Frame& frame, can::Time, can::Time end) override {
    frames.push_back(frame);
    times.push_back(end);
  }
  [[nodiscard]] bool has(std::uint32_t identifier) const {
    return std::ranges::any_of(frames,
                               [=](const can::Frame& frame) { return frame.identifier == identifier; });
  }
  std::vector<can::Frame> frames;
  std::vector<can::Time> times;
};

class LinkedPlant : public support::PlantFolder, public plant::PlantObserver {
 protected:
  void start(std::string_view text) {
    plant_ = support::PlantFolder::load(text, *this);
    ASSERT_NE(plant_, nullptr);
    watch();
    plant_->power_on();
  }
  void watch() {
    heard_.resize(plant_->bus_count());
    for (std::size_t i = 0; i < heard_.size(); ++i) plant_->bus(i).add_observer(heard_[i]);
  }
  void run(can::Duration time) { plant_->timeline().run_until(plant_->timeline().now() + time); }
  void on(const plant::Event& event) override {
    if (const auto* failure = std::get_if<plant::Failure>(&event.what))
      errors_.push_back(fmt::format("{}: {}", failure->source, failure->message));
  }

  std::unique_ptr<plant::Plant> plant_;
  std::vector<Heard> heard_;
  std::vector<std::string> errors_;
};

TEST_F(LinkedPlant, MasterBootsASlaveBehindABridge) {
  start(std::string(two_buses) + "[[bridge]]\nfrom = \"a\"\nto = \"b\"\nboth_ways = true\n" + device("b", 3) +
        master("a", "[[plc.module.slave]]\nnode = 3\n"));
  run(5s);
  for (const plant::NodeStatus& node : plant_->nodes()) {
    EXPECT_EQ(node.state, canopen::NmtState::operational) << int{node.label.node_id};
  }
  EXPECT_TRUE(heard_[0].has(0x703));  // boot-up of node 3, on the master's bus
  EXPECT_TRUE(heard_[1].has(0x603));  // SDO request, on the slave's bus
  EXPECT_THAT(errors_, IsEmpty());
}

TEST_F(LinkedPlant, BridgeInOneDirection_LetsNothingBack) {
  start(std::string(two_buses) + "[[bridge]]\nfrom = \"a\"\nto = \"b\"\n" + device("a", 2) + device("b", 3) +
        device("a", 4) + device("b", 5));
  run(2s);
  EXPECT_TRUE(heard_[1].has(0x702));
  EXPECT_FALSE(heard_[0].has(0x703));
}

TEST_F(LinkedPlant, BridgeWithAFilter_LetsThatThrough) {
  start(std::string(two_buses) + "[[bridge]]\nfrom = \"a\"\nto = \"b\"\nidentifiers = [\"703\"]\n" +
        device("a", 2) + device("a", 3) + device("b", 4) + device("b", 5));
  run(2s);
  EXPECT_TRUE(heard_[1].has(0x703));
  EXPECT_FALSE(heard_[1].has(0x702));
}

/// A transport that goes nowhere and takes everything.
class Nowhere final : public link::BusClient {
 public:
  bool send(const can::Frame& frame) override {
    sent.push_back(frame);
    return true;
  }
  void set_user(link::BusClientListener* new_user) override { user = new_user; }
  bool close(std::chrono::milliseconds) override { return true; }
  link::BusClientListener* user = nullptr;
  std::vector<can::Frame> sent;
};

TEST_F(LinkedPlant, DevicesAndModules_LiveOnABusThatIsNotSimulated) {
  struct Opener final : plant::BusOpener {
    std::expected<std::unique_ptr<can::Bus>, std::string> open(const plant::BusSection& section,
                                                               can::Timeline& timeline) override {
      auto client = std::make_unique<Nowhere>();
      transport = client.get();
      auto made =
          std::make_unique<link::LinkedBus>(section.name, section.bit_rate, timeline, std::move(client));
      bus = made.get();
      return made;
    }
    Nowhere* transport = nullptr;
    link::LinkedBus* bus = nullptr;
  } opener;
  plant_ =
      support::PlantFolder::load("[[bus]]\nname = \"a\"\nbit_rate = 250_000\nlink = \"socketcan:can0\"\n" +
                                     device("a", 3) + master("a", "[[plc.module.slave]]\nnode = 3\n"),
                                 *this, &opener);
  ASSERT_NE(plant_, nullptr);
  EXPECT_EQ(plant_->simulated_bus(0), nullptr);
  opener.bus->start(nullptr, {});
  plant_->power_on();
  for (int i = 0; i < 5000; ++i) {
    run(1ms);
    for (const can::Frame& frame : std::exchange(opener.transport->sent, {}))
      opener.transport->user->frame_sent(frame);
  }
  for (const plant::NodeStatus& node : plant_->nodes()) {
    EXPECT_EQ(node.state, canopen::NmtState::operational) << int{node.label.node_id};
  }
}

TEST_F(LinkedPlant, WithoutAnOpener_ALinkedBusIsLookedAtAsASimulatedOne) {
  start("[[bus]]\nname = \"a\"\nbit_rate = 250_000\nlink = \"socketcan:can0\"\n" + device("a", 3));
  EXPECT_NE(plant_->simulated_bus(0), nullptr);
}

class ReplayedPlant : public LinkedPlant {
 protected:
  void replay(std::string_view trace, std::string_view plant, bool virtual_time = true) {
    write("run.log", trace);
    buses_.emplace(io_, path(), virtual_time);
    plant_ = support::PlantFolder::load(plant, *this, &*buses_);
    if (plant_ == nullptr) return;
    watch();
    buses_->start(nullptr, *plant_);
    plant_->power_on();
  }
  boost::asio::io_context io_{1};
  std::optional<serve::LinkedBuses> buses_;
};

constexpr std::string_view replayed =
    "[[bus]]\nname = \"a\"\nbit_rate = 250_000\nlink = \"replay:run.log\"\n";

TEST_F(ReplayedPlant, FramesComeAtTheirTimes) {
  replay("(1700000000.250000) can0 703#00\n(1700000000.750000) can0 183#0102\n", replayed);
  ASSERT_NE(plant_, nullptr);
  run(499ms);
  EXPECT_EQ(heard_[0].frames.size(), 1U);
  run(2ms);
  EXPECT_THAT(heard_[0].frames, ElementsAre(can::data_frame(0x703, {0}), can::data_frame(0x183, {1, 2})));
  EXPECT_THAT(heard_[0].times, ElementsAre(can::Time{}, can::Time{} + 500ms));
  EXPECT_EQ(heard_[0].frames.size(), 2U);
}

TEST_F(ReplayedPlant, ANodeOfThePlantHearsAndAnswers) {
  // NMT start of node 3, and a question for its device type: the answer comes from the plant.
  replay("(10.0) can0 702#00\n(11.0) can0 000#0103\n(12.0) can0 603#4000100000000000\n",
         std::string(replayed) + device("a", 3));
  ASSERT_NE(plant_, nullptr);
  run(3s);
  EXPECT_EQ(plant_->nodes()[0].state, canopen::NmtState::operational);
  EXPECT_TRUE(heard_[0].has(0x583));
  EXPECT_TRUE(heard_[0].has(0x703));
}

TEST_F(ReplayedPlant, BridgeOntoASlowBus_SaysOnceASecondThatFramesAreLost) {
  std::string trace;
  for (int i = 0; i < 3000; ++i) trace += fmt::format("({}.{:06}) can0 123#00\n", i / 2000, i % 2000 * 500);
  replay(trace, std::string(replayed) +
                    "[[bus]]\nname = \"b\"\nbit_rate = 10_000\n[[bridge]]\nfrom = \"a\"\nto = \"b\"\n" +
                    device("b", 3));
  ASSERT_NE(plant_, nullptr);
  run(60s);
  EXPECT_THAT(
      errors_,
      ElementsAre("bridge a to b: frames are lost: the other bus does not take them as fast as they come"));
  const auto passed =
      static_cast<std::size_t>(std::ranges::count(heard_[1].frames, 0x123U, &can::Frame::identifier));
  EXPECT_GT(passed, 1024U);
  EXPECT_LT(passed, 3000U);
}

TEST_F(ReplayedPlant, OneChannelOfSeveral) {
  replay("(1.0) can0 701#00\n(1.5) can1 702#00\n(2.0) can0 703#00\n(2.5) can1 704#00\n",
         "[[bus]]\nname = \"a\"\nbit_rate = 250_000\nlink = \"replay:run.log#can1\"\n");
  ASSERT_NE(plant_, nullptr);
  run(5s);
  EXPECT_THAT(heard_[0].frames, ElementsAre(can::data_frame(0x702, {0}), can::data_frame(0x704, {0})));
  EXPECT_THAT(heard_[0].times, ElementsAre(can::Time{}, can::Time{} + 1s));
}

TEST_F(ReplayedPlant, ChannelThatTheTraceHasNot_IsAMistakeThatNamesThem) {
  buses_.emplace(io_, path(), true);
  write("run.log", "(1.0) can0 701#00\n(1.5) can1 702#00\n");
  EXPECT_THAT(
      refusal("[[bus]]\nname = \"a\"\nbit_rate = 250_000\nlink = \"replay:run.log#can2\"\n", *this, &*buses_),
      HasSubstr("no frame of the channel \"can2\"; expected one of can0, can1"));
}

TEST_F(ReplayedPlant, WrongLines_AreSaidAndTheOthersPlayedBack) {
  replay("(10.0) can0 702#00\n(11.0) can0 nonsense\n(12.0) can0 703#00\nrubbish\n(13.0) can0 704#00\n",
         replayed);
  ASSERT_NE(plant_, nullptr);
  run(5s);
  EXPECT_EQ(heard_[0].frames.size(), 3U);
  EXPECT_EQ(heard_[0].times.back(), can::Time{} + 3s);
  ASSERT_EQ(errors_.size(), 2U);
  EXPECT_THAT(errors_[0], HasSubstr("bus a: "));
  EXPECT_THAT(errors_[0], HasSubstr("run.log:2"));
  EXPECT_EQ(errors_[1], "bus a: 2 parts of the trace could not be read");
}

TEST_F(ReplayedPlant, WrongLineAtTheBegin_DoesNotHideTheOthers) {
  replay("rubbish\n(12.0) can0 703#00\n", replayed);
  ASSERT_NE(plant_, nullptr);
  run(5s);
  EXPECT_EQ(heard_[0].frames.size(), 1U);
  EXPECT_EQ(errors_.size(), 1U);
}

TEST_F(ReplayedPlant, MissingFile_IsAMistakeOfThePlantFile) {
  buses_.emplace(io_, path(), true);
  EXPECT_THAT(
      refusal("[[bus]]\nname = \"a\"\nbit_rate = 250_000\nlink = \"replay:none.log\"\n", *this, &*buses_),
      HasSubstr("plant.toml:4:8: link = \"replay:none.log\": "));
}

TEST_F(ReplayedPlant, RealBusInVirtualTime_IsAMistake) {
  buses_.emplace(io_, path(), true);
  EXPECT_THAT(
      refusal("[[bus]]\nname = \"a\"\nbit_rate = 250_000\nlink = \"socketcan:can0\"\n", *this, &*buses_),
      HasSubstr("a plant in virtual time runs ahead of a real bus"));
}

}  // namespace
}  // namespace canopus::cli::linked_plant_test
