// Devices of one device file share what it describes, also when the plant file gives them other values.

#include <fmt/format.h>
#include <malloc.h>

#include "canopus/plant/device_on_bus.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant::plant_descriptions_test {
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
  const std::size_t with_values = heap_of(own);
  RecordProperty("bytes_per_device", static_cast<int>((with_values - shared) / 100));
  EXPECT_LT(with_values, shared + 100 * 2048);
}

TEST_F(PlantDescriptions, AnLssSlaveIsHeardByItsControllersFilter) {
  struct Master final : can::Participant {
    void receive(const can::Frame& frame, can::Time) override { heard.push_back(frame); }
    void tick(can::Time) override {}
    std::vector<can::Frame> heard;
  } master;
  load(fmt::format(
      "[[device]]\nbus = \"line1\"\nnode = \"unconfigured\"\neds = \"{}/examples/devices/io-block.eds\"\n",
      CANOPUS_SOURCE_DIR));
  can::Port& port = plant_->bus(0).add_port("master");
  plant_->timeline().add(master);
  port.connect(master);
  port.plug(true);
  plant_->timeline().run_until(can::Time{std::chrono::seconds(1)});
  // Switch to configuration, then inquire identity: vendor-ID
  port.send(can::data_frame(0x7E5, {0x04, 1, 0, 0, 0, 0, 0, 0}));
  port.send(can::data_frame(0x7E5, {0x5A, 0, 0, 0, 0, 0, 0, 0}));
  plant_->timeline().run_until(can::Time{std::chrono::seconds(2)});
  ASSERT_EQ(master.heard.size(), 1U);
  EXPECT_EQ(master.heard[0].identifier, 0x7E4U);
}

class SharedFile : public PlantDescriptions {
 protected:
  static std::string sharing(unsigned node, std::string_view objects) {
    return fmt::format("[[device]]\nbus = \"line1\"\nnode = {}\neds = \"shared.eds\"\n{}\n", node, objects);
  }
  std::uint32_t value(std::size_t number) { return objects(number).get<std::uint32_t>(0x2000, 0); }
  void write_value(std::size_t number, std::uint16_t index, std::uint8_t sub, std::uint32_t to) {
    ASSERT_EQ(objects(number).write(index, sub, can::little_endian(to, 4), plant_->timeline().now()),
              canopen::AbortCode::none);
  }
  void reset(std::size_t number) {
    plant_->device(number).device().node().command(canopen::NmtCommand::reset_node, plant_->timeline().now());
  }
  static std::string eds(std::string_view value) {
    return support::device_file(support::array_of_one("1010") + support::array_of_one("1011", "1") +
                                support::variable("2000", 7, value));
  }
};

constexpr std::uint32_t save = 0x65766173;
constexpr std::uint32_t load_defaults = 0x64616F6C;

TEST_F(SharedFile, WhatOneDeviceWrites_SavesAndRestores_IsItsOwn) {
  write("shared.eds", eds("7"));
  load(sharing(1, "") + sharing(2, "objects = { \"2000:00\" = 20 }") +
       sharing(3, "objects = { \"2000:00\" = 30 }") + sharing(4, "objects = { \"2000:00\" = 20 }"));
  EXPECT_EQ(value(0), 7U);
  EXPECT_EQ(value(1), 20U);
  EXPECT_EQ(value(2), 30U);
  EXPECT_EQ(value(3), 20U);
  write_value(1, 0x2000, 0, 99);
  EXPECT_EQ(value(0), 7U);
  EXPECT_EQ(value(2), 30U);
  EXPECT_EQ(value(3), 20U) << "of one description with the one that was written";
  write_value(1, 0x1010, 1, save);
  for (std::size_t number = 0; number < 4; ++number) reset(number);
  EXPECT_EQ(value(0), 7U);
  EXPECT_EQ(value(1), 99U);
  EXPECT_EQ(value(2), 30U);
  EXPECT_EQ(value(3), 20U);
  write_value(1, 0x1011, 1, load_defaults);
  reset(1);
  EXPECT_EQ(value(1), 20U) << "what the plant file says is its default";
  EXPECT_EQ(value(3), 20U);
}

TEST_F(SharedFile, ThatChanges_IsReadAnewByTheNextPlant) {
  write("shared.eds", eds("7"));
  const std::string devices = sharing(1, "") + sharing(2, "objects = { \"2000:00\" = 20 }");
  load(devices);
  const std::unique_ptr<Plant> before = std::move(plant_);
  write("shared.eds", eds("8"));
  load(devices);
  EXPECT_EQ(value(0), 8U);
  EXPECT_EQ(value(1), 20U);
  plant_ = nullptr;
  auto& dictionary = before->device(0).device().node().dictionary();
  EXPECT_EQ(dictionary.get<std::uint32_t>(0x2000, 0), 7U);
  before->device(0).device().node().command(canopen::NmtCommand::reset_node, before->timeline().now());
  EXPECT_EQ(dictionary.get<std::uint32_t>(0x2000, 0), 7U) << "its plant lives on with what it has read";
}

class PresetObjects : public PlantDescriptions {
 protected:
  std::vector<std::string> with(std::string_view objects) {
    return check(fmt::format(
        "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[plc]]\nlisten = \"off\"\n[[plc.module]]\n"
        "model = \"ME3CAN1-Q\"\nbus = \"line1\"\nhead = 0\nnode = 1\nobjects = {{ {} }}\n",
        objects));
  }
};

// By the description alone: no service of the module is asked, so the order does not matter.
TEST_F(PresetObjects, AreRefusedAsAWriteWouldBe) {
  using testing::ElementsAre;
  using testing::HasSubstr;
  EXPECT_THAT(with("\"1017:00\" = 500"), testing::IsEmpty());
  EXPECT_THAT(
      with("\"1018:01\" = 1"),
      ElementsAre(HasSubstr("1018:01: the ME3CAN1-Q refuses the value: write of a read-only object")));
  EXPECT_THAT(with("\"1F80:00\" = 0x80000000"),
              ElementsAre(HasSubstr("1F80:00: the ME3CAN1-Q refuses the value: ")));
  EXPECT_THAT(with("\"1000:00\" = 1"), ElementsAre(HasSubstr("1000:00: the ME3CAN1-Q refuses the value: ")));
}

}  // namespace
}  // namespace canopus::plant::plant_descriptions_test
