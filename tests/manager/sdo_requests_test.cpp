// SDO requests of the application beside the start-up's: queues, turns, ends [CiA 301 7.2.4; CiA 302-2].

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test::sdo_requests_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

class Requests : public MasterBench {
 public:
  Requests() { object(0x1F80, 0, 0x01); }
  /// Notes how the request ends: "2 1018:01 ok 07 00 00 00".
  SdoRequests::Done note() {
    return [this](const SdoResult& result, can::Time) {
      char head[40];
      std::snprintf(head, sizeof head, "%u %04X:%02X %08X", unsigned{result.node_id}, unsigned{result.index},
                    unsigned{result.sub}, static_cast<unsigned>(result.abort_code));
      std::string line = head;
      for (const std::uint8_t byte : result.data) {
        std::snprintf(head, sizeof head, " %02X", unsigned{byte});
        line += head;
      }
      ends.push_back(line);
    };
  }
  AbortCode read_object(std::uint8_t id, std::uint16_t index, std::uint8_t sub,
                        const SdoRequestOptions& options = {}) {
    return master.read_object(id, index, sub, note(), now, options);
  }
  AbortCode write_object(std::uint8_t id, std::uint16_t index, std::uint8_t sub, const Bytes& value,
                         const SdoRequestOptions& options = {}) {
    return master.write_object(id, index, sub, value, note(), now, options);
  }
  ScriptedSlave& device() { return slaves.front(); }

  std::vector<std::string> ends;
};

TEST_F(Requests, ToOneNode_QueueUp_InTheirOrder) {
  slave(2).objects[{0x2000, 1}] = {7};
  switch_on();
  sent();
  EXPECT_EQ(read_object(2, 0x1000, 0), AbortCode::none);
  EXPECT_EQ(write_object(2, 0x2000, 2, {1, 2}), AbortCode::none);
  EXPECT_EQ(read_object(2, 0x2000, 1), AbortCode::none);
  EXPECT_EQ(read_object(2, 0x3000, 0), AbortCode::none);
  EXPECT_EQ(master.pending_requests(2), 4U);
  EXPECT_TRUE(master.sdo_channel_busy(2));
  run_for(100ms);
  EXPECT_THAT(only(sent(), " 602 "),
              ElementsAre("0 602 40 00 10 00 00 00 00 00", "1 602 2B 00 20 02 01 02 00 00",
                          "2 602 40 00 20 01 00 00 00 00", "3 602 40 00 30 00 00 00 00 00"));
  EXPECT_THAT(ends, ElementsAre("2 1000:00 00000000 91 01 0F 00", "2 2000:02 00000000",
                                "2 2000:01 00000000 07", "2 3000:00 06020000"));
  EXPECT_EQ(master.pending_requests(2), 0U);
  EXPECT_FALSE(master.sdo_channel_busy(2));
}

TEST_F(Requests, ToSeveralNodes_RunSideBySide) {
  for (std::uint8_t id = 2; id <= 4; ++id) slave(id).answer_delay = 10ms;
  switch_on();
  sent();
  for (std::uint8_t id = 2; id <= 4; ++id) read_object(id, 0x1000, 0);
  EXPECT_THAT(only(sent(), " 40 00 10 00"),
              ElementsAre("0 602 40 00 10 00 00 00 00 00", "0 603 40 00 10 00 00 00 00 00",
                          "0 604 40 00 10 00 00 00 00 00"));
  run_for(10ms);
  EXPECT_EQ(ends.size(), 3U);
}

TEST_F(Requests, LongValues_SegmentedOrInBlocks) {
  slave(2).objects[{0x2000, 1}] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  switch_on();
  sent();
  read_object(2, 0x2000, 1);
  write_object(2, 0x2000, 2, Bytes(10, 0x55), {.mode = canopen::SdoClient::Mode::block});
  run_for(100ms);
  EXPECT_EQ(ends[0], "2 2000:01 00000000 01 02 03 04 05 06 07 08 09");
  EXPECT_EQ(device().objects[(std::pair<std::uint16_t, std::uint8_t>{0x2000, 2})], Bytes(10, 0x55));
  EXPECT_THAT(only(sent(), " 602 C2"), IsEmpty());
  EXPECT_EQ(ends[1], "2 2000:02 00000000");
}

TEST_F(Requests, FromInsideTheCall_MoreCanBeMade) {
  slave(2);
  slave(3);
  switch_on();
  unsigned calls = 0;
  std::function<void(const SdoResult&, can::Time)> again = [&](const SdoResult& result, can::Time at) {
    if (++calls == 10) return;
    const auto other = static_cast<std::uint8_t>(5 - result.node_id);
    EXPECT_EQ(master.read_object(calls % 2 == 0 ? other : result.node_id, 0x1000, 0, again, at),
              AbortCode::none);
  };
  master.read_object(2, 0x1000, 0, again, now);
  run_for(100ms);
  EXPECT_EQ(calls, 10U);
}

TEST_F(Requests, FromTheMastersOwnCalls_AreTakenToo) {
  class Listener final : public MasterListener {
   public:
    explicit Listener(Requests& bench) : bench_(bench) {}
    void slave_booted(std::uint8_t id, can::Time) override { bench_.read_object(id, 0x1018, 1); }
    void node_state_changed(std::uint8_t id, std::uint8_t state, can::Time) override {
      if (state == 5) bench_.write_object(id, 0x2000, 1, {1});
    }

   private:
    Requests& bench_;
  } listener(*this);
  slave(2).objects[{0x1018, 1}] = {9, 0, 0, 0};
  object(0x1F81, 2, 0x0D);
  master.set_listener(&listener);
  switch_on();
  run_for(1s);
  EXPECT_THAT(ends, ElementsAre("2 1018:01 00000000 09 00 00 00", "2 2000:01 00000000"));
}

