// Errors of a plant's modules cleared, and modules restarted, from the page: as a PLC program would, and why not.

#include "canopus/web/commands/modules.hpp"

#include <memory>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/module/interface/communication_module.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/web/commands/commands.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::web::modules_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using namespace std::chrono_literals;
using WishJson = text::Json;

std::string plant_with(const std::string& module, const std::string& rack = "", const std::string& bus = "") {
  return "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n" + bus +
         "[[device]]\nnode = 3\nname = \"encoder\"\neds = \"" CANOPUS_SOURCE_DIR
         "/examples/devices/encoder.eds\"\n[[plc]]\n" +
         rack + "[[plc.module]]\nmodel = " + module;
}
const std::string me3can1 = "\"ME3CAN1-Q\"\nhead = 0\nnode = 1\nrestart_time = \"100ms\"\n";
const std::string fx3u = "\"FX3U-CAN\"\nposition = 0\nnode = 1\nrestart_time = \"100ms\"\n";
constexpr unsigned head_of_second = 0x20;

class WebModulesTest : public support::PlantFolder {
 protected:
  void start(const std::string& text) {
    plant_ = load(text, no_observer_);
    ASSERT_NE(plant_, nullptr);
    modules_.emplace(*plant_, clock_);
    plant_->power_on();
    run(3s);
  }
  void TearDown() override { modules_.reset(); }

  void run(can::Duration time) { plant_->timeline().run_until(now() + time); }
  can::Time now() { return plant_->timeline().now(); }
  plc::Rack& rack() { return plant_->rack(0); }
  std::uint16_t word(std::uint32_t address) {
    return plant_->module(0).buffer_memory()->peek(address, now());
  }
  void write_word(std::uint32_t address, std::uint16_t value) {
    ASSERT_TRUE(rack().write_buffer(0, address, std::span(&value, 1), now()));
  }
  bool output(std::uint32_t number) {
    std::uint8_t bit = 0;
    EXPECT_TRUE(rack().read_bits(plc::Device::y, number, std::span(&bit, 1), now()));
    return bit != 0;
  }
  void set_output(std::uint32_t number, bool on) {
    const std::uint8_t bit = on ? 1 : 0;
    ASSERT_TRUE(rack().write_bits(plc::Device::y, number, std::span(&bit, 1), now()));
  }

  WebModules::Done hear() {
    said_.clear();
    return [this](const std::expected<WebModules::Json, std::string>& row) {
      ++told_;
      said_ = row ? (*row)["said"].get<std::string>() : row.error();
    };
  }
  void clear(const WishJson& wish = {{"number", 0U}}) { modules_->clear_errors(wish, hear()); }
  void reset(const WishJson& wish = {{"number", 0U}}) { modules_->restart(wish, hear()); }

  class NoObserver final : public plant::PlantObserver {
  } no_observer_;
  class Clock final : public link::LoopClock {
   public:
    can::Time now() override { return {}; }
    void touched() override { ++touches; }
    int touches = 0;
  } clock_;
  std::unique_ptr<plant::Plant> plant_;
  std::optional<WebModules> modules_;
  std::string said_;
  int told_ = 0;
};

constexpr std::uint16_t setting_error = 1U << 6;

TEST_F(WebModulesTest, ClearErrors_OfAnMe3can1Q_HoldsY0F_UntilX0FIsOff) {
  start(plant_with(me3can1));
  write_word(27, 200);
  ASSERT_EQ(word(29) & setting_error, setting_error);
  ASSERT_EQ(word(39), 27);
  clear();
  EXPECT_TRUE(output(0x0F));
  EXPECT_EQ(told_, 0) << "it takes plant time";
  EXPECT_EQ(clock_.touches, 1);
  run(10ms);
  EXPECT_EQ(said_, "errors cleared: Y0F ON until X0F is OFF");
  EXPECT_FALSE(output(0x0F));
  EXPECT_EQ(word(29), 0);
  EXPECT_EQ(word(39), 0);
  write_word(27, 200);
  EXPECT_EQ(word(29) & setting_error, setting_error) << "errors are found again";
  EXPECT_EQ(told_, 1);
}

