// LSS commands of the ASCII gateway, in literal frames.

#include "canopus/client/gateway/gateway_lss.hpp"

#include <gmock/gmock.h>

#include "gateway_setup.hpp"

namespace canopus::client::gateway_lss_test {
namespace {

using can::data_frame;
using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

class GatewayLssTest : public GatewaySetup {
 protected:
  static can::Frame of_eight(std::uint32_t identifier, std::vector<std::uint8_t> bytes) {
    bytes.resize(8);
    return data_frame(identifier, bytes);
  }
  static can::Frame request(std::vector<std::uint8_t> bytes) { return of_eight(0x7E5, std::move(bytes)); }
  /// The answer line to a frame of the device.
  std::string receive_from_device(std::vector<std::uint8_t> bytes) {
    receive(of_eight(0x7E4, std::move(bytes)));
    return ends.lines.empty() ? "(nothing)" : ends.lines.back();
  }
  std::string request_and_wait(const std::string& text) {
    ends.frames.clear();
    answer_to(text);
    pass(10ms);
    return ends.lines.empty() ? "(nothing)" : ends.lines.back();
  }
};

TEST_F(GatewayLssTest, SwitchStateGlobal_IsSentAndNotAnswered) {
  EXPECT_EQ(request_and_wait("[1] 1 lss_switch_glob 1"), "[1] OK\r\n");
  EXPECT_THAT(ends.frames, ElementsAre(request({4, 1})));
  EXPECT_EQ(request_and_wait("lss_switch_glob 0"), "OK\r\n");
  EXPECT_THAT(ends.frames, ElementsAre(request({4, 0})));
}

TEST_F(GatewayLssTest, SwitchStateSelective_IsFourFrames) {
  EXPECT_EQ(request_and_wait("[2] lss_switch_sel 0x71 2 3 0x12345678"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x40, 0x71}), request({0x41, 2}), request({0x42, 3}),
                                       request({0x43, 0x78, 0x56, 0x34, 0x12})));
  EXPECT_EQ(receive_from_device({0x44}), "[2] OK\r\n");
}

TEST_F(GatewayLssTest, SilenceOfTheDevice_IsATimeOut) {
  EXPECT_EQ(answer_to("[3] lss_store"), "(nothing)");
  pass(99ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  pass(1ms);
  EXPECT_THAT(ends.lines, ElementsAre("[3] ERROR:103 #time-out\r\n"));
}

TEST_F(GatewayLssTest, NodeId_IsSetOrTakenAwayOrRefused) {
  EXPECT_EQ(request_and_wait("lss_set_node 5"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x11, 5})));
  EXPECT_EQ(receive_from_device({0x11, 0}), "OK\r\n");
  EXPECT_EQ(request_and_wait("lss_set_node 255"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x11, 0xFF})));
  EXPECT_EQ(receive_from_device({0x11, 1}), "ERROR:502 #LSS node-ID not supported\r\n");
  EXPECT_EQ(request_and_wait("lss_set_node 128"), "ERROR:107 #unsupported node\r\n");
  EXPECT_EQ(request_and_wait("lss_set_node 5"), "(nothing)");
  EXPECT_EQ(receive_from_device({0x11, 0xFF, 7}), "ERROR:501 #LSS error of the device\r\n");
}

TEST_F(GatewayLssTest, BitRate_IsATableAndAnIndex) {
  EXPECT_EQ(request_and_wait("lss_conf_bitrate 0 3"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x13, 0, 3})));
  EXPECT_EQ(receive_from_device({0x13, 0}), "OK\r\n");
  EXPECT_EQ(request_and_wait("lss_conf_bitrate 128 9"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x13, 128, 9})));
  EXPECT_EQ(receive_from_device({0x13, 1}), "ERROR:503 #LSS bit rate not supported\r\n");
}

TEST_F(GatewayLssTest, Store_IsRefusedForItsReason) {
  for (const auto& [code, answer] : std::vector<std::pair<std::uint8_t, std::string>>{
           {0, "OK\r\n"},
           {1, "ERROR:504 #LSS parameter storing failed\r\n"},
           {2, "ERROR:505 #LSS command failed because of a media error\r\n"},
           {0xFF, "ERROR:501 #LSS error of the device\r\n"}}) {
    EXPECT_EQ(request_and_wait("lss_store"), "(nothing)");
    EXPECT_THAT(ends.frames, ElementsAre(request({0x17})));
    EXPECT_EQ(receive_from_device({0x17, code}), answer);
  }
}

