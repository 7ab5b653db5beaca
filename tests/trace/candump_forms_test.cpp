// What candump writes on the screen with its options -e, -8, -d, -S, -i and -c.

#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "trace/support_trace.hpp"

namespace canopus::trace::candump_forms_test {
namespace {

using can::data_frame;
using Texts = std::vector<std::string>;

WholeTrace read(std::string bytes) {
  return read_whole(open_reader(TraceInput::from_memory("x", std::move(bytes))));
}

std::vector<can::Frame> frames_of(const WholeTrace& all) {
  std::vector<can::Frame> frames;
  for (const NamedRecord& named : all.records) frames.push_back(named.record.frame);
  return frames;
}

TEST(CandumpForms, ExplanationsBelowAnErrorFrame_AreNoFrames) {
  const WholeTrace all = read(
      " (000.000000)  can0  RX - -  705   [1]  05\n"
      " (000.010000)  can0  RX - -  20000004   [8]  00 08 00 00 00 00 60 00   ERRORFRAME\n"
      "\tcontroller-problem{tx-error-warning}\n"
      "\terror-counter-tx-rx{{96}{0}}\n"
      " (000.020000)  can0  RX - -  705   [1]  05\n");
  EXPECT_EQ(all.errors, Texts{});
  ASSERT_EQ(all.records.size(), 3U);
  EXPECT_TRUE(all.records[1].record.error_frame);
  EXPECT_EQ(all.records[1].record.frame, data_frame(4, {0, 8, 0, 0, 0, 0, 0x60, 0}));
  EXPECT_EQ(all.left_out_text, "2 comments");
}

TEST(CandumpForms, ExplanationWithoutAnErrorFrame_IsAMistake) {
  const WholeTrace all = read("(1.0) can0 705#05\n\tcontroller-problem{tx-error-warning}\n");
  EXPECT_EQ(all.errors, Texts{"x:2:2: expected '(' and a time in seconds, found 'c'"});
}

TEST(CandumpForms, RawDlc_IsReadWithItsData) {
  const WholeTrace all = read(
      "  can0  181   {8}  01 02 03 04 05 06 07 08\n  can0  182   {F}  01 02 03 04 05 06 07 08\n"
      "  can0  701   {1}  05\n  can0  702   {9}  remote request\n  can0  703   {0}\n");
  can::Frame raw = data_frame(0x182, {1, 2, 3, 4, 5, 6, 7, 8});
  raw.dlc = 15;
  EXPECT_EQ(all.errors, Texts{});
  EXPECT_EQ(frames_of(all),
            (std::vector<can::Frame>{data_frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8}), raw, data_frame(0x701, {5}),
                                     can::remote_frame(0x702, 9), data_frame(0x703, {})}));
}

TEST(CandumpForms, SwappedBytes_AreTurnedBack) {
  const WholeTrace all = read(
      "  can0  601   [8]  00`00`00`00`00`10`00`40\n  can0  181   [2]  02`01                     `..`\n"
      " (0.5)  can0  182   [1]  07\n");
  EXPECT_EQ(all.errors, Texts{});
  EXPECT_EQ(frames_of(all), (std::vector<can::Frame>{data_frame(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0}),
                                                     data_frame(0x181, {1, 2}), data_frame(0x182, {7})}));
}

TEST(CandumpForms, BinaryData_IsReadForwardsAndSwapped) {
  const WholeTrace all = read(
      "  can0  601   [3]  01000000 00011000 00010000\n  can0  602   [3]  00010000`00011000`01000000\n"
      "  can0  603   {1}  11111111\n  can0  604   [1]  10\n");
  EXPECT_EQ(all.errors, Texts{});
  EXPECT_EQ(frames_of(all), (std::vector<can::Frame>{data_frame(0x601, {0x40, 0x18, 0x10}),
                                                     data_frame(0x602, {0x40, 0x18, 0x10}),
                                                     data_frame(0x603, {0xFF}), data_frame(0x604, {0x10})}));
}

TEST(CandumpForms, AsciiColumnOfAFrameWithoutData_IsSkipped) {
  const WholeTrace all =
      read("  can0  600   [0]                           ''\n (1.5)  can0  601  [0]  remote request\n");
  EXPECT_EQ(all.errors, Texts{});
  EXPECT_EQ(frames_of(all), (std::vector<can::Frame>{data_frame(0x600, {}), can::remote_frame(0x601)}));
}

TEST(CandumpForms, Colours_AreSkipped) {
  const WholeTrace all =
      read("\x1B[31m  can0  601   [2]  40 18\x1B[0m\n\x1B[1;32m  can1  602   [0]\x1B[0m\n");
  EXPECT_EQ(all.errors, Texts{});
  EXPECT_EQ(frames_of(all),
            (std::vector<can::Frame>{data_frame(0x601, {0x40, 0x18}), data_frame(0x602, {})}));
}

TEST(CandumpForms, MistakeInALineWithoutTime_IsNamedWhereItIs) {
  const WholeTrace all = read(
      "  can0  601   [2]  40 18\n  can0  601   [2]  40 1G\n  can0  601   {G}  40\n  can0  601   [9]  40\n"
      "  can0  601   [2]  40`\n");
  EXPECT_EQ(
      all.errors,
      (Texts{"x:2:24: expected two hexadecimal digits for a byte, found 'G'",
             "x:3:16: expected a DLC of 0 to F, found 'G'", "x:4:16: expected a length of 0 to 8, found '9'",
             "x:5:23: expected two hexadecimal digits for a byte, found the end of the line"}));
  EXPECT_EQ(all.records.size(), 1U);
}

}  // namespace
}  // namespace canopus::trace::candump_forms_test
