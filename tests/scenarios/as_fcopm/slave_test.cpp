// The card as slave: scenarios D-05 and F-03 to F-07 of spec/as-fcopm/scenarios.md.

#include "canopus/module/models/as_fcopm/object_table.hpp"

#include "scenarios/as_fcopm/card.hpp"

namespace canopus::scenario::as_fcopm_slave_test {
namespace {

class FcopmAsSlave : public testing::Test, public FcopmCard {
 protected:
  void SetUp() override {
    configuration.work_mode = fcopm::WorkMode::slave;
    configuration.node_id = 5;
  }
  void start_operational() {
    start(10ms);
    receive(0x000, {0x01, 0x05});
    forget();
  }
  Bytes upload(std::uint16_t index, std::uint8_t sub) {
    forget();
    receive(0x605,
            {0x40, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8), sub, 0, 0, 0, 0});
    const auto replies = sent(0x585);
    if (replies.size() != 1 || (replies[0][0] & 0xE3) != 0x43) return {};
    return {replies[0].begin() + 4, replies[0].begin() + 8 - (replies[0][0] >> 2 & 3)};
  }
  /// 60H, or 80H when it is refused.
  std::uint8_t download(std::uint16_t index, std::uint8_t sub, const Bytes& value) {
    forget();
    Bytes request{static_cast<std::uint8_t>(0x23 | (4 - value.size()) << 2), static_cast<std::uint8_t>(index),
                  static_cast<std::uint8_t>(index >> 8), sub};
    request.insert(request.end(), value.begin(), value.end());
    request.resize(8);
    receive(0x605, request);
    const auto replies = sent(0x585);
    return replies.empty() ? std::uint8_t{0} : replies[0][0];
  }
};

TEST_F(FcopmAsSlave, F03_ItBootsAndWaitsForTheMaster) {
  RecordProperty(
      "spec",
      "ASF-GEN-001 ASF-GEN-003 ASF-NMT-001 ASF-NMT-003 ASF-NMT-005 ASF-SRS-001 ASF-SRS-002 ASF-HB-006");
  card.download(configuration);
  card.power_on(now);
  EXPECT_EQ(sr(825), 0xA0U);
  run(1100ms);
  EXPECT_EQ(sr(825), 0xA1U);
  EXPECT_EQ(sent(0x705), (std::vector<Bytes>{{0x00}}));
  run(5s);
  EXPECT_EQ(frames.size(), 1U) << "no heartbeat, no PDO, no SYNC";
  receive(0x000, {0x01, 0x05});
  EXPECT_EQ(sr(825), 0U);
  run(101ms);
  EXPECT_EQ(sent(0x185).size(), 1U);
  receive(0x000, {0x80, 0x05});
  EXPECT_EQ(sr(825), 0xA1U);
  receive(0x000, {0x01, 0x04});
  EXPECT_EQ(sr(825), 0xA1U) << "another node's command";
  receive(0x000, {0x02, 0x00});
  EXPECT_EQ(card.node().state(), canopen::NmtState::stopped);
  EXPECT_EQ(sr(825), 0U);
  for (const std::uint8_t reset : std::vector<std::uint8_t>{0x81, 0x82}) {
    forget();
    receive(0x000, {reset, 0x05});
    EXPECT_EQ(sr(825), 0xA0U);
    run(1s);
    EXPECT_EQ(sent(0x705), (std::vector<Bytes>{{0x00}}));
    EXPECT_EQ(sr(825), 0xA1U);
  }
}

TEST_F(FcopmAsSlave, EachStateHasItsServices) {
  RecordProperty("spec", "ASF-NMT-004 ASF-PDO-009 ASF-SDO-005");
  start(10ms);
  EXPECT_EQ(upload(0x1000, 0), (Bytes{0, 0, 0, 0})) << "Pre-operational";
  receive(0x205, {1, 0, 2, 0, 3, 0, 4, 0});
  EXPECT_EQ(d(24032), 0U);
  receive(0x000, {0x01, 0x05});
  EXPECT_EQ(upload(0x1000, 0).size(), 4U);
  receive(0x205, {1, 0, 2, 0, 3, 0, 4, 0});
  EXPECT_EQ(d(24035), 4U);
  receive(0x000, {0x02, 0x05});
  EXPECT_TRUE(upload(0x1000, 0).empty()) << "Stopped";
  receive(0x205, {9, 0, 9, 0, 9, 0, 9, 0});
  card.cpu_failed(now);
  run(1s);
  EXPECT_EQ(d(24032), 1U);
  EXPECT_TRUE(frames.empty()) << "no emergency message either";
  card.cpu_changed(module::CpuState::run, now);
  receive(0x000, {0x80, 0x05});
  forget();
  card.cpu_failed(now);
  settle_now();
  EXPECT_EQ(sent(0x085).size(), 1U) << "Pre-operational";
}

TEST_F(FcopmAsSlave, F04_WordsAndPdosByDefault) {
  RecordProperty("spec",
                 "ASF-SLV-001 ASF-SLV-003 ASF-SLV-004 ASF-OD-005 ASF-PDO-006 ASF-PDO-007 ASF-PDO-014");
  start_operational();
  set_d(25032, 0x1234);
  set_d(25035, 0xABCD);
  run(1s);
  EXPECT_EQ(sent(0x185), std::vector<Bytes>(10, {0x34, 0x12, 0, 0, 0, 0, 0xCD, 0xAB})) << "every 100 ms";
  EXPECT_EQ(d(25032), 0x1234U);
  receive(0x205, {0xAA, 0xBB, 1, 0, 2, 0, 3, 0});
  EXPECT_EQ(d(24032), 0xBBAAU);
  EXPECT_EQ(d(24035), 3U);
  for (std::uint32_t id = 0x285; id <= 0x505; id += 0x80) {
    receive(id, {1, 2, 3, 4, 5, 6, 7, 8});
    EXPECT_TRUE(sent(id).empty());
  }
  EXPECT_EQ(d(24036), 0U);
  EXPECT_EQ(d(6032), 0U) << "the table's addresses are another PLC's";
  set_d(24032, 1);
  EXPECT_EQ(d(24032), 0xBBAAU);
}

TEST_F(FcopmAsSlave, ThirtyTwoWordsEachWay_InEightPdos) {
  RecordProperty("spec", "ASF-GEN-008 ASF-SLV-002 ASF-SLV-004 ASF-OD-004 ASF-OD-006");
  start(10ms);
  for (std::uint8_t pdo = 0; pdo < 8; ++pdo) {
    for (const std::uint16_t parameters : std::vector<std::uint16_t>{0x1400, 0x1800}) {
      const auto index = static_cast<std::uint16_t>(parameters + pdo);
      const auto mapping = static_cast<std::uint16_t>(index + 0x200);
      const bool transmit = parameters == 0x1800;
      const auto low = static_cast<std::uint8_t>((transmit ? 0x10 : 0x20) + pdo);
      ASSERT_EQ(download(index, 1, {low, transmit ? std::uint8_t{2} : std::uint8_t{2}, 0, 0x80}), 0x60);
      ASSERT_EQ(download(mapping, 0, {0}), 0x60);
      for (std::uint8_t sub = 1; sub <= 4; ++sub) {
        const auto word = static_cast<std::uint8_t>(4 * pdo + sub);
        ASSERT_EQ(download(mapping, sub, {0x10, word, transmit ? std::uint8_t{1} : std::uint8_t{0}, 0x20}),
                  0x60);
      }
      ASSERT_EQ(download(mapping, 0, {4}), 0x60);
      ASSERT_EQ(download(index, 1, {low, 2, 0, 0}), 0x60);
    }
  }
  receive(0x000, {0x01, 0x00});
  for (std::uint32_t word = 0; word < 32; ++word)
    set_d(25032 + word, static_cast<std::uint16_t>(0x100 + word));
  forget();
  run(110ms);
  for (std::uint8_t pdo = 0; pdo < 8; ++pdo) {
    Bytes expected, data;
    for (unsigned i = 0; i < 4; ++i) {
      expected.push_back(static_cast<std::uint8_t>(4 * pdo + i));
      expected.push_back(1);
      data.push_back(static_cast<std::uint8_t>(0x40 + 4 * pdo + i));
      data.push_back(2);
    }
    EXPECT_EQ(sent(0x210U + pdo), (std::vector<Bytes>{expected})) << int{pdo};
    receive(0x220U + pdo, data);
  }
  for (std::uint32_t word = 0; word < 32; ++word) EXPECT_EQ(d(24032 + word), 0x240 + word);
  EXPECT_EQ(d(24064), 0U);
  EXPECT_EQ(upload(0x2000, 32), (Bytes{0x5F, 0x02}));
  EXPECT_EQ(upload(0x2001, 32), (Bytes{0x1F, 0x01}));
  EXPECT_EQ(download(0x1607, 5, {1, 0, 0, 0}), 0x80) << "four objects at most";
}

TEST_F(FcopmAsSlave, TxPdosOfTypes254And255) {
  RecordProperty("spec", "ASF-PDO-006 ASF-PDO-007 ASF-OD-005");
  for (const std::uint8_t type : std::vector<std::uint8_t>{254, 255}) {
    FcopmCard other;
    other.configuration = configuration;
    other.card.download(other.configuration);
    const Bytes none{0, 0};
    ASSERT_EQ(other.card.preset_object(0x1800, 2, Bytes{type}), canopen::AbortCode::none);
    ASSERT_EQ(other.card.preset_object(0x1800, 3, none), canopen::AbortCode::none);
    ASSERT_EQ(other.card.preset_object(0x1800, 5, none), canopen::AbortCode::none);
    other.card.power_on(other.now);
    other.run(1100ms);
    other.receive(0x000, {0x01, 0x05});
    other.forget();
    other.run(1s);
    EXPECT_TRUE(other.sent(0x185).empty()) << "no change";
    other.set_d(25033, 3);
    other.run(2ms);
    other.set_d(25033, 3);
    other.set_d(25036, 3);  // not mapped
    other.run(1s);
    EXPECT_EQ(other.sent(0x185), (std::vector<Bytes>{{0, 0, 3, 0, 0, 0, 0, 0}}));
    for (const std::uint8_t command : std::vector<std::uint8_t>{0x80, 0x01})
      other.receive(0x000, {command, 0x05});
    other.run(1s);
    EXPECT_EQ(other.sent(0x185).size(), 2U) << "it begins with zeros each time";
  }
  // With an event timer it alone sends.
  start_operational();
  run(50ms);
  forget();
  set_d(25032, 1);
  run(20ms);
  EXPECT_TRUE(sent(0x185).empty());
  run(1s);
  EXPECT_EQ(sent(0x185).size(), 10U);
}

TEST_F(FcopmAsSlave, TheInhibitTimeHoldsATxPdo) {
  RecordProperty("spec", "ASF-PDO-006 ASF-OD-005");
  card.download(configuration);
  ASSERT_EQ(card.preset_object(0x1800, 5, Bytes{0, 0}), canopen::AbortCode::none);
  ASSERT_EQ(card.preset_object(0x1800, 3, Bytes{0xF4, 0x01}), canopen::AbortCode::none);  // 500 x 100 us
  card.power_on(now);
  run(1100ms);
  receive(0x000, {0x01, 0x05});
  forget();
  for (std::uint16_t i = 1; i <= 100; ++i) {
    set_d(25032, i);
    run(2ms);
  }
  const auto at = times(0x185);
  ASSERT_GE(at.size(), 4U);
  EXPECT_LE(at.size(), 5U);
  for (std::size_t i = 1; i < at.size(); ++i) EXPECT_GE(at[i] - at[i - 1], 50ms);
}

TEST_F(FcopmAsSlave, SynchronousPdos) {
  RecordProperty("spec", "ASF-PDO-001 ASF-PDO-002 ASF-PDO-003 ASF-PDO-004 ASF-SYNC-002");
  for (const std::uint8_t type : std::vector<std::uint8_t>{0, 1, 3}) {
    FcopmCard other;
    other.configuration = configuration;
    other.card.download(other.configuration);
    ASSERT_EQ(other.card.preset_object(0x1800, 2, Bytes{type}), canopen::AbortCode::none);
    ASSERT_EQ(other.card.preset_object(0x1400, 2, Bytes{type}), canopen::AbortCode::none);
    other.card.power_on(other.now);
    other.run(1100ms);
    other.receive(0x000, {0x01, 0x05});
    other.forget();
    other.set_d(25032, 7);
    other.receive(0x205, {5, 0, 0, 0, 0, 0, 0, 0});
    other.run(1s);
    EXPECT_TRUE(other.sent(0x185).empty()) << "before the SYNC";
    EXPECT_EQ(other.d(24032), 0U);
    for (int i = 0; i < 6; ++i) other.receive(0x080);
    EXPECT_EQ(other.d(24032), 5U);
    EXPECT_EQ(other.sent(0x185), std::vector<Bytes>(type == 0 ? 1 : 6U / type, {7, 0, 0, 0, 0, 0, 0, 0}))
        << int{type};
  }
}

TEST_F(FcopmAsSlave, NoPdoCanBeAskedFor) {
  RecordProperty("spec", "ASF-PDO-008");
  start_operational();
  card.receive(can::remote_frame(0x185, 8), now);
  run(1ms);
  EXPECT_TRUE(sent(0x185).empty());
  for (const std::uint8_t type : std::vector<std::uint8_t>{252, 253, 241})
    EXPECT_EQ(download(0x1800, 2, {type}), 0x80) << int{type};
  for (const std::uint8_t type : std::vector<std::uint8_t>{0, 1, 240, 254, 255})
    EXPECT_EQ(download(0x1800, 2, {type}), 0x60) << int{type};
}

TEST_F(FcopmAsSlave, D05_F05_AHeartbeatThatIsMissed_WithItsEmergencyMessage) {
  RecordProperty(
      "spec",
      "ASF-SRS-004 ASF-HB-002 ASF-HB-005 ASF-EMCY-001 ASF-EMCY-002 ASF-EMCY-003 ASF-EMCY-004 ASF-OD-007");
  start_operational();
  EXPECT_EQ(upload(0x1016, 1), (Bytes{0, 0, 0, 0}));
  EXPECT_EQ(download(0x1016, 1, {0xF4, 0x01, 0x01, 0x00}), 0x60);  // node 1, 500 ms
  EXPECT_EQ(download(0x1016, 2, {0, 0, 0, 0}), 0x80) << "one entry";
  receive(0x701, {0x05});
  forget();
  run(499ms);
  EXPECT_EQ(sr(825), 0U);
  run(2ms);
  EXPECT_EQ(sr(825), 0xB0U);
  ASSERT_EQ(sent(0x085).size(), 1U);
  EXPECT_EQ(sent(0x085)[0][0] | sent(0x085)[0][1] << 8, 0x8130);
  EXPECT_EQ(sent(0x085)[0][2], 0x01) << "generic error, and no other bit";
  EXPECT_EQ(upload(0x1001, 0), (Bytes{1}));
  forget();
  receive(0x701, {0x05});
  EXPECT_NE(sr(825), 0xB0U);
  EXPECT_EQ(sent(0x085), (std::vector<Bytes>{Bytes(8, 0)}));
  EXPECT_EQ(upload(0x1001, 0), (Bytes{0}));
}

TEST_F(FcopmAsSlave, D05_APdoOfAnotherLength) {
  RecordProperty("spec", "ASF-SRS-005 ASF-PDO-011 ASF-EMCY-003");
  start_operational();
  receive(0x205, {1, 2, 3});
  EXPECT_EQ(sr(825), 0xB1U);
  EXPECT_EQ(sent(0x085).at(0)[2], 0x01);
  receive(0x205, {1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_EQ(sr(825), 0U);
  EXPECT_EQ(sent(0x085).back(), Bytes(8, 0));
}

TEST_F(FcopmAsSlave, F05_AnErrorOfTheCpu) {
  RecordProperty("spec", "ASF-EMCY-003 ASF-EMCY-004 ASF-EMCY-002");
  start_operational();
  card.cpu_changed(module::CpuState::run, now);
  EXPECT_TRUE(frames.empty());
  card.cpu_failed(now);
  card.cpu_changed(module::CpuState::stop, now);
  settle_now();
  EXPECT_EQ(sent(0x085), (std::vector<Bytes>{{0x00, 0x61, 0x80, 0, 0, 0, 0, 0}})) << "internal error";
  EXPECT_EQ(upload(0x1001, 0), (Bytes{0x80}));
  forget();
  card.cpu_changed(module::CpuState::run, now);
  settle_now();
  EXPECT_EQ(sent(0x085), (std::vector<Bytes>{Bytes(8, 0)}));
}

TEST_F(FcopmAsSlave, D05_BusOffBuffersAndDownload) {
  RecordProperty("spec", "ASF-SRS-003 ASF-SRS-006 ASF-SRS-007 ASF-SRS-008 ASF-CFG-010");
  start_operational();
  card.download(configuration, now);
  EXPECT_EQ(sr(825), 0xA3U);
  run(3s);
  EXPECT_EQ(sr(825), 0U);
  bus.lost = 1;
  run(200ms);
  EXPECT_EQ(sr(825), 0xFCU);
  bus.accepts = false;
  run(200ms);
  EXPECT_EQ(sr(825), 0xFBU);
  bus.accepts = true;
  bus.transmit_errors = 256;
  card.controller_changed(now);
  EXPECT_EQ(sr(825), 0xF4U);
  bus.transmit_errors = 0;
  run(1s);
  EXPECT_EQ(sr(825), 0xF4U);
  card.power_off(now);
  card.power_on(now);
  run(2s);
  EXPECT_EQ(sr(825), 0xA1U);
}

TEST_F(FcopmAsSlave, F07_ItsObjects) {
  RecordProperty("spec", "ASF-OD-001 ASF-OD-002 ASF-OD-003 ASF-OD-007 ASF-HB-005 ASF-HB-006 ASF-SYNC-003");
  start(10ms);
  EXPECT_EQ(upload(0x1000, 0), (Bytes{0, 0, 0, 0}));
  EXPECT_EQ(upload(0x1018, 0), (Bytes{3}));
  EXPECT_EQ(upload(0x1018, 1), (Bytes{0xDD, 0x01, 0, 0}));
  EXPECT_EQ(upload(0x1018, 2), (Bytes{0x55, 0, 0, 0}));
  EXPECT_EQ(upload(0x1018, 3), (Bytes{0x02, 0x00, 0x01, 0x00}));
  EXPECT_EQ(upload(0x1005, 0), (Bytes{0x80, 0, 0, 0}));
  EXPECT_EQ(upload(0x1014, 0), (Bytes{0x85, 0, 0, 0}));
  EXPECT_EQ(download(0x1014, 0, {0x86, 0, 0, 0}), 0x80) << "read only";
  EXPECT_EQ(upload(0x1017, 0), (Bytes{0, 0}));
  EXPECT_EQ(download(0x1017, 0, {100, 0}), 0x60);
  forget();
  run(1s);
  EXPECT_EQ(sent(0x705).size(), 10U);
  EXPECT_EQ(upload(0x1800, 3), (Bytes{50, 0}));
  EXPECT_EQ(upload(0x1800, 5), (Bytes{100, 0}));
  EXPECT_TRUE(upload(0x1800, 4).empty());
  // 1008H is longer than four bytes: by segments, the last one says so.
  forget();
  receive(0x605, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  receive(0x605, {0x60, 0, 0, 0, 0, 0, 0, 0});
  receive(0x605, {0x70, 0, 0, 0, 0, 0, 0, 0});
  receive(0x605, {0x60, 0, 0, 0, 0, 0, 0, 0});
  std::string name;
  const auto replies = sent(0x585);
  ASSERT_EQ(replies.size(), 4U);
  EXPECT_EQ(replies[0], (Bytes{0x41, 0x08, 0x10, 0, 16, 0, 0, 0}));
  for (std::size_t i = 1; i < 4; ++i) name.append(replies[i].begin() + 1, replies[i].end());
  EXPECT_EQ(name.substr(0, 16), "AS300 Series PLC");
  EXPECT_EQ(replies[2][0] & 1, 0);
  EXPECT_EQ(replies[3][0] & 1, 1) << "the end";
}

TEST_F(FcopmAsSlave, TheMastersRegistersAreNotThere) {
  RecordProperty("spec", "ASF-GEN-001");
  start_operational();
  request({0x0101, 4, 0x0103, 0x1000, 0});
  run(1s);
  EXPECT_TRUE(sent(0x603).empty());
  for (std::uint32_t number = 24000; number < 24032; ++number) EXPECT_EQ(d(number), 0U);
  for (std::uint32_t number = 826; number <= 893; ++number) EXPECT_EQ(sr(number), 0U);
  EXPECT_EQ(sr(822), 1000U);
}

TEST_F(FcopmAsSlave, DownloadedObjectsComeBackWithAReset_WrittenOnesDoNot) {
  RecordProperty("spec", "ASF-NMT-001 ASF-CFG-008");
  card.download(configuration);
  ASSERT_EQ(card.preset_object(0x1017, 0, Bytes{200, 0}), canopen::AbortCode::none);
  EXPECT_EQ(card.preset_object(0x1018, 1, Bytes{1, 0, 0, 0}), canopen::AbortCode::write_of_read_only);
  EXPECT_EQ(card.preset_object(0x1010, 1, Bytes{1, 0, 0, 0}), canopen::AbortCode::no_object);
  card.power_on(now);
  run(1100ms);
  EXPECT_EQ(upload(0x1017, 0), (Bytes{200, 0}));
  EXPECT_EQ(download(0x1017, 0, {50, 0}), 0x60);
  receive(0x000, {0x82, 0x05});
  run(1s);
  EXPECT_EQ(upload(0x1017, 0), (Bytes{200, 0}));
}

}  // namespace
}  // namespace canopus::scenario::as_fcopm_slave_test
