// Frames written byte by byte from CiA 301, 302-2 and 305, and the lines people read of them.

#include "canopus/trace/decode/decoder.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "canopus/eds/device_file.hpp"

namespace canopus::trace::decoder_test {
namespace {

using can::data_frame;
using can::Frame;
using can::remote_frame;
using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

std::shared_ptr<const canopen::DictionaryDescription> encoder() {
  canopen::DictionaryBuilder builder;
  using canopen::DataType;
  builder.variable(0x1005, {.name = "COB-ID SYNC message", .value = can::little_endian(0x80, 4)});
  builder.variable(0x1008, {.name = "Manufacturer device name", .type = DataType::visible_string});
  builder.object(0x1800, canopen::ObjectCode::record, "TPDO1")
      .sub(0x1800, 1, {.name = "COB-ID", .value = can::little_endian(0x180, 4), .adds_node_id = true});
  builder.object(0x1A00, canopen::ObjectCode::record, "TPDO1 mapping")
      .sub(0x1A00, 0, {.name = "Count", .type = DataType::unsigned8, .value = {2}})
      .sub(0x1A00, 1, {.name = "Entry 1", .value = can::little_endian(0x60000120, 4)})
      .sub(0x1A00, 2, {.name = "Entry 2", .value = can::little_endian(0x60300110, 4)});
  builder.object(0x6000, canopen::ObjectCode::array, "Encoder values")
      .sub(0x6000, 1, {.name = "Position value", .type = DataType::unsigned32});
  builder.object(0x6030, canopen::ObjectCode::array, "Speed value")
      .sub(0x6030, 1, {.name = "Speed value channel 1", .type = DataType::integer16});
  builder.variable(0x2000, {.name = "Program", .type = DataType::domain});
  return builder.build();
}

/// Puts frames in, a tenth of a millisecond after each other, and gets lines out: service or kind, node, text.
class DecoderTest : public testing::Test {
 protected:
  explicit DecoderTest(DecoderOptions options = {}) : decoder(names(), options) {}
  static Names names() {
    Names all;
    all.add(describe_node("", 3, "encoder", encoder()));
    return all;
  }
  void receive(const Frame& frame, can::Duration after = 100us) {
    now += after;
    decoder.receive({.time = now, .frame = frame}, "can0", sink);
  }
  void receive(std::uint32_t identifier, std::initializer_list<std::uint8_t> bytes) {
    receive(data_frame(identifier, bytes));
  }
  std::vector<std::string> lines() {
    std::vector<std::string> all;
    for (const Message& message : messages)
      all.push_back(std::string(name(message.service)) + " | " + std::string(message.kind) + " | " +
                    node_text(message) + " | " + message.text);
    messages.clear();
    return all;
  }

