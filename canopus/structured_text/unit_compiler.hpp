#pragma once
// Compiles the statements and expressions of one program organization unit.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/structured_text/body.hpp"
#include "canopus/structured_text/declarations.hpp"

namespace canopus::structured_text {

/// What an expression is: a scalar in a slot of the frame, anything else by its place in the memory, which is in the slot.
struct Value {
  const DataType* type = nullptr;  ///< nullptr after an error
  std::uint32_t slot = 0;
};

/// Where a variable is.
struct Place {
  enum class Kind : std::uint8_t {
    none,      ///< after an error
    frame,     ///< slot of the frame
    global,    ///< slot of the memory
    indirect,  ///< `offset` behind the place that is in a slot of the frame
    element,   ///< of the array `offset` of the elements' table, with the index in a slot of the frame
    device,
    constant,  ///< `value`
    partial    ///< bits of `whole`
  };
  Kind kind = Kind::none;
  const DataType* type = nullptr;
  std::uint32_t slot = 0;
  std::uint32_t offset = 0;
  Slot value = 0;
  std::shared_ptr<Place> whole{};
  unsigned first_bit = 0;
  bool has_index = false;           ///< a device: points or words in `slot` are added to its number
  bool is_constant = false;         ///< must not be written
  std::string_view why_constant{};  ///< and why
  DeviceAccess device{};
};

/// Types of expressions that take the type of what stands beside them.
struct OpenTypes {
  DataType integer{.base = Elementary::lint, .name = "integer literal"};
  DataType real{.base = Elementary::lreal, .name = "real literal"};
  DataType word{.base = Elementary::int_, .name = "word device"};
  DataType double_word{.base = Elementary::dint, .name = "double word device"};
};
[[nodiscard]] const OpenTypes& open_types();

enum class Standard : std::uint8_t;

class UnitCompiler {
 public:
  /// `unit`: nullptr outside of a unit.
  UnitCompiler(Declarations& declarations, UnitInfo* unit, bool is_constant = false)
      : declarations_(declarations), unit_(unit), constants_only_(is_constant) {}

  /// Variables, code and frame of a unit. False after an error.
  bool compile_unit();
  /// A value of a constant expression.
  bool constant(Expression& value, const DataType& type, Slot* to);
  /// Its type without context: an open type for literals.
  const DataType* natural(Expression& expression);

 private:
  static constexpr std::uint32_t nowhere = ~std::uint32_t{0};
  static constexpr std::uint32_t this_slot = 0;  ///< in a method's frame: the place of its instance
  static constexpr std::string_view expected_variable = "expected a variable, not a constant";
  static constexpr std::string_view expected_element =
      "expected an element of it: an array of devices is no value as a whole";
  struct Loop {
    std::vector<std::size_t> exits{};
    std::vector<std::size_t> continues{};
  };

  void error(SourcePosition at, std::string message) { declarations_.error(at, std::move(message)); }
  [[nodiscard]] const DataType* type(Elementary elementary) const {
    return declarations_.elementary(elementary);
  }

  /// A function or a method: its variables begin anew with each call.
  [[nodiscard]] bool is_called() const {
    return unit_->unit->kind == Unit::Kind::function || unit_->unit->kind == Unit::Kind::method;
  }

  // Declarations of the unit
  bool declare_variables();
  bool declare(const VariableSection& section, const VariableNode& node);
  bool declare_external(const VariableSection& section, const VariableNode& node);
  void add_edges();

  // Statements
  void statements(const Statements& list);
  void statement(const Statement& statement);
  void assign(Expression& target, Expression& value);
  void assign_value(const Place& to, Value value, SourcePosition at);
  void if_(const Statement& statement);
  void case_(const Statement& statement);
  void for_(const Statement& statement);
  void while_(const Statement& statement);
  void repeat(const Statement& statement);
  void call_statement(Expression& call);
  /// A jump that is taken if the condition is FALSE; its places to land().
  std::vector<std::size_t> jump_unless(Expression& condition);
  [[nodiscard]] bool has_no_effect(const Expression& expression);
  [[nodiscard]] bool has_call(const Expression& expression);

  // Types of expressions
  const DataType* find_natural(Expression& expression);
  const DataType* place_type(Expression& expression);
  const DataType* binary_type(Expression& expression);
  const DataType* call_type(Expression& call);
  const DataType* common_of(const std::vector<Expression*>& operands);
  const DataType* common(const DataType* a, const DataType* b);
  /// Of an operand beside one of type `other`: a literal that is too large for it has a larger type of its own.
  const DataType* beside(Expression& operand, const DataType* other);
  /// What becomes of an open type where `want` is expected.
  const DataType* resolved(const DataType* open, const DataType* want, const Expression& expression);
  bool can_become(const DataType& from, const DataType& to) const;

