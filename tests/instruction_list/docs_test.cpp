// The table of docs/instruction-list.md is that of the compiler.

#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "canopus/ascii/words.hpp"
#include "canopus/instruction_list/instructions.hpp"

#include "paths.hpp"

namespace canopus::list_docs_test {
namespace {

using instruction_list::Instruction;

std::string row_of(const Instruction& instruction) {
  std::string operands(instruction.operands);
  if (const std::size_t bar = operands.find('|'); bar != std::string::npos) operands.replace(bar, 1, " or ");
  std::string forms;
  if ((instruction.forms & instruction_list::with_double) != 0) forms += " D";
  if ((instruction.forms & instruction_list::with_pulse) != 0) forms += " P";
  if ((instruction.forms & instruction_list::with_unsigned) != 0) forms += " U";
  std::string row = "| `" + std::string(instruction.names) + "` | " + operands + " | " +
                    (forms.empty() ? forms : forms.substr(1)) + " |";
  for (unsigned family = 0; family < 4; ++family)
    row += (instruction.families >> family & 1U) != 0 ? " x |" : "  |";
  return row + ' ' + std::string(instruction.meaning) + " |";
}

TEST(ListDocs, TableOfInstructions_IsThatOfTheCompiler) {
  std::vector<std::string> expected;
  for (const Instruction& each : instruction_list::instructions()) expected.push_back(row_of(each));
  std::ifstream file(CANOPUS_SOURCE_DIR "/docs/instruction-list.md");
  std::vector<std::string> found;
  bool is_table = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("| instruction |")) is_table = true;
    if (is_table && line.starts_with("| `")) found.push_back(line);
  }
  EXPECT_THAT(found, testing::ElementsAreArray(expected));
}

TEST(ListDocs, TableOfAbsentInstructions_IsThatOfTheCompiler) {
  std::vector<std::string> expected;
  for (const instruction_list::AbsentInstruction& each : instruction_list::absent_instructions()) {
    std::string row = "| `" + std::string(each.names) + "` |";
    for (unsigned family = 0; family < 4; ++family)
      row += (each.families >> family & 1U) != 0 ? " x |" : "  |";
    expected.push_back(row + ' ' + std::string(each.missing) + " |");
  }
  std::ifstream file(CANOPUS_SOURCE_DIR "/docs/instruction-list.md");
  std::vector<std::string> found;
  bool is_table = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("| not there |")) is_table = true;
    if (line.starts_with("| instruction |")) is_table = false;
    if (is_table && line.starts_with("| `")) found.push_back(line);
  }
  EXPECT_THAT(found, testing::ElementsAreArray(expected));
}

TEST(ListDocs, NoAbsentInstruction_IsInTheOtherTable) {
  for (const Instruction& row : instruction_list::instructions())
    for (unsigned family = 0; family < 4; ++family) {
      if ((row.families >> family & 1U) == 0) continue;
      for (const std::string_view name : ascii::words(row.names))
        EXPECT_EQ(instruction_list::absent_instruction(name, static_cast<instruction_list::Family>(family)),
                  nullptr)
            << name;
    }
}

}  // namespace
}  // namespace canopus::list_docs_test
