#pragma once
// Reads program files of GX Works2 and GX Works3 ("Write to CSV File"): an instruction a row, further operands on rows of their own.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::instruction_list {

/// "MAIN.csv:12: expected a closing quote"
struct CompileError {
  std::string file;
  std::uint32_t line = 0;  ///< from 1
  std::string message;
};

struct InstructionRow {
  std::uint32_t line = 0;  ///< of the file
  std::string name{};      ///< in capitals; a pointer by its name: "P10", "I610"
  std::vector<std::string> operands{};
  std::string note{};
};

/// A statement, or P/I statement, above the instruction that comes next.
struct StatementRow {
  std::uint32_t line = 0;
  std::size_t instruction = 0;  ///< number of the next one in `instructions`
  std::string text{};
};

struct ProgramText {
  std::string title{};
  std::string cpu{};  ///< "QCPU (Q mode) Q03UDV"
  std::vector<InstructionRow> instructions{};
  std::vector<StatementRow> statements{};
};

/// Errors go to `errors`, with the file's name; whatever could be read is returned.
[[nodiscard]] ProgramText read_program_csv(const std::string& file, std::string_view bytes,
                                           std::vector<CompileError>& errors);

}  // namespace canopus::instruction_list