  Decoder decoder;
  can::Time now{};
  std::vector<Message> messages;
  Decoder::Sink sink = [this](const Message& message) { messages.push_back(message); };
};
class DecoderFrames : public DecoderTest {
 protected:
  DecoderFrames() : DecoderTest({.frames = true, .transfers = false}) {}
};

/// A drive: type 402, TPDO1 with 6041H and 6077H.
std::shared_ptr<const canopen::DictionaryDescription> drive() {
  canopen::DictionaryBuilder builder;
  using canopen::DataType;
  builder.variable(0x1000, {.value = can::little_endian(0x00020192, 4)});
  builder.object(0x1800, canopen::ObjectCode::record, "TPDO1")
      .sub(0x1800, 1, {.name = "COB-ID", .value = can::little_endian(0x180, 4), .adds_node_id = true});
  builder.object(0x1A00, canopen::ObjectCode::record, "TPDO1 mapping")
      .sub(0x1A00, 0, {.name = "Count", .type = DataType::unsigned8, .value = {2}})
      .sub(0x1A00, 1, {.name = "Entry 1", .value = can::little_endian(0x60410010, 4)})
      .sub(0x1A00, 2, {.name = "Entry 2", .value = can::little_endian(0x60770010, 4)});
  builder.variable(0x6041, {.name = "Statusword", .type = DataType::unsigned16});
  builder.variable(0x6060, {.name = "Modes of operation", .type = DataType::integer8});
  builder.variable(0x6077, {.name = "Torque actual value", .type = DataType::integer16});
  return builder.build();
}

class DecoderOfADrive : public testing::Test {
 protected:
  static Names names() {
    Names all;
    all.add(describe_node("", 5, "servo", drive()));
    return all;
  }
  std::string text_of(std::initializer_list<Frame> frames) {
    std::string text;
    Decoder decoder(names(), {.transfers = true});
    const Decoder::Sink sink = [&](const Message& message) {
      text = message.text;
      last = message;
    };
    can::Time now{};
    for (const Frame& frame : frames) decoder.receive({.time = now += 100us, .frame = frame}, "can0", sink);
    return text;
  }
  Message last;
};

TEST_F(DecoderOfADrive, SignalsOfAPdo_HaveUnitsAndStatesInWords) {
  EXPECT_EQ(text_of({data_frame(0x185, {0x37, 0x06, 0xCE, 0xFF})}),
            "Statusword = 1591 (operation enabled), Torque actual value = -50 x 0.1 %");
  ASSERT_EQ(last.signals.size(), 2U);
  EXPECT_EQ(last.signals[0].value, "1591");
  EXPECT_EQ(last.signals[0].words, "operation enabled");
  EXPECT_EQ(last.signals[1].unit, "x 0.1 %");
}

TEST_F(DecoderOfADrive, ValuesOfSdos_HaveThem_WithTheirBits) {
  EXPECT_EQ(text_of({data_frame(0x605, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0}),
                     data_frame(0x585, {0x4B, 0x41, 0x60, 0, 0x08, 0, 0, 0})}),
            "6041:00 'Statusword' read: 8 fault (UNSIGNED16, 0.1 ms)");
  EXPECT_EQ(text_of({data_frame(0x605, {0x2F, 0x60, 0x60, 0, 0x03, 0, 0, 0}),
                     data_frame(0x585, {0x60, 0x60, 0x60, 0, 0, 0, 0, 0})}),
            "6060:00 'Modes of operation' write: 3 profile velocity (INTEGER8, 0.1 ms)");
  EXPECT_EQ(text_of({data_frame(0x605, {0x40, 0x77, 0x60, 0, 0, 0, 0, 0}),
                     data_frame(0x585, {0x4B, 0x77, 0x60, 0, 0x32, 0, 0, 0})}),
            "6077:00 'Torque actual value' read: 50 x 0.1 % (INTEGER16, 0.1 ms)");
}

TEST_F(DecoderTest, Nmt_IsNamedByItsCommand) {
  receive(0x000, {0x01, 0x00});
  receive(0x000, {0x02, 0x03});
  receive(0x000, {0x80, 0x05});
  receive(0x000, {0x81, 0x03});
  receive(0x000, {0x82, 0x03});
  receive(0x000, {0x55, 0x03});
  receive(0x000, {0x01});
  EXPECT_THAT(lines(), ElementsAre("nmt | start | all | start", "nmt | stop | 3 (encoder) | stop",
                                   "nmt | enter pre-operational | 5 | enter pre-operational",
                                   "nmt | reset node | 3 (encoder) | reset node",
                                   "nmt | reset communication | 3 (encoder) | reset communication",
                                   "nmt | unknown command | 3 (encoder) | unknown command 55H",
                                   "nmt | malformed | all | 1 byte, expected 2: 01"));
}

TEST_F(DecoderTest, ErrorControl_IsBootUpHeartbeatOrGuarding) {
  receive(0x703, {0x00});
  receive(0x703, {0x7F});
  receive(0x703, {0x05});
  receive(0x703, {0x04});
  receive(0x703, {0x09});
  receive(remote_frame(0x703, 1));
  receive(0x703, {0x85});
  receive(remote_frame(0x703, 1));
  receive(0x703, {0x05});
  receive(0x703, {0x05});
  EXPECT_THAT(lines(), ElementsAre("error-control | boot-up | 3 (encoder) | boot-up",
                                   "error-control | heartbeat | 3 (encoder) | pre-operational",
                                   "error-control | heartbeat | 3 (encoder) | operational",
                                   "error-control | heartbeat | 3 (encoder) | stopped",
                                   "error-control | heartbeat | 3 (encoder) | unknown state 09H",
                                   "error-control | guarding request | 3 (encoder) | guarding request",
                                   "error-control | guarding answer | 3 (encoder) | operational, toggle 1",
                                   "error-control | guarding request | 3 (encoder) | guarding request",
                                   "error-control | guarding answer | 3 (encoder) | operational, toggle 0",
                                   "error-control | heartbeat | 3 (encoder) | operational"));
}

TEST_F(DecoderTest, GuardingToggleThatDoesNotAlternate_IsFlagged) {
  const auto guard = [&](std::uint8_t answer) {
    receive(remote_frame(0x703, 1));
    messages.clear();
    receive(0x703, {answer});
    const std::string text = messages.at(0).text;
    EXPECT_EQ(messages.at(0).is_malformed, text.find("alternate") != std::string::npos) << text;
    return text;
  };
  EXPECT_EQ(guard(0x05), "operational, toggle 0");
  EXPECT_EQ(guard(0x85), "operational, toggle 1");
  EXPECT_EQ(guard(0x85), "operational, toggle 1, expected 0: it does not alternate");
  EXPECT_EQ(guard(0x05), "operational, toggle 0");
  EXPECT_EQ(guard(0x04), "stopped, toggle 0, expected 1: it does not alternate");
  receive(0x703, {0x00});
  EXPECT_EQ(guard(0xFF), "pre-operational, toggle 1, expected 0: it does not alternate");
  receive(0x703, {0x00});
  EXPECT_EQ(guard(0x7F), "pre-operational, toggle 0");
  // a recorder that hears no remote frames
  messages.clear();
  receive(0x704, {0x85});
  receive(0x704, {0x05});
  receive(0x704, {0x85});
  receive(0x704, {0x85});
  EXPECT_THAT(lines(),
              ElementsAre("error-control | guarding answer | 4 | operational, toggle 1",
                          "error-control | heartbeat | 4 | operational",
                          "error-control | guarding answer | 4 | operational, toggle 1",
                          "error-control | guarding answer | 4 | operational, toggle 1, expected 0: it does "
                          "not alternate"));
}

TEST_F(DecoderTest, MessagesOfAWrongLength_AreMalformedInEveryService) {
  receive(0x000, {0x01});
  receive(0x080, {0x01, 0x02});
  receive(0x100, {0x01});
  receive(0x083, {0x30});
  receive(0x083, {0x30, 0x81, 0x11, 1});
  receive(0x183, {0xD2, 0x04});
  receive(0x603, {0x40});
  receive(0x703, {0x05, 0x05});
  receive(0x7E5, {0x04, 0x01});
  receive(0x071, {0x01});
  for (const Message& message : messages) {
    EXPECT_TRUE(message.is_malformed) << message.text;
    EXPECT_TRUE(message.text.find("expected") != std::string::npos ||
                message.text.find("too short") != std::string::npos)
        << message.text;
  }
  EXPECT_EQ(messages.size(), 10U);
  messages.clear();
  receive(0x183, {0xD2, 0x04, 0x00, 0x00, 0xFB, 0xFF});
  receive(0x083, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5});
  receive(0x7F0, {});
  for (const Message& message : messages) EXPECT_FALSE(message.is_malformed) << message.text;
}

