

#include "plc/answering_module.hpp"

namespace canopus::plc::built_in_program_test {
namespace {

TEST(BuiltInProgram, Exchange_BySignal_WaitsForTheAnswerAndComesAgainAtTheInterval) {
  Slot slot(signals, {.exchange = 20ms});
  slot.power();
  EXPECT_THAT(slot.notes_until(65ms), ElementsAre("20ms Y5 on", "23ms Y5 off", "40ms Y5 on", "43ms Y5 off",
                                                  "60ms Y5 on", "63ms Y5 off"));
  slot.module.set_output(exchange, true, slot.timeline.now());
  EXPECT_EQ(slot.module.own, 3 * 4) << "Y on, X on, Y off, X off of each are the program's own";
}

TEST(BuiltInProgram, Exchange_BySignalThatIsAnsweredLate_GoesOnAMillisecondAfterTheAnswer) {
  Slot slot(signals, {.exchange = 20ms});
  slot.module.answer_time = 30ms;
  slot.power();
  EXPECT_THAT(slot.notes_until(60ms), ElementsAre("20ms Y5 on", "50ms Y5 off", "51ms Y5 on"));
}

TEST(BuiltInProgram, Exchange_ByBits_WaitsUntilTheModuleTakesThemBack) {
  Slot slot(bits, {.exchange = 20ms});
  slot.power();
  EXPECT_THAT(slot.notes_until(45ms), ElementsAre("20ms 41=4", "40ms 41=4"));
  slot.module.answer_time = 30ms;
  EXPECT_THAT(slot.notes_until(100ms), ElementsAre("60ms 41=4", "91ms 41=4"))
      << "the bit is 0 again at 90 ms";
  slot.module.write_word(exchange_word, 4, slot.timeline.now());
  EXPECT_EQ(slot.module.own, 4) << "a client's is not the program's own";
  EXPECT_THAT(slot.module.edges, IsEmpty()) << "no signals";
}

TEST(BuiltInProgram, Exchange_ByBitsThatAreTakenBackAtOnce_ComesAgainAtTheInterval) {
  Slot slot(bits, {.exchange = 20ms});
  slot.module.answer_time = 0ms;
  slot.power();
  EXPECT_THAT(slot.notes_until(45ms), ElementsAre("20ms 41=4", "40ms 41=4"));
}

TEST(BuiltInProgram, Exchange_ByWriteAlone_DoesNotMindWhatTheWordReads) {
  Slot slot(write_only, {.exchange = 20ms});
  slot.power();
  EXPECT_THAT(slot.notes_until(65ms), ElementsAre("20ms 41=1", "40ms 41=1", "60ms 41=1"));
}

TEST(BuiltInProgram, Exchange_OfAModuleThatExchangesByItself_IsNotRequested) {
  constexpr ProgramInterface nothing{};
  Slot slot(nothing, {.exchange = 20ms, .online = true});
  slot.power();
  EXPECT_THAT(slot.notes_until(100ms), IsEmpty());
  EXPECT_EQ(slot.module.reads, 0) << "it may have no buffer memory at all";
}

TEST(BuiltInProgram, Exchange_WhileInitializing_IsPutOff) {
  for (const ProgramInterface* interface : {&signals, &bits}) {
    Slot slot(*interface, {.exchange = 20ms});
    slot.power(70ms);
    EXPECT_THAT(slot.notes_until(75ms), IsEmpty());
    EXPECT_EQ(slot.notes_until(82ms).size(), 1U);
  }
}

TEST(BuiltInProgram, Exchange_WhileAClientRequestsOne_IsPutOff) {
  Slot by_signal(signals, {.exchange = 20ms});
  by_signal.power();
  by_signal.module.answer_time = 50ms;
  by_signal.module.set_output(exchange, true, by_signal.timeline.now());
  EXPECT_THAT(by_signal.notes_until(75ms), ElementsAre("0ms Y5 on"));
  EXPECT_EQ(by_signal.module.own, 0) << "the client's request is news";
  by_signal.module.set_output(exchange, false, by_signal.timeline.now());
  EXPECT_THAT(by_signal.notes_until(81ms), ElementsAre("75ms Y5 off", "80ms Y5 on"));

  Slot unanswered(signals, {.exchange = 20ms});
  unanswered.power();
  unanswered.module.x |= 1U << exchange;
  EXPECT_THAT(unanswered.notes_until(75ms), IsEmpty()) << "X of the one before is not OFF yet";

  Slot by_bits(bits, {.exchange = 20ms});
  by_bits.power();
  by_bits.module.answer_time = 50ms;
  by_bits.module.write_word(exchange_word, 4, by_bits.timeline.now());
  EXPECT_THAT(by_bits.notes_until(61ms), ElementsAre("0ms 41=4", "60ms 41=4"));
  EXPECT_EQ(by_bits.module.own, 1);
}

TEST(BuiltInProgram, Exchange_ByBitsWhenTheModuleRestarts_GoesOnAfterwards) {
  Slot slot(bits, {.exchange = 20ms, .words = {{100, 7}}});
  slot.module.answer_time = 1000ms;
  slot.power();
  EXPECT_THAT(slot.notes_until(30ms), ElementsAre("0ms 100=7", "20ms 41=4"));
  slot.module.answer_at = can::never;
  slot.module.words[exchange_word] = 0;
  slot.module.initialize(slot.timeline.now(), can::Time{} + 90ms);
  EXPECT_THAT(slot.notes_until(89ms), IsEmpty()) << "an initializing module takes no words";
  EXPECT_THAT(slot.notes_until(95ms), ElementsAre("90ms 100=7", "91ms 41=4"));
  EXPECT_EQ(slot.module.wrong_reads, 0);
}

TEST(BuiltInProgram, SetUp_BySignal_WritesTheWordsOfflineAndThenGoesOnline) {
  Slot slot(signals, {.words = {{100, 7}, {101, 8}}, .online = true});
  slot.power(15ms);
  EXPECT_THAT(slot.notes_until(14ms), IsEmpty());
  // Y07 is OFF at the CPU already.
  EXPECT_THAT(slot.notes_until(50ms), ElementsAre("15ms 100=7", "15ms 101=8", "15ms Y7 on"));
  slot.module.initialize(slot.timeline.now(), can::Time{} + 80ms);
  EXPECT_THAT(slot.notes_until(200ms), ElementsAre("80ms Y7 off", "80ms 100=7", "80ms 101=8", "80ms Y7 on"));
  EXPECT_EQ(slot.module.own, 0) << "what is done once is news";
}

TEST(BuiltInProgram, SetUp_ByBits_WritesNothingButTheBits) {
  Slot slot(bits, {.words = {{100, 7}}, .online = true});
  slot.power(15ms);
  EXPECT_THAT(slot.notes_until(100ms), ElementsAre("15ms 100=7", "15ms 43=16"));
  // Reading, bit 0 says something; written, it would be another request.
  slot.module.initialize(slot.timeline.now(), can::never);
  EXPECT_THAT(slot.notes_until(150ms), IsEmpty());
  slot.module.words[status_word] = 0x0011;
  EXPECT_THAT(slot.notes_until(200ms), ElementsAre("160ms 43=0", "160ms 100=7", "160ms 43=16"))
      << "seen by the next scan";
}

TEST(BuiltInProgram, SetUp_OfAModuleWithoutSignals_SeesARestartThatNobodyTellsOf) {
  Slot slot(bits, {.words = {{100, 7}}});
  slot.program.update(slot.timeline.now());
  EXPECT_THAT(slot.module.drain_notes(), IsEmpty()) << "no supply yet";
  slot.power();
  EXPECT_THAT(slot.notes_until(50ms), ElementsAre("0ms 100=7"));
  slot.module.initialize(slot.timeline.now(), can::Time{} + 75ms);  // by the CPU's reset, say
  EXPECT_THAT(slot.notes_until(200ms), ElementsAre("75ms 100=7"));
}

TEST(BuiltInProgram, SetUp_ByACommand_WaitsForItsEndBeforeTheNextWord) {
  ProgramInterface by_word = bits;
  by_word.command = {.first = 60, .execute = {.kind = ProgramRequest::Kind::write, .word = 60, .bits = 2}};
  Slot slot(by_word, {.words = {{61, 1}, {60, 0xFFFF}, {100, 7}}, .online = true});  // FFFFH: it runs
  slot.power();
  EXPECT_THAT(slot.notes_until(95ms), ElementsAre("0ms 61=1", "0ms 60=65535"));
  slot.module.words[60] = 0x8201;
  EXPECT_THAT(slot.notes_until(200ms), ElementsAre("100ms 100=7", "100ms 43=16")) << "seen by the next scan";
  // It starts anew in the middle of the command: so does the program.
  slot.module.initialize(slot.timeline.now(), can::Time{} + 225ms);
  EXPECT_THAT(slot.notes_until(240ms), ElementsAre("225ms 61=1", "225ms 60=65535"));
  slot.module.initialize(slot.timeline.now(), can::Time{} + 265ms);
  EXPECT_THAT(slot.notes_until(280ms), ElementsAre("265ms 61=1", "265ms 60=65535"));
}

TEST(BuiltInProgram, SetUp_WithoutWordsAndOnline_LeavesTheModuleAlone) {
  for (const ProgramInterface* interface : {&signals, &bits}) {
    Slot slot(*interface, {});
    slot.power();
    EXPECT_THAT(slot.notes_until(100ms), IsEmpty());
    EXPECT_EQ(slot.program.alarm().deadline(), can::never);
    EXPECT_EQ(slot.module.reads, 0);
  }
}

// The answer never comes, because the module initialized when the request came, and the ready signal said
// nothing of it.
TEST(BuiltInProgram, RequestWhileInitializing_IsTakenBackAndMadeAnew) {
  RecordProperty("spec", "ME3-STAT-005");
  Slot slot(signals, {.exchange = 20ms});
  slot.power();
  slot.module.answer_time = 1h;
  EXPECT_THAT(slot.notes_until(25ms), ElementsAre("20ms Y5 on"));
  slot.module.answer_time = 3ms;
  slot.module.answer_at = can::never;
  slot.module.words[status_word] = initializing;
  slot.module.starts_at = can::Time{} + 63ms;
  slot.program.update(slot.timeline.now());
  EXPECT_THAT(slot.notes_until(60ms), ElementsAre("25ms Y5 off"));
  EXPECT_THAT(slot.notes_until(80ms), ElementsAre("75ms Y5 on", "78ms Y5 off"));
  slot.module.set_output(exchange, true, slot.timeline.now());
  EXPECT_EQ(slot.module.own, 2 + 4) << "a client's next one is not";
}

TEST(BuiltInProgram, RequestWithoutAnAnswer_IsTakenBackAndMadeAnew) {
  Slot slot(signals, {.exchange = 20ms});
  slot.power();
  slot.module.answer_time = 1h;
  EXPECT_THAT(slot.notes_until(525ms), ElementsAre("20ms Y5 on", "520ms Y5 off"));
  slot.module.answer_time = 3ms;
  EXPECT_THAT(slot.notes_until(540ms), ElementsAre("530ms Y5 on", "533ms Y5 off"));
}

TEST(BuiltInProgram, WithoutRecover_WaitsForTheAnswerForEver) {
  Slot slot(signals, {.exchange = 20ms, .recover = false});
  slot.power();
  slot.module.answer_time = 1h;
  EXPECT_THAT(slot.notes_until(20ms), ElementsAre("20ms Y5 on"));
  slot.module.words[status_word] = initializing;
  slot.module.starts_at = can::Time{} + 30ms;
  EXPECT_THAT(slot.notes_until(10min), IsEmpty());
  // The way back: OFF and ON, by whoever it is.
  const std::uint8_t off = 0;
  const std::uint8_t on = 1;
  slot.module.answer_time = 3ms;
  EXPECT_TRUE(slot.rack.write_bits(Device::y, Slot::head + exchange, {&off, 1}, slot.timeline.now()));
  EXPECT_TRUE(slot.rack.write_bits(Device::y, Slot::head + exchange, {&on, 1}, slot.timeline.now()));
  EXPECT_THAT(slot.notes_until(10min + 5ms),
              ElementsAre("600000ms Y5 off", "600000ms Y5 on", "600003ms Y5 off", "600004ms Y5 on"));
}

TEST(BuiltInProgram, InStop_StandsStill) {
  Slot slot(signals, {.exchange = 20ms});
  slot.power();
  EXPECT_THAT(slot.notes_until(30ms), ElementsAre("20ms Y5 on", "23ms Y5 off"));
  slot.rack.set_cpu_state(module::CpuState::stop, slot.timeline.now());
  EXPECT_EQ(slot.program.alarm().deadline(), can::never);
  EXPECT_THAT(slot.notes_until(100ms), IsEmpty());
  slot.rack.set_cpu_state(module::CpuState::run, slot.timeline.now());
  EXPECT_THAT(slot.notes_until(130ms), ElementsAre("120ms Y5 on", "123ms Y5 off"));
}

// Y OFF with the STOP, ON again with RUN: the module answers that.
TEST(BuiltInProgram, StopInTheMiddleOfARequest_GoesOnWithRun) {
  for (const bool recover : {true, false}) {
    for (const auto after : {1ms, 2ms, 4ms}) {
      Slot slot(signals, {.exchange = 20ms, .recover = recover});
      slot.power();
      slot.run_until(20ms + after);
      slot.module.drain_notes();
      slot.rack.set_cpu_state(module::CpuState::stop, slot.timeline.now());
      slot.run_until(100ms);
      EXPECT_EQ(slot.module.y >> exchange & 1U, 0U);
      slot.rack.set_cpu_state(module::CpuState::run, slot.timeline.now());
      slot.module.drain_notes();
      EXPECT_FALSE(slot.notes_until(130ms).empty());
    }
  }
}

TEST(BuiltInProgram, InPause_StandsStill) {
  Slot slot(signals, {.exchange = 20ms});
  slot.power();
  EXPECT_THAT(slot.notes_until(30ms), ElementsAre("20ms Y5 on", "23ms Y5 off"));
  slot.rack.pause(slot.timeline.now());
  EXPECT_EQ(slot.program.alarm().deadline(), can::never);
  EXPECT_THAT(slot.notes_until(100ms), IsEmpty());
  slot.rack.set_cpu_state(module::CpuState::run, slot.timeline.now());
  EXPECT_THAT(slot.notes_until(130ms), ElementsAre("120ms Y5 on", "123ms Y5 off"));
}

// Y stays ON, so the module answers, and the program finds that when it goes on.
TEST(BuiltInProgram, PauseInTheMiddleOfARequest_GoesOnWhereItWas) {
  Slot slot(signals, {.exchange = 20ms});
  slot.power();
  EXPECT_THAT(slot.notes_until(21ms), ElementsAre("20ms Y5 on"));
  slot.rack.pause(slot.timeline.now());
  EXPECT_THAT(slot.notes_until(100ms), IsEmpty());
  EXPECT_EQ(slot.module.x >> exchange & 1U, 1U);
  slot.rack.set_cpu_state(module::CpuState::run, slot.timeline.now());
  EXPECT_THAT(slot.notes_until(125ms), ElementsAre("100ms Y5 off", "120ms Y5 on", "123ms Y5 off"));
}

TEST(BuiltInProgram, AfterPause_DoesNotSetUpAgain) {
  for (const ProgramInterface* interface : {&signals, &bits}) {
    Slot slot(*interface, {.words = {{100, 7}}, .online = true});
    slot.power();
    EXPECT_FALSE(slot.notes_until(50ms).empty());
    slot.rack.pause(slot.timeline.now());
    EXPECT_THAT(slot.notes_until(100ms), IsEmpty());
    slot.rack.set_cpu_state(module::CpuState::run, slot.timeline.now());
    EXPECT_THAT(slot.notes_until(150ms), IsEmpty());
  }
}

TEST(BuiltInProgram, SupplyOffAndOn_BeginsAnew) {
  Slot slot(signals, {.exchange = 20ms});
  slot.power();
  slot.module.answer_time = 1h;
  EXPECT_THAT(slot.notes_until(25ms), ElementsAre("20ms Y5 on"));
  slot.module.y = slot.module.x = 0;
  slot.module.answer_at = can::never;
  slot.module.answer_time = 3ms;
  slot.rack.power_off(slot.timeline.now());
  EXPECT_EQ(slot.program.alarm().deadline(), can::never);
  slot.power(10ms);
  EXPECT_THAT(slot.notes_until(60ms), ElementsAre("45ms Y5 on", "48ms Y5 off"));
}

TEST(BuiltInProgram, CpuInStopFromTheStart_DoesNothing) {
  Slot slot(signals, {.exchange = 20ms, .words = {{100, 7}}});
  slot.module.initialize(slot.timeline.now(), can::Time{} + 10ms);
  slot.rack.power_on(slot.timeline.now(), module::CpuState::stop);
  EXPECT_THAT(slot.notes_until(100ms), IsEmpty());
  slot.rack.set_cpu_state(module::CpuState::run, slot.timeline.now());
  EXPECT_THAT(slot.notes_until(125ms), ElementsAre("100ms 100=7", "120ms Y5 on", "123ms Y5 off"));
}

}  // namespace
}  // namespace canopus::plc::built_in_program_test
