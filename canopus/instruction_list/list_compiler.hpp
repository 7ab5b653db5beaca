#pragma once
// Compiles one program.
//
// The results of contacts stand in slots of the frame, one for each LD that no ANB or ORB has joined yet; which slot that is, is known
// when the program is compiled. Edges, loops and timers have slots that last from scan to scan. A routine behind FEND has results of its
// own, so that a CALL leaves those of its caller.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/instruction_list/instructions.hpp"
#include "canopus/instruction_list/interrupt_programs.hpp"
#include "canopus/instruction_list/label.hpp"
#include "canopus/instruction_list/operand.hpp"
#include "canopus/instruction_list/program_csv.hpp"
#include "canopus/program/program.hpp"

namespace canopus::instruction_list {

/// Counters of an FX3 with 32 bits: the high word is another device.
inline constexpr std::uint32_t first_long_counter = 200;

/// The compiler ends with so many: a list of nothing but errors is not compiled to its end.
inline constexpr std::size_t most_errors = 100;

/// What the programs of one compilation share.
struct Shared {
  program::Program& program;
  const program::DeviceNames& devices;
  Family family;
  std::vector<CompileError>& errors;
  std::span<const Label> labels;
  InterruptPrograms interrupts{program};
  std::map<program::Native, std::uint32_t> natives{};
  std::optional<std::uint32_t>
      index_registers{};  ///< place of V0 to V7 of an FX3 in the memory; Z0 to Z7 are devices
  bool is_too_large = false;
};

class ListCompiler {
 public:
  ListCompiler(Shared& shared, std::uint16_t file) : shared_(shared), file_(file) {}
  /// Adds the program; errors go to the shared ones.
  void compile(const ProgramText& text, std::string name);

 private:
  using Opcode = program::Opcode;
  using Elementary = program::Elementary;
  using Slot = program::Slot;

  /// A place to jump to, or a subroutine.
  struct Pointer {
    std::size_t row = 0;  ///< of ProgramText::instructions
    std::size_t routine = 0;
    std::optional<std::uint32_t> entry{};  ///< once it has been compiled
    std::optional<std::uint32_t> function{};
  };
  /// An interrupt program, behind its pointer I.
  struct Interrupt {
    std::string name{};
    std::size_t row = 0;
    std::size_t routine = 0;
    std::optional<std::uint32_t> entry{};
  };
  /// The rows from the begin, or from the end of another one, to FEND, SRET, RET, IRET or END.
  struct Routine {
    std::size_t first_row = 0;
    Action end = Action::end;
    std::vector<std::uint32_t> results{};  ///< slots, one for each open LD
    std::vector<std::uint32_t> stored{};   ///< of MPS
    std::vector<std::uint32_t> temporaries{};
    std::vector<std::size_t> jumps{};  ///< routines that it calls or jumps to
    std::vector<std::size_t> calls{};
  };
  struct Jump {
    std::size_t instruction = 0;
    std::uint32_t pointer = 0;
    std::size_t row = 0;
  };
  struct Loop {
    std::uint32_t counter = 0;  ///< the limit is in the next slot, the step behind it
    std::size_t first = 0;      ///< instruction
    std::size_t row = 0;
  };
  /// What stands between STL and the next one, or RET.
  struct StateBlock {
    std::vector<Operand> sources{};  ///< states, several STL in a row
    std::uint32_t slot = 0;          ///< all of them are ON
    std::size_t over = 0;            ///< the jump behind it
    std::size_t row = 0;
  };
  struct MasterControl {
    std::uint32_t level = 0;
    std::uint32_t slot = 0;
  };

  // Errors
  void error(std::size_t row, std::string message);
  void error(std::string message) { error(row_, std::move(message)); }
  void operand_error(const Operand& operand, const std::string& message);

  // The frame
  std::uint32_t reserve(std::uint32_t slots);
  std::uint32_t constant(Slot value);
  std::uint32_t temporary();
  /// A slot that lasts; online change finds it by the instruction's text.
  std::uint32_t state();
  /// Slots of a native function with these first values, behind one for its result.
  std::uint32_t record(std::initializer_list<Slot> values);
  std::uint32_t place_in_memory(std::size_t slots);

  // Code
  std::size_t emit(Opcode code, std::uint32_t a = 0, std::uint32_t b = 0, std::uint32_t c = 0,
                   std::uint16_t extra = 0);
  void native(program::Native function, std::uint32_t record);
  void land(std::size_t jump) { land(jump, here()); }
  void land(std::size_t jump, std::size_t target);
  void keep_distance(std::size_t target);
  [[nodiscard]] std::size_t here() const noexcept { return shared_.program.code.size(); }
  std::uint32_t add_device(program::DeviceAccess access);

  // Passes
  void find_routines();
  void compile_row();
  [[nodiscard]] bool parse_operands(std::string_view letters);
  /// The letters of the operands that the row has: "s s d" of "s d|s s d"; nullptr, with an error, for a wrong number.
  [[nodiscard]] std::optional<std::string_view> letters_of(const Instruction& instruction);
  void execute(const NamedInstruction& named);
  void link();
  void refuse_recursion();
  void begin_routine();
  void check_end_of_routine();
  void check_interrupts();

  // Step ladders and interrupts
  void begin_state();
  void end_state();
  /// SET or OUT of a state within another one; false: it is none.
  bool transfer(std::uint32_t when);
  void begin_interrupt(Interrupt& interrupt);
  void allow_interrupts(bool are_allowed);
  void add_interrupts(const std::string& name, std::uint32_t frame, std::uint32_t instructions);

