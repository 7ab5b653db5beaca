#pragma once
// The interrupt programs of a compilation, behind their pointers I. Each begins with code that executes it while EI is in force; one
// that is due under DI waits, and the next EI of a main program executes it.

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "canopus/instruction_list/instructions.hpp"
#include "canopus/program/program.hpp"

namespace canopus::instruction_list {

/// What calls an interrupt program.
struct InterruptCause {
  std::int64_t every = 0;  ///< ns; 0: an edge of the input
  std::string input{};     ///< "X0"
  bool is_falling = false;
  std::string mask{};  ///< a special relay that keeps it from being executed: "M8050"; or none
};

/// Of the pointer I with this number, three digits on an FX3. The error says what was expected.
[[nodiscard]] std::expected<InterruptCause, std::string> interrupt_cause(const std::string& pointer,
                                                                         Family family);

class InterruptPrograms {
 public:
  explicit InterruptPrograms(program::Program& program) : program_(program) {}

  /// `function` is its code; the point of `mask` is a bit device.
  void add(program::InterruptProgram interrupt, std::optional<program::DevicePoint> mask,
           program::SourcePosition position);
  /// The slot of the memory that is 1 behind EI and 0 behind DI, as in the beginning.
  [[nodiscard]] std::uint32_t enabled();
  /// The function that executes what has waited.
  [[nodiscard]] std::uint32_t waiting();
  /// Writes the code, behind that of all programs.
  void finish();

 private:
  struct Entry {
    program::InterruptProgram interrupt;
    std::optional<program::DevicePoint> mask;
    program::SourcePosition position;
    std::uint32_t waits = 0;  // slot of the memory
  };
  void emit(const Entry& entry, program::Opcode code, std::uint32_t a = 0, std::uint32_t b = 0,
            std::uint32_t c = 0);

  program::Program& program_;
  std::vector<Entry> entries_;
  std::optional<std::uint32_t> enabled_;
  std::optional<std::uint32_t> waiting_;
};

}  // namespace canopus::instruction_list