TEST_F(WebModulesTest, ClearErrors_SaysWhatIsStillWrong) {
  start("[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[plc]]\n[[plc.module]]\nmodel = " + me3can1);
  write_word(27, 200);
  clear();
  run(10ms);
  EXPECT_EQ(said_, "errors cleared: Y0F ON until X0F is OFF; G29 is 4000H: that is still wrong")
      << "nobody acknowledges its frames: error passive";
}

TEST_F(WebModulesTest, ClearErrors_WithAScanOfTheCpu_WaitsForItsRefresh) {
  start(plant_with(me3can1, "scan = \"20ms\"\n"));
  write_word(27, 200);
  run(40ms);
  clear();
  run(10ms);
  EXPECT_EQ(told_, 0);
  run(200ms);
  EXPECT_EQ(said_, "errors cleared: Y0F ON until X0F is OFF");
  EXPECT_EQ(word(29), 0);
  EXPECT_FALSE(output(0x0F));
  EXPECT_EQ(plant_->module(0).signals()->outputs() >> 0x0F & 1U, 0U);
  clear();
  run(5ms);
  EXPECT_EQ(told_, 1) << "X0F is OFF, but the module has not seen Y0F yet";
  run(100ms);
  EXPECT_EQ(told_, 2);
}

TEST_F(WebModulesTest, ClearErrors_OfAModuleThatKeepsX0F_EndsAfterItsTime_AndY0FIsOff) {
  start(plant_with(me3can1));
  plant_->module(0).inject(module::ModuleFault::hardware_error, now());
  run(10ms);
  clear();
  run(900ms);
  EXPECT_EQ(told_, 0);
  EXPECT_TRUE(output(0x0F));
  run(200ms);
  EXPECT_EQ(said_, "ME3CAN1-Q U0: X0F stays ON for 1 s; Y0F is OFF again");
  EXPECT_FALSE(output(0x0F));
}

TEST_F(WebModulesTest, ClearErrors_OfAnFx3uCan_WritesBfm29_AndSaysWhatCameBack) {
  start(plant_with(fx3u, "family = \"FX3\"\n"));
  write_word(21, 1);
  ASSERT_EQ(word(29) & setting_error, setting_error);
  clear();
  run(5ms);
  EXPECT_EQ(said_, "errors cleared: 0 into BFM #29");
  EXPECT_EQ(word(29), 0);
  write_word(24, 300);  // bit 11 is there until the setting is right [FX3U-CAN 14.2]
  clear();
  run(5ms);
  EXPECT_EQ(said_, "errors cleared: 0 into BFM #29; BFM #29 is 0801H: that is still wrong");
}

TEST_F(WebModulesTest, ClearErrors_OfAnFxModule_WorksInStop_ButNotWhileItInitializes) {
  start(plant_with(fx3u, "family = \"FX3\"\n"));
  write_word(21, 1);
  rack().set_cpu_state(module::CpuState::stop, now());
  clear();
  run(5ms);
  EXPECT_THAT(said_, StartsWith("errors cleared"));
  write_word(25, 1);
  run(5ms);
  clear();
  EXPECT_EQ(said_, "FX3U-CAN U0: it still initializes, and takes no words");
  run(1s);
  EXPECT_EQ(word(29), 0) << "nothing was written that is forbidden then";
}

TEST_F(WebModulesTest, Reset_OfAnMe3can1Q_HoldsY02_UntilX02) {
  start(plant_with(me3can1));
  write_word(27, 9);
  reset();
  run(50ms);
  EXPECT_EQ(told_, 0);
  EXPECT_TRUE(output(0x02));
  run(60ms);
  EXPECT_EQ(said_, "restarted in 0.100 s: Y02 ON until X02 is ON");
  EXPECT_FALSE(output(0x02));
  EXPECT_EQ(word(27), 1) << "what was not saved is lost";
  run(2s);
  EXPECT_EQ(word(25) & 1U << 7, 0) << "once, and not again";
}

