// Files of GX Works2 and GX Works3 as bytes: encodings, separators, titles, rows of operands, and what is damaged.

#include <random>

#include <gmock/gmock.h>

#include "list_plc.hpp"

namespace canopus::list_csv_test {
namespace {

using instruction_list::CompileError;
using instruction_list::ProgramText;
using instruction_list::read_program_csv;

std::string in_utf16(std::u16string_view text, bool is_big) {
  std::string bytes = is_big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char16_t c : text) {
    const char low = static_cast<char>(c & 0xFFU);
    const char high = static_cast<char>(c >> 8U);
    bytes += is_big ? high : low;
    bytes += is_big ? low : high;
  }
  return bytes;
}

ProgramText read(const std::string& bytes, std::string* wrong = nullptr) {
  std::vector<CompileError> errors;
  ProgramText text = read_program_csv("A.csv", bytes, errors);
  if (wrong != nullptr)
    *wrong = list_plc::text(errors);
  else
    EXPECT_EQ(list_plc::text(errors), "");
  return text;
}

void expect_small_program(const ProgramText& text) {
  ASSERT_EQ(text.instructions.size(), 3U);
  EXPECT_EQ(text.instructions[0].name, "LD");
  EXPECT_THAT(text.instructions[0].operands, testing::ElementsAre("X0"));
  EXPECT_EQ(text.instructions[1].name, "OUT");
  EXPECT_THAT(text.instructions[1].operands, testing::ElementsAre("T0", "K50"));
  EXPECT_EQ(text.instructions[1].line, 5U);
  EXPECT_EQ(text.instructions[2].name, "END");
}

constexpr std::u16string_view english =
    u"\"MAIN\"\r\n\"PLC Information:\"\t\"QCPU (Q mode) Q03UDV\"\r\n"
    u"\"Step No.\"\t\"Line Statement\"\t\"Instruction\"\t\"I/O(Device)\"\t\"Blank\"\t\"PI "
    u"Statement\"\t\"Note\"\r\n"
    u"\"0\"\t\"\"\t\"LD\"\t\"X0\"\t\"\"\t\"\"\t\"\"\r\n\"1\"\t\"\"\t\"OUT\"\t\"T0\"\t\"\"\t\"\"\t\"\"\r\n"
    u"\"\"\t\"\"\t\"\"\t\"K50\"\t\"\"\t\"\"\t\"\"\r\n\"5\"\t\"\"\t\"END\"\t\"\"\t\"\"\t\"\"\t\"\"\r\n";

TEST(ProgramCsv, Utf16OfBothOrders_AsGxWorksWritesIt) {
  for (const bool is_big : {false, true}) {
    const ProgramText text = read(in_utf16(english, is_big));
    expect_small_program(text);
    EXPECT_EQ(text.title, "MAIN");
    EXPECT_EQ(text.cpu, "QCPU (Q mode) Q03UDV");
  }
}

TEST(ProgramCsv, Utf8WithCommas_AndJapaneseTitles) {
  expect_small_program(
      read("\xEF\xBB\xBF\"E5482L\"\n\"機種情報\",\"RCPU R16N\"\n"
           "\"ステップ番号\",\"行間ステートメント\",\"命令\",\"I/"
           "Oデバイス\",\"空欄\",\"PIステートメント\",\"ノート\"\n"
           "0,,LD,X0,,,\n1,,OUT,T0,,,\n,,,K50,,,\n5,,END,,,,\n"));
}

TEST(ProgramCsv, Cp932_BecomesUtf8) {
  // 命令 is 96BDH 97DFH, 搬送 94C0H 9197H in CP932.
  const ProgramText text = read(
      "a\nb\tc\nStep\tS\t\x96\xBD\x97\xDF\tI/"
      "O(Device)\n0\t\x94\xC0\x91\x97\tLD\tX0\n1\t\tOUT\tT0\n\t\t\tK50\n2\t\tEND\t\n");
  ASSERT_EQ(text.statements.size(), 1U);
  EXPECT_EQ(text.statements[0].text, "搬送");
  EXPECT_EQ(text.instructions.size(), 3U);
}

TEST(ProgramCsv, TitlesOfAnotherLanguage_HaveTheUsualOrder) {
  expect_small_program(
      read("Projekt\nSPS-Information:\tQCPU\nSchritt\tKommentar\tAnw.\tOperand\tLeer\tPI\tNotiz\n"
           "0\t\tLD\tX0\t\t\t\n1\t\tOUT\tT0\t\t\t\n\t\t\tK50\t\t\t\n5\t\tEND\t\t\t\t\n"));
}

TEST(ProgramCsv, TitlesInAnotherOrder_AreFollowed) {
  const ProgramText text = read("Step No.,Instruction,I/O (Device),Note\n0,ld,x0,a note\n1,END,,\n");
  ASSERT_EQ(text.instructions.size(), 2U);
  EXPECT_EQ(text.instructions[0].name, "LD");
  EXPECT_THAT(text.instructions[0].operands, testing::ElementsAre("x0"));
  EXPECT_EQ(text.instructions[0].note, "a note");
}

TEST(ProgramCsv, StatementsNotesAndPointers_AreKept) {
  const ProgramText text = read(
      "Step No.\tLine Statement\tInstruction\tI/O(Device)\tBlank\tPI Statement\tNote\n"
      "0\t* "
      "conveyor\t\t\t\t\t\n0\t\tLD\tX0\t\t\tstart\n1\t\tOUT\tY0\t\t\t\n2\t\tP10\t\t\tlift\t\n3\t\t\tP11\t\t\t"
      "\n4\t\tEND\t\t\t\t\n");
  ASSERT_EQ(text.instructions.size(), 5U);
  ASSERT_EQ(text.statements.size(), 2U);
  EXPECT_EQ(text.statements[0].text, "* conveyor");
  EXPECT_EQ(text.statements[0].instruction, 0U);
  EXPECT_EQ(text.statements[1].text, "lift");
  EXPECT_EQ(text.statements[1].instruction, 2U);
  EXPECT_EQ(text.instructions[0].note, "start");
  EXPECT_EQ(text.instructions[2].name, "P10");
  EXPECT_EQ(text.instructions[3].name, "P11");
}

TEST(ProgramCsv, QuotesInQuotes_AreDoubled) {
  const ProgramText text = read("0\t\"\"\t\"$MOV\"\t\"\"\"A\tB\"\"\"\n\t\t\tD0\n");
  ASSERT_EQ(text.instructions.size(), 1U);
  EXPECT_THAT(text.instructions[0].operands, testing::ElementsAre("\"A\tB\"", "D0"));
}

TEST(ProgramCsv, DamagedFiles_AreRefusedWithTheirLine) {
  const auto error_of = [](const std::string& bytes) {
    std::string wrong;
    (void)read(bytes, &wrong);
    return wrong;
  };
  EXPECT_EQ(error_of(""),
            "A.csv:1: expected rows with step number, statement, instruction and device, as GX Works writes "
            "them\n");
  EXPECT_EQ(error_of("0,,LD,X0\n1,,\"OUT,Y0\n2,,END,\n"),
            "A.csv:2: the quote that is opened in line 2 is not closed\n");
  EXPECT_EQ(error_of("0,,\"LD\"X,X0\n"), "A.csv:1: expected a separator behind the closing quote\n");
  EXPECT_EQ(error_of("Step,S,Instruction,Device\n,,,K50\n"),
            "A.csv:2: 'K50' belongs to no instruction; expected an instruction above it\n");
  EXPECT_EQ(error_of("0,,LD," + std::string(70, ',') + "\n"),
            "A.csv:1: expected at most 64 fields in a row\n");
  EXPECT_EQ(
      error_of(std::string("\xFF\xFE\x00\xD8\x00", 5)),
      "A.csv:1: byte 1 is no text in UTF-16LE; expected UTF-16 with a byte order mark, UTF-8 or CP932\n");
  EXPECT_EQ(error_of("0,,LD,\x81"),
            "A.csv:1: byte 7 is no text in CP932; expected UTF-16 with a byte order mark, UTF-8 or CP932\n");
  std::string many = "0,,LD,X0\n";
  for (int i = 0; i < 20; ++i) many += ",,,K1\n";
  EXPECT_THAT(error_of(many), testing::StartsWith("A.csv:17: expected at most 16 operands\n"));
}

TEST(ProgramCsv, AnyBytes_AreReadOrRefused) {
  std::mt19937 random(1);
  const std::string whole =
      list_plc::csv({"LD X0", "OUT T0 K50", "LDP M0", "MOV D0 K4Y0", "CJ P0", "P0", "END"});
  const plc::CpuDeviceNames names(plc::q03udvcpu());
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    for (unsigned n = random() % 8; n < 8; ++n) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 3) {
        case 0: bytes[at] = static_cast<char>(random()); break;
        case 1: bytes.erase(at, random() % 20); break;
        default: bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 40)); break;
      }
    }
    const std::vector<instruction_list::Source> sources = {{"A.csv", bytes}};
    const auto made = instruction_list::compile(sources, instruction_list::Family::q, names);
    EXPECT_EQ(made.program == nullptr, !made.errors.empty());
  }
}

}  // namespace
}  // namespace canopus::list_csv_test
