// ISO 16845-1 clause 8: the IUT transmits.

#include "conformance/iso16845/lower_tester.hpp"

namespace canopus::sim::iso16845::transmitted_frame_test {
namespace {

/// Frame of 53 bits with its acknowledgement by the lower tester, from bit 0.
const std::string acknowledged = times(44, "1") + "0" + times(8, "1");

// --- 8.1 Valid frame format

TEST(Iso16845_8_1_ValidFrame, EveryBitOfAFrame_AndItsConfirmation) {
  for (unsigned dlc = 0; dlc <= 8; ++dlc) {
    for (const bool extended : {false, true}) {
      Frame frame{.identifier = 0x078, .extended = extended, .dlc = static_cast<std::uint8_t>(dlc)};
      for (unsigned byte = 0; byte < dlc; ++byte) frame.data[byte] = static_cast<std::uint8_t>(0xE0 >> byte);
      const std::string wire = can::slow::wire(frame);
      LowerTester lt;
      lt.run(with(times(wire.size(), "1"), wire.size() - 9, '0'), {frame});
      EXPECT_EQ(lt.driven(0, static_cast<int>(wire.size()) + 30), wire + times(30, "1"));
      EXPECT_EQ(lt.iut.sent.size(), 1U);
      EXPECT_EQ(lt.tec(), 0);
    }
  }
}

TEST(Iso16845_8_1_ValidFrame, ArbitrationLostAtEachRecessiveBitOfTheIdentifier) {
  const std::string wire = can::slow::wire(frame_of_53_bits);
  for (int bit = 1; bit <= 11; ++bit) {
    if (wire[static_cast<std::size_t>(bit)] == '0') continue;
    LowerTester lt;
    lt.run(with(times(53, "1"), static_cast<std::size_t>(bit), '0')
                   .substr(0, static_cast<std::size_t>(bit) + 1) +
               "1010",
           {frame_of_53_bits}, 0);
    // From the lost bit on it drives nothing: neither its identifier nor an error flag.
    EXPECT_EQ(lt.dominant(bit, bit + 5), "") << bit;
    EXPECT_EQ(lt.tec(), 0);
  }
}

TEST(Iso16845_8_1_ValidFrame, IsRepeatedAfterLostArbitration) {
  const Frame winner = data_frame(0x0AB);
  const std::string wire = can::slow::wire(winner);
  LowerTester lt;
  lt.run(wire + "111" + times(44, "1") + "0" + times(8, "1"), {frame_of_53_bits});
  EXPECT_EQ(lt.iut.sent.size(), 1U);
  EXPECT_THAT(lt.iut.frames(), ElementsAre(winner));
}

TEST(Iso16845_8_1_ValidFrame, OnTheThirdBitOfIntermission_ItJoinsWithItsIdentifier) {
  // The lower tester's SOF in bit 55; the IUT, with a frame to send, goes on with the identifier at once.
  LowerTester lt;
  lt.run(acknowledged + "11" + "0", {frame_of_53_bits, frame_of_53_bits}, 20);
  EXPECT_EQ(lt.driven(55, 55 + 12), "1" + can::slow::wire(frame_of_53_bits).substr(1, 11));
}

// --- 8.2 Error detection

TEST(Iso16845_8_2_ErrorDetection, BitError_OfEachDominantBit) {
  const std::string wire = can::slow::wire(frame_of_53_bits);
  for (std::size_t bit = 0; bit < 43; ++bit) {
    if (wire[bit] == '1') continue;
    LowerTester lt;
    lt.run(times(bit, "1") + "R", {frame_of_53_bits}, 7);
    const int at = static_cast<int>(bit);
    EXPECT_EQ(lt.driven(at + 1, at + 8), "0000001") << bit;
    EXPECT_EQ(lt.tec(), 8);
  }
}

TEST(Iso16845_8_2_ErrorDetection, BitError_OfEachRecessiveBitAfterArbitration) {
  const std::string wire = can::slow::wire(frame_of_53_bits);
  for (std::size_t bit = 13; bit < 43; ++bit) {
    if (wire[bit] == '0') continue;
    LowerTester lt;
    lt.run(times(bit, "1") + "0", {frame_of_53_bits}, 7);
    const int at = static_cast<int>(bit);
    EXPECT_EQ(lt.driven(at + 1, at + 8), "0000001") << bit;
    EXPECT_EQ(lt.tec(), 8);
  }
}

TEST(Iso16845_8_2_ErrorDetection, FormError_OfDelimitersAndEof) {
  for (const std::size_t bit : {43U, 45U, 46U, 47U, 48U, 49U, 50U, 51U}) {
    LowerTester lt;
    lt.run(with(acknowledged, bit, '0').substr(0, bit + 1), {frame_of_53_bits}, 7);
    const int at = static_cast<int>(bit);
    EXPECT_EQ(lt.driven(at + 1, at + 8), "0000001") << bit;
    EXPECT_EQ(lt.tec(), 8);
    EXPECT_EQ(lt.iut.sent.size(), 0U);
  }
}

TEST(Iso16845_8_2_ErrorDetection, AcknowledgementError) {
  LowerTester lt;
  lt.run(times(45, "1"), {frame_of_53_bits}, 7);
  EXPECT_EQ(lt.driven(44, 52), "10000001");
  EXPECT_EQ(lt.tec(), 8);
}

TEST(Iso16845_8_2_ErrorDetection, AfterAnError_TheFrameIsRepeated) {
  // Error at bit 14: flag 15-20, delimiter 21-28, intermission 29-31, SOF at 32.
  LowerTester lt;
  lt.run(times(14, "1") + "R" + times(17, "1") + acknowledged, {frame_of_53_bits});
  EXPECT_EQ(lt.driven(21, 33), "111111111110");
  EXPECT_EQ(lt.iut.sent.size(), 1U);
  EXPECT_EQ(lt.tec(), 7);  // 8, and rule g
}

// --- 8.3 Active error frame management

TEST(Iso16845_8_3_ActiveErrorFrame, FlagLongerThan6Bits_DelaysTheRepetition) {
  LowerTester lt;
  lt.run(times(14, "1") + "R" + "111111" + "000" + times(11, "1") + acknowledged, {frame_of_53_bits});
  EXPECT_EQ(lt.driven(21, 36), "111111111111110");  // three bits later than without
  EXPECT_EQ(lt.tec(), 7);
}

TEST(Iso16845_8_3_ActiveErrorFrame, BitErrorInTheFlag_BeginsAnotherFlag) {
  for (int bit = 15; bit <= 20; ++bit) {
    LowerTester lt;
    lt.run(times(14, "1") + "R" + times(static_cast<std::size_t>(bit - 15), "1") + "R", {frame_of_53_bits},
           7);
    EXPECT_EQ(lt.driven(bit + 1, bit + 8), "0000001") << bit;
    EXPECT_EQ(lt.tec(), 16);  // rules c and d
  }
}

TEST(Iso16845_8_3_ActiveErrorFrame, FormErrorInTheDelimiter_IsAnotherErrorFrame) {
  LowerTester lt;
  lt.run(times(14, "1") + "R" + "111111" + "1110", {frame_of_53_bits}, 7);
  EXPECT_EQ(lt.driven(25, 32), "0000001");
  EXPECT_EQ(lt.tec(), 16);
}

// --- 8.4 Overload frame management

TEST(Iso16845_8_4_Overload, InTheIntermission_DelaysTheNextFrame) {
  for (const std::size_t bit : {1U, 2U}) {
    LowerTester lt;
    lt.run(acknowledged + "111", {frame_of_53_bits}, 0);
    LowerTester delayed;
    delayed.run(acknowledged + times(bit - 1, "1") + "0" + times(17, "1"),
                {frame_of_53_bits, frame_of_53_bits}, 3);
    const int flag = 53 + static_cast<int>(bit);
    EXPECT_EQ(delayed.driven(flag, flag + 18),
              "000000"
              "11111111"
              "111"
              "0");
    EXPECT_EQ(delayed.tec(), 0);
  }
}

TEST(Iso16845_8_4_Overload, BitErrorInTheFlag_IsAnErrorOfItsFormerTransmitter) {
  LowerTester lt;
  lt.run(acknowledged +
             "0"
             "1R",
         {frame_of_53_bits}, 7);
  EXPECT_EQ(lt.driven(56, 63), "0000001");
  EXPECT_EQ(lt.tec(), 8);
}

// --- 8.5 Passive error state and bus-off

TEST(Iso16845_8_5_PassiveAndBusOff, APassiveTransmitter_SendsAPassiveFlagAndWaits8Bits) {
  LowerTester lt;
  lt.run(to_passive_transmitter + times(14, "1") + "R" + times(25, "1"), {frame_of_53_bits}, 1);
  // bits of the attempt at 520: error at 534, flag 535-540, delimiter 541-548, intermission 549-551, suspend 552-559
  EXPECT_EQ(lt.driven(520, 521), "0");
  EXPECT_EQ(lt.dominant(535, 560), "");
  EXPECT_EQ(lt.driven(560, 561), "0");
  EXPECT_EQ(lt.tec(), 136);
}

TEST(Iso16845_8_5_PassiveAndBusOff, TheErrorThatMakesItPassive_IsStillSignalledActive) {
  LowerTester lt;
  lt.run(times(16, eight_transmit_errors), {frame_of_53_bits}, 0);
  EXPECT_EQ(lt.driven(15 * 32 + 15, 15 * 32 + 22), "0000001");
}

TEST(Iso16845_8_5_PassiveAndBusOff, AFrameOfAnotherDuringSuspend_IsReceived) {
  const Frame other = data_frame(0x7FF);
  LowerTester lt;
  // The suspend of the sixteenth error is bits 512 to 519.
  lt.run(times(16, eight_transmit_errors) + "111" + can::slow::wire(other), {frame_of_53_bits}, 0);
  EXPECT_THAT(lt.iut.frames(), ElementsAre(other));
}

TEST(Iso16845_8_5_PassiveAndBusOff, AfterReceiving_ThereIsNoSuspend) {
  const Frame other = data_frame(0x7FF);
  const std::string wire = can::slow::wire(other);
  LowerTester lt;
  lt.run(times(16, eight_transmit_errors) + "1" + wire + "111", {frame_of_53_bits}, 1);
  const int next = 512 + 1 + static_cast<int>(wire.size()) + 3;
  EXPECT_EQ(lt.driven(next - 3, next + 1), "1110");
}

TEST(Iso16845_8_5_PassiveAndBusOff, APassiveFlagOverwrittenByAnActiveOne_IsNoBitError) {
  LowerTester lt;
  lt.run(to_passive_transmitter + times(14, "1") + "R" + "000000" + times(19, "1"), {frame_of_53_bits}, 1);
  EXPECT_EQ(lt.tec(), 136);
  EXPECT_EQ(lt.dominant(535, 560), "");
  EXPECT_EQ(lt.driven(560, 561), "0");
}

TEST(Iso16845_8_5_PassiveAndBusOff, SevenDominantBitsAfterAPassiveFlag_AreTolerated) {
  LowerTester lt;
  lt.run(to_passive_transmitter + times(14, "1") + "R" + "111111" + "0000000" + times(19, "1"),
         {frame_of_53_bits}, 1);
  EXPECT_EQ(lt.tec(), 136);
}

/// Up to the bit error that makes TEC 256, the last of its bits: 32 errors.
const std::string to_bus_off =
    to_passive_transmitter + times(15, eight_transmit_errors_passive) + times(14, "1") + "R";

TEST(Iso16845_8_5_PassiveAndBusOff, BusOff_DrivesNothing_NotEvenAcknowledgements) {
  LowerTester lt;
  lt.iut.port.set_automatic_recovery(false);
  lt.run(to_bus_off + times(20, "1") + wire_of_53_bits, {frame_of_53_bits}, 2000);
  const int off = static_cast<int>(to_bus_off.size());
  EXPECT_EQ(lt.iut.port.error_state(), ErrorState::bus_off);
  EXPECT_EQ(lt.dominant(off, off + 2000), "");
  EXPECT_THAT(lt.iut.frames(), IsEmpty());
}

TEST(Iso16845_8_5_PassiveAndBusOff, Recovery_Is128Times11RecessiveBits) {
  const int off = static_cast<int>(to_bus_off.size());
  LowerTester lt;
  lt.run(to_bus_off, {frame_of_53_bits}, 128 * 11 + 10);
  EXPECT_EQ(lt.dominant(off, off + 128 * 11), "");
  EXPECT_EQ(lt.driven(off + 128 * 11, off + 128 * 11 + 1), "0");  // what waited goes out
  EXPECT_EQ(lt.iut.port.error_state(), ErrorState::error_active);
}

TEST(Iso16845_8_5_PassiveAndBusOff, Recovery_CountsOnlyWholeSequences) {
  const int off = static_cast<int>(to_bus_off.size());
  LowerTester lt;
  lt.run(to_bus_off + times(10, "1") + "0", {frame_of_53_bits}, 128 * 11 + 10);
  EXPECT_EQ(lt.dominant(off, off + 11 + 128 * 11), "");
  EXPECT_EQ(lt.driven(off + 11 + 128 * 11, off + 11 + 128 * 11 + 1), "0");
}

// --- 8.6 Error counter management

/// TEC when the IUT has sent its frame among these bits.
int tec_after(const std::string& bits) {
  LowerTester lt;
  lt.run(bits, {frame_of_53_bits}, 0);
  return lt.tec();
}

TEST(Iso16845_8_6_Tec, RuleC_EachErrorCountsEight) {
  for (int errors = 1; errors <= 16; ++errors) {
    EXPECT_EQ(tec_after(times(static_cast<std::size_t>(errors), eight_transmit_errors)), 8 * errors);
  }
}

TEST(Iso16845_8_6_Tec, RuleC_Exception1_APassiveTransmitterWithoutAcknowledgement) {
  // Alone: TEC stays 128 for ever.
  LowerTester lt;
  lt.run("1", {frame_of_53_bits}, 5000);
  EXPECT_EQ(lt.tec(), 128);
  EXPECT_EQ(lt.iut.port.error_state(), ErrorState::error_passive);
  // A dominant bit within its passive flag: eight more.
  EXPECT_EQ(tec_after(to_passive_transmitter + times(45, "1") + "111111"), 128);
  EXPECT_EQ(tec_after(to_passive_transmitter + times(45, "1") + "110000"), 136);
}

TEST(Iso16845_8_6_Tec, RuleC_Exception2_AStuffBitOfTheArbitrationSeenDominant) {
  // 000...: stuff bits 5 and 11 are sent recessive.
  for (const std::size_t bit : {5U, 11U}) {
    LowerTester lt;
    lt.run(times(bit, "1") + "0", {data_frame(0x000)}, 7);
    const int at = static_cast<int>(bit);
    EXPECT_EQ(lt.driven(at + 1, at + 8), "0000001");
    EXPECT_EQ(lt.tec(), 0);
  }
}

TEST(Iso16845_8_6_Tec, RuleD_ABitErrorInAnActiveFlag) {
  EXPECT_EQ(tec_after(times(14, "1") + "R" + "1R"), 16);
}

TEST(Iso16845_8_6_Tec, RuleF_AFlagFollowedByManyDominantBits) {
  const std::string error = times(14, "1") + "R" + "111111";
  EXPECT_EQ(tec_after(error + times(7, "0")), 8);
  EXPECT_EQ(tec_after(error + times(8, "0")), 16);
  EXPECT_EQ(tec_after(error + times(16, "0")), 24);
  EXPECT_EQ(tec_after(acknowledged +
                      "0"
                      "111111" +
                      times(7, "0")),
            0);
  EXPECT_EQ(tec_after(acknowledged +
                      "0"
                      "111111" +
                      times(8, "0")),
            8);
}

TEST(Iso16845_8_6_Tec, RuleF_APassiveFlagFollowedByManyDominantBits) {
  const std::string error = to_passive_transmitter + times(14, "1") + "R" + "111111";
  EXPECT_EQ(tec_after(error + times(7, "0")), 136);
  EXPECT_EQ(tec_after(error + times(8, "0")), 144);
}

TEST(Iso16845_8_6_Tec, RuleG_ASuccessTakesOneBack) {
  EXPECT_EQ(tec_after(eight_transmit_errors + acknowledged), 7);
  EXPECT_EQ(tec_after(acknowledged), 0);
}

TEST(Iso16845_8_6_Tec, OverloadFramesAndLostArbitration_CountNothing) {
  EXPECT_EQ(tec_after(eight_transmit_errors + acknowledged + "0" + times(17, "1")), 7);
  EXPECT_EQ(tec_after(eight_transmit_errors + "11" + "0" + "10101010"), 8);
}

}  // namespace
}  // namespace canopus::sim::iso16845::transmitted_frame_test
