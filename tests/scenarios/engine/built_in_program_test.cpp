// The built-in PLC program with a module that is asked by bits of words, on the real engine.

#include "canopus/plc/program/built_in_program.hpp"

#include "scenarios/engine/other_models.hpp"

namespace canopus::scenario {
namespace {

constexpr module::ProgramInterface by_words{
    .exchange = {.kind = module::ProgramRequest::Kind::bits, .word = 120, .bits = 1U << 0},
    .online = {.kind = module::ProgramRequest::Kind::bits, .word = 125, .bits = 1U << 4},
    .status = 125,
    .initializing = 1U << 13,
};

class WithProgram : public OtherScenario<WordModule> {
 public:
  explicit WithProgram(plc::BuiltInProgram::Task task)
      : rack_(timeline_), program_(rack_, 0, plug_in(), by_words, std::move(task)) {}

  void start_program() {
    program_.supply_changed(true, now());
    program_.look(now());
  }
  void run(can::Duration time) {
    for (const can::Time end = now() + time; now() < end;) {
      advance(1ms);
      program_.tick(now());
      program_.look(now());
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
  s.expect(129, 0);  // nothing was written while it initialized
  s.run(1ms);
  s.tx(0x703, {0x00}).rx(0x000, {0x01, 0x00}).rx(0x203, {0x34, 0x12}).write(4001, 0x5678).expect(3001, 0);
  s.run(22ms);
  s.tx(0x183, {0x78, 0x56}).expect(3001, 0x1234);
  s.rx(0x203, {0x35, 0x12});
  s.run(30ms);
  s.expect(3001, 0x1235).no_tx();
}

TEST(BuiltInProgramByWords, GoesOnlineAfterEachStart) {
  WithProgram s(
      {.words =
           {{2400, 0xFFFF}, {2401, 0x5FFF}, {2402, 0}, {2403, 0}, {2000, 0x5678}, {2001, 0x1234}, {2002, 2}},
       .online = true});
  s.supply_on().advance(1s).ignore_tx();
  s.write(121, 7).write(122, 1).advance(100ms);
  s.supply_off().supply_on();
  s.start_program();
  s.run(999ms);
  EXPECT_EQ(s.read(2400), 0xFFFF);
  s.expect(129, 0);
  s.run(1ms);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::online);
  s.expect(2401, 0x5FFF).expect(129, 0);
  s.write(125, 1U << 0);  // somebody restarts it
  EXPECT_NE(s.plug_in().layer2_state(), module::Layer2State::online);
  s.run(6s);
  s.expect_bit(125, 13, false).expect(129, 0);
  s.run(10ms);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::online);
}

}  // namespace
}  // namespace canopus::scenario
