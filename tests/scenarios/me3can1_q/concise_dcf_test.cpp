// spec/me3can1-q/scenarios.md, section 10: configuration manager - concise DCFs and their downloads.

#include "scenarios/me3can1_q/concise_dcf.hpp"

namespace canopus::scenario::me3can1_q_concise_dcf_test {
namespace {

CANOPUS_OF_BOTH_MODULES(ConciseDcf);

TEST_P(ConciseDcf, S77_Download_Delete_Limits) {
  spec("ME3-CFG-003 ME3-CFG-004 ME3-CFG-005 ME3-CFG-006 ME3-CFG-007 ME3-STO-003 ME3-SYS-013",
       "RJ71-CM-006 RJ71-CM-004 RJ71-CM-005");
  IntelligentScenario s(GetParam());
  s.power_on();
  EXPECT_EQ(write_concise_dcf(s, 2), 0U);
  s.supply_off();
  s.power_on();  // in the flash memory at once
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1000, {0x0005, 0, 0x1F22, 2, 13})
      .expect(1005, {0x0001, 0x0000, 0x1017, 0x0200, 0x0000, 0xE800, 0x0003});
  EXPECT_EQ(write_concise_dcf(s, 2), 0x06010002U);
  EXPECT_EQ(write_concise_dcf(s, 2, {0}), 0U);
  EXPECT_EQ(write_concise_dcf(s, 2), 0x06060000U);  // the erase still runs
  EXPECT_EQ(write_concise_dcf(s, 3), 0x06060000U);
  s.advance(2s);
  EXPECT_EQ(write_concise_dcf(s, 2), 0U);
  EXPECT_EQ(write_concise_dcf(s, 2, {1}), 0x06010002U);  // one byte, but no 0: not a deletion
  EXPECT_EQ(write_concise_dcf(s, 2, {0, 0}), 0x06010002U);
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1000, 0x0005).expect(1004, 13);
  // Larger than a concise DCF may be: over the bus, segmented.
  const auto segmented = [&](std::uint32_t bytes) {
    s.rx(0x67F, {0x21, 0x22, 0x1F, 0x05, static_cast<std::uint8_t>(bytes & 0xFF),
                 static_cast<std::uint8_t>(bytes >> 8 & 0xFF), static_cast<std::uint8_t>(bytes >> 16), 0});
    s.ignore_tx();
    std::uint8_t toggle = 0;
    for (std::uint32_t sent = 0; sent < bytes; sent += 7, toggle ^= 0x10) {
      const std::uint32_t left = bytes - sent;
      const unsigned unused = left < 7 ? 7 - left : 0;
      const bool last = left <= 7;
      if (last) s.ignore_tx();
      s.rx(0x67F, {static_cast<std::uint8_t>(toggle | unused << 1 | (last ? 1U : 0U)), 1, 1, 1, 1, 1, 1, 1});
    }
    const std::string answer = text(s.controller().sent.back());
    s.ignore_tx();
    return answer;
  };
  EXPECT_EQ(segmented(65532), "5FF [80 22 1F 05 10 00 07 06]");
  EXPECT_EQ(segmented(65531).substr(0, 7), "5FF [30");  // the last of 9362 segments, taken
  // 1010H has no part in it.
  s.set_object(0x1015, 0, 5, 2);
  s.restart();
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1000, 0x0005).expect(1004, 13);
  s.expect_object(0x1015, 0, 0, 2);
}