TEST_F(GatewayLssTest, AddressAndNodeId_AreInquired) {
  EXPECT_EQ(request_and_wait("lss_inquire_addr 0x5C"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x5C})));
  EXPECT_EQ(receive_from_device({0x5C, 0x78, 0x56, 0x34, 0x12}), "0x12345678\r\n");
  EXPECT_EQ(request_and_wait("lss_inquire_addr 1"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x5B})));
  EXPECT_EQ(receive_from_device({0x5B, 2}), "0x00000002\r\n");
  EXPECT_EQ(request_and_wait("[9] lss_inquire_addr"), "(nothing)");
  for (const std::uint8_t command : std::initializer_list<std::uint8_t>{0x5A, 0x5B, 0x5C})
    EXPECT_EQ(receive_from_device({command, command}), "(nothing)");
  EXPECT_EQ(receive_from_device({0x5D, 9}), "[9] 0x0000005A 0x0000005B 0x0000005C 0x00000009\r\n");
  EXPECT_EQ(request_and_wait("lss_get_node"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x5E})));
  EXPECT_EQ(receive_from_device({0x5E, 255, 1}), "255\r\n");
}

TEST_F(GatewayLssTest, Identify_AsksForARangeOrForDevicesWithoutANodeId) {
  EXPECT_EQ(request_and_wait("lss_identity 1 2 3 4 5 6"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x46, 1}), request({0x47, 2}), request({0x48, 3}),
                                       request({0x49, 4}), request({0x4A, 5}), request({0x4B, 6})));
  EXPECT_EQ(receive_from_device({0x4F}), "OK\r\n");
  EXPECT_EQ(request_and_wait("lss_ident_nonconf"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(request({0x4C})));
  EXPECT_EQ(receive_from_device({0x50}), "OK\r\n");
}