TEST_F(WebModulesTest, Reset_OfTheOtherModels) {
  start(plant_with("\"RJ71CN91\"\nhead = 0\nnode = 1\n", "family = \"iQ-R\"\n"));
  reset();
  run(7s);
  EXPECT_EQ(said_, "restarted in 6.000 s: Y2 ON until X2 is ON");
  for (const std::string model : {"FX3U-CAN", "FX2N-32CAN"}) {
    modules_.reset();
    start(plant_with("\"" + model + "\"\nposition = 0\nnode = 1\nrestart_time = \"12s\"\n",
                     "family = \"FX3\"\n"));
    reset();
    run(11s);
    EXPECT_EQ(said_, "") << model;
    run(2s);
    EXPECT_EQ(said_, "restarted in 12.000 s: bit 0 into BFM #25") << model;
  }
}

TEST_F(WebModulesTest, Reset_ThatDoesNotEnd_GivesUp_AndY02IsOff) {
  start(plant_with(me3can1));
  reset();
  run(10ms);
  set_output(0x02, false);  // a program that takes it back: X02 comes no more
  run(9s);
  EXPECT_EQ(told_, 0);
  run(2s);
  EXPECT_EQ(said_, "ME3CAN1-Q U0: X02 stays OFF for 10 s; Y02 is OFF again");
  EXPECT_FALSE(output(0x02));
}

TEST_F(WebModulesTest, Stop_AndPause_AreSaid) {
  start(plant_with(me3can1));
  rack().pause(now());
  clear();
  EXPECT_EQ(said_, "ME3CAN1-Q U0: the CPU is in PAUSE, where its Y stay as they are: Y0F wants RUN");
  rack().set_cpu_state(module::CpuState::stop, now());
  clear();
  EXPECT_EQ(said_, "ME3CAN1-Q U0: the CPU is in STOP, where its Y are OFF: Y0F wants RUN");
  reset();
  EXPECT_EQ(said_, "ME3CAN1-Q U0: the CPU is in STOP, where its Y are OFF: Y02 wants RUN");
  EXPECT_FALSE(output(0x02));
}

TEST_F(WebModulesTest, StopMeanwhile_IsSaidAtOnce_AndRunLeavesNoYOn) {
  start(plant_with(me3can1));
  reset();
  run(20ms);
  rack().set_cpu_state(module::CpuState::stop, now());
  run(5ms);
  EXPECT_EQ(said_, "ME3CAN1-Q U0: the CPU went to STOP meanwhile, and Y02 OFF with all its Y");
  run(1s);
  rack().set_cpu_state(module::CpuState::run, now());
  run(5ms);
  EXPECT_FALSE(output(0x02)) << "RUN takes Y as it was before the STOP";
  run(3s);
  clear();
  run(5ms);
  EXPECT_THAT(said_, StartsWith("errors cleared"));
  EXPECT_EQ(told_, 2);
}

TEST_F(WebModulesTest, SupplyThatGoes_IsSaid) {
  start(plant_with(me3can1));
  reset();
  run(20ms);
  rack().power_off(now());
  run(5ms);
  EXPECT_EQ(said_, "ME3CAN1-Q U0: the PLC's supply went off meanwhile");
  reset();
  EXPECT_EQ(said_, "ME3CAN1-Q U0: the PLC has no supply");
  rack().power_on(now());
  EXPECT_FALSE(output(0x02));
}

