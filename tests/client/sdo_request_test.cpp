// What `canopus sdo` and the page make of an answer: the value's bytes, its words, and why there is none.

#include "canopus/client/sdo_request.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::client::sdo_request_test {
namespace {

using canopen::DataType;
using Bytes = std::vector<std::uint8_t>;
using namespace std::chrono_literals;

Bytes kept(const Bytes& came, bool size_indicated, std::optional<DataType> type) {
  const ReadValue value = value_of(came, {.size_indicated = size_indicated}, type);
  return {value.bytes.begin(), value.bytes.end()};
}
std::string remark(const Bytes& came, bool size_indicated, std::optional<DataType> type) {
  return value_of(came, {.size_indicated = size_indicated}, type).remark;
}

TEST(ReadSdoValue, WithoutItsSize_HasTheBytesOfTheType) {
  const Bytes came{0x34, 0x12, 0, 0};
  EXPECT_EQ(kept(came, false, DataType::unsigned16), (Bytes{0x34, 0x12}));
  EXPECT_EQ(kept(came, false, DataType::boolean), (Bytes{0x34}));
  EXPECT_EQ(kept(came, false, DataType::real32), came);
  EXPECT_EQ(kept(came, false, DataType::visible_string), came);
  EXPECT_EQ(remark(came, false, DataType::unsigned16), "") << "CiA 301 allows it";
}

TEST(ReadSdoValue, WithoutItsSizeAndType_KeepsFourBytesAndSaysSo) {
  EXPECT_EQ(kept({0x34, 0x12, 0, 0}, false, std::nullopt), (Bytes{0x34, 0x12, 0, 0}));
  EXPECT_EQ(remark({0x34, 0x12, 0, 0}, false, std::nullopt),
            "the node did not indicate how many of the 4 bytes are the value");
}

TEST(ReadSdoValue, LongerThanTheType_IsAWarningOrTheWrongLength) {
  EXPECT_EQ(kept({0x34, 0x12, 0, 0}, true, DataType::unsigned16), (Bytes{0x34, 0x12}));
  EXPECT_EQ(remark({0x34, 0x12, 0, 0}, true, DataType::unsigned16),
            "4 bytes came, u16 has 2: the others are 0");
  EXPECT_EQ(kept({0x34, 0x12, 0, 1}, true, DataType::unsigned16).size(), 4U);
  EXPECT_EQ(remark({0x34, 0x12, 0, 1}, true, DataType::unsigned16), "");
}

TEST(ReadSdoValue, AsJson_HasTheValueOfItsType) {
  const auto target = SdoTarget::parse("60", "2000", "u16");
  ASSERT_TRUE(target);
  EXPECT_EQ(row_of(*target, Bytes{0x34, 0x12, 0, 0}, {.size_indicated = false}).dump(),
            R"({"node":60,"object":"2000:00","bytes":"3412","type":"u16","value":4660})");
  EXPECT_EQ(row_of(*target, Bytes{0x34, 0x12, 0, 0}, {}).dump(),
            R"({"node":60,"object":"2000:00","bytes":"3412","type":"u16","value":4660,)"
            R"("remark":"4 bytes came, u16 has 2: the others are 0"})");
}

/// The answers of a node to one upload.
struct Answers final : can::Sink {
  bool send(const can::Frame& frame) override {
    sent.push_back(frame);
    return true;
  }
  std::vector<can::Frame> sent;
};

TEST(SdoTransferOfShortAnswers, NamesTheirLength) {
  Answers bus;
  SdoTransfer transfer(bus, 60, 500ms, false);
  ASSERT_TRUE(transfer.read({0x2008, 0}, {}));
  transfer.receive(can::data_frame(0x5BC, {0x43, 0x08, 0x20, 0, 0x92, 0x01, 0x02}), {});
  ASSERT_TRUE(transfer.is_finished());
  EXPECT_EQ(transfer.result().error().reason, "its answer has 7 bytes, expected 8: 43 08 20 00 92 01 02");

  ASSERT_TRUE(transfer.write({0x2008, 0}, Bytes{1}, {}));
  transfer.receive(can::data_frame(0x5BC, {0x60}), {});
  EXPECT_EQ(transfer.result().error().reason, "its answer has 1 byte, expected 8: 60");

  ASSERT_TRUE(transfer.read({0x2008, 0}, {}));
  transfer.receive(can::data_frame(0x5BC, {0x80, 0x08, 0x20, 0}), {});
  EXPECT_EQ(transfer.result().error().reason, "its answer has 4 bytes, expected 8: 80 08 20 00");

  ASSERT_TRUE(transfer.read({0x2008, 0}, {}));
  transfer.receive(can::data_frame(0x5BC), {});
  EXPECT_EQ(transfer.result().error().reason, "its answer has 0 bytes, expected 8");
}

TEST(SdoTransferOfAnAnswerWithoutItsSize, IsMarked) {
  Answers bus;
  SdoTransfer transfer(bus, 60, 500ms, false);
  ASSERT_TRUE(transfer.read({0x2000, 0}, {}));
  transfer.receive(can::data_frame(0x5BC, {0x42, 0x00, 0x20, 0, 0x34, 0x12, 0, 0}), {});
  EXPECT_EQ(transfer.result(), (Bytes{0x34, 0x12, 0, 0}));
  EXPECT_FALSE(transfer.speed().size_indicated);
  ASSERT_TRUE(transfer.write({0x2000, 0}, Bytes{1}, {}));
  transfer.receive(can::data_frame(0x5BC, {0x60, 0x00, 0x20, 0, 0, 0, 0, 0}), {});
  EXPECT_TRUE(transfer.speed().size_indicated) << "of a value that was written";
}

}  // namespace
}  // namespace canopus::client::sdo_request_test
