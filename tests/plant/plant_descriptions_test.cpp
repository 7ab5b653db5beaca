// Devices of one device file share what it describes, also when the plant file gives them other values.

#include <fmt/format.h>
#include <malloc.h>

#include "canopus/plant/device_seat.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant {
namespace {

class PlantDescriptions : public support::PlantFolder, public PlantObserver {
 protected:
  static std::string device(unsigned node, std::string_view objects) {
    return fmt::format(
        "[[device]]\nbus = \"line1\"\nnode = {}\neds = \"{}/examples/devices/io-block.eds\"\n{}\n", node,
        CANOPUS_SOURCE_DIR, objects);
  }
  void load(const std::string& devices) {
    plant_ = support::PlantFolder::load("[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n" + devices, *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
  }
  canopen::ObjectDictionary& objects(std::size_t number) {
    return plant_->device(number).device().node().dictionary();
  }
  const eds::DeviceFile& file(std::size_t number) { return plant_->device(number).device().file(); }

  std::unique_ptr<Plant> plant_;
};

TEST_F(PlantDescriptions, EachDeviceHasItsOwnValues) {
  load(device(1, "") + device(2, "objects = { \"1017:00\" = 100 }") +
       device(3, "objects = { \"1017:00\" = 200 }") +
       device(4, "objects = { \"1017:00\" = 100, \"1029:01\" = 2 }") +
       device(5, "objects = { \"1017:00\" = 100 }"));
  const auto heartbeat = [&](std::size_t number) { return objects(number).get<std::uint16_t>(0x1017, 0); };
  const std::uint16_t of_the_file = heartbeat(0);
  EXPECT_NE(of_the_file, 100);
  EXPECT_EQ(heartbeat(1), 100);
  EXPECT_EQ(heartbeat(2), 200);
  EXPECT_EQ(heartbeat(3), 100);
  EXPECT_EQ(objects(3).get<std::uint8_t>(0x1029, 1), 2);
  EXPECT_NE(objects(1).get<std::uint8_t>(0x1029, 1), 2);
  EXPECT_EQ(heartbeat(4), 100);
}

TEST_F(PlantDescriptions, ValuesAreAllThatDiffers) {
  load(device(1, "") + device(2, "objects = { \"1017:00\" = 100 }") +
       device(3, "objects = { \"1017:00\" = 200 }") + device(4, "objects = { \"1017:00\" = 100 }"));
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(file(i).dictionary->objects().data(), file(0).dictionary->objects().data());
    EXPECT_EQ(file(i).facts.begin(), file(0).facts.begin());
  }
  EXPECT_EQ(&file(1), &file(3)) << "with the same values even those are shared";
  EXPECT_NE(&file(1), &file(2));
}

TEST_F(PlantDescriptions, ADeviceWithValuesOfItsOwnCostsLittleMore) {
  const auto heap_of = [&](auto&& objects_of) {
    plant_.reset();
    std::string devices;
    for (unsigned node = 1; node <= 100; ++node) devices += device(node, objects_of(node));
    const std::size_t before = mallinfo2().uordblks;
    load(devices);
    return mallinfo2().uordblks - before;
  };
  const auto without = [](unsigned) { return std::string{}; };
  const auto own = [](unsigned node) { return fmt::format("objects = {{ \"1017:00\" = {} }}", 100 + node); };
  static_cast<void>(heap_of(without));  // what is made once in a process
  const std::size_t shared = heap_of(without);
  EXPECT_LT(heap_of(own), shared + 100 * 2048);
}

}  // namespace
}  // namespace canopus::plant
