// What is wrong in a program: file, line, and what was expected.

#include <algorithm>

#include <gmock/gmock.h>

#include "list_plc.hpp"

namespace canopus::list_errors_test {
namespace {

using list_plc::errors_of;
using list_plc::Family;

TEST(ListErrors, AnUnknownInstruction_IsNamedWithTheFamily) {
  EXPECT_EQ(errors_of(Family::fx3, {"LD X0", "PIDX D0", "END"}),
            "MAIN.csv:5: 'PIDX' is not available for FX3; see docs/instruction-list.md\n");
  EXPECT_EQ(
      errors_of(Family::fx3, {"LD X0", "OUTH T0 K1", "END"}),
      "MAIN.csv:5: 'OUTH' is not available for FX3 but for Q, iQ-R, FX5; see docs/instruction-list.md\n");
}

TEST(ListErrors, AnInstructionThatIsNotThere_SaysWhatIsMissing) {
  EXPECT_EQ(errors_of(Family::fx3, {"LD X0", "PID D0", "END"}),
            "MAIN.csv:5: 'PID' is not there: there is no PID control loop\n");
  EXPECT_EQ(
      errors_of(Family::q, {"LD X0", "JP.READ J1", "END"}),
      "MAIN.csv:5: 'JP.READ' is not there: dedicated instructions of modules and networks are not there; "
      "use FROM, TO and U\\G\n");
  EXPECT_EQ(errors_of(Family::fx3, {"LD X0", "IST X20 S20 S40", "DHSCSP K1 C235 Y0", "END"}),
            "MAIN.csv:5: 'IST' is not there: there is no operation mode of initial states; SET the states by "
            "contacts\n"
            "MAIN.csv:8: 'DHSCSP' is not there: there are no inputs of high-speed counters\n");
}

TEST(ListErrors, Operands) {
  const auto of = [](Family family, const std::string& line) {
    return errors_of(family, {"LD M0", line, "END"});
  };
  EXPECT_EQ(of(Family::q, "MOV D0"), "MAIN.csv:5: MOV: expected 2 operands, found 1\n");
  EXPECT_EQ(of(Family::q, "+ D0"), "MAIN.csv:5: +: expected 2 or 3 operands, found 1\n");
  EXPECT_EQ(of(Family::q, "MOV D0 K1"),
            "MAIN.csv:5: MOV: 'K1': expected a device, not a constant, as something is written there\n");
  EXPECT_EQ(of(Family::q, "MOV K40000 D0"), "MAIN.csv:5: MOV: 'K40000': expected K-32768 to K32767\n");
  EXPECT_EQ(of(Family::q, "MOV H10000 D0"), "MAIN.csv:5: MOV: 'H10000': expected H0 to HFFFF\n");
  EXPECT_EQ(of(Family::q, "MOV HXYZ D0"),
            "MAIN.csv:5: MOV: 'HXYZ': expected a hexadecimal constant such as H1F\n");
  EXPECT_EQ(of(Family::q, "MOV E1.5 D0"),
            "MAIN.csv:5: MOV: 'E1.5': expected a whole number here, such as K10\n");
  EXPECT_EQ(of(Family::q, "EMOV E1.5.5 D0"),
            "MAIN.csv:5: EMOV: 'E1.5.5': expected a real constant such as E1.5 or E1.5+3\n");
  EXPECT_EQ(of(Family::q, "MOV M0 D0"),
            "MAIN.csv:5: MOV: 'M0': expected a word device, or digits before the bit device such as K4M0\n");
  EXPECT_EQ(of(Family::q, "MOV K9M0 D0"), "MAIN.csv:5: MOV: 'K9M0': expected K1 to K8 before a bit device\n");
  EXPECT_EQ(of(Family::q, "MOV K5M0 D0"), "MAIN.csv:5: MOV: 'K5M0': expected at most K4 here\n");
  EXPECT_EQ(of(Family::q, "OUT D0"),
            "MAIN.csv:5: OUT: 'D0': expected a bit device, or a bit of a word such as D0.5\n");
  EXPECT_EQ(of(Family::q, "OUT D0.G"), "MAIN.csv:5: OUT: 'D0.G': expected a bit .0 to .F of a word\n");
  EXPECT_EQ(of(Family::q, "OUT T0"),
            "MAIN.csv:5: OUT: 'T0': expected a setting behind the timer or counter, such as K10\n");
  EXPECT_EQ(of(Family::q, "OUT M1 K5"),
            "MAIN.csv:5: OUT: 'M1': expected a timer or counter, as there is a setting\n");
  EXPECT_EQ(of(Family::q, "OUTH C0 K5"), "MAIN.csv:5: OUTH: 'C0': expected a timer\n");
  EXPECT_EQ(of(Family::q, "MOV D99999 D0"), "MAIN.csv:5: MOV: 'D99999': the Q03UDVCPU has no such device\n");
  EXPECT_EQ(of(Family::fx3, "OUT X8"), "MAIN.csv:5: OUT: 'X8': expected a device of the FX3U\n");
  EXPECT_EQ(of(Family::fx3, "OUT C235 K1"),
            "MAIN.csv:5: OUT: 'C235': expected C0 to C234: there are no inputs of high-speed counters\n");
  EXPECT_EQ(of(Family::fx3, "MOV K1 Z8"), "MAIN.csv:5: MOV: 'Z8': expected Z0 to Z7 or V0 to V7\n");
  EXPECT_EQ(of(Family::fx3, "CJ M0"), "MAIN.csv:5: CJ: 'M0': expected a pointer such as P10\n");
  EXPECT_EQ(of(Family::fx3, "MC M0 M1"), "MAIN.csv:5: MC: 'M0': expected a nesting number such as N0\n");
  EXPECT_EQ(of(Family::fx3, "MC N8 M1"), "MAIN.csv:5: MC: 'N8': expected N0 to N7\n");
  EXPECT_EQ(of(Family::fx3, "MOV \"A\" D1"),
            "MAIN.csv:5: MOV: '\"A\"': expected a device or a number, not a text\n");
  EXPECT_EQ(
      of(Family::fx3, "ZRST D5 D1"),
      "MAIN.csv:5: ZRST: 'D1': expected a device of the same kind with a number from the first one's on\n");
  EXPECT_EQ(of(Family::q, "SFT M0"), "MAIN.csv:5: SFT: 'M0': expected a bit that another one is below\n");
}

TEST(ListErrors, ContactsThatDoNotFit) {
  EXPECT_EQ(errors_of(Family::q, {"OUT M0", "END"}),
            "MAIN.csv:4: OUT without contacts; expected LD or another contact before it\n");
  EXPECT_EQ(errors_of(Family::q, {"LD M0", "ANB", "OUT M1", "END"}),
            "MAIN.csv:5: ANB: expected two blocks of contacts before it\n");
  EXPECT_EQ(errors_of(Family::q, {"LD M0", "LD M1", "OUT M2", "END"}),
            "MAIN.csv:6: OUT: the contacts above are not joined; expected ANB or ORB\n");
  EXPECT_EQ(errors_of(Family::q, {"LD M0", "MPP", "OUT M2", "END"}),
            "MAIN.csv:5: MPP without MPS; expected one above\n");
  EXPECT_EQ(errors_of(Family::q, {"LD M0", "MPS", "OUT M2", "LD M1", "OUT M3", "END"}),
            "MAIN.csv:7: MPS without MPP above; expected one for each other\n");
  EXPECT_EQ(errors_of(Family::q, {"LD M0", "END"}),
            "MAIN.csv:5: the result of the contacts above is not used; expected an output such as OUT\n");
}

TEST(ListErrors, Structure) {
  EXPECT_EQ(errors_of(Family::q, {"LD M0", "OUT M1"}), "MAIN.csv:5: the program ends here without END\n");
  EXPECT_EQ(errors_of(Family::q, {"END", "LD M0"}),
            "MAIN.csv:5: LD stands behind END; expected nothing there\n");
  EXPECT_EQ(errors_of(Family::q, {"LD M0", "CJ P3", "END"}), "MAIN.csv:5: there is no P3 in this program\n");
  EXPECT_EQ(errors_of(Family::q, {"P3", "LD M0", "OUT M1", "P3", "END"}),
            "MAIN.csv:7: P3: there is another one of this number in line 4\n");
  EXPECT_EQ(errors_of(Family::q, {"LD M0", "CALL P1", "FEND", "P1", "LD M0", "OUT M1", "END"}),
            "MAIN.csv:7: P1 is called, but its end is no RET\n");
  EXPECT_EQ(errors_of(Family::q, {"P1", "LD M0", "CALL P1", "END"}),
            "MAIN.csv:4: P1 is called, but its end is no RET\n"
            "MAIN.csv:4: P1 is called; expected it behind FEND\n");
  EXPECT_EQ(
      errors_of(Family::q, {"LD M0", "CALL P1", "FEND", "P1", "LD M0", "CALL P2", "RET", "P2", "LD M0",
                            "CALL P1", "RET", "END"}),
      "MAIN.csv:7: this subroutine calls itself, or one that calls it; expected calls without a circle\n");
  EXPECT_EQ(errors_of(Family::q, {"FOR K1", "END"}),
            "MAIN.csv:4: FOR without NEXT: expected one before the end of the program\n");
  EXPECT_EQ(errors_of(Family::q, {"NEXT", "END"}), "MAIN.csv:4: NEXT without FOR; expected one above\n");
  EXPECT_EQ(errors_of(Family::fx3, {"FOR K1", "FOR K1", "FOR K1", "FOR K1", "FOR K1", "FOR K1", "NEXT",
                                    "NEXT", "NEXT", "NEXT", "NEXT", "END"}),
            "MAIN.csv:9: expected at most 5 nested FOR\n");
  EXPECT_EQ(errors_of(Family::q, {"MCR N0", "END"}),
            "MAIN.csv:4: MCR N0 without MC; expected one of this number above\n");
}

TEST(ListErrors, AllOfAFile_AreReportedAtOnce) {
  EXPECT_EQ(errors_of(Family::q, {"LD M0", "MOV K1", "LD M99999", "OUT M1", "XYZ", "END"}),
            "MAIN.csv:5: MOV: expected 2 operands, found 1\n"
            "MAIN.csv:6: LD: 'M99999': the Q03UDVCPU has no such device\n"
            "MAIN.csv:8: 'XYZ' is not available for Q; see docs/instruction-list.md\n");
}

TEST(ListErrors, ManyErrors_AreAtMost100) {
  std::vector<std::string> lines(300, "XYZ");
  const std::string all = errors_of(Family::q, lines);
  EXPECT_EQ(std::ranges::count(all, '\n'), 100);
}

// Each of these rungs, with no output that is known, would be searched for the end of all of them: hours.
TEST(ListErrors, AHundredThousandWrongRungs_AreNotCompiled) {
  std::vector<std::string> lines;
  for (int i = 0; i < 90'000; ++i) {
    lines.emplace_back("LD M0");
    lines.emplace_back("XYZ");
  }
  const std::string all = errors_of(Family::q, lines);
  EXPECT_EQ(std::ranges::count(all, '\n'), 100);
  EXPECT_THAT(all, testing::HasSubstr("MAIN.csv:203: 'XYZ' is not available for Q"));
}

TEST(ListErrors, DeepContacts_AreRefusedAndNotCrashedOn) {
  EXPECT_THAT(errors_of(Family::q, std::vector<std::string>(5000, "LD M0")),
              testing::HasSubstr("expected at most 64 blocks that no ANB or ORB has joined"));
  EXPECT_THAT(errors_of(Family::q, std::vector<std::string>(5000, "MPS")),
              testing::HasSubstr("MPS without contacts"));
  EXPECT_THAT(errors_of(Family::q, std::vector<std::string>(5000, "FOR K1")),
              testing::HasSubstr("expected at most 16 nested FOR"));
}

}  // namespace
}  // namespace canopus::list_errors_test