TEST_F(Requests, NoAnswer_EndsWithTimeOut_EachWithItsOwn) {
  absent_slave(2);
  switch_on();
  sent();
  read_object(2, 0x1000, 0, {.time_out = 100ms});
  read_object(2, 0x1008, 0);
  run_for(99ms);
  EXPECT_THAT(ends, IsEmpty());
  run_for(1ms);
  EXPECT_THAT(ends, ElementsAre("2 1000:00 05040000"));
  run_for(500ms);
  EXPECT_EQ(ends[1], "2 1008:00 05040000");
  EXPECT_THAT(only(sent(), " 602 "),
              ElementsAre("0 602 40 00 10 00 00 00 00 00", "100 602 80 00 10 00 00 00 04 05",
                          "100 602 40 08 10 00 00 00 00 00", "600 602 80 08 10 00 00 00 04 05"));
}

TEST_F(Requests, StartUpAndApplication_TakeTurns) {
  object(0x1F81, 2, 0x0D);
  files[2] = {3, 0, 0, 0, 0x00, 0x20, 1,    1,    0, 0, 0, 5, 0x00, 0x20,
              2, 1, 0, 0, 0,    5,    0x00, 0x20, 3, 1, 0, 0, 0,    5};
  slave(2);
  switch_on();
  run_until_ms(5);
  for (std::uint8_t sub = 1; sub <= 3; ++sub) read_object(2, 0x3000, sub);
  EXPECT_EQ(master.pending_requests(2), 3U);
  run_for(100ms);
  EXPECT_THAT(only(sent(), " 602 "),
              ElementsAre("5 602 40 00 10 00 00 00 00 00",                                   // start-up
                          "6 602 40 00 30 01 00 00 00 00", "7 602 2F 00 20 01 05 00 00 00",  // in turn
                          "8 602 40 00 30 02 00 00 00 00", "9 602 2F 00 20 02 05 00 00 00",
                          "10 602 40 00 30 03 00 00 00 00", "11 602 2F 00 20 03 05 00 00 00"));
  EXPECT_EQ(ends.size(), 3U);
  EXPECT_EQ(master.boot_record(2).step, BootStep::booted);
}

TEST_F(Requests, WithoutEnd_DoNotStarveTheStartUp) {
  object(0x1F81, 2, 0x0D);
  slave(2);
  switch_on();
  unsigned calls = 0;
  std::function<void(const SdoResult&, can::Time)> again = [&](const SdoResult&, can::Time at) {
    ++calls;
    master.read_object(2, 0x1000, 0, again, at);
  };
  again({}, now);
  run_for(50ms);
  EXPECT_EQ(master.boot_record(2).step, BootStep::booted);
  EXPECT_GT(calls, 40U);
}

TEST_F(Requests, ChannelTakenBySomebodyElse_IsTriedEvery10Ms) {
  slave(2);
  switch_on();
  channel_free = false;
  sent();
  read_object(2, 0x1000, 0);
  run_for(25ms);
  EXPECT_THAT(sent(), IsEmpty());
  channel_free = true;
  run_for(10ms);
  EXPECT_THAT(sent(), ElementsAre("30 602 40 00 10 00 00 00 00 00"));
}

TEST_F(Requests, FullTransmitQueue_IsTriedAgain) {
  slave(2);
  switch_on();
  refuse_frames = 2;
  read_object(2, 0x1000, 0);
  run_for(100ms);
  EXPECT_EQ(ends.size(), 1U);
}

TEST_F(Requests, OwnReset_EndsAllOfThem_WithoutAFrame) {
  absent_slave(2);
  switch_on();
  read_object(2, 0x1000, 0);
  read_object(2, 0x1008, 0);
  run_for(1ms);
  sent();
  master.stop(now);
  EXPECT_THAT(ends, ElementsAre("2 1000:00 08000022", "2 1008:00 08000022"));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(read_object(2, 0x1000, 0), AbortCode::device_state);
}

TEST_F(Requests, Cancel_EndsThoseOfOneNode_WithAnAbortForTheRunningOne) {
  slave(2).answer_delay = 10ms;
  slave(3).answer_delay = 10ms;
  switch_on();
  sent();
  read_object(2, 0x1000, 0);
  read_object(2, 0x1008, 0);
  read_object(3, 0x1000, 0);
  sent();
  master.cancel_requests(2, now);
  EXPECT_THAT(ends, ElementsAre("2 1000:00 08000021", "2 1008:00 08000021"));
  EXPECT_THAT(sent(), ElementsAre("0 602 80 00 10 00 21 00 00 08"));
  run_for(50ms);
  EXPECT_EQ(ends.size(), 3U);
}

TEST_F(Requests, Refusals) {
  switch_on();
  EXPECT_EQ(read_object(0, 0x1000, 0), AbortCode::invalid_value);
  EXPECT_EQ(read_object(1, 0x1000, 0), AbortCode::invalid_value);  // itself
  EXPECT_EQ(read_object(128, 0x1000, 0), AbortCode::invalid_value);
  node.command(canopen::NmtCommand::stop, now);
  EXPECT_EQ(read_object(2, 0x1000, 0), AbortCode::device_state);
  EXPECT_THAT(ends, IsEmpty());
}

TEST_F(Requests, ASlave_MayAskAsWell) {
  object(0x1F80, 0, 0);
  slave(2);
  switch_on();
  EXPECT_EQ(read_object(2, 0x1000, 0), AbortCode::none);
  run_for(10ms);
  EXPECT_EQ(ends.size(), 1U);
}

}  // namespace
}  // namespace canopus::manager::test::sdo_requests_test
