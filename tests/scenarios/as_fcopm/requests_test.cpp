// Requests by registers: scenarios A, B and C of spec/as-fcopm/scenarios.md [AS-FCOPM 10.4].

#include "scenarios/as_fcopm/card.hpp"

namespace canopus::scenario::as_fcopm_requests_test {
namespace {

class FcopmRequests : public testing::Test, public FcopmCard {
 protected:
  void SetUp() override {
    list(2);
    list(3);
    start();
  }
  /// Status of a request that ends at once.
  std::uint16_t status_of(const Words& words) {
    request(words);
    return d(24000);
  }
  std::size_t messages() const { return frames.size() - sent(0x080).size() - sent(0x701).size(); }
};

TEST_F(FcopmRequests, A01_AnSdoWriteOf32Bits) {
  RecordProperty("spec",
                 "ASF-REQ-001 ASF-REQ-002 ASF-REQ-008 ASF-REQ-010 ASF-REQ-011 ASF-SDO-001 ASF-SDO-002 "
                 "ASF-SDOREQ-002 ASF-SDOREQ-005 ASF-SDOREQ-006 ASF-SDOREQ-007 ASF-SDOREQ-008");
  EXPECT_EQ(d(24000), 0U) << "no request yet";
  slaves[3].answers = false;
  request({0x0101, 0x0008, 0x0203, 0x212D, 0x0000, 0x03E8, 0x0102});
  EXPECT_EQ(sent(0x603), (std::vector<Bytes>{{0x23, 0x2D, 0x21, 0x00, 0xE8, 0x03, 0x02, 0x01}}));
  EXPECT_EQ(d(24000), 0x0102U) << "being transmitted";
  receive(0x583, {0x60, 0x2D, 0x21, 0, 0, 0, 0, 0});
  EXPECT_EQ(response(7), (Words{0x0101, 0x0004, 0x6003, 0x212D, 0, 0, 0}));
}

TEST_F(FcopmRequests, A02_AnSdoRead) {
  RecordProperty(
      "spec",
      "ASF-SDOREQ-001 ASF-SDOREQ-006 ASF-SDOREQ-007 ASF-SDOREQ-008 ASF-SDOREQ-009 ASF-SDO-001 ASF-SDO-002");
  slaves[3].objects[{0x212D, 7}] = {0xE8, 0x03, 0x02, 0x01};
  request({0x2101, 0x0004, 0x0103, 0x212D, 0x0007, 0, 0});
  EXPECT_EQ(sent(0x603), (std::vector<Bytes>{{0x40, 0x2D, 0x21, 0x07, 0, 0, 0, 0}}));
  EXPECT_EQ(response(7), (Words{0x2101, 0x0008, 0x4303, 0x212D, 0x0007, 0x03E8, 0x0102}));
}

TEST_F(FcopmRequests, A02_ReadsOfOneAndTwoBytes_UnusedDataAreZero) {
  RecordProperty("spec", "ASF-SDOREQ-006 ASF-SDOREQ-007 ASF-SDOREQ-009 ASF-SDO-002");
  slaves[3].objects[{0x3000, 1}] = {0xA5};
  slaves[3].objects[{0x3000, 2}] = {0x34, 0x12};
  slaves[3].objects[{0x3000, 4}] = {4, 3, 2, 1};
  request({0x0101, 0x0004, 0x0103, 0x3000, 4});
  request({0x0201, 0x0004, 0x0103, 0x3000, 1});
  EXPECT_EQ(response(7), (Words{0x0201, 5, 0x4F03, 0x3000, 1, 0x00A5, 0}));
  request({0x0301, 0x0004, 0x0103, 0x3000, 2});
  EXPECT_EQ(response(7), (Words{0x0301, 6, 0x4B03, 0x3000, 2, 0x1234, 0}));
}

TEST_F(FcopmRequests, A03_TheLadderExampleReadsTheServosParameter) {
  RecordProperty("spec", "ASF-SDOREQ-010 ASF-SDOREQ-001");
  slaves[3].objects[{0x2009, 0}] = {0x00, 0x01, 0x00, 0x00};
  request({0x0101, 0x0004, 0x0103, 0x2009, 0x0000});
  EXPECT_EQ(sent(0x603), (std::vector<Bytes>{{0x40, 0x09, 0x20, 0, 0, 0, 0, 0}}));
  EXPECT_EQ(response(7), (Words{0x0101, 0x0008, 0x4303, 0x2009, 0x0000, 0x0100, 0}));
}

TEST_F(FcopmRequests, A04_OnlyAnotherReqIdAsks) {
  RecordProperty("spec", "ASF-REQ-003 ASF-REQ-008");
  slaves[3].objects[{0x2009, 0}] = slaves[3].objects[{0x200A, 0}] = {1, 0};
  request({0x0101, 0x0004, 0x0103, 0x2009, 0});
  forget();
  set_d(25003, 0x200A);
  set_d(25000, 0x0101);
  run(5ms);
  EXPECT_TRUE(sent(0x603).empty()) << "the ReqID is the same";
  EXPECT_EQ(d(24003), 0x2009U);
  set_d(25000, 0x0201);
  run(2ms);
  EXPECT_EQ(sent(0x603).size(), 1U);
  EXPECT_EQ(response(4), (Words{0x0201, 6, 0x4B03, 0x200A}));
  for (const std::uint16_t id :
       std::vector<std::uint16_t>{0xFF01, 0x0001, 0x0101}) {  // 00H to FFH, and round
    forget();
    set_d(25000, id);
    run(2ms);
    EXPECT_EQ(sent(0x603).size(), 1U) << id;
    EXPECT_EQ(d(24000), id);
  }
}

TEST_F(FcopmRequests, A05_WritesOfAWordAndAByte) {
  RecordProperty("spec", "ASF-SDOREQ-003 ASF-SDOREQ-004 ASF-SDOREQ-007 ASF-SDO-001");
  request({0x0101, 6, 0x0203, 0x2100, 5, 0x1234, 0xFFFF});
  request({0x0201, 5, 0x0203, 0x2100, 6, 0xFF77, 0xFFFF});
  EXPECT_EQ(sent(0x603), (std::vector<Bytes>{{0x2B, 0x00, 0x21, 0x05, 0x34, 0x12, 0x00, 0x00},
                                             {0x2F, 0x00, 0x21, 0x06, 0x77, 0x00, 0x00, 0x00}}));
  EXPECT_EQ(response(7), (Words{0x0201, 4, 0x6003, 0x2100, 6, 0, 0}));
  EXPECT_TRUE(slaves[3].was_written(0x2100, 5, {0x34, 0x12}));
}

TEST_F(FcopmRequests, A06_AnAbortIsAnErrorMessageOfTheSlave) {
  RecordProperty("spec", "ASF-REQ-019 ASF-SDO-003 ASF-SDOREQ-006");
  slaves[3].answers = false;
  request({0x0501, 4, 0x0103, 0x2009, 0});
  receive(0x583, {0x80, 0x09, 0x20, 0x00, 0x02, 0x00, 0x01, 0x06});
  EXPECT_EQ(response(7), (Words{0x050A, 8, 0x8003, 0x2009, 0, 0x0002, 0x0601}));
  slaves[3].answers = true;
  slaves[3].refused[{0x2100, 1}] = 0x06090030;
  request({0x0601, 6, 0x0203, 0x2100, 1, 7});
  EXPECT_EQ(response(7), (Words{0x060A, 8, 0x8003, 0x2100, 1, 0x0030, 0x0609}));
}

TEST_F(FcopmRequests, A07_ASilentNodeTimesOut) {
  RecordProperty("spec", "ASF-REQ-012 ASF-REQ-011 ASF-SDO-001");
  request({0x0701, 4, 0x0109, 0x2009, 0});  // nobody is node 9
  EXPECT_EQ(d(24000), 0x0702U);
  run(490ms);
  EXPECT_EQ(d(24000), 0x0702U);
  run(20ms);
  const auto requests = sent(0x609);
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_EQ(requests[1], (Bytes{0x80, 0x09, 0x20, 0x00, 0x00, 0x00, 0x04, 0x05})) << "the master stops it";
  EXPECT_EQ(response(7), (Words{0x0703, 0, 0x0009, 0, 0, 0, 0}));
}

TEST_F(FcopmRequests, A08_TheLowByteOfTheFirstWordIs01) {
  RecordProperty("spec", "ASF-REQ-005 ASF-REQ-013");
  EXPECT_EQ(status_of({0x0302, 4, 0x0103, 0x1000, 0}), 0x0304U);
  EXPECT_EQ(status_of({0x0400, 4, 0x0303, 1, 3}), 0x0404U);
  EXPECT_EQ(messages(), 0U);
}

TEST_F(FcopmRequests, A09_TypesAndNodesThatAreNone) {
  RecordProperty("spec", "ASF-REQ-017 ASF-REQ-018 ASF-NMTREQ-002");
  EXPECT_EQ(status_of({0x0101, 4, 0x0503}), 0x0108U);
  EXPECT_EQ(status_of({0x0201, 4, 0x0003}), 0x0208U);
  EXPECT_EQ(status_of({0x0301, 4, 0x0180, 0x1000}), 0x0309U) << "node 128";
  EXPECT_EQ(status_of({0x0401, 4, 0x0100, 0x1000}), 0x0409U) << "node 0";
  EXPECT_EQ(status_of({0x0501, 6, 0x0280, 0x1000}), 0x0509U);
  EXPECT_EQ(status_of({0x0601, 4, 0x0101, 0x1000}), 0x0609U) << "the master itself";
  EXPECT_EQ(status_of({0x0701, 4, 0x0380, 1, 128}), 0x0709U);
  EXPECT_EQ(status_of({0x0801, 0, 0x0480}), 0x0809U);
  EXPECT_EQ(status_of({0x0901, 0, 0x0400}), 0x0909U);
  EXPECT_EQ(messages(), 0U);
}

TEST_F(FcopmRequests, A10_SizesThatAreNone) {
  RecordProperty("spec", "ASF-REQ-014");
  std::uint8_t id = 0;
  for (const std::uint16_t size : std::vector<std::uint16_t>{0, 3, 4, 7, 9, 255}) {
    const auto head = static_cast<std::uint16_t>(++id << 8);
    EXPECT_EQ(status_of({static_cast<std::uint16_t>(head | 1), size, 0x0203, 0x2100}), head | 5) << size;
  }
  for (const std::uint16_t size : std::vector<std::uint16_t>{0, 3, 5, 8}) {
    const auto head = static_cast<std::uint16_t>(++id << 8);
    EXPECT_EQ(status_of({static_cast<std::uint16_t>(head | 1), size, 0x0103, 0x2100}), head | 5) << size;
  }
  EXPECT_EQ(status_of({0x7001, 5, 0x0303, 1, 3}), 0x7005U) << "NMT";
  EXPECT_EQ(status_of({0x7101, 4, 0x0403}), 0x7105U) << "emergency messages";
  EXPECT_EQ(messages(), 0U);
  EXPECT_EQ(status_of({0x7201, 0xAA05, 0x0203, 0x2100, 0, 1}), 0x7201U) << "the high byte is reserved";
}

TEST_F(FcopmRequests, A10_AnAnswerOfThreeBytesOrMoreThanFourHasNoPlace) {
  RecordProperty("spec", "ASF-REQ-015 ASF-SDO-004");
  slaves[3].objects[{0x2100, 3}] = {1, 2, 3};
  EXPECT_EQ(status_of({0x0101, 4, 0x0103, 0x2100, 3}), 0x0106U);
  EXPECT_EQ(d(24005), 0U);
  slaves[3].answers = false;
  forget();
  request({0x0201, 4, 0x0103, 0x1008, 0});
  receive(0x583, {0x41, 0x08, 0x10, 0x00, 10, 0, 0, 0});
  receive(0x583, {0x00, 'A', 'S', '3', '0', '0', ' ', 'S'});
  EXPECT_EQ(d(24000), 0x0202U) << "the last segment is still to come";
  receive(0x583, {0x19, 'e', 'r', 'i', 0, 0, 0, 0});  // three bytes, and no more
  EXPECT_EQ(sent(0x603), (std::vector<Bytes>{{0x40, 0x08, 0x10, 0, 0, 0, 0, 0},
                                             {0x60, 0, 0, 0, 0, 0, 0, 0},
                                             {0x70, 0, 0, 0, 0, 0, 0, 0}}));
  EXPECT_EQ(d(24000), 0x0206U);
}

TEST_F(FcopmRequests, A11_OneRequestPerDevice_OthersMeanwhile) {
  RecordProperty("spec", "ASF-REQ-006 ASF-REQ-016");
  slaves[3].answers = false;
  slaves[2].objects[{0x2000, 0}] = {9, 0};
  request({0x0101, 4, 0x0103, 0x2009, 0});
  EXPECT_EQ(status_of({0x0201, 6, 0x0203, 0x2100, 0, 5}), 0x0207U) << "SDO";
  EXPECT_EQ(status_of({0x0301, 4, 0x0303, 2, 3}), 0x0307U) << "NMT";
  EXPECT_EQ(status_of({0x0401, 0, 0x0403}), 0x0407U) << "emergency messages";
  EXPECT_EQ(sent(0x603).size(), 1U);
  EXPECT_TRUE(sent(0x000).empty());
  EXPECT_EQ(status_of({0x0501, 4, 0x0102, 0x2000, 0}), 0x0501U) << "another device";
  receive(0x583, {0x4B, 0x09, 0x20, 0x00, 0x11, 0x00, 0, 0});
  EXPECT_EQ(response(6), (Words{0x0101, 6, 0x4B03, 0x2009, 0, 0x0011})) << "each answer has its ReqID";
  slaves[3].answers = true;
  EXPECT_EQ(status_of({0x0601, 6, 0x0203, 0x2100, 0, 5}), 0x0601U);
}

TEST_F(FcopmRequests, A12_ReservedWordsDoNotMatter_LeftoverDataAreSent) {
  RecordProperty("spec", "ASF-REQ-007 ASF-SDOREQ-011 ASF-REQ-004");
  for (std::uint32_t word = 25007; word <= 25031; ++word) set_d(word, 0xDEAD);
  slaves[3].objects[{0x212D, 0}] = {1, 2, 3, 4};
  request({0x0101, 4, 0x0103, 0x212D, 0xAA00, 0x7777, 0x8888});
  EXPECT_EQ(sent(0x603), (std::vector<Bytes>{{0x40, 0x2D, 0x21, 0, 0, 0, 0, 0}}));
  EXPECT_EQ(d(24000), 0x0101U);
  for (std::uint32_t word = 24007; word <= 24031; ++word) EXPECT_EQ(d(word), 0U) << word;
  forget();
  request({0x0201, 8, 0x0203, 0x212D, 0, 0x0001});  // D25006 has what the request before left
  EXPECT_EQ(sent(0x603), (std::vector<Bytes>{{0x23, 0x2D, 0x21, 0, 0x01, 0x00, 0x88, 0x88}}));
}

// "Clear the request message mapping area to zero" [10.4]; "0: No data transmission request" [10.4.1].
TEST_F(FcopmRequests, AnAreaOfZerosAsksForNothing) {
  RecordProperty("spec", "ASF-REQ-021 ASF-REQ-007 ASF-REQ-009");
  slaves[3].objects[{0x2009, 0}] = {1, 0};
  for (int i = 0; i < 3; ++i) {
    request(Words(32, 0));
    EXPECT_EQ(response(32), Words(32, 0)) << i;
    EXPECT_EQ(messages(), 0U);
    request({0x0101, 4, 0x0103, 0x2009, 0});  // each time with the same ReqID
    EXPECT_EQ(sent(0x603).size(), 1U) << i;
    EXPECT_EQ(response(6), (Words{0x0101, 6, 0x4B03, 0x2009, 0, 1}));
    forget();
  }
  // What is on its way is still shown, and its answer comes.
  slaves[3].answers = false;
  request({0x0201, 4, 0x0103, 0x2009, 0});
  request(Words(32, 0));
  EXPECT_EQ(response(3), (Words{0x0202, 0, 0x0003}));
  receive(0x583, {0x4B, 0x09, 0x20, 0x00, 0x11, 0x00, 0, 0});
  EXPECT_EQ(response(6), (Words{0x0201, 6, 0x4B03, 0x2009, 0, 0x0011}));
}

TEST_F(FcopmRequests, AnAreaThatIsClearedAndFilledWithinAScan_IsANewRequest) {
  RecordProperty("spec", "ASF-REQ-022 ASF-REQ-003 ASF-REQ-007");
  slaves[3].objects[{0x2009, 0}] = {1, 0};
  request({0x0101, 4, 0x0103, 0x2009, 0});
  for (int i = 0; i < 3; ++i) {
    forget();
    for (std::uint32_t word = 25000; word <= 25031; ++word) set_d(word, 0);
    request({0x0101, 4, 0x0103, 0x2009, 0});
    EXPECT_EQ(sent(0x603), (std::vector<Bytes>{{0x40, 0x09, 0x20, 0, 0, 0, 0, 0}})) << i;
    EXPECT_EQ(response(6), (Words{0x0101, 6, 0x4B03, 0x2009, 0, 1}));
    run(100ms);
    EXPECT_EQ(sent(0x603).size(), 1U) << "once";
  }
  forget();
  for (std::uint32_t word = 25001; word <= 25031; ++word) set_d(word, 0);  // the ReqID is not touched
  request({0x0101, 4, 0x0103, 0x2009, 0});
  EXPECT_TRUE(sent(0x603).empty());
}

TEST_F(FcopmRequests, AReqIdThatIsWrittenTwiceWithinAScan_IsOneRequest) {
  RecordProperty("spec", "ASF-REQ-004");
  slaves[3].objects[{0x3001, 1}] = {7, 0};
  for (std::uint32_t i = 0;
       const std::uint16_t word : std::vector<std::uint16_t>{0x0901, 4, 0x0103, 0x3001, 1})
    set_d(25000 + i++, word);
  set_d(25000, 0x0901);
  run(2ms);
  EXPECT_EQ(response(6), (Words{0x0901, 6, 0x4B03, 0x3001, 1, 7}));
  EXPECT_EQ(sent(0x603).size(), 1U);
}

TEST_F(FcopmRequests, TheReqIdFirstAndTheOtherWordsInTheSameScanAreOneRequest) {
  RecordProperty("spec", "ASF-REQ-004");
  slaves[3].objects[{0x3001, 1}] = {7, 0};
  for (std::uint32_t i = 0;
       const std::uint16_t word : std::vector<std::uint16_t>{0x0901, 4, 0x0103, 0x3001, 1})
    set_d(25000 + i++, word);
  run(2ms);
  EXPECT_EQ(response(6), (Words{0x0901, 6, 0x4B03, 0x3001, 1, 7}));
  set_d(25000, 0x0A01);  // in a scan of its own: what the words hold now
  run(2ms);
  set_d(25003, 0x3002);
  run(2ms);
  EXPECT_EQ(response(4), (Words{0x0A01, 6, 0x4B03, 0x3001}));
}

TEST_F(FcopmRequests, StatusCodesAreThoseOfTheTable) {
  RecordProperty("spec", "ASF-REQ-009 ASF-REQ-020");
  FcopmCard other;
  other.list(3);
  other.start();
  EXPECT_EQ(other.d(24000), 0U) << "no request";
  other.run(1s);
  EXPECT_EQ(other.response(32), Words(32, 0));
  // Whatever is asked, the status is one of 0 to 0AH.
  for (unsigned i = 1; i < 256; ++i) {
    request({static_cast<std::uint16_t>(i << 8 | (i % 7 != 0)), static_cast<std::uint16_t>(i % 9),
             static_cast<std::uint16_t>((i % 6) << 8 | i % 5), static_cast<std::uint16_t>(i % 4), 0});
    EXPECT_LE(d(24000) & 0xFF, 0x0A) << i;
    EXPECT_NE(d(24000) & 0xFF, 0) << i;
  }
}

TEST_F(FcopmRequests, B01_StopsOneNode) {
  RecordProperty("spec", "ASF-NMTREQ-001 ASF-NMTREQ-002 ASF-NMTREQ-004 ASF-NMTREQ-005 ASF-NMT-002");
  request({0x0101, 0x0004, 0x0303, 0x0002, 0x0003});
  EXPECT_EQ(sent(0x000), (std::vector<Bytes>{{0x02, 0x03}}));
  EXPECT_EQ(response(8), (Words{0x0101, 0, 0x0003, 0, 0, 0, 0, 0}));
  EXPECT_EQ(slaves[3].state, 0x04);
  EXPECT_EQ(slaves[2].state, 0x05);
}

TEST_F(FcopmRequests, B02_NodeZeroIsAllNodes) {
  RecordProperty("spec", "ASF-NMTREQ-003 ASF-NMTREQ-005");
  request({0x0101, 4, 0x0300, 0x0002, 0});
  EXPECT_EQ(slaves[2].state, 0x04);
  request({0x0201, 4, 0x0300, 0x0001, 0});
  EXPECT_EQ(sent(0x000), (std::vector<Bytes>{{0x02, 0x00}, {0x01, 0x00}}));
  EXPECT_EQ(response(3), (Words{0x0201, 0, 0}));
  EXPECT_EQ(slaves[3].state, 0x05);
  EXPECT_EQ(card.node().state(), canopen::NmtState::operational) << "the master itself stays";
}

TEST_F(FcopmRequests, B03_EachService) {
  RecordProperty("spec", "ASF-NMTREQ-002 ASF-NMT-002");
  std::uint16_t id = 0;
  for (const std::uint8_t service : std::vector<std::uint8_t>{0x01, 0x02, 0x80, 0x81, 0x82}) {
    forget();
    request({static_cast<std::uint16_t>((++id << 8) | 1), 4, 0x0303, service, 3}, 1500us);
    ASSERT_FALSE(sent(0x000).empty());
    EXPECT_EQ(sent(0x000).front(), (Bytes{service, 3}));
    EXPECT_EQ(d(24000), id << 8 | 1);
  }
}

TEST_F(FcopmRequests, B04_OtherServicesAndTwoNodesAtOnceAreRefused) {
  RecordProperty("spec", "ASF-NMTREQ-002 ASF-NMTREQ-004");
  EXPECT_EQ(status_of({0x0101, 4, 0x0303, 0x03, 3}), 0x0104U);
  EXPECT_EQ(d(24002), 3U);
  EXPECT_EQ(status_of({0x0201, 4, 0x0303, 0x00, 3}), 0x0204U);
  EXPECT_EQ(status_of({0x0301, 4, 0x0303, 0x01, 2}), 0x0309U) << "D25002 and D25004 name different nodes";
  EXPECT_EQ(status_of({0x0401, 4, 0x0301, 0x02, 1}), 0x0409U) << "the master itself";
  EXPECT_TRUE(sent(0x000).empty());
}

TEST_F(FcopmRequests, C01_EmergencyMessagesAreReadNewestFirst) {
  RecordProperty("spec",
                 "ASF-EMCYREQ-001 ASF-EMCYREQ-002 ASF-EMCYREQ-004 ASF-EMCYREQ-005 ASF-EMCY-001 ASF-EMCY-005 "
                 "ASF-SRN-001");
  receive(0x082, {0x43, 0x54, 0x20, 0x14, 0, 0, 0, 0});
  receive(0x082, {0x42, 0x54, 0x20, 0x15, 1, 2, 3, 4});
  request({0x0101, 0x0000, 0x0402});
  EXPECT_EQ(response(13),
            (Words{0x0101, 0x002A, 0x0402, 0x0202, 0x5442, 0x1520, 0x0201, 0x0403, 0x5443, 0x1420, 0, 0, 0}));
  EXPECT_EQ(sr(831), 0xE0U) << "C-04: reading does not take it away";
}

TEST_F(FcopmRequests, C02_FiveAreStored_AllAreCounted_NodeByNode) {
  RecordProperty("spec", "ASF-EMCYREQ-003 ASF-EMCYREQ-005 ASF-EMCYREQ-002");
  for (std::uint8_t n = 1; n <= 7; ++n) receive(0x082, {n, 0x10, 1, 0, 0, 0, 0, n});
  receive(0x083, {0x55, 0x20, 1, 0, 0, 0, 0, 0});
  request({0x0101, 0, 0x0402});
  EXPECT_EQ(d(24003), 0x0705U);
  EXPECT_EQ(d(24004), 0x1007U);
  EXPECT_EQ(d(24007), 0x0700U);
  EXPECT_EQ(d(24020), 0x1003U) << "the first two are gone";
  EXPECT_EQ(d(24023), 0x0300U);
  for (std::uint32_t word = 24024; word <= 24031; ++word) EXPECT_EQ(d(word), 0U);
  request({0x0201, 0, 0x0403});
  EXPECT_EQ(response(6), (Words{0x0201, 0x2A, 0x0403, 0x0101, 0x2055, 0x0001}));
  for (unsigned n = 0; n < 300; ++n) receive(0x083, {0, 0, 0, 0, 0, 0, 0, 0});
  request({0x0301, 0, 0x0403});
  EXPECT_EQ(d(24003), 0xFF05U) << "the counter stays at 255";
}

TEST_F(FcopmRequests, C03_ANodeWithoutMessages) {
  RecordProperty("spec", "ASF-EMCYREQ-006");
  receive(0x082, {1, 0x10, 1, 0, 0, 0, 0, 0});
  request({0x0101, 0, 0x0402});
  request({0x0201, 0, 0x0403});
  EXPECT_EQ(response(4), (Words{0x0201, 0x2A, 0x0403, 0}));
  for (std::uint32_t word = 24004; word <= 24031; ++word) EXPECT_EQ(d(word), 0U);
}

TEST_F(FcopmRequests, C03_ARequestThatFailsShowsNoMessages) {
  RecordProperty("spec", "ASF-EMCYREQ-007");
  receive(0x082, {1, 0x10, 1, 0, 0, 0, 0, 0});
  request({0x0101, 0, 0x0402});
  request({0x0201, 1, 0x0402});
  EXPECT_EQ(response(8), (Words{0x0205, 0, 0x0002, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace canopus::scenario::as_fcopm_requests_test
