// A device of a plant file that accepts SDO requests of fewer than 8 bytes, beside one that does not.

#include "canopus/plant/device_on_bus.hpp"

#include "support/plant_folder.hpp"

namespace canopus::plant::short_sdo_requests_test {
namespace {

using namespace std::chrono_literals;

class ShortSdoRequests : public support::PlantFolder, public PlantObserver, public can::Listener {
 protected:
  ShortSdoRequests() { support::PlantFolder::write("io.eds", support::device_file("")); }
  void receive(const can::Frame& frame, can::Time) override {
    if ((frame.identifier & 0x780U) == 0x580) answers.push_back(frame);
  }
  std::vector<can::Frame> answers;
};

TEST_F(ShortSdoRequests, AreAnsweredWhereTheDeviceSaysSo) {
  const auto plant = load(
      "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n"
      "[[device]]\nnode = 2\neds = \"io.eds\"\nshort_sdo_requests = true\n"
      "[[device]]\nnode = 3\neds = \"io.eds\"\n",
      *this);
  ASSERT_NE(plant, nullptr);
  plant->power_on();
  can::Port& port = plant->bus(0).add_port("client");
  port.connect(*this);
  port.plug(true);
  plant->timeline().run_until(can::Time{100ms});
  ASSERT_TRUE(port.send(can::data_frame(0x602, {0x40, 0x00, 0x10, 0x00})));
  ASSERT_TRUE(port.send(can::data_frame(0x603, {0x40, 0x00, 0x10, 0x00})));
  plant->timeline().run_until(can::Time{200ms});
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0], can::data_frame(0x582, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x00, 0x00}));
}

}  // namespace
}  // namespace canopus::plant::short_sdo_requests_test
