#pragma once
// What the files of a program declare: types, global variables and program organization units, found by name and compiled when they
// are first needed.

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/program/program.hpp"
#include "canopus/program/standard_functions.hpp"
#include "canopus/structured_text/syntax_tree.hpp"

namespace canopus::structured_text {

using program::DataType;
using program::DeviceAccess;
using program::Elementary;
using program::Slot;

enum class Progress : std::uint8_t { untouched, begun, done, failed };

/// A variable that is a device, or an array of them.
struct LocatedVariable {
  DeviceAccess device;  ///< the first one
  const DataType* type = nullptr;
  bool is_constant = false;  ///< the program only reads it
};

struct UnitInfo {
  const Unit* unit = nullptr;  ///< nullptr: a standard block
  const program::StandardBlock* standard = nullptr;
  Progress progress = Progress::untouched;
  DataType* type = nullptr;  ///< its variables; a block also as the type of its instances
  const DataType* result = nullptr;
  std::uint32_t function = 0;  ///< its number in the program; of a standard block that of its native function
  std::map<std::string_view, std::size_t> members{};  ///< by their names in capitals
  std::map<std::string_view, LocatedVariable> located{};
  std::map<std::string_view, bool> externals{};     ///< VAR_EXTERNAL, and whether it is CONSTANT
  std::map<std::uint32_t, Slot> constants{};        ///< values of its scalar constants, by their slots
  std::map<std::string_view, UnitInfo*> methods{};  ///< of a function block
  UnitInfo* owner = nullptr;                        ///< of a method: its function block
};

struct GlobalInfo {
  const VariableNode* node = nullptr;
  const VariableSection* section = nullptr;
  Progress progress = Progress::untouched;
  const DataType* type = nullptr;
  std::uint32_t place = 0;
  std::optional<DeviceAccess> located{};
};

struct EnumerationValue {
  const DataType* type = nullptr;
  std::int64_t value = 0;
};

class Declarations {
 public:
  Declarations(program::Program& to, const program::DeviceNames* devices, std::vector<SourceError>& errors);

  void add(const SyntaxTree& tree);
  /// Types, variables and units that nothing has needed so far.
  void compile_all();

  void error(SourcePosition at, std::string message);
  /// Something cannot be used because of an error that was reported.
  void failed() noexcept { ++mistakes_; }
  /// Errors so far, also those that were not worth a second report.
  [[nodiscard]] std::size_t mistakes() const noexcept { return mistakes_; }

  [[nodiscard]] const DataType* elementary(Elementary type) const {
    return elementary_[static_cast<std::size_t>(type)];
  }
  [[nodiscard]] const DataType* string_of(bool is_wide, std::uint32_t capacity);
  /// A type that stands in a declaration; nullptr after an error.
  [[nodiscard]] const DataType* type_of(const TypeNode& node, UnitInfo* scope);
  /// By its name in capitals; nullptr: there is none, or an error was reported.
  [[nodiscard]] const DataType* type_named(std::string_view name, SourcePosition at);
  [[nodiscard]] bool has_type(std::string_view name) const;

  [[nodiscard]] UnitInfo* unit_named(std::string_view name);
  [[nodiscard]] UnitInfo* unit_of(const DataType& block);
  /// Compiles it, if that has not been done. False after an error.
  [[nodiscard]] bool require(UnitInfo& unit, SourcePosition at);
  /// The variable with its type and place; nullptr: there is none, or an error was reported.
  [[nodiscard]] GlobalInfo* global_named(std::string_view name, SourcePosition at);
  [[nodiscard]] const std::vector<EnumerationValue>* enumeration_values(std::string_view name) const;

  /// Writes the initial value that a declaration has for its variable.
  void initialize(const DataType& type, Expression& value, Slot* to, UnitInfo* scope);
  /// A constant expression of the type; false after an error.
  bool constant(Expression& value, const DataType& type, Slot* to, UnitInfo* scope);
  [[nodiscard]] std::optional<std::int64_t> integer_constant(Expression& value, UnitInfo* scope);

  /// "D0Z1", "K4M0", "%MW0.10" in capitals, with the type that follows a colon. Empty after an error.
  [[nodiscard]] std::optional<DeviceAccess> device(std::string_view text, std::string_view type,
                                                   SourcePosition at);
  [[nodiscard]] bool looks_like_device(std::string_view text) const;
  /// The device of a variable AT one, of an array the first one. Empty after an error.
  [[nodiscard]] std::optional<DeviceAccess> locate(const VariableNode& node, const DataType& type);

  [[nodiscard]] std::uint32_t native(program::Native function);
  [[nodiscard]] std::uint32_t add_element(program::ElementAccess element);
  [[nodiscard]] std::uint32_t add_device(DeviceAccess device);
  [[nodiscard]] std::uint32_t allocate(std::uint32_t slots);
  /// Counts slots of initial values that types and units hold; false, with an error, where they are too many.
  [[nodiscard]] bool may_hold(std::size_t slots, SourcePosition at);
  [[nodiscard]] program::Program& program() noexcept { return program_; }

 private:
  struct NamedType {
    const TypeDeclaration* node = nullptr;
    const DataType* type = nullptr;
    Progress progress = Progress::untouched;
  };

  DataType& make(DataType type);
  /// Arrays and structures within one another; of a function block, of a variable without any: 0.
  [[nodiscard]] unsigned depth_of(const DataType& type) const;
  void is_too_deep(SourcePosition at);
  [[nodiscard]] const DataType* make_type(const TypeNode& node, UnitInfo* scope);
  [[nodiscard]] const DataType* array_of(const TypeNode& node, UnitInfo* scope);
  [[nodiscard]] const DataType* structure_of(const TypeNode& node, UnitInfo* scope);
  [[nodiscard]] const DataType* enumeration_of(const TypeNode& node, UnitInfo* scope);
  [[nodiscard]] const DataType* subrange_of(const TypeNode& node, UnitInfo* scope);
  void add_standard_blocks();
  void declare(GlobalInfo& global);
  void compile_unit(UnitInfo& unit);
  void initialize_array(const DataType& type, Expression& value, Slot* to, UnitInfo* scope);
  void expand(Expression& list, std::vector<Expression*>& to, std::size_t most);

  program::Program& program_;
  const program::DeviceNames* devices_;
  std::vector<SourceError>& errors_;
  std::set<std::pair<std::uint64_t, std::uint32_t>> error_places_;
  std::size_t mistakes_ = 0;
  std::vector<const DataType*> elementary_;
  std::map<std::pair<bool, std::uint32_t>, const DataType*> strings_;
  std::map<std::string_view, NamedType> types_;
  std::map<const TypeNode*, const DataType*>
      type_of_node_;  // variables that are declared together have one type
  std::map<std::string_view, UnitInfo> units_;
  std::deque<UnitInfo> methods_;
  std::vector<UnitInfo*> unit_order_;
  std::map<const DataType*, UnitInfo*> unit_of_type_;
  std::map<std::string_view, GlobalInfo> globals_;
  std::vector<std::string_view> global_order_;
  std::map<std::string, std::vector<EnumerationValue>, std::less<>> enumeration_values_;
  std::map<program::Native, std::uint32_t> natives_;
  std::size_t held_ = 0;                        // slots of initial values
  std::map<const DataType*, unsigned> depths_;  // of arrays and structures
  unsigned depth_ = 0;                          // of units that need each other
  unsigned nested_types_ = 0;                   // types that are being made
  unsigned nested_globals_ = 0;                 // global variables that are being declared
};

}  // namespace canopus::structured_text
