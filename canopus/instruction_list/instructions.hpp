#pragma once
// The instructions of the MELSEC families: their names, operands and families. The compiler and the table of docs/instruction-list.md
// come from this table.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace canopus::instruction_list {

enum class Family : std::uint8_t { q, iqr, fx3, fx5 };

/// "FX3"
[[nodiscard]] std::string_view family_name(Family family) noexcept;

/// What an instruction does: how it is compiled. `variant` is the place of its name in the row.
enum class Action : std::uint8_t {
  contact,        ///< LD LDI AND ANI OR ORI
  pulse_contact,  ///< LDP LDF ANDP ANDF ORP ORF, and the same inverted: LDPI ...
  block,          ///< ANB ORB
  stack,          ///< MPS MRD MPP
  invert,
  pulse_result,  ///< MEP MEF
  edge_relay,    ///< EGP EGF
  compare,       ///< = <> > <= < >=
  compare_text,
  compare_clock,  ///< LDDT= and LDTM= ...: dates or times of three words
  out,
  out_high_speed,  ///< OUTH: 10 ms
  out_millisecond,
  set,
  reset,
  pulse,  ///< PLS PLF
  toggle,
  shift_device,
  master_control,
  master_control_reset,
  jump,
  jump_always,
  jump_to_end,
  call,
  return_,
  main_end,
  end,
  for_,
  next,
  break_,
  nothing,
  move,
  complement,
  negate,
  exchange,
  swap_bytes,
  block_move,
  fill_move,
  reset_range,  ///< ZRST
  reset_block,  ///< BKRST
  arithmetic,   ///< + - with two or three operands
  multiply,     ///< * /
  increment,
  decrement,
  real_arithmetic,
  real_multiply,
  logic,           ///< AND OR XOR XNR
  rotate,          ///< ROR RCR ROL RCL
  shift,           ///< SFR SFL
  shift_bits,      ///< BSFR BSFL
  shift_words,     ///< DSFR DSFL
  shift_in_bits,   ///< SFTR SFTL
  shift_in_words,  ///< WSFR WSFL
  to_bcd,
  from_bcd,
  to_real,
  to_double_real,
  from_real,
  truncate_real,
  compare_to_bits,  ///< CMP
  zone_compare,     ///< ZCP
  count_bits,       ///< SUM
  mean,
  limit,
  square_root,
  from,
  to,
  move_text,
  state,      ///< STL
  state_end,  ///< RET of an FX3
  enable_interrupts,
  disable_interrupts,
  interrupt_return,
  read_clock,
  set_clock,
  compare_time,
  compare_time_zone,
  add_times,
  to_seconds,
  from_seconds,
  refresh
};

/// Forms of a name beside the plain one.
enum Form : std::uint8_t {
  with_pulse = 1,    ///< MOVP: once with each rising edge of the condition
  with_double = 2,   ///< DMOV: 32 bits; of contacts LDD=
  with_unsigned = 4  ///< +_U
};

struct Instruction {
  std::string_view names;     ///< one or several that differ in one respect: "LD LDI"
  std::string_view operands;  ///< a letter each; "s d|s s d": two or three
  std::uint8_t families;      ///< bit 1 << Family
  std::uint8_t forms;
  Action action;
  std::string_view meaning;
};

// Letters of operands: s source and d destination of 16 bits, in a double form of 32; w W of 16; l L of 32; e E REAL; f F LREAL;
// x X of twice the width; b B bit; n number; a A first of several words, bits or digits; v the same or a constant; p pointer; N nesting; t T text;
// o what OUT, SET and RST work on; k setting.
[[nodiscard]] std::span<const Instruction> instructions() noexcept;

/// An instruction by one of its names.
struct NamedInstruction {
  const Instruction* instruction = nullptr;
  std::uint8_t variant = 0;
  std::uint8_t forms = 0;  ///< those that the name has
};
/// "DMOVP", "LDD>=_U", in capitals. Empty: the family has none of that name.
[[nodiscard]] std::optional<NamedInstruction> instruction_named(std::string_view name, Family family);
/// The families that have it: "FX3, FX5"; empty for none.
[[nodiscard]] std::string families_with(std::string_view name);

/// Instructions of a family that are not there, and why. Some names end with *: all that begin so.
struct AbsentInstruction {
  std::string_view names;
  std::uint8_t families;
  std::string_view missing;  ///< "there is no PID control loop"
};
[[nodiscard]] std::span<const AbsentInstruction> absent_instructions() noexcept;
/// Null: it is no instruction that the list knows.
[[nodiscard]] const AbsentInstruction* absent_instruction(std::string_view name, Family family);

/// All names of a row in all of its forms, for tests.
[[nodiscard]] std::string form_of_name(const Instruction& instruction, std::string_view name,
                                       std::uint8_t forms);

}  // namespace canopus::instruction_list
