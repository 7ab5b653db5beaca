// The built-in PLC program with a module that is asked by bits of words, on the real engine.

#include "canopus/plc/program/built_in_program.hpp"

#include "scenarios/engine/other_models.hpp"
#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario::engine_built_in_program_test {
namespace {

class WithProgram : public OtherScenario<module::fx3u_can::Fx3uCan> {
 public:
  explicit WithProgram(plc::BuiltInProgram::Task task)
      : rack_(timeline_), program_(rack_, 0, plug_in(), plug_in().program_interface(), std::move(task)) {}

  void start_program() {
    program_.supply_changed(true, now());
    program_.update(now());
  }
  void run(can::Duration time) {
    for (const can::Time end = now() + time; now() < end;) {
      advance(1ms);
      program_.tick(now());
      program_.update(now());
    }
  }

 private:
  can::Timeline timeline_;
  plc::Rack rack_;
  plc::BuiltInProgram program_;
};

TEST(BuiltInProgramByWords, ExchangesProcessDataOnceTheModuleIsReady) {
  WithProgram s({.exchange = 30ms});
  s.supply_on();
  s.start_program();
  s.run(999ms);
  s.expect(29, 0);  // nothing was written while it initialized
  s.run(1ms);
  s.tx(0x77F, {0x00})
      .rx(0x000, {0x01, 0x00})
      .rx(0x27F, {0x34, 0x12, 0, 0, 0, 0, 0, 0})
      .write(0, 0x5678)
      .expect(0, 0);
  s.run(22ms);
  s.tx(0x1FF, {0x78, 0x56, 0, 0, 0, 0, 0, 0}).expect(0, 0x1234);
  s.rx(0x27F, {0x35, 0x12, 0, 0, 0, 0, 0, 0});
  s.run(30ms);
  s.expect(0, 0x1235).no_tx();
}

TEST(BuiltInProgramByWords, GoesOnlineAfterEachStart) {
  WithProgram s(
      {.words =
           {{1100, 0xFFFF}, {1101, 0x5FFF}, {1102, 0}, {1103, 0}, {100, 0x5678}, {101, 0x1234}, {102, 2}},
       .online = true});
  s.supply_on().advance(1s).ignore_tx();
  s.write(21, 29).write(22, 1).advance(100ms);
  s.supply_off().supply_on();
  s.start_program();
  s.run(999ms);
  EXPECT_EQ(s.read(1100), 0xFFFF);
  s.expect(29, 0);
  s.run(1ms);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::online);
  s.expect(1101, 0x5FFF).expect(29, 0);
  s.write(25, 1U << 0);  // somebody restarts it
  EXPECT_NE(s.plug_in().layer2_state(), module::Layer2State::online);
  s.run(6s);
  s.expect_bit(25, 7, false).expect(29, 0);
  s.run(10ms);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::online);
}

}  // namespace
}  // namespace canopus::scenario::engine_built_in_program_test
