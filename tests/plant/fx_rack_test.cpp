// FX racks with special function blocks of both kinds side by side, and their networks.

#include <fmt/format.h>

#include "canopus/can/timeline.hpp"

#include "support/plant_folder.hpp"

namespace canopus::plant::fx_rack_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

std::string bus(std::string_view name, unsigned bit_rate = 125'000) {
  return fmt::format("[[bus]]\nname = \"{}\"\nbit_rate = {}\n", name, bit_rate);
}
std::string plc(std::string_view name) {
  return fmt::format("[[plc]]\nname = \"{}\"\nfamily = \"FX3\"\nlisten = \"off\"\n", name);
}
std::string block(std::string_view model, unsigned position, std::string_view bus, unsigned node,
                  std::string_view keys = "") {
  return fmt::format(
      "[[plc.module]]\nname = \"{} {} {}\"\nmodel = \"{}\"\nposition = {}\nbus = \"{}\"\nnode = {}\n"
      "exchange = \"10ms\"\n{}",
      model, bus, node, model, position, bus, node, keys);
}

class FxRack : public support::PlantFolder, public PlantObserver {
 protected:
  void start(const std::string& text) {
    plant_ = support::PlantFolder::load(text, *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
  }
  void run(can::Duration time) { plant_->timeline().run_until(plant_->timeline().now() + time); }
  std::uint16_t word(std::size_t rack, unsigned position, module::BufferAddress address) {
    std::uint16_t value = 0;
    EXPECT_TRUE(plant_->rack(rack).read_buffer(static_cast<std::uint16_t>(16 * position), address,
                                               {&value, 1}, plant_->timeline().now()));
    return value;
  }
  void write(std::size_t rack, unsigned position, module::BufferAddress address, std::uint16_t value) {
    EXPECT_TRUE(plant_->rack(rack).write_buffer(static_cast<std::uint16_t>(16 * position), address,
                                                {&value, 1}, plant_->timeline().now()));
  }

  std::unique_ptr<Plant> plant_;
};

TEST_F(FxRack, BothKindsOfBlocks_WorkSideBySide) {
  RecordProperty("spec", "FX2N-MAPA-006 FX2N-GEN-010 FX2N-NMT-002 FX2N-GRD-005 FX2N-MAPA-003");
  constexpr std::string_view mode_a = "write = { G1000 = 0x8200 }\n";
  constexpr std::string_view manager =
      "write = { G1000 = 0x8200 }\nobjects = { \"1F80:00\" = 1, \"1F81:02\" = 0x00640305 }\n";
  start(bus("old") + bus("new") + plc("plc1") + block("FX2N-32CAN", 0, "old", 1, manager) +
        block("FX3U-CAN", 1, "new", 1, "master = true\nslaves = \"all\"\n") + plc("plc2") +
        block("FX3U-CAN", 6, "new", 2) + block("FX2N-32CAN", 7, "old", 2, mode_a));
  run(15s);
  EXPECT_EQ(word(0, 0, 30), 7100);
  EXPECT_EQ(word(0, 1, 30), 7170);
  EXPECT_EQ(word(1, 6, 30), 7170);
  EXPECT_EQ(word(1, 7, 30), 7100);
  EXPECT_EQ(word(0, 0, 24), 125);
  EXPECT_EQ(word(1, 7, 27), 2);
  for (const auto& [rack, position] : {std::pair{0U, 0U}, {1U, 7U}})
    EXPECT_EQ(word(rack, position, 25), 0x0201);
  EXPECT_EQ(word(0, 0, 29), 0);
  write(0, 0, 3, 1234);
  write(1, 7, 15, 4321);
  run(200ms);
  EXPECT_EQ(word(1, 7, 3), 1234);
  EXPECT_EQ(word(0, 0, 111), 4321) << "the last word of station 2";
  write(0, 1, 11000, 77);
  run(200ms);
  EXPECT_EQ(word(1, 6, 10000), 77);
  for (const auto& [rack, position] : {std::pair{0U, 0U}, {1U, 7U}}) EXPECT_EQ(word(rack, position, 29), 0);
}

TEST_F(FxRack, SlavesOfThePlantFile_HaveTheirWords) {
  start(bus("old") + plc("plc1") + block("FX2N-32CAN", 0, "old", 1, "master = true\nslaves = \"all\"\n") +
        plc("plc2") + block("FX2N-32CAN", 3, "old", 2));
  run(15s);
  EXPECT_EQ(word(1, 3, 25), 0x0201);
  write(0, 0, 1, 0x1234);
  write(1, 3, 2, 0x4321);
  run(200ms);
  EXPECT_EQ(word(1, 3, 1), 0x1234);
  EXPECT_EQ(word(0, 0, 2), 0x4321);
}

}  // namespace
}  // namespace canopus::plant::fx_rack_test