  // Expressions
  /// Of type `want`, if that is not nullptr; into slot `into`, if that suits.
  Value expression(Expression& expression, const DataType* want, std::uint32_t into = nowhere);
  Value plain(Expression& expression, const DataType* want, std::uint32_t into);
  Value literal(Expression& expression, const DataType* want);
  Value typed_literal(Expression& expression);
  Value string_literal(Expression& expression);
  /// What a literal between quotes means; empty after an error.
  std::optional<std::vector<std::uint16_t>> characters_of(const Expression& literal, std::string_view text,
                                                          bool is_wide);
  Value character_literal(const Expression& literal, std::string_view text, const DataType* type);
  /// Which operands are read by this instruction last, as BitOperands has it.
  [[nodiscard]] std::uint16_t uses_of(std::uint32_t b, std::uint32_t c) const;
  Value unary(Expression& expression, const DataType* want, std::uint32_t into);
  Value binary(Expression& expression, const DataType* want, std::uint32_t into);
  Value compare(Expression& expression, std::uint32_t into);
  /// By operator `name`; both of one type.
  Value compare_values(std::string_view name, Value a, Value b, std::uint32_t into);
  Value time_arithmetic(Expression& expression, std::uint32_t into);
  /// Both operands of a type; the first one is kept from what the second one's functions do.
  std::pair<Value, Value> operands(Expression& expression, const DataType* a, const DataType* b);
  Value convert(Value value, const DataType* to, SourcePosition at, bool is_explicit,
                std::uint32_t into = nowhere);
  Value numeric_conversion(Value value, const DataType* to, std::uint32_t into, bool truncates);
  [[nodiscard]] Value constant_value(Slot value, const DataType* type) {
    return {type, body_.constant(value)};
  }
  std::uint32_t target(std::uint32_t into) { return into == nowhere ? body_.temporary() : into; }

  // Variables
  Place place(Expression& expression);
  Place named(Expression& expression);
  /// A variable of the unit, or of a method's block; empty: there is none of that name.
  std::optional<Place> own_variable(Expression& expression);
  Place member_place(const UnitInfo& scope, const program::Member& member, Place place);
  static bool is_device_array(const Place& place) {
    return place.kind == Place::Kind::device && !place.type->is_scalar();
  }
  /// What stands behind "there is no variable": what has that name, or what to write.
  std::string what_it_is(std::string_view name);
  /// Color.red, as CODESYS writes Color#red; nullptr: it is none.
  const EnumerationValue* qualified_value(const Expression& member);
  Place member(Expression& expression);
  Place indexed(Expression& expression);
  Place device_place(const DeviceAccess& access, const DataType* type = nullptr, bool is_constant = false);
  Place member_of(const Place& whole, const program::Member& member);
  Place element_of(Place array, Expression& index, bool is_last);
  std::optional<unsigned> partial_access(Expression& expression, const DataType& whole, Elementary& part);
  Value load(const Place& place);
  void store(const Place& place, Value value);
  std::uint32_t address_of(const Place& place);
  bool is_variable(std::string_view name);
  /// VAR_EXTERNAL CONSTANT: the unit only reads the global variable.
  [[nodiscard]] bool is_constant_external(std::string_view name) const;
  [[nodiscard]] bool is_own_function(std::string_view name) const;

  // Calls
  /// The function block that the code is of, or of that the method is; nullptr: none.
  [[nodiscard]] UnitInfo* own_block();
  [[nodiscard]] bool is_this(const Expression& expression);
  /// instance.method, THIS.method, or a method within its block; nullptr: the call is of something else.
  UnitInfo* method_of(Expression& callee);
  const DataType* result_of(Expression& call, UnitInfo& function);
  std::uint32_t instance_address(Expression& callee);
  /// Takes EN and ENO out of the arguments, unless the unit has variables of these names.
  static void extract_enable(Expression& call, const UnitInfo* unit);
  template <typename Call>
  void if_enabled(Expression& expression, Call call);
  Value enabled_value(Expression& expression, const DataType* want);
  Value call(Expression& call, const DataType* want, std::uint32_t into);
  Value function_call(Expression& call, UnitInfo& function);
  void block_call(Expression& call, const Place& instance);
  /// The output of a call to the variable behind =>, inverted behind NOT.
  void assign_output(const Place& to, Value value, const Argument& argument);
  struct Bound {
    const program::Member* member;
    Argument* argument;
  };
  /// Which argument is for which variable; false after an error.
  bool bind(Expression& call, UnitInfo& unit, std::vector<Bound>& to);
  Place writable(Expression& expression, const DataType& type);
  Value native(std::string_view name, const std::vector<Value>& arguments, const DataType* result);
  Value native_string(std::string_view name, const std::vector<Value>& arguments, bool is_wide,
                      std::uint32_t capacity);

  // Standard functions
  bool arrange(Expression& call, std::string_view names, std::size_t least, std::size_t most);
  const DataType* standard_type(Expression& call);
  Value standard_call(Expression& call, const DataType* want, std::uint32_t into);
  void split_call(Expression& call);
  std::vector<Value> kept_values(const std::vector<Expression*>& given, const DataType* wanted);
  Value compare_all(std::string_view name, Expression& call);
  Value selection(Standard which, Expression& call, const DataType* want);
  Value string_function(Standard which, Expression& call);
  std::vector<Expression*> arguments_of(Expression& call, std::size_t from = 0);

  Declarations& declarations_;
  UnitInfo* unit_;
  bool constants_only_;
  Body body_;
  std::vector<Loop> loops_;
  struct EdgeInput {
    std::uint32_t slot, before;
    bool is_rising;
  };
  std::vector<EdgeInput> edges_;
  std::uint32_t reset_first_ = 0;
  std::uint32_t reset_slots_ = 0;
};

}  // namespace canopus::structured_text