// A concise DCF of no entries, a count of 0 and nothing else, says that the node has no configuration
// [CiA 302-3]; "write 0 to this sub-index" deletes an entry, of whatever length the 0 is [ME3CAN1-Q 4.8.12].
TEST_P(ConciseDcf, EmptyConciseDcf_IsTakenAndMeansNoConfiguration) {
  spec("ME3-CFG-002 ME3-CFG-004 ME3-CFG-006", "RJ71-CM-004 RJ71-CM-006 RJ71-CM-005");
  IntelligentScenario s(GetParam());
  s.power_on();
  const Bytes empty(4, 0);
  EXPECT_EQ(write_concise_dcf(s, 2, empty), 0U);
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1000, 0x0005).expect(1004, 0);
  EXPECT_EQ(write_concise_dcf(s, 2), 0U);  // at once: there was nothing to erase
  EXPECT_EQ(write_concise_dcf(s, 2, empty), 0U);
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1000, 0x0005).expect(1004, 0);
  EXPECT_EQ(write_concise_dcf(s, 2), 0x06060000U);  // the erase runs
  s.advance(2s);
  s.supply_off();
  s.power_on();
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1000, 0x0005).expect(1004, 0);
  // An announced entry is none of that; nor are bytes after the count.
  EXPECT_EQ(write_concise_dcf(s, 3), 0U);
  EXPECT_EQ(write_concise_dcf(s, 3, {1, 0, 0, 0}), 0x06010002U);
  EXPECT_EQ(write_concise_dcf(s, 3, {0, 0, 0, 0, 0}), 0x06010002U);
  // With sixty files, an empty one is no sixty-first.
  for (std::uint16_t sub = 10; sub < 69; ++sub) {
    EXPECT_EQ(write_concise_dcf(s, sub), 0U);
  }
  EXPECT_EQ(write_concise_dcf(s, 100), 0x08000020U);
  EXPECT_EQ(write_concise_dcf(s, 100, empty), 0U);
}

// Each of the three groups has a way of its own to be saved, which saves nothing of the others.
TEST_P(ConciseDcf, ThreeGroupsOfData_AreSavedSeparately) {
  spec("ME3-SYS-013 ME3-STO-003", "");
  for (const int way : {0, 1, 2, 3}) {
    IntelligentScenario s(GetParam());
    s.power_on();
    s.write(70, 1000);
    s.set_object(0x1015, 0, 5, 2);
    if (way == 1) s.save();
    if (way == 2) s.store_objects();
    if (way == 3) write_concise_dcf(s, 2);
    s.supply_off();
    s.power_on();
    s.expect(70, way == 1 ? 1000 : 500);
    s.expect_object(0x1015, 0, way == 2 ? 5 : 0, 2);
    s.cif({0x0004, 0, 0x1F22, 2});
    s.expect(1000, 0x0005).expect(1004, way == 3 ? 13 : 0).no_tx();
  }
}

TEST_P(ConciseDcf, SixtyFiles_AndNotOneMore) {
  spec("ME3-CFG-002", "RJ71-CM-004");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (std::uint16_t sub = 68; sub <= 127; ++sub) {
    EXPECT_EQ(write_concise_dcf(s, sub), 0U);
  }
  EXPECT_EQ(write_concise_dcf(s, 1), 0x08000020U);
  for (std::uint16_t sub = 1; sub <= 127; ++sub) {
    s.cif({0x0004, 0, 0x1F22, sub});
    s.expect(1000, {0x0005, 0, 0x1F22, sub, sub >= 68 ? std::uint16_t{13} : std::uint16_t{0}});
  }
  for (const std::uint16_t sub : Words{0x80, 0xFF}) s.cif({0x0004, 0, 0x1F22, sub}).expect_abort(0x06090011);
  // One deleted makes room for one.
  EXPECT_EQ(write_concise_dcf(s, 100, {0}), 0U);
  s.advance(2s);
  EXPECT_EQ(write_concise_dcf(s, 1), 0U);
  EXPECT_EQ(write_concise_dcf(s, 2), 0x08000020U);
  s.supply_off();
  s.power_on();
  s.cif({0x0004, 0, 0x1F22, 1});
  s.expect(1004, 13);
  s.cif({0x0004, 0, 0x1F22, 100});
  s.expect(1000, 0x0005).expect(1004, 0);
}

