// Where a run records.

#include "canopus/cli/run/run_recording.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

namespace canopus::cli::run_recording_test {
namespace {

TEST(VcdPath, IsThatOfTheOptionWithTheBusInItsName) {
  EXPECT_EQ(vcd_path_of("wire.vcd", "line1"), "wire-line1.vcd");
  EXPECT_EQ(vcd_path_of("out/wire", "line1"), "out/wire-line1");
}

TEST(VcdPath, NeverLeavesTheFolderByTheNameOfABus) {
  EXPECT_EQ(vcd_path_of("out/wire.vcd", "/../../etc/x"), "out/wire-%2F%2E%2E%2F%2E%2E%2Fetc%2Fx.vcd");
  EXPECT_EQ(vcd_path_of("wire.vcd", "a\nb"), "wire-a%0Ab.vcd");
}

/// A real bus of which the test is the kernel.
struct Kernel final : link::BusClient {
  bool send(const can::Frame&) override { return true; }
  void set_user(link::BusClientListener* new_user) override { user = new_user; }
  bool close(std::chrono::milliseconds) override { return true; }
  link::BusClientListener* user = nullptr;
};

TEST(TraceWriter, FramesOfARealBus_HaveTheStampsOfTheKernel) {
  using namespace std::chrono_literals;
  const std::string path = testing::TempDir() + "stamps.log";
  can::Timeline timeline;
  auto client = std::make_unique<Kernel>();
  Kernel& kernel = *client;
  link::LinkedBus bus("line1", 250'000, timeline, std::move(client));
  bus.set_wall_clock([] { return 1'000'000s; });
  bus.start(nullptr, {});
  auto file = trace::TraceFile::create(path, trace::FileFormat::candump);
  ASSERT_TRUE(file);
  TraceWriter writer(*file, bus, timeline);
  bus.add_observer(writer);
  timeline.run_until(can::Time(5s));
  kernel.user->frame_received_at(can::data_frame(0x181, {1}), 1'000'000s - 2ms);
  ASSERT_TRUE(file->close());
  bus.remove_observer(writer);
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(), "(0000000004.998000) line1 181#01\n");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace canopus::cli::run_recording_test
