// ISO 16845-1 clause 7: the IUT receives.

#include "conformance/iso16845/lower_tester.hpp"

namespace canopus::sim::iso16845::received_frame_test {
namespace {

// --- 7.1 Valid frame format

TEST(Iso16845_7_1_ValidFrame, BaseFormat_EveryIdentifierBitAndLength) {
  for (unsigned dlc = 0; dlc <= 8; ++dlc) {
    for (const std::uint32_t identifier : {0x000U, 0x7FFU, 0x555U, 0x2AAU, 0x001U, 0x400U, 0x123U}) {
      Frame frame{.identifier = identifier, .dlc = static_cast<std::uint8_t>(dlc)};
      for (unsigned byte = 0; byte < dlc; ++byte)
        frame.data[byte] = static_cast<std::uint8_t>(0x3C + 37 * byte);
      LowerTester lt;
      const std::string wire = can::slow::wire(frame);
      lt.run(wire);
      EXPECT_THAT(lt.iut.frames(), ElementsAre(frame));
      EXPECT_EQ(lt.dominant(), std::to_string(wire.size() - 9));  // the ACK slot, and nothing else
      EXPECT_EQ(lt.rec(), 0);
    }
  }
}

TEST(Iso16845_7_1_ValidFrame, ExtendedFormat_EveryIdentifierBitAndLength) {
  for (unsigned dlc = 0; dlc <= 8; ++dlc) {
    for (const std::uint32_t identifier : {0x0U, 0x1FFFFFFFU, 0x15555555U, 0x0AAAAAAAU, 0x1U, 0x10000000U}) {
      Frame frame{.identifier = identifier, .extended = true, .dlc = static_cast<std::uint8_t>(dlc)};
      for (unsigned byte = 0; byte < dlc; ++byte)
        frame.data[byte] = static_cast<std::uint8_t>(0xF0 + 11 * byte);
      LowerTester lt;
      const std::string wire = can::slow::wire(frame);
      lt.run(wire);
      EXPECT_THAT(lt.iut.frames(), ElementsAre(frame));
      EXPECT_EQ(lt.dominant(), std::to_string(wire.size() - 9));
    }
  }
}

TEST(Iso16845_7_1_ValidFrame, RemoteFramesOfEveryDlc) {
  for (unsigned dlc = 0; dlc <= 8; ++dlc) {
    const Frame frame = can::remote_frame(0x321, static_cast<std::uint8_t>(dlc));
    LowerTester lt;
    lt.run(can::slow::wire(frame));
    EXPECT_THAT(lt.iut.frames(), ElementsAre(frame));
  }
}

TEST(Iso16845_7_1_ValidFrame, AfterArbitrationLost) {
  // The IUT sends 123H and loses at the third bit of the identifier (recessive) against 000...
  const Frame winner = data_frame(0x0AB, {1, 2});
  const std::string wire = can::slow::wire(winner);
  LowerTester lt;
  lt.run(wire + "111", {frame_of_53_bits}, 10);
  EXPECT_THAT(lt.iut.frames(), ElementsAre(winner));
  EXPECT_EQ(lt.driven(static_cast<int>(wire.size()) - 9, static_cast<int>(wire.size()) - 8), "0");
  EXPECT_EQ(lt.driven(static_cast<int>(wire.size()) + 3, static_cast<int>(wire.size()) + 4),
            "0");  // its own SOF
}

TEST(Iso16845_7_1_ValidFrame, NonNominalReservedBits_AreAccepted) {
  // r0 of a base frame, r1 and r0 of an extended one recessive, CRC and stuff bits made for them.
  const auto wire_of = [](std::string bits) {
    can::slow::append(bits, can::slow::crc(bits), 15);
    return can::slow::stuffed(bits) + "1111111111";
  };
  std::string base = can::slow::before_crc(frame_of_53_bits);
  base[14] = '1';
  LowerTester lt;
  lt.run(wire_of(base));
  // CAN FD's FDF bit: a classical controller of ISO 11898-1:2003 accepts it either way.
  EXPECT_THAT(lt.iut.frames(), ElementsAre(frame_of_53_bits));

  const Frame extended{.identifier = 0x1234567, .extended = true, .dlc = 1, .data = {0x55}};
  for (const std::size_t reserved : {33U, 34U}) {
    std::string bits = can::slow::before_crc(extended);
    bits[reserved] = '1';
    LowerTester other;
    other.run(wire_of(bits));
    EXPECT_THAT(other.iut.frames(), ElementsAre(extended)) << reserved;
  }
}

TEST(Iso16845_7_1_ValidFrame, DominantSrrOfAnExtendedFrame_IsAccepted) {
  const Frame extended{.identifier = 0x1234567, .extended = true, .dlc = 1, .data = {0x55}};
  std::string bits = can::slow::before_crc(extended);
  bits[12] = '0';
  can::slow::append(bits, can::slow::crc(bits), 15);
  LowerTester lt;
  lt.run(can::slow::stuffed(bits) + "1111111111");
  EXPECT_THAT(lt.iut.frames(), ElementsAre(extended));
}

TEST(Iso16845_7_1_ValidFrame, DlcGreaterThan8_MeansEightBytes) {
  for (std::uint8_t dlc = 9; dlc <= 15; ++dlc) {
    const Frame frame{.identifier = 0x123, .dlc = dlc, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
    LowerTester lt;
    lt.run(can::slow::wire(frame));
    EXPECT_THAT(lt.iut.frames(), ElementsAre(frame));
  }
}

TEST(Iso16845_7_1_ValidFrame, WithoutBusIdle_TheNextFrameFollowsTheIntermission) {
  LowerTester lt;
  lt.run(wire_of_53_bits + "111" + wire_of_53_bits);
  EXPECT_EQ(lt.iut.heard.size(), 2U);
  EXPECT_EQ(lt.dominant(), "44 100");
}

TEST(Iso16845_7_1_ValidFrame, StuffBitsOfEveryKind_AreAccepted) {
  for (const int byte : {0x00, 0xFF, 0x0F, 0xF0, 0x1F, 0xE0, 0x87, 0x78}) {
    Frame frame{.identifier = 0x078, .dlc = 8};
    frame.data.fill(static_cast<std::uint8_t>(byte));
    LowerTester lt;
    lt.run(can::slow::wire(frame));
    EXPECT_THAT(lt.iut.frames(), ElementsAre(frame)) << byte;
  }
}

TEST(Iso16845_7_1_ValidFrame, IsValidAtTheLastButOneBitOfEof) {
  LowerTester lt;
  lt.run(with(wire_of_53_bits, 52, '0'));
  EXPECT_THAT(lt.iut.frames(), ElementsAre(frame_of_53_bits));
  EXPECT_EQ(lt.dominant(), "44 53-58");  // overload flag
  EXPECT_EQ(lt.rec(), 0);
}

// --- 7.2 Error detection

TEST(Iso16845_7_2_ErrorDetection, BitError_OfTheAckSlot) {
  LowerTester lt;
  lt.run(with(wire_of_53_bits, 44, 'R'));
  EXPECT_EQ(lt.dominant(), "44-50");  // its ACK, which nobody sees, and the flag
  EXPECT_THAT(lt.iut.frames(), IsEmpty());
  EXPECT_EQ(lt.rec(), 1);
}

TEST(Iso16845_7_2_ErrorDetection, StuffError_AtEveryStuffBit_BaseAndExtended) {
  for (const bool extended : {false, true}) {
    const Frame frame{.identifier = 0x078, .extended = extended, .dlc = 8};
    const std::string bits = can::slow::wire(frame);
    std::size_t row = 0;
    char last = 'x';
    std::size_t checked = 0;
    for (std::size_t bit = 0; bit + 10 < bits.size(); ++bit) {
      if (row == 5) {  // this one is a stuff bit: make it equal
        LowerTester lt;
        lt.run(bits.substr(0, bit) + last);
        const int at = static_cast<int>(bit);
        EXPECT_EQ(lt.dominant(), std::to_string(at + 1) + "-" + std::to_string(at + 6)) << bit;
        EXPECT_EQ(lt.rec(), 1);
        EXPECT_THAT(lt.iut.frames(), IsEmpty());
        ++checked;
      }
      row = bits[bit] == last ? row + 1 : 1;
      last = bits[bit];
    }
    EXPECT_GT(checked, 10U);
  }
}

TEST(Iso16845_7_2_ErrorDetection, CrcError_OfEachBitOfTheSequence) {
  for (std::size_t bit = 28; bit <= 42; ++bit) {
    std::string bits = can::slow::before_crc(frame_of_53_bits);
    can::slow::append(bits, can::slow::crc(bits) ^ 1U << (42 - bit), 15);
    const std::string wire = can::slow::stuffed(bits);
    LowerTester lt;
    lt.run(wire + "101");  // CRC delimiter, an ACK slot that another one drives, ACK delimiter
    const int flag = static_cast<int>(wire.size()) + 3;
    EXPECT_EQ(lt.dominant(), std::to_string(flag) + "-" + std::to_string(flag + 5)) << bit;
    EXPECT_EQ(lt.rec(), 1);
    EXPECT_THAT(lt.iut.frames(), IsEmpty());
  }
}

TEST(Iso16845_7_2_ErrorDetection, CrcErrorAndFormError_TheFormErrorOfTheCrcDelimiterComesFirst) {
  std::string bits = can::slow::before_crc(frame_of_53_bits);
  can::slow::append(bits, can::slow::crc(bits) ^ 2U, 15);
  const std::string wire = can::slow::stuffed(bits);
  LowerTester lt;
  lt.run(wire + "0");
  const int flag = static_cast<int>(wire.size()) + 1;
  EXPECT_EQ(lt.dominant(), std::to_string(flag) + "-" + std::to_string(flag + 5));
  EXPECT_EQ(lt.rec(), 1);  // one error, not two
}

TEST(Iso16845_7_2_ErrorDetection, FormError_OfTheCrcDelimiter) {
  LowerTester lt;
  lt.run(with(wire_of_53_bits.substr(0, 44), 43, '0'));
  EXPECT_EQ(lt.dominant(), "44-49");
  EXPECT_EQ(lt.rec(), 1);
}

TEST(Iso16845_7_2_ErrorDetection, FormError_OfTheAckDelimiter) {
  LowerTester lt;
  lt.run(with(wire_of_53_bits.substr(0, 46), 45, '0'));
  EXPECT_EQ(lt.dominant(), "44 46-51");
  EXPECT_THAT(lt.iut.frames(), IsEmpty());
  EXPECT_EQ(lt.rec(), 1);
}

TEST(Iso16845_7_2_ErrorDetection, FormError_OfEachBitOfEofButTheLast_InvalidatesTheFrame) {
  for (int bit = 46; bit <= 51; ++bit) {
    LowerTester lt;
    lt.run(wire_of_53_bits.substr(0, static_cast<std::size_t>(bit)) + "0");
    EXPECT_EQ(lt.dominant(), "44 " + std::to_string(bit + 1) + "-" + std::to_string(bit + 6));
    EXPECT_THAT(lt.iut.frames(), IsEmpty()) << bit;
    EXPECT_EQ(lt.rec(), 1);
  }
}

// --- 7.3 Active error frame management

/// A stuff error at bit 5, with what comes after the IUT's flag of bits 6 to 11.
const std::string stuff_error = "000000";

TEST(Iso16845_7_3_ActiveErrorFrame, FlagLongerThan6Bits_DelimiterBeginsAfterIt) {
  for (const int longer : {1, 4, 7}) {
    LowerTester lt;
    lt.run(stuff_error + "111111" + times(static_cast<std::size_t>(longer), "0") + "11111111" + "111" +
           wire_of_53_bits);
    EXPECT_THAT(lt.iut.frames(), ElementsAre(frame_of_53_bits)) << longer;
    EXPECT_EQ(lt.dominant(0, 20 + longer), "6-11");
  }
}

TEST(Iso16845_7_3_ActiveErrorFrame, DataFrameOnTheThirdBitOfIntermission_IsReceived) {
  LowerTester lt;
  lt.run(stuff_error +
         "111111"
         "11111111"
         "11" +
         wire_of_53_bits);
  EXPECT_THAT(lt.iut.frames(), ElementsAre(frame_of_53_bits));
}

TEST(Iso16845_7_3_ActiveErrorFrame, BitErrorInTheFlag_BeginsAnotherFlag) {
  for (int bit = 6; bit <= 11; ++bit) {
    LowerTester lt;
    lt.run(stuff_error + times(static_cast<std::size_t>(bit - 6), "1") + "R");
    EXPECT_EQ(lt.dominant(), "6-" + std::to_string(bit + 6));
    EXPECT_EQ(lt.rec(), 9);  // rules a and e
  }
}

TEST(Iso16845_7_3_ActiveErrorFrame, FormErrorInTheDelimiter_IsAnotherErrorFrame) {
  for (int bit = 2; bit <= 7; ++bit) {  // of the delimiter, from 1
    LowerTester lt;
    lt.run(stuff_error + "111111" + times(static_cast<std::size_t>(bit - 1), "1") + "0");
    const int flag = 12 + bit;
    EXPECT_EQ(lt.dominant(), "6-11 " + std::to_string(flag) + "-" + std::to_string(flag + 5)) << bit;
    EXPECT_EQ(lt.rec(), 2) << bit;
  }
}

// --- 7.4 Overload frame management

TEST(Iso16845_7_4_Overload, InTheFirstTwoBitsOfTheIntermission) {
  for (const std::size_t bit : {1U, 2U}) {
    LowerTester lt;
    lt.run(wire_of_53_bits + times(bit - 1, "1") + "0");
    const int flag = 53 + static_cast<int>(bit);
    EXPECT_EQ(lt.dominant(), "44 " + std::to_string(flag) + "-" + std::to_string(flag + 5));
    EXPECT_EQ(lt.rec(), 0);
    EXPECT_THAT(lt.iut.frames(), ElementsAre(frame_of_53_bits));
  }
}

TEST(Iso16845_7_4_Overload, AtTheEighthBitOfAnErrorDelimiter_AndOfAnOverloadDelimiter) {
  LowerTester lt;
  lt.run(stuff_error +
         "111111"
         "1111111"
         "0"
         "111111"
         "1111111"
         "0");
  // delimiter 12-19; overload flag 20-25, its delimiter 26-33, overload flag 34-39
  EXPECT_EQ(lt.dominant(), "6-11 20-25 34-39");
  EXPECT_EQ(lt.rec(), 1);
}

TEST(Iso16845_7_4_Overload, BitErrorInTheFlag_IsAnErrorFrame) {
  LowerTester lt;
  lt.run(wire_of_53_bits +
         "0"
         "1R");  // flag from 54, its second bit seen recessive
  EXPECT_EQ(lt.dominant(), "44 54-61");
  EXPECT_EQ(lt.rec(), 8);  // rule e
}

TEST(Iso16845_7_4_Overload, FormErrorInTheDelimiter_IsAnErrorFrame) {
  LowerTester lt;
  lt.run(wire_of_53_bits +
         "0"
         "111111"
         "110");  // flag 54-59, delimiter from 60
  EXPECT_EQ(lt.dominant(), "44 54-59 63-68");
  EXPECT_EQ(lt.rec(), 1);
}

TEST(Iso16845_7_4_Overload, InTheIntermissionAfterAnErrorFrame) {
  LowerTester lt;
  lt.run(stuff_error +
         "111111"
         "11111111"
         "0");
  EXPECT_EQ(lt.dominant(), "6-11 21-26");
  EXPECT_EQ(lt.rec(), 1);
}

// --- 7.5 Passive error state

TEST(Iso16845_7_5_Passive, AnErrorPassiveReceiver_SendsAPassiveFlag) {
  LowerTester lt;
  lt.run(to_passive_receiver + stuff_error +
         "111111"
         "11111111"
         "111");
  EXPECT_EQ(lt.dominant(360, 400), "");
  EXPECT_EQ(lt.iut.port.error_state(), ErrorState::error_passive);
}

TEST(Iso16845_7_5_Passive, TheErrorThatMakesItPassive_IsStillSignalledActive) {
  LowerTester lt;
  lt.run(times(14, nine_receive_errors) + times(1, nine_receive_errors));
  EXPECT_EQ(lt.dominant(14 * 24, 15 * 24), std::to_string(14 * 24 + 6) + "-" + std::to_string(14 * 24 + 11));
  EXPECT_EQ(lt.rec(), 135);
}

TEST(Iso16845_7_5_Passive, ItsFlag_IsCompleteAfterSixEqualBits) {
  // Recessive from the start: 366-371, delimiter 372-379, intermission 380-382, a frame from 383.
  LowerTester recessive;
  recessive.run(to_passive_receiver + stuff_error +
                "111111"
                "11111111"
                "111" +
                wire_of_53_bits);
  EXPECT_THAT(recessive.iut.frames(), ElementsAre(frame_of_53_bits));
  // A recessive bit, then six dominant ones: complete with the sixth.
  LowerTester dominant;
  dominant.run(to_passive_receiver + stuff_error +
               "1"
               "000000"
               "11111111"
               "111" +
               wire_of_53_bits);
  EXPECT_THAT(dominant.iut.frames(), ElementsAre(frame_of_53_bits));
}

TEST(Iso16845_7_5_Passive, SevenDominantBitsAfterThePassiveFlag_AreTolerated) {
  LowerTester lt;
  lt.run(to_passive_receiver + stuff_error + "111111" + "0000000" +
         "11111111"
         "111" +
         wire_of_53_bits);
  EXPECT_THAT(lt.iut.frames(), ElementsAre(frame_of_53_bits));
}

TEST(Iso16845_7_5_Passive, AValidFrame_BringsItBackTo127AtMost) {
  LowerTester lt;
  lt.run(to_passive_receiver + wire_of_53_bits);
  EXPECT_THAT(lt.iut.frames(), ElementsAre(frame_of_53_bits));
  EXPECT_GE(lt.rec(), 119);  // rule h
  EXPECT_LE(lt.rec(), 127);
  EXPECT_EQ(lt.iut.port.error_state(), ErrorState::error_active);
}

// --- 7.6 Error counter management

/// REC after these bits.
int rec_after(const std::string& bits) {
  LowerTester lt;
  lt.run(bits);
  return lt.rec();
}

TEST(Iso16845_7_6_Rec, RuleB_ADominantBitAfterTheFlag) {
  EXPECT_EQ(rec_after(stuff_error + "111111"
                                    "0"),
            9);
  EXPECT_EQ(rec_after(stuff_error + "111111"
                                    "1"),
            1);
}

TEST(Iso16845_7_6_Rec, RuleF_ActiveFlagFollowedByManyDominantBits) {
  // 1, and 8 for the first bit after the flag; the eighth consecutive dominant bit after it adds 8, every further eight too.
  EXPECT_EQ(rec_after(stuff_error + "111111" + times(7, "0")), 9);
  EXPECT_EQ(rec_after(stuff_error + "111111" + times(8, "0")), 17);
  EXPECT_EQ(rec_after(stuff_error + "111111" + times(15, "0")), 17);
  EXPECT_EQ(rec_after(stuff_error + "111111" + times(16, "0")), 25);
}

TEST(Iso16845_7_6_Rec, RuleF_OverloadFlagFollowedByManyDominantBits) {
  EXPECT_EQ(rec_after(wire_of_53_bits +
                      "0"
                      "111111" +
                      times(7, "0")),
            0);
  EXPECT_EQ(rec_after(wire_of_53_bits +
                      "0"
                      "111111" +
                      times(8, "0")),
            8);
  EXPECT_EQ(rec_after(wire_of_53_bits +
                      "0"
                      "111111" +
                      times(16, "0")),
            16);
}

TEST(Iso16845_7_6_Rec, RuleH_AValidFrameTakesOneBack) {
  EXPECT_EQ(rec_after(nine_receive_errors + wire_of_53_bits), 8);
  EXPECT_EQ(rec_after(nine_receive_errors + wire_of_53_bits + "111" + wire_of_53_bits), 7);
  EXPECT_EQ(rec_after(wire_of_53_bits), 0);
}

TEST(Iso16845_7_6_Rec, LastBitOfADelimiter_IsNoError) {
  EXPECT_EQ(rec_after(stuff_error + "111111"
                                    "1111111"
                                    "0"),
            1);
  EXPECT_EQ(rec_after(wire_of_53_bits + "0"
                                        "111111"
                                        "1111111"
                                        "0"),
            0);
}

TEST(Iso16845_7_6_Rec, ErrorsOfAPassiveReceiver_LeaveItPassive) {
  LowerTester lt;
  lt.run(to_passive_receiver + times(10, stuff_error + "111111"
                                                       "11111111"
                                                       "111"));
  EXPECT_EQ(lt.iut.port.error_state(), ErrorState::error_passive);
  EXPECT_GT(lt.rec(), 127);
}

}  // namespace
}  // namespace canopus::sim::iso16845::received_frame_test