TEST_F(WebModulesTest, TwoAtOnce_AreForTwoModules) {
  start(plant_with(me3can1) +
        "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0x20\nnode = 2\nrestart_time = "
        "\"200ms\"\n");
  reset();
  clear();
  EXPECT_EQ(said_, "ME3CAN1-Q U0: another request of the page is not yet over; it goes on with plant time");
  EXPECT_FALSE(output(0x0F));
  reset({{"number", 1U}});
  EXPECT_TRUE(output(0x02));
  EXPECT_TRUE(output(head_of_second + 0x02));
  run(150ms);
  EXPECT_EQ(told_, 2);
  run(100ms);
  EXPECT_EQ(told_, 3);
  EXPECT_EQ(said_, "restarted in 0.200 s: Y02 ON until X02 is ON");
}

TEST_F(WebModulesTest, PartsOfAPlant_ThatShareNothing) {
  std::string text;
  for (const std::string name : {"line1", "line2"})
    text += "[[bus]]\nname = \"" + name + "\"\nbit_rate = 250_000\n";
  for (const std::string name : {"line1", "line2"})
    text += "[[plc]]\nname = \"of " + name + "\"\nlisten = \"off\"\n[[plc.module]]\nbus = \"" + name +
            "\"\nmodel = " + me3can1;
  start(text);
  ASSERT_EQ(plant_->timeline().partition_count(), 2U);
  reset({{"number", 1U}});
  run(99ms);
  EXPECT_EQ(told_, 0);
  EXPECT_EQ(word(25) & 1U << 7, 0) << "the other one goes on";
  run(10ms);
  EXPECT_EQ(said_, "restarted in 0.100 s: Y02 ON until X02 is ON");
}

TEST_F(WebModulesTest, SomebodyElsesRequest_IsLeftAlone) {
  start(plant_with(me3can1));
  set_output(0x0F, true);
  clear();
  EXPECT_EQ(said_, "ME3CAN1-Q U0: Y0F is ON already: the PLC program, or another client, asks for the same");
  run(2s);
  EXPECT_TRUE(output(0x0F));
}

TEST_F(WebModulesTest, Nonsense_IsRefusedInASentence) {
  start(plant_with(me3can1));
  for (const WishJson& wish : {WishJson{{"number", 1U}}, WishJson{{"number", -1}}, WishJson{{"number", "0"}},
                               WishJson{{"number", 0.5}}, WishJson::object()}) {
    clear(wish);
    EXPECT_EQ(said_, "number: expected that of a module of the plant, 0 to 0") << wish.dump();
    EXPECT_EQ(modules_->live_bus(wish), "");
  }
  EXPECT_EQ(clock_.touches, 0);
  modules_.reset();
  start(plant_with("\"AS-FCOPM\"\n", "family = \"AS300\"\n"));
  clear();
  EXPECT_THAT(said_, HasSubstr(": its codes go by themselves when their cause is gone"));
  reset();
  EXPECT_THAT(said_, HasSubstr(": it starts with the PLC's supply alone"));
}

TEST_F(WebModulesTest, LiveBus_IsThatOfALink) {
  start(plant_with(me3can1));
  EXPECT_EQ(modules_->live_bus({{"number", 0U}}), "");
  modules_.reset();
  start(plant_with(me3can1, "", "link = \"socketcan:can0\"\n"));
  EXPECT_EQ(modules_->live_bus({{"number", 0U}}), "line1");
}

TEST(WebOwnCommands, OnALiveBus_WantToBeArmed) {
  boost::asio::io_context io;
  int runs = 0;
  WebCommands commands(io,
                       {.own = {{"clear errors",
                                 {.fields = {"bus"},
                                  .run =
                                      [&runs](const WishJson&, const WebCommands::Own::Done& done) {
                                        ++runs;
                                        done(WebModules::Json::object());
                                      },
                                  .live_bus = [](const WishJson& wish) { return wish.value("bus", ""); }}}},
                        .now = [] { return can::Time{}; }});
  nlohmann::json reply;
  const auto say = [&](const WishJson& wish) {
    commands.run({.role = WebRole::operate}, wish.dump(), 1,
                 [&reply](const std::string& event) { reply = nlohmann::json::parse(event); });
  };
  say({{"command", "clear errors"}});
  EXPECT_EQ(reply["code"], 0);
  say({{"command", "clear errors"}, {"bus", "line1"}});
  EXPECT_EQ(reply["code"], web_code::not_armed);
  EXPECT_EQ(reply["message"], "clear errors: line1 is a live bus; arm writing first");
  EXPECT_EQ(runs, 1);
  say({{"command", "arm"}, {"on", true}});
  say({{"command", "clear errors"}, {"bus", "line1"}});
  EXPECT_EQ(reply["code"], 0);
  EXPECT_EQ(runs, 2);
}

