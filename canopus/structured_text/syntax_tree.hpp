#pragma once
// A source of Structured Text as the parser reads it. Names are in capitals and refer to the source's text.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/structured_text/token.hpp"

namespace canopus::structured_text {

struct Expression;
using ExpressionPtr = std::unique_ptr<Expression>;

/// NAME := value, NAME => variable, or a value alone.
struct Argument {
  SourcePosition at{};
  std::string_view name{};
  bool is_output = false;
  bool is_negated = false;  ///< NOT NAME => variable
  ExpressionPtr value{};
};

struct Expression {
  enum class Kind : std::uint8_t {
    wrong,  ///< was reported
    integer,
    real,
    string,
    wide_string,
    typed_literal,
    name,
    member,        ///< of the first child
    index,         ///< of the first child by the others
    typed_device,  ///< D0:REAL: type `name` of the first child
    unary,
    binary,
    call,
    typed_value,  ///< the first child as type `name`: an input of ADD_INT
    list,         ///< initial value of an array: [1, 2, 3(0)]
    repeat,       ///< 3(0) in it: how often, then what
    fields        ///< initial value of a structure: (a := 1)
  };
  Kind kind = Kind::wrong;
  SourcePosition at{};
  std::string_view name{};     ///< or the operator, or a literal's prefix
  std::string_view written{};  ///< a name or literal as it stands in the source
  std::uint64_t number = 0;
  double real = 0;
  bool is_based = false;
  std::uint32_t depth = 1;  ///< of the tree below
  std::vector<ExpressionPtr> children{};
  std::vector<Argument> arguments{};  ///< of a call or of fields
  ExpressionPtr enable{};  ///< EN := of a call, once the compiler has found that it is not the unit's own
  ExpressionPtr enable_output{};            ///< ENO =>
  bool inverts_enable_output = false;       ///< NOT ENO =>
  const program::DataType* type = nullptr;  ///< found by the compiler
  bool is_typed = false;                    ///< `type` was determined
};

struct TypeNode {
  enum class Kind : std::uint8_t {
    wrong,
    named,
    string,
    wide_string,
    array,
    structure,
    enumeration,
    subrange
  };
  Kind kind = Kind::wrong;
  SourcePosition at{};
  std::string_view name{};  ///< of a named type, or the base of an enumeration or subrange
  ExpressionPtr length{};   ///< of a string
  struct Range {
    ExpressionPtr low{};
    ExpressionPtr high{};
  };
  std::vector<Range> ranges{};  ///< of an array, or one of a subrange
  std::shared_ptr<TypeNode> element{};
  struct Value {
    SourcePosition at{};
    std::string_view name{};
    std::string_view written{};
    ExpressionPtr number{};
  };
  std::vector<Value> values{};
  std::vector<struct VariableNode> fields;  // not complete yet: no initializer here
};

struct VariableNode {
  SourcePosition at{};
  std::string_view name{};
  std::string_view written{};
  std::string_view location{};  ///< AT
  SourcePosition location_at{};
  std::shared_ptr<TypeNode> type{};
  std::shared_ptr<Expression> initial{};
  enum class Edge : std::uint8_t { none, rising, falling } edge = Edge::none;
};

struct VariableSection {
  enum class Kind : std::uint8_t { local, input, output, in_out, temporary, external, global };
  Kind kind = Kind::local;
  SourcePosition at{};
  bool is_constant = false;
  bool is_retained = false;
  std::vector<VariableNode> variables{};
};

struct Statement;
using Statements = std::vector<Statement>;

struct Branch {
  SourcePosition at{};
  ExpressionPtr condition{};              ///< of IF; none: ELSE
  std::vector<TypeNode::Range> labels{};  ///< of CASE; without `high`: one value
  Statements body;                        // Statement is not complete yet: no initializer here
};

struct Statement {
  enum class Kind : std::uint8_t { assign, call, if_, case_, for_, while_, repeat, exit, continue_, return_ };
  Kind kind = Kind::assign;
  SourcePosition at{};
  ExpressionPtr target{};  ///< of an assignment or FOR; a call
  ExpressionPtr value{};   ///< of an assignment; condition; first value of FOR; selector of CASE
  ExpressionPtr limit{};   ///< TO
  ExpressionPtr step{};    ///< BY
  std::vector<Branch> branches{};
  Statements body{};
};

struct TypeDeclaration {
  SourcePosition at{};
  std::string_view name{};
  std::string_view written{};
  std::shared_ptr<TypeNode> type{};
  std::shared_ptr<Expression> initial{};
};

/// A program organization unit.
struct Unit {
  enum class Kind : std::uint8_t { program, function, block, method };
  Kind kind = Kind::program;
  SourcePosition at{};
  SourcePosition end{};  ///< of END_PROGRAM ...
  std::string_view name{};
  std::string_view written{};
  std::shared_ptr<TypeNode> result{};
  std::vector<VariableSection> sections{};
  Statements body{};
  std::vector<Unit> methods{};  ///< of a function block
  bool is_private = false;      ///< a method that the block alone calls
};

/// "function block"
[[nodiscard]] std::string_view text_of(Unit::Kind kind);

struct SyntaxTree {
  std::vector<TypeDeclaration> types{};
  std::vector<VariableSection> globals{};
  std::vector<Unit> units{};
};

/// Reads one file; its mistakes are added to `errors`, and what could be read is returned.
[[nodiscard]] SyntaxTree parse(const std::vector<Token>& tokens, std::vector<SourceError>& errors);

}  // namespace canopus::structured_text