// 1F22:02 is written to the flash memory with the write, and 60 files of 65531 bytes have room.
TEST_P(ConciseDcf, SixtyFilesOfTheGreatestLength) {
  spec("ME3-CFG-002 ME3-CFG-003 ME3-CFG-005", "RJ71-CM-004");
  IntelligentScenario s(GetParam());
  s.power_on();
  Bytes content(65531, 0xA5);
  content[0] = content[1] = content[2] = content[3] = 0;  // no entries
  const auto download_whole = [&](std::uint8_t sub) {
    s.rx(0x67F, {0x21, 0x22, 0x1F, sub, 0xFB, 0xFF, 0x00, 0x00})
        .tx(0x5FF, {0x60, 0x22, 0x1F, sub, 0, 0, 0, 0});
    for (std::size_t sent = 0, segment = 0; sent < content.size(); sent += 7, ++segment) {
      const std::size_t bytes = std::min<std::size_t>(7, content.size() - sent);
      Bytes frame(8, 0);
      frame[0] = static_cast<std::uint8_t>(segment % 2 * 0x10 | (7 - bytes) << 1 |
                                           (sent + bytes == content.size() ? 1 : 0));
      std::copy_n(content.begin() + static_cast<std::ptrdiff_t>(sent), bytes, frame.begin() + 1);
      s.rx(0x67F, frame);
    }
    s.ignore_tx();
  };
  for (std::uint8_t sub = 1; sub <= 60; ++sub) {
    content[4] = sub;
    download_whole(sub);
  }
  EXPECT_EQ(write_concise_dcf(s, 61), 0x08000020U);
  const auto upload_whole = [&](std::uint8_t sub) {
    s.rx(0x67F, {0x40, 0x22, 0x1F, sub, 0, 0, 0, 0})
        .tx(0x5FF, {0x41, 0x22, 0x1F, sub, 0xFB, 0xFF, 0x00, 0x00});
    Bytes received;
    for (std::uint8_t toggle = 0;; toggle ^= 0x10) {
      s.rx(0x67F, {static_cast<std::uint8_t>(0x60 | toggle), 0, 0, 0, 0, 0, 0, 0});
      const can::Frame& frame = s.controller().sent.back();
      received.insert(received.end(), frame.data.begin() + 1, frame.data.end() - (frame.data[0] >> 1 & 7));
      if ((frame.data[0] & 0xE1) != 0) break;  // the last segment, or an abort
      s.ignore_tx();
    }
    s.ignore_tx();
    return received;
  };
  s.supply_off();
  s.power_on();
  s.expect(29, 0).ignore_tx();
  for (std::uint8_t sub = 1; sub <= 60; ++sub) {
    content[4] = sub;
    EXPECT_TRUE(upload_whole(sub) == content) << int{sub};
  }
}

TEST_P(ConciseDcf, RestoreDefaults_DeletesAllAtTheRestart) {
  spec("ME3-STO-006", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  EXPECT_EQ(write_concise_dcf(s, 2), 0U);
  EXPECT_EQ(write_concise_dcf(s, 3), 0U);
  s.set_object(0x1011, 1, 0x64616F6C, 4);
  s.cif({0x0004, 0, 0x1F22, 3});
  s.expect(1004, 13);  // not before
  s.restart();
  for (const std::uint16_t sub : Words{2, 3}) {
    s.cif({0x0004, 0, 0x1F22, sub});
    s.expect(1000, 0x0005).expect(1004, 0);
  }
  s.supply_off();
  s.power_on();
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1004, 0);
}