TEST_F(DecoderTest, SyncTimeAndEmcy_AreInWords) {
  receive(0x080, {});
  receive(0x080, {0x07});
  receive(0x100, {0x40, 0x77, 0x1B, 0x00, 0x01, 0x00});  // 30 minutes after midnight
  receive(0x083, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5});
  receive(0x083, {0x00, 0x00, 0x00, 0, 0, 0, 0, 0});
  receive(0x085, {0x10, 0x43, 0x09, 0, 0, 0, 0, 0});
  EXPECT_THAT(
      lines(),
      ElementsAre("sync | SYNC |  | ", "sync | SYNC |  | counter 7",
                  "time | TIME |  | 00:30:00.000, day 1 since 1984-01-01",
                  "emcy | EMCY | 3 (encoder) | 8130H life guard or heartbeat error; error register 11H: "
                  "generic, communication; 01 02 03 04 05",
                  "emcy | EMCY | 3 (encoder) | 0000H no error, or error reset; error register 00H: no error",
                  "emcy | EMCY | 5 | 4310H temperature; error register 09H: generic, temperature"));
}

TEST_F(DecoderTest, Pdo_HasTheValuesOfItsMapping) {
  receive(0x183, {0xD2, 0x04, 0x00, 0x00, 0xFB, 0xFF});
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].signals.at(0).number, 1234.0);
  EXPECT_EQ(messages[0].signals.at(1).first_bit, 32);
  EXPECT_EQ(messages[0].signals.at(1).number, -5.0);
  receive(0x183, {0xD2, 0x04, 0x00, 0x00});
  receive(0x204, {0x01, 0x02});
  receive(remote_frame(0x183, 6));
  EXPECT_THAT(
      lines(),
      ElementsAre(
          "pdo | TPDO | 3 (encoder) | Encoder values: Position value = 1234, Speed value channel 1 = -5",
          "pdo | TPDO | 3 (encoder) | Encoder values: Position value = 1234 (too short: 4 bytes of 6)",
          "pdo | RPDO | 4 | 01 02", "pdo | TPDO request | 3 (encoder) | remote request"));
}

