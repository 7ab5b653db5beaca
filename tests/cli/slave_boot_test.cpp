// Why is my slave stuck? The boot of every slave by a module of the plant, as events, as JSON and in the live
// table.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/cli/run/live_table.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"

#include "cli/table_picture.hpp"
#include "paths.hpp"

namespace canopus::cli::slave_boot_test {
namespace {

using manager::BootStep;
using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using namespace std::chrono_literals;

const std::string devices = CANOPUS_SOURCE_DIR "/examples/devices/";

class SlaveBootTest : public testing::Test, public plant::PlantObserver {
 protected:
  /// A master (node 1), an encoder (node 3), and what `objects` says of others.
  void run(const std::string& objects, can::Duration duration, const std::string& of_encoder = "") {
    const std::string text = R"(
[[bus]]
name = "line1"
bit_rate = 250_000
[[device]]
node = 3
name = "encoder"
eds = ")" + devices + R"(encoder.eds"
)" + of_encoder + R"(
[[plc]]
name = "plc1"
[[plc.module]]
model = "ME3CAN1-Q"
head = 0x00
node = 1
master = true
slaves = "all"
objects = {)" + objects + "}\n";
    const plant::PlantReading reading = plant::read_plant(text, "plant.toml");
    ASSERT_THAT(reading.errors, IsEmpty());
    auto built = plant::Plant::build(reading.plant, *this);
    ASSERT_TRUE(built.has_value()) << describe(built.error()[0], "plant.toml");
    plant = std::move(*built);
    raw_plant = plant.get();
    plant->power_on();
    plant->timeline().run_until(can::Time(duration));
  }
  void on(const plant::Event& event) override {
    if (const auto* failure = std::get_if<plant::Failure>(&event.what)) errors.push_back(failure->message);
    const auto* const boot = std::get_if<plant::SlaveBootStep>(&event.what);
    if (boot == nullptr) return;
    events.push_back(fmt::format("{:.3f} {} {} by {}", can::seconds(event.time), boot->slave.node_id,
                                 manager::describe(boot->record), boot->master.node_id));
    table.on(event);
  }
  [[nodiscard]] std::string picture(TableSize size = {.rows = 40, .columns = 80}, TableView view = {}) {
    return shown(table, plant->timeline().now(), size, view);
  }

  std::unique_ptr<plant::Plant> plant;
  plant::Plant* raw_plant = nullptr;
  LiveTable table{raw_plant};
  std::vector<std::string> events;
  std::vector<std::string> errors;
};

TEST_F(SlaveBootTest, EveryStepOfAGoodBootIsTold) {
  run("", 1500ms);
  EXPECT_THAT(events, ElementsAre("1.000 3 waiting for its boot-up message after the reset by 1",
                                  "1.001 3 asking for 1000H by 1",
                                  "1.002 3 checking its identity, 1018:02 by 1", "1.004 3 booted by 1"));
  ASSERT_EQ(plant->boots().size(), 1U);
  EXPECT_EQ(plant->boots()[0].slave.name, "encoder");
  EXPECT_EQ(plant->boots()[0].master.node_id, 1);
  EXPECT_EQ(plant->boots()[0].record.step, BootStep::booted);
  EXPECT_THAT(picture(), Not(HasSubstr("boot-up")));
}

TEST_F(SlaveBootTest, AMissingSlave_IsInTheTableWithWhatToCheck) {
  run(R"("1F81:09" = 0x05)", 4200ms);  // node 9: assigned, boot slave, not mandatory
  EXPECT_THAT(picture(),
              HasSubstr("   9  -             not booted       -          -             -\n"
                        "      no answer to 1000H, waiting to ask again, for 0.2 s. Asked 2 times without\n"
                        "      an answer. Check that the device is powered and connected, has this\n"));
  const plant::SlaveBoot missing = plant->boots().back();
  EXPECT_EQ(missing.slave.node_id, 9);
  EXPECT_EQ(missing.slave.name, "");
  EXPECT_EQ(missing.record.error, manager::BootError::no_answer);
  EXPECT_EQ(missing.record.attempts, 2U);
}

TEST_F(SlaveBootTest, ASlaveWithAnotherBitRate_IsTheReasonForAllThatDoNotAnswer) {
  run(R"("1F81:09" = 0x05)", 4200ms, "bit_rate = 500_000");
  for (const plant::SlaveBoot& boot : plant->boots()) {
    EXPECT_THAT(
        manager::explain(boot.record, plant->timeline().now()),
        AllOf(
            HasSubstr("no answer to 1000H"),
            HasSubstr("without an answer. Node 3 has 500 kbit/s, the bus 250 kbit/s: no frame of this bus is "
                      "valid until they are the same.")))
        << unsigned{boot.slave.node_id};
  }
  EXPECT_EQ(plant->boots().size(), 2U);
}

TEST_F(SlaveBootTest, AWrongMandatoryDevice_EndsTheStartUpAndSaysSo) {
  run(R"("1F81:03" = 0x0D, "1F86:03" = 0x1234)", 2s);
  EXPECT_THAT(events.back(), HasSubstr("failed (M, product code differs from 1F86H)"));
  EXPECT_THAT(errors,
              ElementsAre("the start-up of the network has ended: node 3 is mandatory (1F81H bit 3) and "
                          "was not booted"));
  EXPECT_THAT(picture(), HasSubstr("expected 00001234H"));
}

TEST_F(SlaveBootTest, ManyMissingSlaves_LeaveRoomForTheRest) {
  std::string objects;
  for (int node = 20; node < 60; ++node)
    objects += fmt::format("{}\"1F81:{:02X}\" = 0x05", node == 20 ? "" : ", ", node);
  run(objects, 4200ms);
  const std::string drawn = picture({.rows = 24, .columns = 80});
  EXPECT_LE(std::ranges::count(drawn, '\n'), 24);
  EXPECT_THAT(drawn, HasSubstr("  20  -             not booted "));
  EXPECT_THAT(drawn, ContainsRegex("\n… 3[0-9] more nodes\n"));
  EXPECT_THAT(picture({.rows = 24, .columns = 80}, {.first = 999}), HasSubstr("encoder"));
}

TEST_F(SlaveBootTest, Json_HasTheFieldsThatPrograms_LookAt) {
  run(R"("1F86:03" = 0x1234)", 2s);
  plant::RunSummary summary{.end = can::Time{2s}, .virtual_time = true, .boots = plant->boots()};
  TextOutput out;
  plant::JsonPrinter(out).summary(summary);
  const auto line = nlohmann::json::parse(out.text());
  const auto& slave = line["slaves"][0];
  EXPECT_EQ(slave["node"], 3);
  EXPECT_EQ(slave["master"], 1);
  EXPECT_EQ(slave["step"], "failed");
  EXPECT_EQ(slave["object"], "1018:02");
  EXPECT_EQ(slave["attempts"], 1);
  EXPECT_EQ(slave["error"], "M");
  EXPECT_EQ(slave["expected"], 0x1234);
  EXPECT_THAT(slave["reason"].get<std::string>(), HasSubstr("Check the device"));
  EXPECT_FALSE(slave.contains("abort"));
}

}  // namespace
}  // namespace canopus::cli::slave_boot_test