TEST_P(ConciseDcf, S79_ConfigurationRequest) {
  spec("ME3-CFG-008 ME3-CFG-012 ME3-CFG-013 ME3-CFG-014", "RJ71-CM-003 RJ71-CM-008");
  IntelligentScenario s(GetParam());
  s.power_on_as_master();
  EXPECT_EQ(write_concise_dcf(s, 1), 0U);  // for the own node: never executed
  EXPECT_EQ(write_concise_dcf(s, 2), 0U);
  EXPECT_EQ(write_concise_dcf(s, 3), 0U);
  const Words conf{4, 0x6F63, 0x666E};
  const auto request = [&](std::uint16_t sub) {
    return Words{0x0002, 0, 0x1F25, sub, conf[0], conf[1], conf[2]};
  };
  s.cif(request(1));
  s.expect(1000, 0x0003).no_tx();
  s.cif(request(4)).expect_abort(0x08000024);
  s.no_tx();
  s.cif({0x0002, 0, 0x1F25, 2, 4, 0x6F63, 0x666F});
  s.expect(1000, {0x000F, 0x0003}).no_tx();
  s.cif(request(2));
  s.expect(1000, 0x0003);
  s.tx(0x602, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0}).no_tx();
  s.rx(0x582, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0}).no_tx();
  s.cif(request(0x80));
  s.expect(1000, 0x0003);
  s.tx(0x602, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0});
  s.tx(0x603, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0}).no_tx();
  s.rx(0x582, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  s.rx(0x583, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0}).no_tx();
}

// Whatever its length, an object goes expedited or segmented: the manual knows no block transfer.
TEST_P(ConciseDcf, LongEntries_GoSegmented) {
  spec("ME3-SDO-003 ME3-CFG-012", "RJ71-CM-003");
  IntelligentScenario s(GetParam());
  s.power_on_as_master();
  Bytes file{1, 0, 0, 0, 0x00, 0x20, 0x01, 100, 0, 0, 0};
  file.resize(111);
  EXPECT_EQ(write_concise_dcf(s, 2, file), 0U);
  s.cif({0x0002, 0, 0x1F25, 2, 4, 0x6F63, 0x666E});
  s.expect(1000, 0x0003);
  s.tx(0x602, {0x21, 0x00, 0x20, 0x01, 100, 0, 0, 0}).rx(0x582, {0x60, 0x00, 0x20, 0x01, 0, 0, 0, 0});
  for (unsigned segment = 0; segment < 15; ++segment) {
    const unsigned toggle = segment % 2 * 0x10;
    s.tx(0x602, {static_cast<std::uint8_t>(segment == 14 ? 0x0B | toggle : toggle), 0, 0, 0, 0, 0, 0, 0});
    s.rx(0x582, {static_cast<std::uint8_t>(0x20 | toggle), 0, 0, 0, 0, 0, 0, 0});
  }
  s.no_tx();
}

// Restored is what was written to the flash memory: nothing, when it could not be.
TEST_P(ConciseDcf, RestoreThatCannotBeWritten_DeletesNothing) {
  IntelligentScenario s(GetParam());
  s.power_on();
  EXPECT_EQ(write_concise_dcf(s, 2), 0U);
  s.set_object(0x1015, 0, 5, 2);
  s.store_objects();
  s.flash().writable = false;
  s.cif({0x0002, 0, 0x1011, 1, 4, 0x6F6C, 0x6461}).expect_abort(0x06060000);
  s.flash().writable = true;
  s.restart();
  s.expect_object(0x1015, 0, 5, 2);
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1000, 0x0005).expect(1004, 13);
}

// A file that is on its way to its node is not taken away under it.
TEST_P(ConciseDcf, FileInUse_IsNotDeleted) {
  spec("ME3-CFG-006 ME3-CFG-007", "RJ71-CM-005");
  IntelligentScenario s(GetParam());
  s.power_on_as_master();
  EXPECT_EQ(write_concise_dcf(s, 2), 0U);
  EXPECT_EQ(write_concise_dcf(s, 3), 0U);
  s.cif({0x0002, 0, 0x1F25, 2, 4, 0x6F63, 0x666E});
  s.expect(1000, 0x0003).tx(0x602, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0}).no_tx();
  EXPECT_EQ(write_concise_dcf(s, 2, {0}), 0x06060000U);
  s.rx(0x582, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0}).no_tx();
  EXPECT_EQ(write_concise_dcf(s, 2, {0}), 0U);
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1000, 0x0005).expect(1004, 0);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_concise_dcf_test