TEST_F(WebModulesTest, AWordIsWritten_AsAProgramWritesIt) {
  start(plant_with(me3can1));
  const auto row = modules_->write_word({{"number", 0U}, {"address", 13000U}, {"value", 0x1234U}});
  ASSERT_TRUE(row) << row.error();
  EXPECT_EQ((*row)["module"].string(), "ME3CAN1-Q U0");
  EXPECT_EQ((*row)["address"].get<int>(), 13000);
  EXPECT_EQ((*row)["value"].get<int>(), 0x1234);
  EXPECT_NE((*row)["name"].string(), "");
  EXPECT_EQ(word(13000), 0x1234);
  EXPECT_EQ(clock_.touches, 1);
}

TEST_F(WebModulesTest, AWordThatCannotBeWritten_SaysWhy_AndNothingIsWritten) {
  start(plant_with(me3can1));
  const auto error = [&](const WishJson& wish) {
    const auto row = modules_->write_word(wish);
    return row ? std::string("it was written") : row.error();
  };
  EXPECT_EQ(error({{"number", 1U}, {"address", 1U}, {"value", 1U}}),
            "number: expected that of a module of the plant, 0 to 0");
  EXPECT_EQ(error({{"number", 0U}, {"value", 1U}}), "address: expected 0 to 65535");
  EXPECT_EQ(error({{"number", 0U}, {"address", 65536U}, {"value", 1U}}), "address: expected 0 to 65535");
  EXPECT_EQ(error({{"number", 0U}, {"address", 27U}}), "value: expected 0 to 65535");
  EXPECT_EQ(error({{"number", 0U}, {"address", 27U}, {"value", -1}}), "value: expected 0 to 65535");
  EXPECT_EQ(error({{"number", 0U}, {"address", 27U}, {"value", 65536U}}), "value: expected 0 to 65535");
  EXPECT_EQ(error({{"number", 0U}, {"address", 65535U}, {"value", 1U}}),
            "ME3CAN1-Q U0 G65535: the module has no such word");
  EXPECT_EQ(error({{"number", 0U}, {"address", 10000U}, {"value", 1U}}),
            "ME3CAN1-Q U0 G10000: a program can only read this word");
  EXPECT_EQ(error({{"number", 0U}, {"address", 27U}, {"value", 200U}}),
            "ME3CAN1-Q U0 G27: 200 does not fit; expected 1 to 127")
      << "[ME3CAN1-Q 4.6.6]";
  EXPECT_THAT(error({{"number", 0U}, {"address", 24U}, {"value", 3U}}),
              StartsWith("ME3CAN1-Q U0 G24: 3 does not fit; expected one of "));
  EXPECT_EQ(word(29), 0) << "a wrong value would be an error of the module";
  EXPECT_EQ(clock_.touches, 0);
}

TEST_F(WebModulesTest, AWordOfAnotherModel_IsWritten) {
  start(plant_with(fx3u, "family = \"FX3\"\n"));
  const auto row = modules_->write_word({{"number", 0U}, {"address", 11000U}, {"value", 7U}});
  ASSERT_TRUE(row) << row.error();
  EXPECT_EQ(word(11000), 7);
}

}  // namespace
}  // namespace canopus::web::modules_test