  // Labels
  std::expected<Operand, std::string> operand_of(const std::string& text);
  std::expected<Operand, std::string> variable_of(const Label& label, const std::string& text);
  bool fits(const Operand& variable, Elementary type);
  std::optional<std::uint32_t> load_variable(const Operand& variable, Elementary type);
  bool store_variable(const Operand& variable, Elementary type, std::uint32_t value);

  // Results
  Routine& routine() { return routines_[routine_]; }
  std::uint32_t result_slot(std::size_t depth);
  [[nodiscard]] bool begins_rung() const;
  void push_result();
  [[nodiscard]] std::optional<std::uint32_t> result();
  /// The condition of an output: the result, and master control.
  [[nodiscard]] std::optional<std::uint32_t> condition();
  std::uint32_t edge(std::uint32_t value, bool is_rising);
  void invert(std::uint32_t value);
  void combine(unsigned place, std::uint32_t value);

  // Operands
  std::optional<program::DeviceAccess> access(const Operand& operand, Elementary type);
  std::optional<program::DeviceAccess> bit_access(const Operand& operand);
  std::optional<program::DeviceAccess> named(std::string name, const Operand& operand);
  /// Number of the device in the program's table and slot of what is added to it.
  struct Located {
    std::uint32_t device = 0;
    std::optional<std::uint32_t> offset{};
  };
  std::optional<Located> located(const Operand& operand, Elementary type);
  std::optional<std::uint32_t> index_value(const std::string& register_name);
  std::optional<Slot> constant_value(const Operand& operand, Elementary type);
  std::optional<std::uint32_t> load(const Operand& operand, Elementary type);
  /// `into`: a slot of one's own.
  std::optional<std::uint32_t> load_bit(const Operand& operand, std::optional<std::uint32_t> into = {});
  bool store(const Operand& operand, Elementary type, std::uint32_t value);
  bool store_bit(const Operand& operand, std::uint32_t value);
  bool store_access(program::DeviceAccess access, const std::string& index, std::uint32_t value);
  std::optional<std::uint32_t> load_access(program::DeviceAccess access, const std::string& index,
                                           std::optional<std::uint32_t> into = {});
  std::optional<program::DeviceAccess> index_register(const Operand& operand);
  bool load_index_register(const Operand& operand, std::uint32_t into);
  bool store_index_register(const Operand& operand, std::uint32_t value);
  [[nodiscard]] std::uint32_t index_register_place(std::uint32_t number);
  /// To the device that many points behind: the remainder, the next of three bits.
  bool store_behind(const Operand& operand, unsigned points, Elementary type, std::uint32_t value);
  void locate(std::uint32_t record, std::uint32_t slot, const Located& located);

  // Instructions
  void contact(unsigned variant);
  void pulse_contact(unsigned variant);
  void block(bool is_or);
  void stack(unsigned variant);
  void compare(std::string_view name, unsigned variant, Elementary type);
  void compare_text(std::string_view name, unsigned variant);
  void compare_clock(std::string_view name, unsigned variant);
  void out(std::int64_t unit);
  void out_timer(const Operand& timer, std::uint32_t when, std::int64_t unit);
  void out_counter(const Operand& counter, std::uint32_t when);
  void set_or_reset(bool is_set);
  bool reset(const Operand& operand);
  void shift_device();
  void master_control(bool begins);
  void jump(bool is_conditional);
  void call();
  void for_();
  void next();
  void break_(std::uint32_t when);
  void multiply(bool divides, Elementary type);
  void logic(unsigned variant, Elementary type);
  void rotate(unsigned rotation, unsigned bits, Elementary type);
  void block_instruction(const NamedInstruction& named, Elementary type);
  void shift_in(bool has_source, bool is_left, bool of_words);
  void module_access(bool writes, bool is_double);
  void move_text();
  bool text_argument(const Operand& operand, std::uint32_t record, std::uint32_t slot);
  void compare_to_bits(bool is_zone, Elementary type);
  /// Three bits: the value is less than low, within, greater than high.
  void store_comparison(std::uint32_t low, std::uint32_t high, std::uint32_t value);
  void clock_instruction(const NamedInstruction& named, Elementary type);
  void clock_words(bool sets);
  /// The registers that show the clock, and how: ClockForm.
  std::optional<std::pair<std::uint32_t, Slot>> clock_registers();
  void compare_times(bool is_zone);
  std::optional<std::uint32_t> time_of_day(const Operand& operand);
  void refresh();
  void arithmetic(const NamedInstruction& named, Elementary type);
  /// SUM, MEAN, LIMIT, SQR
  void calculation(Action action, Elementary type);
  void values(const NamedInstruction& named, Elementary type);

  Shared& shared_;
  std::uint16_t file_;
  const ProgramText* text_ = nullptr;
  std::string name_;
  std::size_t row_ = 0;
  std::vector<Operand> operands_;
  std::string letters_;
  std::map<std::uint32_t, Pointer> pointers_;
  std::vector<Interrupt> interrupts_;
  std::map<std::string, std::uint32_t> local_variables_;  // slots of the frame
  std::optional<StateBlock> state_;
  std::vector<Routine> routines_;
  std::size_t routine_ = 0;
  std::size_t depth_ = 0;   // open results
  std::size_t stored_ = 0;  // by MPS
  std::size_t temporaries_used_ = 0;
  bool has_output_ = false;  // since the last LD
  bool has_ended_ = false;
  std::vector<MasterControl> master_controls_;
  std::vector<Loop> loops_;
  std::vector<Jump> jumps_;
  std::vector<std::size_t> jumps_to_end_;
  std::vector<Slot> image_;  // of the frame
  std::map<Slot, std::uint32_t> constants_;
  std::vector<program::Member> members_;
  std::map<std::string, unsigned> members_named_;
};

}  // namespace canopus::instruction_list