TEST_F(GatewayLssTest, FastscanWithKnownBits_AsksForTheOthersOnly) {
  EXPECT_EQ(answer_to("[7] _lss_fastscan 0x71 0xFFFFFFFF 2 0xFFFFFFFF 3 0xFFFFFFFF 0x20 0xFFFFFFFC"),
            "(nothing)");
  EXPECT_EQ(ends.frames.back(), request({0x51, 0, 0, 0, 0, 0x80}));
  // Its serial number is 21H: bit 1 is answered as it is 0, bit 0 is not.
  const auto answered = [&](bool answers) {
    if (answers) receive(of_eight(0x7E4, {0x4F}));
    ends.frames.clear();
    pass(100ms);
    return ends.frames.empty() ? request({}) : ends.frames.back();
  };
  EXPECT_EQ(answered(true), request({0x51, 0x71, 0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(answered(true), request({0x51, 2, 0, 0, 0, 0, 1, 2}));
  EXPECT_EQ(answered(true), request({0x51, 3, 0, 0, 0, 0, 2, 3}));
  EXPECT_EQ(answered(true), request({0x51, 0x20, 0, 0, 0, 1, 3, 3}));
  EXPECT_EQ(answered(true), request({0x51, 0x20, 0, 0, 0, 0, 3, 3}));
  EXPECT_EQ(answered(false), request({0x51, 0x21, 0, 0, 0, 0, 3, 0}));
  EXPECT_EQ(answered(true), request({}));
  EXPECT_THAT(ends.lines, ElementsAre("[7] 0x00000071 0x00000002 0x00000003 0x00000021\r\n"));
}

TEST_F(GatewayLssTest, Fastscan_HasItsOwnTimeOutAndOutlastsThatOfCommands) {
  EXPECT_EQ(answer_to("set command_timeout 20"), "OK");
  EXPECT_EQ(answer_to("_lss_fastscan 300"), "(nothing)");
  pass(299ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  pass(1ms);
  EXPECT_THAT(ends.lines, ElementsAre("ERROR:103 #time-out\r\n"));
}

TEST_F(GatewayLssTest, Slowscan_HalvesTheRangeAndSelects) {
  EXPECT_EQ(answer_to("_lss_slowscan 1 2 3 3 8 9"), "(nothing)");
  const auto question = [&] {
    ends.frames.clear();
    pass(10ms);
    return ends.frames.back();
  };
  EXPECT_EQ(question(), request({0x4B, 9}));
  receive(of_eight(0x7E4, {0x4F}));
  pass(90ms);
  EXPECT_EQ(question(), request({0x4B, 8}));
  pass(100ms);  // no answer: it is 9
  EXPECT_EQ(question(), request({0x43, 9}));
  EXPECT_EQ(receive_from_device({0x44}), "0x00000001 0x00000002 0x00000003 0x00000009\r\n");
}

class GatewayAllNodesTest : public GatewayLssTest {
 protected:
  /// As so many devices 1 2 3 4 without a node-ID would, until there is a line: answers every frame but those of bits
  /// that are 1. What configured them is kept.
  void devices_answer(unsigned devices) {
    for (int i = 0; i < 2000 && ends.lines.empty(); ++i) {
      const can::Frame asked = ends.frames.back();
      ends.frames.clear();
      const unsigned own = asked.data[6] + 1U;
      const unsigned shift = asked.data[5];
      const unsigned number = asked.data[1] | unsigned{asked.data[2]} << 8U;
      switch (asked.data[0]) {
        case 0x51:
          if (shift == 0x80 ? devices > 0
                            : number >> shift == own >> shift && asked.data[3] == 0 && asked.data[4] == 0)
            gateway.receive(of_eight(0x7E4, {0x4F}), now);
          break;
        case 0x11:
        case 0x17:
          configured.push_back(asked);
          gateway.receive(of_eight(0x7E4, {asked.data[0], 0}), now);
          break;
        case 0x04:
          configured.push_back(asked);
          --devices;
          break;
        default: FAIL() << "an unexpected request";
      }
      while (ends.frames.empty() && ends.lines.empty()) pass(10ms);
    }
  }
  std::vector<can::Frame> configured;
};

TEST_F(GatewayAllNodesTest, AllNodes_GetNodeIdsUntilNobodyAnswers) {
  EXPECT_EQ(answer_to("set command_timeout 100"), "OK");  // it is no bound here
  answer_to("[8] lss_allnodes 10 20 1");
  devices_answer(2);
  EXPECT_THAT(ends.lines, ElementsAre("[8] OK, found 2 nodes starting at node ID 20.\r\n"));
  EXPECT_THAT(configured, ElementsAre(request({0x11, 20}), request({0x17}), request({4, 0}),
                                      request({0x11, 21}), request({0x17}), request({4, 0})));
  EXPECT_EQ(answer_to("lss_allnodes 100 1 0 2 1 2 1 2 1 2 1"), "ERROR:100 #request not supported");
}

TEST_F(GatewayAllNodesTest, WithoutNumbers_TheyBeginAt2AndDoNotStore) {
  answer_to("lss_allnodes");
  devices_answer(1);
  EXPECT_THAT(ends.lines, ElementsAre("OK, found 1 nodes starting at node ID 2.\r\n"));
  EXPECT_THAT(configured, ElementsAre(request({0x11, 2}), request({4, 0})));
}

TEST_F(GatewayAllNodesTest, MoreDevicesThanNodeIds_AreAnError) {
  answer_to("lss_allnodes 10 127");
  devices_answer(2);
  EXPECT_THAT(ends.lines, ElementsAre("ERROR:107 #unsupported node\r\n"));
  EXPECT_THAT(configured, ElementsAre(request({0x11, 127}), request({4, 0})));
}

TEST_F(GatewayLssTest, ActivationChangesTheOwnRateBetweenTwoTimesOfSilence) {
  std::vector<std::uint32_t> rates;
  gateway.set_restart([&](std::uint32_t rate) {
    rates.push_back(rate);
    return std::expected<void, std::string>();
  });
  request_and_wait("lss_conf_bitrate 0 4");
  receive_from_device({0x13, 0});
  ends.frames.clear();
  EXPECT_EQ(answer_to("[1] lss_activate_bitrate 500"), "(nothing)");
  pass(1ms);
  EXPECT_THAT(ends.frames, ElementsAre(request({0x15, 0xF4, 0x01})));
  WireAndClient other;
  GatewaySession second(gateway, other);
  second.receive("5 start\n", now);
  EXPECT_THAT(other.lines, ElementsAre("ERROR:303 #CAN buffer overflow\r\n")) << "nobody may send";
  pass(499ms);
  EXPECT_THAT(rates, IsEmpty());
  pass(1ms);
  EXPECT_THAT(rates, ElementsAre(125'000U));
  pass(499ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  second.receive("5 start\n", now);
  EXPECT_EQ(ends.frames.size(), 1U);
  pass(1ms);
  EXPECT_THAT(ends.lines, ElementsAre("[1] OK\r\n"));
  EXPECT_EQ(answer_to("5 start"), "OK");
}

TEST_F(GatewayLssTest, RateThatTheDeviceRefuses_IsNotTheOwnOneAfterAnActivation) {
  std::vector<std::uint32_t> rates;
  gateway.set_restart([&](std::uint32_t rate) {
    rates.push_back(rate);
    return std::expected<void, std::string>();
  });
  const auto activated = [&](const char* configure, std::uint8_t error) {
    request_and_wait(configure);
    receive_from_device({0x13, error});
    answer_to("lss_activate_bitrate 100");
    pass(300ms);
    return rates;
  };
  EXPECT_THAT(activated("lss_conf_bitrate 0 4", 1), IsEmpty());
  request_and_wait("lss_conf_bitrate 0 3");
  receive_from_device({0x13, 0});
  EXPECT_THAT(activated("lss_conf_bitrate 0 4", 1), IsEmpty()) << "nor one that it took before";
  EXPECT_THAT(activated("lss_conf_bitrate 128 4", 0), IsEmpty())
      << "of a table that only its manufacturer knows";
  EXPECT_THAT(activated("lss_conf_bitrate 0 4", 0), ElementsAre(125'000U));
  answer_to("lss_activate_bitrate 100");
  pass(300ms);
  EXPECT_THAT(ends.lines, ElementsAre("OK\r\n"));
  EXPECT_EQ(rates.size(), 1U) << "it was activated already";
}

TEST_F(GatewayLssTest, InitInAnActivation_EndsItsSilence) {
  gateway.set_restart([](std::uint32_t) { return std::expected<void, std::string>(); });
  WireAndClient other;
  GatewaySession second(gateway, other);
  answer_to("lss_activate_bitrate 10000");
  pass(50ms);
  second.receive("init 0\n5 start\n", now);
  EXPECT_THAT(other.lines, ElementsAre("OK\r\n", "OK\r\n"));
  EXPECT_THAT(ends.lines, ElementsAre("ERROR:102 #request not processed due to the internal state\r\n"));
}

TEST_F(GatewayLssTest, ActivationThatTheOwnControllerCannotFollow_IsTold) {
  request_and_wait("lss_conf_bitrate 0 4");
  receive_from_device({0x13, 0});
  EXPECT_EQ(answer_to("lss_activate_bitrate 100"), "(nothing)");
  pass(300ms);
  EXPECT_THAT(ends.lines,
              ElementsAre("ERROR:304 #CAN init: the bit rate of this bus is not set from here\r\n"));
}

TEST_F(GatewayLssTest, ClientThatLeavesInAnActivation_DoesNotSilenceTheOthers) {
  auto first = std::make_unique<GatewaySession>(gateway, ends);
  first->receive("lss_activate_bitrate 100\n", now);
  pass(50ms);
  first->end(now);
  EXPECT_TRUE(answer_to("5 start").starts_with("ERROR:303"));
  ends.lines.clear();
  pass(200ms);
  EXPECT_THAT(ends.lines, IsEmpty()) << "nobody is there for its answer";
  first.reset();
  EXPECT_EQ(answer_to("5 start"), "OK");
}

TEST_F(GatewayLssTest, RequestsOfTwoClients_DoNotComeBetweenEachOther) {
  WireAndClient other;
  GatewaySession second(gateway, other);
  answer_to("lss_inquire_addr");
  second.receive("lss_get_node\n", now);
  for (const std::uint8_t command : std::initializer_list<std::uint8_t>{0x5A, 0x5B, 0x5C, 0x5D}) {
    EXPECT_EQ(ends.frames.back(), request({command}));
    gateway.receive(of_eight(0x7E4, {command, 1}), now);
  }
  EXPECT_EQ(ends.frames.back(), request({0x5E}));
  gateway.receive(of_eight(0x7E4, {0x5E, 5}), now);
  EXPECT_THAT(other.lines, ElementsAre("5\r\n"));
  // One that leaves while it waits disturbs nobody.
  answer_to("lss_get_node");
  auto waiting = std::make_unique<GatewaySession>(gateway, other);
  waiting->receive("lss_store\n", now);
  waiting->end(now);
  waiting.reset();
  EXPECT_EQ(receive_from_device({0x5E, 6}), "6\r\n");
  // One that leaves gives its turn to the next.
  auto third = std::make_unique<GatewaySession>(gateway, other);
  third->receive("lss_store\n", now);
  answer_to("lss_get_node");
  third->end(now);
  third.reset();
  EXPECT_EQ(ends.frames.back(), request({0x5E}));
  EXPECT_EQ(receive_from_device({0x5E, 6}), "6\r\n");
}

TEST_F(GatewayLssTest, CommandTimeOut_EndsAService) {
  EXPECT_EQ(answer_to("set command_timeout 20"), "OK");
  EXPECT_EQ(answer_to("lss_store"), "(nothing)");
  pass(20ms);
  EXPECT_THAT(ends.lines, ElementsAre("ERROR:103 #time-out\r\n"));
  EXPECT_EQ(answer_to("lss_get_node"), "(nothing)");
  EXPECT_EQ(receive_from_device({0x17, 0}), "(nothing)") << "the late answer to another service";
  EXPECT_EQ(receive_from_device({0x5E, 6}), "6\r\n");
}

}  // namespace
}  // namespace canopus::client::gateway_lss_test
