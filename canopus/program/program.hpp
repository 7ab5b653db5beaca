#pragma once
// A compiled PLC program: the intermediate code that all languages are translated into, the memory it begins with, and the names of
// its variables. Nothing in it changes while it runs, so that machines on several threads may share one, if it has no plug-in.
//
// The code works on one row of slots, the memory. Global variables have fixed places in it. A program, a function and each instance
// of a function block have a frame: their variables, constants and intermediate results. As functions do not call themselves
// [IEC 61131-3 6.6.1], a function has one frame, too, at a fixed place, and a scan allocates nothing.

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/program/data_type.hpp"
#include "canopus/program/device_image.hpp"
#include "canopus/program/opcodes.hpp"
#include "canopus/program/plugin.hpp"

namespace canopus::program {

enum class Opcode : std::uint16_t {
#define CANOPUS_EACH_OPCODE(name) name,
  CANOPUS_OPCODES
#undef CANOPUS_EACH_OPCODE
};

struct Instruction {
  Opcode code = Opcode::end;
  std::uint16_t extra = 0;
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  std::uint32_t c = 0;
};

/// `extra` of bit_and, bit_or and bit_xor: what a compiler knows, so that several of them can be executed at once.
enum BitOperands : std::uint16_t {
  of_bool = 1,      ///< both operands are 0 or 1
  b_is_last = 2,    ///< nothing reads operand b again before it is written
  c_is_last = 4,    ///< the same of c
  is_inversion = 8  ///< of bit_xor: c is 1, so that a = NOT b
};

struct SourcePosition {
  std::uint16_t file = 0;  ///< number in Program::files
  std::uint16_t column = 0;
  std::uint32_t line = 0;  ///< from 1; 0: none
};

enum class FaultCode : std::uint8_t {
  none,
  division_by_zero,
  index_out_of_range,
  value_out_of_range,  ///< of a subrange, or of the type that a number is converted to
  no_value,            ///< a text that is no number
  device_out_of_range,
  no_module,
  watchdog,  ///< more instructions in a scan than permitted
  call_depth,
  reported  ///< by a plug-in, in its own words
};

/// Why a run of a program ended.
struct Fault {
  FaultCode code = FaultCode::none;
  SourcePosition position{};
  std::int64_t value = 0;  ///< of an index or a number
  std::int64_t low = 0;    ///< what was permitted
  std::int64_t high = 0;
  std::string_view device{};  ///< as the program writes it
  std::string_view reason{};  ///< of a plug-in
};

struct Program;

/// Where a device of Program::devices is in the memory of its image; none: only the image's functions reach it.
struct DeviceMemory {
  std::uint8_t* bit = nullptr;     ///< a point: 0 or 1
  std::uint16_t* words = nullptr;  ///< of DeviceAccess::Form::words all of them, of bit_of_word the one
};

/// What a native function works on.
struct NativeCall {
  Slot* memory;
  Slot* slots;       ///< its result, then its arguments; of a function block its variables
  std::int64_t now;  ///< ns of the scan
  Fault fault{};     ///< set by a function that returns false
  static constexpr std::int64_t usual_cost = 10;
  std::int64_t cost =
      usual_cost;  ///< instructions that take about as long: what it counts towards the watchdog
  DeviceImage* devices = nullptr;  ///< none: the program has no CPU
  const Program* program = nullptr;
  const DeviceMemory* device_memory = nullptr;  ///< of each of Program::devices; nullptr: not known
};
using Native = bool (*)(NativeCall&);

/// An array in the present frame, or a range of numbers.
struct ElementAccess {
  std::uint32_t offset = 0;  ///< of the first element in the frame
  std::uint32_t size = 1;    ///< slots of an element
  std::int64_t low = 0;
  std::int64_t high = 0;
};

struct Function {
  std::string name{};
  std::uint32_t entry = 0;         ///< its first instruction
  std::uint32_t instructions = 0;  ///< their number
  std::uint32_t frame = 0;         ///< place in the memory; none of function blocks
};

/// A global variable, or a program with its variables.
struct Symbol {
  std::string name{};
  const DataType* type = nullptr;
  std::uint32_t place = 0;
  bool is_program = false;
  bool is_constant = false;
  bool is_retained = false;
  std::string comment{};
};

/// A program that is executed between scans, or before one whose refresh finds an edge.
struct InterruptProgram {
  std::string name{};          ///< "I610"
  std::uint32_t function = 0;  ///< number in Program::functions
  std::int64_t every = 0;      ///< ns of a timer interrupt; 0: an edge of `input`
  DevicePoint input{};
  std::string input_name{};  ///< "X0"
  bool is_falling = false;
};

struct Program {
  std::vector<std::string> files{};
  std::vector<Instruction> code{};
  std::vector<SourcePosition> positions{};  ///< of each instruction
  std::vector<Slot> initial{};              ///< the memory at a cold start
  std::deque<DataType> types{};
  std::vector<Function> functions{};
  std::vector<Native> natives{};
  std::vector<ElementAccess> elements{};
  std::vector<DeviceAccess> devices{};
  std::vector<Symbol> symbols{};
  std::vector<std::uint32_t> programs{};  ///< numbers in `functions`, in the order of execution
  std::vector<InterruptProgram> interrupts{};
  std::shared_ptr<Plugin> plugin{};  ///< what Opcode::run_plugin executes
};

inline constexpr std::size_t most_nested_calls = 64;
/// Slots of the memory: 32 MB.
inline constexpr std::size_t most_slots = 4'000'000;

/// "main.st:12:5: array index 11 is outside of 1 to 10".
[[nodiscard]] std::string fault_text(const Program& program, const Fault& fault);

}  // namespace canopus::program
