// [plc.module.parameters]: what the engineering tools have written to the CPU for a module, mistakes with their place, and
// the refresh of a running plant.

#include <fmt/format.h>

#include "canopus/can/timeline.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/interface/parameters.hpp"

#include "support/plant_folder.hpp"

namespace canopus::cli::module_parameters_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

constexpr std::string_view head = R"([[bus]]
name = "line"
bit_rate = 250_000
[[plc]]
name = "a"
family = "iQ-R"
listen = "off"
[[plc.module]]
model = "RJ71CN91"
bus = "line"
node = 1
master = true
restart_time = "100ms"
)";  // 13 lines

/// A second rack; its module exchanges by Y1.
constexpr std::string_view second = R"([[plc]]
name = "b"
family = "iQ-R"
listen = "off"
[[plc.module]]
model = "RJ71CN91"
bus = "line"
node = 2
exchange = "10ms"
restart_time = "100ms"
)";

std::string with(std::string_view parameters, std::string_view slave = "") {
  return fmt::format("{}{}[plc.module.parameters]\n{}{}", head, slave, parameters, second);
}

class ModuleParametersFile : public support::PlantFolder, public plant::PlantObserver {
 protected:
  void start(const std::string& text) {
    plant_ = support::PlantFolder::load(text, *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
  }
  void run(can::Duration time) { plant_->timeline().run_until(plant_->timeline().now() + time); }
  std::uint16_t g(std::size_t rack, module::BufferAddress address) {
    std::uint16_t value = 0;
    EXPECT_TRUE(plant_->rack(rack).read_buffer(0, address, {&value, 1}, plant_->timeline().now()));
    return value;
  }
  void g(std::size_t rack, module::BufferAddress address, std::uint16_t value) {
    EXPECT_TRUE(plant_->rack(rack).write_buffer(0, address, {&value, 1}, plant_->timeline().now()));
  }
  std::uint16_t d(std::uint32_t number) {
    std::uint16_t value = 0;
    EXPECT_TRUE(plant_->rack(0).read_words(plc::Device::d, number, {&value, 1}, plant_->timeline().now()));
    return value;
  }
  void d(std::uint32_t number, std::uint16_t value) {
    EXPECT_TRUE(plant_->rack(0).write_words(plc::Device::d, number, {&value, 1}, plant_->timeline().now()));
  }
  const canopen::ObjectDictionary& objects(std::size_t rack) {
    return dynamic_cast<module::CommunicationModule&>(*plant_->rack(rack).module_at(0)).node().dictionary();
  }
  std::unique_ptr<plant::Plant> plant_;
};

TEST_F(ModuleParametersFile, WordsAndObjects_AreTheModules) {
  RecordProperty("spec", "RJ71-PARAM-006");
  start(with("buffer = { G70 = 1000, G71 = 2000 }\nobjects = { \"1017:00\" = 300 }\n"));
  run(2s);
  EXPECT_EQ(g(0, 70), 1000);
  EXPECT_EQ(g(0, 71), 2000);
  EXPECT_EQ(g(1, 70), 500);
  EXPECT_EQ(objects(0).get<std::uint16_t>(0x1017, 0), 300);
}

TEST_F(ModuleParametersFile, SettingsOfAnotherNode_ReachItByTheConfigurationManager) {
  RecordProperty("spec", "RJ71-CM-009 RJ71-TOOL-002");
  start(
      with("[[plc.module.parameters.node]]\nnode = 2\nobjects = { \"1017:00\" = 123, \"1A00:00\" = 1, "
           "\"1A00:01\" = "
           "0xA100_0510, \"1800:01\" = 0x4000_0345 }\n",
           "[[plc.module.slave]]\nnode = 2\n"));
  run(4s);
  const auto& slave = objects(1);
  EXPECT_EQ(slave.get<std::uint16_t>(0x1017, 0), 123);
  EXPECT_EQ(slave.get<std::uint8_t>(0x1A00, 0), 1);
  EXPECT_EQ(slave.get<std::uint32_t>(0x1A00, 1), 0xA1000510U);
  EXPECT_EQ(slave.get<std::uint32_t>(0x1800, 1), 0x40000345U);
}

TEST_F(ModuleParametersFile, Refresh_CopiesBlocksAtTheEndOfEachScan) {
  RecordProperty("spec", "RJ71-PARAM-001 RJ71-PARAM-002 RJ71-PARAM-010");
  constexpr std::string_view parameters =
      "data_exchange = \"refresh\"\nrefresh = { G10000 = \"D1000\", G10064 = \"D1064\", G13000 = \"D2000\", "
      "G13960 = "
      "\"W100\" }\n";
  constexpr std::string_view slave =
      "objects = { \"1401:01\" = 0x182, \"1410:01\" = 0x183 }\n[[plc.module.slave]]\nnode = 2\nreceive = "
      "[1]\nsend = [1]\n";
  start(with(parameters, slave));
  run(4s);
  d(2001, 0x1234);
  g(1, 13002, 0x5678);
  run(100ms);
  EXPECT_EQ(g(1, 10001), 0x1234);
  EXPECT_EQ(d(1002), 0x5678);
  // The buffer memory is overwritten by the devices, and the devices by what was received.
  g(0, 13001, 0x9999);
  d(1002, 0x7777);
  run(20ms);
  EXPECT_EQ(g(0, 13001), 0x1234);
  EXPECT_EQ(d(1002), 0x5678);
  // Words of no block are the program's, and go out with the refresh all the same.
  g(0, 13064, 0x4321);
  run(20ms);
  EXPECT_EQ(g(0, 13064), 0x4321);
  std::uint16_t word = 0x0A0B;
  EXPECT_TRUE(plant_->rack(0).write_words(plc::Device::w, 0x100 + 63, {&word, 1}, plant_->timeline().now()));
  run(20ms);
  EXPECT_EQ(g(0, 14023), 0x0A0B);
  EXPECT_THAT(check(with(parameters, slave)), IsEmpty());
}

TEST_F(ModuleParametersFile, Refresh_WithoutABlockInEachDirection_ExchangesNothing) {
  RecordProperty("spec", "RJ71-PARAM-001");
  const std::string text = with("data_exchange = \"refresh\"\nrefresh = { G13000 = \"D2000\" }\n",
                                "[[plc.module.slave]]\nnode = 2\nsend = [1]\n");
  EXPECT_THAT(check(text),
              ElementsAre(HasSubstr("plant.toml:19:11: warning: refresh has no block of the RPDOs")));
  start(text);
  run(4s);
  d(2001, 0x1234);
  run(1s);
  EXPECT_EQ(g(0, 13001), 0);
  EXPECT_EQ(g(1, 10001), 0);
}

constexpr std::string_view linked =
    "objects = { \"1401:01\" = 0x182, \"1410:01\" = 0x183 }\n[[plc.module.slave]]\nnode = 2\nreceive = "
    "[1]\nsend = [1]\n";

/// [[plc.program]] sections stand before the second rack.
std::string with_programs(std::string_view parameters, std::string_view programs) {
  const std::string text = with(parameters, linked);
  const std::size_t place = text.size() - second.size();
  return text.substr(0, place) + std::string(programs) + text.substr(place);
}

constexpr std::string_view of_group_3 =
    "data_exchange = \"refresh\"\nrefresh_group = 3\nrefresh = { G10000 = \"RD0\", G13000 = \"RD524224\" }\n";

TEST_F(ModuleParametersFile, Refresh_AtAProgramOfTheGroup_OnceAScan_InRunAlone) {
  RecordProperty("spec", "RJ71-PARAM-003");
  const std::string text = with_programs(of_group_3,
                                         "[[plc.program]]\nname = \"MAIN\"\nrefresh_group = "
                                         "3\n[[plc.program]]\nname = \"B\"\nrefresh_group = 4\n");
  EXPECT_THAT(check(text), IsEmpty());
  start(text);
  run(4s);
  const auto rd = [&](std::uint32_t number) {
    std::uint16_t value = 0;
    EXPECT_TRUE(plant_->rack(0).read_words(plc::Device::rd, number, {&value, 1}, plant_->timeline().now()));
    return value;
  };
  const auto set_rd = [&](std::uint32_t number, std::uint16_t value) {
    EXPECT_TRUE(plant_->rack(0).write_words(plc::Device::rd, number, {&value, 1}, plant_->timeline().now()));
  };
  set_rd(524224 + 1, 0x1234);
  g(1, 13002, 0x5678);
  run(50ms);
  EXPECT_EQ(g(1, 10001), 0x1234);
  EXPECT_EQ(rd(2), 0x5678);
  EXPECT_EQ(d(2), 0);
  // A scan is 10 ms; with END it would be the same moment. No program is executed in PAUSE and STOP.
  set_rd(524225, 0x0001);
  run(9ms);
  EXPECT_EQ(g(0, 13001), 0x1234);
  run(1ms);
  EXPECT_EQ(g(0, 13001), 0x0001);
  plant_->rack(0).pause(plant_->timeline().now());
  set_rd(524225, 0x0002);
  run(100ms);
  EXPECT_EQ(g(0, 13001), 0x0001);
  plant_->rack(0).set_cpu_state(module::CpuState::run, plant_->timeline().now());
  run(10ms);
  EXPECT_EQ(g(0, 13001), 0x0002);
  plant_->rack(0).set_cpu_state(module::CpuState::stop, plant_->timeline().now());
  set_rd(524225, 0x0003);
  run(100ms);
  EXPECT_EQ(g(0, 13001), 0x0002);
  plant_->rack(0).set_cpu_state(module::CpuState::run, plant_->timeline().now());
  run(10ms);
  EXPECT_EQ(g(0, 13001), 0x0003);
}

// With `scan` the rack says when its scans end: END goes on in STOP, programs do not.
TEST_F(ModuleParametersFile, Refresh_OfARackWithItsOwnScans) {
  RecordProperty("spec", "RJ71-PARAM-003");
  for (const bool at_end : {true, false}) {
    std::string text = with_programs(
        at_end ? "data_exchange = \"refresh\"\nrefresh = { G10000 = \"RD0\", G13000 = \"RD524224\" }\n"
               : of_group_3,
        "[[plc.program]]\nname = \"MAIN\"\nrefresh_group = 3\n");
    text.replace(text.find("listen"), 0, "scan = \"20ms\"\n");
    start(text);
    run(4s);
    const auto comes_after = [&](std::uint16_t value, int most) {
      EXPECT_TRUE(
          plant_->rack(0).write_words(plc::Device::rd, 524224, {&value, 1}, plant_->timeline().now()));
      for (int ms = 1; ms <= most; ++ms) {
        run(1ms);
        if (g(0, 13000) == value) return ms;
      }
      return 0;
    };
    EXPECT_EQ(comes_after(1, 50), 20);
    EXPECT_EQ(comes_after(2, 50), 20);
    plant_->rack(0).set_cpu_state(module::CpuState::stop, plant_->timeline().now());
    EXPECT_EQ(comes_after(3, 50), at_end ? 20 : 0);
    plant_->rack(0).power_off(plant_->timeline().now());
    run(1s);
    plant_->rack(0).power_on(plant_->timeline().now());
    run(4s);
    EXPECT_EQ(comes_after(4, 50), 20);
  }
}

TEST_F(ModuleParametersFile, Refresh_AtAProgramInFixedIntervals) {
  RecordProperty("spec", "RJ71-PARAM-003");
  const std::string text =
      with_programs(of_group_3,
                    "[[plc.program]]\nname = \"SLOW\"\nrefresh_group = 3\ninterval = \"35ms\"\n"
                    "[[plc.program]]\nname = \"SLOWER\"\nrefresh_group = 3\ninterval = \"50ms\"\n");
  start(text);
  run(4s);
  plant_->rack(0).set_cpu_state(module::CpuState::stop, plant_->timeline().now());
  run(3ms);
  plant_->rack(0).set_cpu_state(module::CpuState::run, plant_->timeline().now());  // at 4.003 s
  std::vector<int> executions;
  for (std::uint16_t ms = 1; ms <= 105; ++ms) {
    const std::uint16_t before = g(0, 13000);
    EXPECT_TRUE(plant_->rack(0).write_words(plc::Device::rd, 524224, {&ms, 1}, plant_->timeline().now()));
    run(1ms);
    if (g(0, 13000) != before) executions.push_back(ms);
  }
  EXPECT_THAT(executions, ElementsAre(35, 50, 70, 100, 105));
}

TEST_F(ModuleParametersFile, Refresh_AtTheEndOfEachScan_DoesNotNeedAProgram_AndAGroupDoes) {
  RecordProperty("spec", "RJ71-PARAM-003");
  EXPECT_THAT(check(with_programs(of_group_3, "[[plc.program]]\nname = \"B\"\nrefresh_group = 4\n")),
              ElementsAre(HasSubstr("plant.toml:21:17: warning: refresh_group = 3: no [[plc.program]]")));
  start(with_programs(of_group_3, ""));
  run(4s);
  std::uint16_t word = 7;
  EXPECT_TRUE(plant_->rack(0).write_words(plc::Device::rd, 524225, {&word, 1}, plant_->timeline().now()));
  run(100ms);
  EXPECT_EQ(g(0, 13001), 0);
}

// Nobody but a program can write a label: the words of the TPDOs stay 0, those of the RPDOs come into G10000 as ever.
TEST_F(ModuleParametersFile, Refresh_IntoModuleLabels) {
  RecordProperty("spec", "RJ71-PARAM-003");
  const std::string text = with(
      "data_exchange = \"refresh\"\nrefresh = { G10000 = \"label\", G13000 = \"label\", G13064 = \"R0\" }\n",
      linked);
  EXPECT_THAT(check(text), ElementsAre(HasSubstr("plant.toml:21:31: warning: refresh: G13000 = \"label\"")));
  start(text);
  run(4s);
  g(1, 13002, 0x5678);
  g(0, 13001, 0x1234);
  run(50ms);
  EXPECT_EQ(g(0, 10002), 0x5678);
  EXPECT_EQ(g(0, 13001), 0);
  EXPECT_EQ(g(1, 10001), 0);
}

TEST_F(ModuleParametersFile, MistakesOfRefreshGroupsAndPrograms_HaveTheirPlace) {
  const auto says = [&](const std::string& text, std::string_view error) {
    EXPECT_THAT(check(text), ::testing::Contains(HasSubstr(std::string(error)))) << text;
  };
  for (const std::string_view group : {"0", "65", "-1", "\"3\""}) {
    says(with(fmt::format("data_exchange = \"refresh\"\nrefresh_group = {}\n", group)),
         "a refresh group is 1 to 64");
    says(with_programs("", fmt::format("[[plc.program]]\nname = \"A\"\nrefresh_group = {}\n", group)),
         "a refresh group is 1 to 64");
  }
  says(with("refresh_group = 1\n"), "is for data_exchange = \"refresh\"");
  says(with_programs("", "[[plc.program]]\nname = \"A\"\n"), "refresh_group is missing");
  says(with_programs("", "[[plc.program]]\nrefresh_group = 1\n"), "name is missing");
  says(with_programs("", "[[plc.program]]\nname = \"A\"\nrefresh_group = 1\ninterval = \"1us\"\n"),
       "a program is executed every 100us or less often");
  says(with_programs("",
                     "[[plc.program]]\nname = \"A\"\nrefresh_group = 1\n[[plc.program]]\nname = \"A\"\n"
                     "refresh_group = 2\n"),
       "another program is \"A\" already");
  says(
      "[[bus]]\nname = \"line\"\nbit_rate = 250_000\n[[plc]]\nlisten = \"off\"\nfamily = "
      "\"Q\"\n[[plc.program]]\n"
      "name = \"A\"\nrefresh_group = 1\n",
      "programs with a refresh group are a CPU's of the family iQ-R");
  says(with("data_exchange = \"refresh\"\nrefresh = { G10000 = \"RD524225\" }\n"),
       "the CPU's last one is nearer");
}

TEST_F(ModuleParametersFile, AnotherWayOfExchange_IsAMistake) {
  EXPECT_THAT(check(with("data_exchange = \"Y1\"\n")),
              ElementsAre(::testing::AllOf(HasSubstr("plant.toml:15:17: "),
                                           HasSubstr("expected \"request\" or \"refresh\""))));
}

TEST_F(ModuleParametersFile, MistakesOfTheModule_HaveTheirPlace) {
  EXPECT_THAT(
      check(with("buffer = { G21 = 11, G71 = 1 }\nobjects = { \"1000:00\" = 1, \"1017:00\" = 70000, "
                 "\"2222:00\" = 1 }\n")),
      ElementsAre(HasSubstr("plant.toml:15:12: parameters: G21 = 11: the RJ71CN91 does not take this value"),
                  HasSubstr("plant.toml:15:22: parameters: G71 = 1"),
                  HasSubstr("plant.toml:16:13: parameters: 1000:00"),
                  HasSubstr("plant.toml:16:28: parameters: 1017:00"),
                  HasSubstr("plant.toml:16:47: parameters: the RJ71CN91 has no object 2222:00")));
  EXPECT_THAT(
      check(with("data_exchange = \"refresh\"\nrefresh = { G10000 = \"D1000\", G13001 = \"D2000\" }\n")),
      ElementsAre(HasSubstr("plant.toml:16:31: refresh: G13001: expected the first of 64 words")));
  EXPECT_THAT(
      check(with("data_exchange = \"refresh\"\nrefresh = { G10000 = \"RD0\", G13000 = \"RD524224\" }\n")),
      IsEmpty());
  for (const std::string_view device : {"D99999999", "Q5", "D", "1000", "D10x", "RD524225"}) {
    EXPECT_THAT(
        check(with(fmt::format("data_exchange = \"refresh\"\nrefresh = {{ G10000 = \"{}\" }}\n", device))),
        ElementsAre(HasSubstr("plant.toml:16:22: refresh: G10000 = \"" + std::string(device) + "\"")))
        << device;
  }
  EXPECT_THAT(check(with("refresh = { G10000 = \"D1000\" }\n")),
              ElementsAre(HasSubstr("is for data_exchange = \"refresh\"")));
  EXPECT_THAT(
      check(with("[[plc.module.parameters.node]]\nnode = 1\n[[plc.module.parameters.node]]\nnode = 9\n")),
      ElementsAre(HasSubstr("plant.toml:16:8: parameters: node 1 is the module itself"),
                  HasSubstr("plant.toml:18:8: parameters: there is no device or module with node = 9")));
  EXPECT_THAT(check(with("[[plc.module.parameters.node]]\nnode = 2\nobjects = { \"3000:00\" = 1 }\n"
                         "[[plc.module.parameters.node]]\nnode = 2\n")),
              ElementsAre(HasSubstr("plant.toml:17:13: parameters: node 2 has no object"),
                          HasSubstr("plant.toml:19:8: node = 2: node 2 is there already, in line 16")));
  EXPECT_THAT(check(with("[[plc.module.parameters.node]]\nnode = 2\nobjects = { \"3000:00\" = 1 }\n")),
              ElementsAre(HasSubstr("plant.toml:17:13: parameters: node 2 has no object 3000:00")));
  EXPECT_THAT(check(with("colour = 1\n")), ElementsAre(HasSubstr("plant.toml:15:1")));
  EXPECT_THAT(
      check(
          "[[bus]]\nname = \"line\"\nbit_rate = 250_000\n[[plc]]\nlisten = \"off\"\n[[plc.module]]\nmodel = "
          "\"ME3CAN1-Q\"\nnode = 1\n[plc.module.parameters]\nbuffer = { G70 = 1 }\n"),
      ElementsAre(HasSubstr("parameters: the ME3CAN1-Q takes none from its CPU")));
}

}  // namespace
}  // namespace canopus::cli::module_parameters_test