TEST_F(DecoderTest, PdoOfAnUnknownNode_IsLearntFromItsConfiguration) {
  const auto write = [&](std::uint8_t low, std::uint8_t high, std::uint8_t sub, std::uint32_t value) {
    Frame request = data_frame(0x609, {0x23, low, high, sub, 0, 0, 0, 0});
    can::store_value(&request.data[4], value, 4);
    receive(request);
    receive(0x589, {0x60, low, high, sub, 0, 0, 0, 0});
  };
  write(0x00, 0x1A, 1, 0x20010108);
  write(0x00, 0x1A, 2, 0x20010210);
  write(0x00, 0x1A, 0, 2);
  write(0x00, 0x18, 1, 0x40000345);  // TPDO1 on an identifier that the connection set gives to another PDO
  messages.clear();
  receive(0x345, {0x05, 0x34, 0x12});
  EXPECT_THAT(lines(), ElementsAre("pdo | TPDO | 9 | 2001:01 = 05H, 2001:02 = 1234H"));
  write(0x00, 0x18, 1, 0x80000345);
  messages.clear();
  receive(0x345, {0x05, 0x34, 0x12});
  EXPECT_THAT(lines(), ElementsAre("pdo | RPDO | 69 | 05 34 12"));
}

TEST_F(DecoderTest, Mpdo_NamesItsObject) {
  const auto write = [&](std::uint8_t sub, std::uint32_t value) {
    Frame request = data_frame(0x603, {0x23, 0x00, 0x1A, sub, 0, 0, 0, 0});
    can::store_value(&request.data[4], value, 4);
    receive(request);
    receive(0x583, {0x60, 0x00, 0x1A, sub, 0, 0, 0, 0});
  };
  write(0, 0xFE);
  messages.clear();
  receive(0x183, {0x03, 0x00, 0x60, 0x01, 0xD2, 0x04, 0x00, 0x00});
  receive(0x183, {0x83, 0x30, 0x60, 0x01, 0xFF, 0xFF, 0x00, 0x00});
  receive(0x183, {0x80, 0x00, 0x20, 0x05, 0x01, 0x00, 0x00, 0x00});
  EXPECT_THAT(lines(),
              ElementsAre("mpdo | SAM | 3 (encoder) | from 6000:01 'Encoder values: Position value' = 1234",
                          "mpdo | DAM | 3 (encoder) | to node 3: 6030:01 'Speed value channel 1' = -1",
                          "mpdo | DAM | 3 (encoder) | to all: 2000:05 = 00000001H"));
}

TEST_F(DecoderTest, Lss_IsItsServiceAndItsFields) {
  receive(0x7E5, {0x04, 0x01, 0, 0, 0, 0, 0, 0});
  receive(0x7E5, {0x40, 0x78, 0x56, 0x34, 0x12, 0, 0, 0});
  receive(0x7E4, {0x44, 0, 0, 0, 0, 0, 0, 0});
  receive(0x7E5, {0x11, 0x05, 0, 0, 0, 0, 0, 0});
  receive(0x7E4, {0x11, 0x01, 0, 0, 0, 0, 0, 0});
  receive(0x7E5, {0x13, 0x00, 0x03, 0, 0, 0, 0, 0});
  receive(0x7E5, {0x15, 0xE8, 0x03, 0, 0, 0, 0, 0});
  receive(0x7E4, {0x17, 0x00, 0x00, 0, 0, 0, 0, 0});
  receive(0x7E5, {0x49, 0x01, 0, 0, 0, 0, 0, 0});
  receive(0x7E5, {0x51, 0x78, 0x56, 0x34, 0x12, 0x1F, 0x00, 0x01});
  receive(0x7E5, {0x5D, 0, 0, 0, 0, 0, 0, 0});
  receive(0x7E4, {0x5D, 0x2A, 0, 0, 0, 0, 0, 0});
  receive(0x7E4, {0x5E, 0xFF, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(
      lines(),
      ElementsAre("lss | switch state global |  | all devices to LSS configuration state",
                  "lss | switch state selective: vendor-ID |  | switch state selective: vendor-ID 12345678H",
                  "lss | switch state selective |  | the addressed device is in LSS configuration state",
                  "lss | configure node-ID |  | configure node-ID 5",
                  "lss | configure node-ID |  | configure node-ID: refused: node-ID out of range",
                  "lss | configure bit timing |  | configure bit timing: 250 kbit/s",
                  "lss | activate bit timing |  | activate bit timing in 1000 ms",
                  "lss | store configuration |  | store configuration: done",
                  "lss | identify remote slaves: revision number to |  | identify remote slaves: revision "
                  "number to 00000001H",
                  "lss | fastscan |  | fastscan: vendor-ID 12345678H from bit 31 on, next 1",
                  "lss | inquire serial number |  | inquire serial number",
                  "lss | inquire serial number |  | serial number is 0000002AH",
                  "lss | inquire node-ID |  | node-ID is none (FFH)"));
}

TEST_F(DecoderTest, FlyingMaster_HasItsSixFrames) {
  receive(0x071, {0x01, 0x03});
  receive(0x072, {});
  receive(0x073, {});
  receive(0x074, {});
  receive(0x075, {});
  receive(0x076, {});
  EXPECT_THAT(
      lines(),
      ElementsAre(
          "flying-master | active NMT master | 3 (encoder) | active NMT master: node 3, priority level 1",
          "flying-master | negotiation request |  | negotiation request",
          "flying-master | detect active NMT master |  | detect active NMT master",
          "flying-master | NMT master capable device |  | NMT master capable device",
          "flying-master | detect NMT master capable devices |  | detect NMT master capable devices",
          "flying-master | force negotiation |  | force negotiation"));
}

TEST_F(DecoderTest, FramesOfNoService_AreLayer2) {
  receive(0x7F0, {0xDE, 0xAD});
  Frame extended = data_frame(0x183, {0x01});
  extended.extended = true;
  receive(extended);
  receive(remote_frame(0x7F0, 4));
  receive(0x001, {});
  EXPECT_THAT(lines(), ElementsAre("layer2 | frame |  | DE AD", "layer2 | frame |  | 01",
                                   "layer2 | remote frame |  | remote frame, asks for 4 bytes",
                                   "failsafe | global failsafe command |  | "));
}

TEST_F(DecoderTest, ErrorFrames_AreInWords) {
  const auto error = [&](std::uint32_t kind, std::initializer_list<std::uint8_t> bytes) {
    decoder.receive({.time = now, .error_frame = true, .frame = data_frame(kind, bytes)}, "can0", sink);
  };
  error(0x20, {0, 0, 0, 0, 0, 0, 0, 0});
  error(0x04, {0, 0x20, 0, 0, 0, 0, 128, 3});
  error(0x88, {0, 0, 0x04, 0, 0, 0, 0, 0});
  error(0x40, {0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(
      lines(),
      ElementsAre("error-frame | error frame |  | no acknowledgement",
                  "error-frame | error frame |  | controller: transmit error passive (TEC 128, REC 3)",
                  "error-frame | error frame |  | protocol violation: bit stuffing; bus error",
                  "error-frame | error frame |  | bus-off"));
}

TEST_F(DecoderTest, FrameThatTheRecorderSentAndHeard_CountsOnce) {
  const Frame request = data_frame(0x603, {0x40, 0x00, 0x60, 0x01, 0, 0, 0, 0});
  decoder.receive({.time = now, .transmitted = true, .frame = request}, "", sink);
  decoder.receive({.time = now + 1ms, .frame = request}, "", sink);
  decoder.receive({.time = now + 2ms, .frame = data_frame(0x583, {0x43, 0x00, 0x60, 0x01, 1, 0, 0, 0})}, "",
                  sink);
  decoder.finish(sink);
  EXPECT_THAT(lines(),
              ElementsAre("sdo | read | 3 (encoder) | 6000:01 'Encoder values: Position value' read: 1 "
                          "(UNSIGNED32, 2.0 ms)"));
}

TEST_F(DecoderFrames, SdoFrames_AreShownOneByOne) {
  receive(0x603, {0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  receive(0x583, {0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0});
  receive(0x603, {0x60, 0, 0, 0, 0, 0, 0, 0});
  receive(0x583, {0x00, 'M', 'E', '3', 'C', 'A', 'N', '1'});
  receive(0x603, {0x70, 0, 0, 0, 0, 0, 0, 0});
  receive(0x583, {0x1B, '-', 'Q', 0, 0, 0, 0, 0});
  receive(0x583, {0x80, 0x00, 0x60, 0x09, 0x11, 0x00, 0x09, 0x06});
  EXPECT_THAT(
      lines(),
      ElementsAre(
          "sdo | upload request | 3 (encoder) | upload request 1008:00 'Manufacturer device name'",
          "sdo | upload response | 3 (encoder) | upload response 1008:00 'Manufacturer device name', 9 bytes",
          "sdo | upload segment request | 3 (encoder) | upload segment request 1008:00 'Manufacturer device "
          "name', toggle 0",
          "sdo | upload segment | 3 (encoder) | upload segment 1008:00 'Manufacturer device name', toggle 0: "
          "4D 45 33 43 41 4E 31",
          "sdo | upload segment request | 3 (encoder) | upload segment request 1008:00 'Manufacturer device "
          "name', toggle 1",
          "sdo | upload segment | 3 (encoder) | upload segment 1008:00 'Manufacturer device name', toggle 1, "
          "last: 2D 51",
          "sdo | abort | 3 (encoder) | abort 6000:09 'Encoder values': 06090011H sub-index does not exist"));
}

void decodes_anything() {
  Names names;
  names.add(describe_node("", 3, "encoder", encoder()));
  for (const bool frames : {false, true}) {
    Decoder decoder(names, {.frames = frames});
    can::Time now{};
    const auto count = *rc::gen::inRange(0, 200);
    for (int i = 0; i < count; ++i) {
      // Mostly identifiers of services that keep something, and command bytes that fit them.
      Frame frame{.identifier =
                      *rc::gen::element<std::uint32_t>(0x583, 0x603, 0x603, 0x583, 0x703, 0x183, 0x000, 0x7E5,
                                                       0x7E4, 0x083, 0x100, 0x080, 0x071, 0x7F0)};
      frame.dlc = *rc::gen::element<std::uint8_t>(8, 8, 8, 8, 0, 1, 2, 6, 15);
      frame.remote = *rc::gen::weightedElement<bool>({{9, false}, {1, true}});
      if (!frame.remote) {
        for (std::size_t byte = 0; byte < frame.length(); ++byte) {
          frame.data[byte] =
              *rc::gen::element<std::uint8_t>(0x00, 0x01, 0x20, 0x23, 0x40, 0x41, 0x43, 0x60, 0x80, 0x81,
                                              0xA0, 0xA1, 0xA2, 0xA3, 0xC0, 0xC1, 0xC2, 0x10, 0x1A, 0xFF);
        }
      }
      now += 1ms;
      unsigned emitted = 0;
      decoder.receive({.time = now, .transmitted = *rc::gen::arbitrary<bool>(), .frame = frame}, "",
                      [&](const Message& message) {
                        RC_ASSERT(!message.kind.empty());
                        RC_ASSERT(message.data.size() <= most_sdo_data);
                        if (message.frame.identifier == 0x7F0 && !message.is_transfer)
                          RC_ASSERT(message.service == Service::layer2);
                        ++emitted;
                      });
      if (frames) RC_ASSERT(emitted >= 1U);
    }
    decoder.finish([](const Message& message) { RC_ASSERT(message.is_transfer); });
  }
}

TEST(DecoderProperty, AnyRecords_AreSurvivedAndUnknownOnesStayUnknown) {
  EXPECT_TRUE(rc::check("any records", decodes_anything));
}

}  // namespace
}  // namespace canopus::trace::decoder_test
