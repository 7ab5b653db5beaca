#include <algorithm>
#include <array>
#include <utility>

#include "canopus/structured_text/syntax_tree.hpp"

namespace canopus::structured_text {

namespace {

using Kind = Token::Kind;
using Expr = Expression::Kind;

constexpr unsigned deepest = 100;             // of nested expressions, statements and types
constexpr std::uint32_t deepest_tree = 1000;  // of one expression
constexpr std::size_t most_syntax_errors = 100;

constexpr std::array<std::string_view, 71> keywords = {"AND",
                                                       "ARRAY",
                                                       "AT",
                                                       "BY",
                                                       "CASE",
                                                       "CONFIGURATION",
                                                       "CONSTANT",
                                                       "CONTINUE",
                                                       "DO",
                                                       "ELSE",
                                                       "ELSIF",
                                                       "END_CASE",
                                                       "END_CONFIGURATION",
                                                       "END_FOR",
                                                       "END_FUNCTION",
                                                       "END_FUNCTION_BLOCK",
                                                       "END_IF",
                                                       "END_PROGRAM",
                                                       "END_REPEAT",
                                                       "END_STRUCT",
                                                       "END_TYPE",
                                                       "END_VAR",
                                                       "END_WHILE",
                                                       "EXIT",
                                                       "FALSE",
                                                       "FOR",
                                                       "FUNCTION",
                                                       "FUNCTION_BLOCK",
                                                       "IF",
                                                       "MOD",
                                                       "NON_RETAIN",
                                                       "NOT",
                                                       "OF",
                                                       "OR",
                                                       "PROGRAM",
                                                       "R_EDGE",
                                                       "F_EDGE",
                                                       "REPEAT",
                                                       "RETAIN",
                                                       "RETURN",
                                                       "STRUCT",
                                                       "THEN",
                                                       "TO",
                                                       "TRUE",
                                                       "TYPE",
                                                       "UNTIL",
                                                       "VAR",
                                                       "VAR_EXTERNAL",
                                                       "VAR_GLOBAL",
                                                       "VAR_INPUT",
                                                       "VAR_IN_OUT",
                                                       "VAR_OUTPUT",
                                                       "VAR_TEMP",
                                                       "WHILE",
                                                       "XOR",
                                                       "METHOD",
                                                       "END_METHOD",
                                                       "CLASS",
                                                       "END_CLASS",
                                                       "INTERFACE",
                                                       "END_INTERFACE",
                                                       "NAMESPACE",
                                                       "END_NAMESPACE",
                                                       "REF_TO",
                                                       "VAR_ACCESS",
                                                       "VAR_CONFIG",
                                                       "PERSISTENT",
                                                       "EXTENDS",
                                                       "IMPLEMENTS",
                                                       "GOTO",
                                                       "ACTION"};

bool is_keyword(std::string_view name) { return std::ranges::find(keywords, name) != keywords.end(); }

/// What stands in place of a word of the standard, or of CODESYS, that is not there.
constexpr std::array<std::pair<std::string_view, std::string_view>, 20> instead_of = {
    {{"CONFIGURATION", "tasks are [[plc.task]] of the plant file; VAR_GLOBAL stands by itself"},
     {"CLASS", "a FUNCTION_BLOCK with methods is one"},
     {"INTERFACE", "there is no inheritance"},
     {"NAMESPACE", "there are no namespaces"},
     {"USING", "there are no namespaces"},
     {"EXTENDS", "there is no inheritance"},
     {"IMPLEMENTS", "there is no inheritance"},
     {"ABSTRACT", "there is no inheritance"},
     {"FINAL", "there is no inheritance"},
     {"PROPERTY", "write methods"},
     {"POINTER", "there are no pointers; VAR_IN_OUT passes a variable itself"},
     {"REFERENCE", "there are no references; VAR_IN_OUT passes a variable itself"},
     {"REF_TO", "there are no references; VAR_IN_OUT passes a variable itself"},
     {"UNION", "there is none; parts of a bit string are x.%B0, x.%W1"},
     {"AND_THEN", "AND evaluates both sides; write an IF within an IF"},
     {"OR_ELSE", "OR evaluates both sides; write ELSIF"},
     {"INITIAL_STEP", "there is no sequential function chart; write a CASE over an enumeration"},
     {"STEP", "there is no sequential function chart; write a CASE over an enumeration"},
     {"TRANSITION", "there is no sequential function chart; write a CASE over an enumeration"},
     {"ACTION", "there are no actions; write a METHOD of a function block"}}};

/// " (...)", or nothing.
std::string hint_for(std::string_view word) {
  const auto* const found =
      std::ranges::find(instead_of, word, &std::pair<std::string_view, std::string_view>::first);
  return found == instead_of.end() ? std::string() : " (" + std::string(found->second) + ")";
}

/// END_... or VAR...; "variable" and "end_position" are names like any other.
bool is_end_or_section(std::string_view name) {
  return (name.starts_with("END_") || name.starts_with("VAR")) && is_keyword(name);
}

class Parser {
 public:
  Parser(const std::vector<Token>& tokens, std::vector<SourceError>& errors)
      : tokens_(tokens), errors_(errors) {}

  SyntaxTree run() {
    SyntaxTree tree;
    while (!is_end()) {
      if (accept("TYPE")) {
        types(tree);
      } else if (accept("VAR_GLOBAL")) {
        tree.globals.push_back(section(VariableSection::Kind::global));
      } else if (accept("PROGRAM")) {
        tree.units.push_back(unit(Unit::Kind::program, "END_PROGRAM"));
      } else if (accept("FUNCTION")) {
        tree.units.push_back(unit(Unit::Kind::function, "END_FUNCTION"));
      } else if (accept("FUNCTION_BLOCK")) {
        tree.units.push_back(unit(Unit::Kind::block, "END_FUNCTION_BLOCK"));
      } else {
        error("expected PROGRAM, FUNCTION, FUNCTION_BLOCK, TYPE or VAR_GLOBAL" + hint_for(now().text));
        for (const auto& [begin, end] :
             {std::pair("CONFIGURATION", "END_CONFIGURATION"), std::pair("CLASS", "END_CLASS"),
              std::pair("INTERFACE", "END_INTERFACE")})
          if (is(begin)) skip_to({end});  // a PROGRAM in it is none
        skip_to({"TYPE", "VAR_GLOBAL", "PROGRAM", "FUNCTION", "FUNCTION_BLOCK"});
      }
    }
    return tree;
  }

 private:
  // Tokens

  [[nodiscard]] const Token& now() const { return tokens_[at_]; }
  [[nodiscard]] const Token& ahead(std::size_t distance) const {
    return tokens_[std::min(at_ + distance, tokens_.size() - 1)];
  }
  [[nodiscard]] bool is_end() const { return now().kind == Kind::end; }
  void advance() {
    if (at_ + 1 < tokens_.size()) ++at_;
  }
  static bool matches(const Token& token, std::string_view text) {
    return (token.kind == Kind::name || token.kind == Kind::symbol) && token.text == text;
  }
  [[nodiscard]] bool is(std::string_view text) const { return matches(now(), text); }
  bool accept(std::string_view text) {
    if (!is(text)) return false;
    advance();
    return true;
  }
  bool expect(std::string_view text) {
    if (accept(text)) return true;
    error("expected " + std::string(text));
    return false;
  }
  [[nodiscard]] bool is_name() const { return now().kind == Kind::name && !is_keyword(now().text); }

  // Errors: the first of a statement or declaration; then the parser goes on behind it.

  void error(std::string message) { error_at(now(), std::move(message)); }
  void error_at(const Token& token, std::string message) {
    if (is_lost_) return;
    is_lost_ = true;
    if (token.kind == Kind::wrong || errors_.size() >= most_syntax_errors) return;  // was reported
    message += token.kind == Kind::end ? ", found the end of the file"
                                       : ", found '" + std::string(token.written) + "'";
    errors_.push_back({token.at, std::move(message)});
  }
  void skip_to(std::initializer_list<std::string_view> texts) {
    while (!is_end() && std::ranges::none_of(texts, [this](std::string_view text) { return is(text); }))
      advance();
    is_lost_ = false;
  }
  /// Behind the next ';', or at what ends the statements or declarations.
  void recover() {
    is_lost_ = false;
    while (!is_end()) {
      if (accept(";")) return;
      if (now().kind == Kind::name &&
          (is_end_or_section(now().text) || now().text == "ELSE" || now().text == "ELSIF" ||
           now().text == "UNTIL" || now().text == "PROGRAM" || now().text == "FUNCTION" ||
           now().text == "FUNCTION_BLOCK"))
        return;
      advance();
    }
  }

  struct Nesting {
    explicit Nesting(Parser& parser) : parser_(parser) { ++parser_.depth_; }
    Nesting(const Nesting&) = delete;
    Nesting& operator=(const Nesting&) = delete;
    ~Nesting() { --parser_.depth_; }
    [[nodiscard]] bool is_too_deep() const {
      if (parser_.depth_ <= deepest) return false;
      parser_.error("expected at most " + std::to_string(deepest) + " levels of nesting");
      return true;
    }
    Parser& parser_;
  };

  /// A round of a loop that stands where it began would be repeated for ever.
  struct Progress {
    explicit Progress(Parser& parser) : parser_(parser), at_(parser.at_) {}
    void ensure() const {
      if (parser_.at_ == at_) parser_.advance();
      at_ = parser_.at_;
    }
    Parser& parser_;
    mutable std::size_t at_;
  };

  // Declarations

  void types(SyntaxTree& tree) {
    for (const Progress progress(*this); !is_end() && !is("END_TYPE"); progress.ensure()) {
      TypeDeclaration declaration{.at = now().at, .name = now().text, .written = now().written};
      if (!is_name()) {
        error("expected the name of a type or END_TYPE");
        if (is_unit_start()) break;
      } else {
        advance();
        if (is("EXTENDS")) error("expected :" + hint_for(now().text));
        expect(":");
        declaration.type = type();
        if (!is_lost_ && accept(":=")) declaration.initial = initial_value_of(*declaration.type);
        const bool is_struct = declaration.type->kind == TypeNode::Kind::structure;
        if (!is_lost_ && !accept(";") && !is_struct) error("expected ;");
      }
      if (is_lost_) {
        recover();
      } else {
        tree.types.push_back(std::move(declaration));
      }
      if (is_unit_start()) break;
    }
    if (!accept("END_TYPE")) {
      error("expected END_TYPE");
      is_lost_ = false;
    }
  }

  [[nodiscard]] bool is_unit_start() const {
    return is("PROGRAM") || is("FUNCTION") || is("FUNCTION_BLOCK") || is("VAR_GLOBAL") || is("TYPE");
  }

  /// [IEC 61131-3 6.5.2.2]
  static bool may_be_constant(VariableSection::Kind kind) {
    return kind == VariableSection::Kind::local || kind == VariableSection::Kind::global ||
           kind == VariableSection::Kind::external;
  }

  VariableSection section(VariableSection::Kind kind) {
    VariableSection found{.kind = kind, .at = now().at};
    const bool is_external = kind == VariableSection::Kind::external;
    while (true) {
      if (is("CONSTANT") && !may_be_constant(kind)) {
        error("expected CONSTANT behind VAR, VAR_GLOBAL or VAR_EXTERNAL alone");
        break;
      }
      if (accept("CONSTANT")) {
        found.is_constant = true;
      } else if (accept("RETAIN") || accept("PERSISTENT")) {
        found.is_retained = true;
      } else if (!accept("NON_RETAIN")) {
        break;
      }
    }
    for (const Progress progress(*this); !is_end() && !is("END_VAR"); progress.ensure()) {
      if (is_name()) {
        variables(found.variables, !is_external, !is_external && kind != VariableSection::Kind::global);
      } else {
        error("expected the name of a variable or END_VAR");
        if (is_unit_start() || now().text.starts_with("VAR") || now().text.starts_with("END_")) break;
      }
      if (is_lost_) {
        recover();
        if (is_unit_start()) break;
      }
    }
    if (!accept("END_VAR")) error("expected END_VAR");
    is_lost_ = false;
    return found;
  }

  /// a, b AT D0 : INT := 1; in a STRUCT without AT, there and in VAR_GLOBAL and VAR_EXTERNAL without edges.
  void variables(std::vector<VariableNode>& to, bool has_device, bool has_edge) {
    const std::size_t first = to.size();
    do {
      if (!is_name()) return error("expected the name of a variable");
      VariableNode variable{.at = now().at, .name = now().text, .written = now().written};
      advance();
      if (!has_device && is("AT")) return error("expected : (this variable has no device)");
      if (accept("AT")) {
        if (now().kind != Kind::name) return error("expected a device after AT");
        variable.location = now().text;
        variable.location_at = now().at;
        advance();
        if (is(".") && !now().follows_blank) {  // D100.3
          const char* const begin = variable.location.data();
          advance();
          variable.location = {begin,
                               static_cast<std::size_t>(now().text.data() + now().text.size() - begin)};
          advance();
        }
      }
      to.push_back(std::move(variable));
    } while (accept(","));
    if (!expect(":")) return;
    const auto shared = type();
    std::shared_ptr<Expression> initial;
    auto edge = VariableNode::Edge::none;
    if (!is_lost_ && has_edge) {
      if (accept("R_EDGE")) {
        edge = VariableNode::Edge::rising;
      } else if (accept("F_EDGE")) {
        edge = VariableNode::Edge::falling;
      }
    }
    if (!is_lost_ && accept(":=")) initial = initial_value_of(*shared);
    if (!is_lost_) expect(";");
    for (std::size_t i = first; i < to.size(); ++i) {
      to[i].type = shared;
      to[i].initial = initial;
      to[i].edge = edge;
    }
  }

  std::shared_ptr<TypeNode> type() {
    auto found = std::make_shared<TypeNode>();
    found->at = now().at;
    const Nesting nesting(*this);
    if (nesting.is_too_deep()) return found;
    if (accept("ARRAY")) {
      found->kind = TypeNode::Kind::array;
      expect("[");
      do found->ranges.push_back(range());
      while (!is_lost_ && accept(","));
      expect("]");
      expect("OF");
      if (!is_lost_) found->element = type();
      if (found->element == nullptr) found->kind = TypeNode::Kind::wrong;
      return found;
    }
    if (accept("STRUCT")) {
      found->kind = TypeNode::Kind::structure;
      for (const Progress progress(*this);
           !is_end() && !is("END_STRUCT") && !is("END_TYPE") && !is_unit_start(); progress.ensure()) {
        if (is_name()) {
          variables(found->fields, false, false);
        } else {
          error("expected the name of an element or END_STRUCT");
        }
        if (is_lost_) {
          recover();
          if (now().text.starts_with("VAR")) break;
        }
      }
      expect("END_STRUCT");
      return found;
    }
    if (is("(")) {
      found->kind = TypeNode::Kind::enumeration;
      enumeration(*found);
      if (!is_lost_ && is_name()) {  // (red, green) DINT, as CODESYS has the base type
        found->name = now().text;
        advance();
      }
      return found;
    }
    if (is("REF_TO") || is("UNION") || ((is("POINTER") || is("REFERENCE")) && matches(ahead(1), "TO"))) {
      error("expected a type" + hint_for(now().text));
      return found;
    }
    if (is("STRING") || is("WSTRING")) {
      found->kind = is("STRING") ? TypeNode::Kind::string : TypeNode::Kind::wide_string;
      advance();
      const bool is_round = is("(");
      if (accept("[") || accept("(")) {
        found->length = expression();
        expect(is_round ? ")" : "]");
      }
      return found;
    }
    if (!is_name()) {
      error("expected a type");
      return found;
    }
    found->kind = TypeNode::Kind::named;
    found->name = now().text;
    advance();
    if (is("(")) {
      // INT (0..10), or INT (red, green): an enumeration with a base type
      const bool is_enumeration =
          ahead(1).kind == Kind::name &&
          (matches(ahead(2), ",") || matches(ahead(2), ":=") || matches(ahead(2), ")"));
      if (is_enumeration) {
        found->kind = TypeNode::Kind::enumeration;
        enumeration(*found);
      } else {
        found->kind = TypeNode::Kind::subrange;
        advance();
        found->ranges.push_back(range());
        expect(")");
      }
    }
    return found;
  }

  void enumeration(TypeNode& to) {
    expect("(");
    do {
      if (!is_name()) return error("expected the name of a value");
      TypeNode::Value value{.at = now().at, .name = now().text, .written = now().written};
      advance();
      if (accept(":=")) value.number = expression();
      to.values.push_back(std::move(value));
    } while (!is_lost_ && accept(","));
    expect(")");
  }

  TypeNode::Range range() {
    TypeNode::Range found;
    found.low = expression();
    expect("..");
    found.high = expression();
    return found;
  }

  /// Of an array also without brackets, as in the second edition of the standard: 1, 2, 3(0).
  ExpressionPtr initial_value_of(const TypeNode& type) {
    if (type.kind != TypeNode::Kind::array || is("[")) return initial_value();
    auto found = std::make_unique<Expression>();
    found->kind = Expr::list;
    found->at = now().at;
    elements(*found);
    return found;
  }

  /// 1, 2, 3(0)
  void elements(Expression& list) {
    do {
      if (is("]")) break;
      if (now().kind == Kind::integer && matches(ahead(1), "(")) {
        auto repeat = std::make_unique<Expression>();
        repeat->kind = Expr::repeat;
        repeat->at = now().at;
        repeat->number = now().number;
        advance();
        advance();
        do repeat->children.push_back(initial_value());
        while (!is_lost_ && accept(","));
        expect(")");
        list.children.push_back(std::move(repeat));
      } else {
        list.children.push_back(initial_value());
      }
    } while (!is_lost_ && accept(","));
  }

  ExpressionPtr initial_value() {
    const Nesting nesting(*this);
    auto found = std::make_unique<Expression>();
    found->at = now().at;
    if (nesting.is_too_deep()) return found;
    if (accept("[")) {
      found->kind = Expr::list;
      if (!is("]")) elements(*found);
      expect("]");
      return found;
    }
    if (is("(") && ahead(1).kind == Kind::name && matches(ahead(2), ":=")) {
      advance();
      found->kind = Expr::fields;
      do {
        Argument field{.at = now().at, .name = now().text};
        if (!is_name()) {
          error("expected the name of an element");
          break;
        }
        advance();
        expect(":=");
        field.value = initial_value();
        found->arguments.push_back(std::move(field));
      } while (!is_lost_ && accept(","));
      expect(")");
      return found;
    }
    return expression();
  }

  Unit unit(Unit::Kind kind, std::string_view end) {
    Unit found{.kind = kind, .at = now().at, .name = now().text, .written = now().written};
    if (is_name()) {
      advance();
    } else {
      error("expected the name of the " + std::string(text_of(kind)));
    }
    if (is("EXTENDS") || is("IMPLEMENTS")) error("expected VAR or statements" + hint_for(now().text));
    if ((found.name == "ABSTRACT" || found.name == "FINAL") && is_name() && !matches(ahead(1), ":=") &&
        !matches(ahead(1), "("))
      error_at(tokens_[at_ - 1],
               "expected the name of the " + std::string(text_of(kind)) + hint_for(found.name));
    if (!is_lost_ && is(":")) {
      if (kind != Unit::Kind::function && kind != Unit::Kind::method)
        error("expected VAR or statements: only a function or a method has a result");
      advance();
      found.result = type();
    }
    if (is_lost_) recover();
    accept(";");
    while (sections(found) || (kind == Unit::Kind::block && method(found))) {
    }
    statements(found.body);
    while (!is_end() && !is(end)) {
      if (is_unit_start()) break;
      // The standard has methods before the statements; exports have them behind, too.
      if (kind == Unit::Kind::block && method(found)) continue;
      error("expected a statement or " + std::string(end));
      is_lost_ = false;
      advance();
      statements(found.body);
    }
    found.end = now().at;
    if (!accept(end)) error("expected " + std::string(end));
    accept(";");
    is_lost_ = false;
    return found;
  }

  /// METHOD PRIVATE name : type ... END_METHOD
  bool method(Unit& block) {
    if (!accept("METHOD")) return false;
    const bool has_access = ahead(1).kind == Kind::name && !is_keyword(ahead(1).text);
    const bool is_private = has_access && (is("PRIVATE") || is("PROTECTED"));
    if (is_private || (has_access && (is("PUBLIC") || is("INTERNAL")))) advance();
    block.methods.push_back(unit(Unit::Kind::method, "END_METHOD"));
    block.methods.back().is_private = is_private;
    return true;
  }

  bool sections(Unit& unit) {
    using Section = VariableSection::Kind;
    constexpr std::array<std::pair<std::string_view, Section>, 6> kinds = {
        {{"VAR", Section::local},
         {"VAR_INPUT", Section::input},
         {"VAR_OUTPUT", Section::output},
         {"VAR_IN_OUT", Section::in_out},
         {"VAR_TEMP", Section::temporary},
         {"VAR_EXTERNAL", Section::external}}};
    if (is("VAR_STAT") || is("VAR_INST")) {  // of CODESYS
      error("expected VAR");
      advance();
      unit.sections.push_back(section(Section::local));
      return true;
    }
    for (const auto& [name, kind] : kinds) {
      if (!accept(name)) continue;
      unit.sections.push_back(section(kind));
      return true;
    }
    return false;
  }

  // Statements

  [[nodiscard]] bool ends_statements() const {
    return is_end() || (now().kind == Kind::name &&
                        (is_end_or_section(now().text) || now().text == "ELSE" || now().text == "ELSIF" ||
                         now().text == "UNTIL" || now().text == "METHOD" || is_unit_start()));
  }

  void statements(Statements& to) {
    const Nesting nesting(*this);
    if (nesting.is_too_deep()) return;
    while (!ends_statements()) {
      if (accept(";")) continue;
      if (in_case_ > 0 && is_case_label()) return;
      statement(to);
      if (is_lost_) recover();
    }
  }

  void statement(Statements& to) {
    Statement found{.at = now().at};
    using S = Statement::Kind;
    if (accept("IF")) {
      found.kind = S::if_;
      if_(found);
    } else if (accept("CASE")) {
      found.kind = S::case_;
      case_(found);
    } else if (accept("FOR")) {
      found.kind = S::for_;
      found.target = expression();
      expect(":=");
      found.value = expression();
      expect("TO");
      found.limit = expression();
      if (accept("BY")) found.step = expression();
      body(found.body, "DO", "END_FOR");
    } else if (accept("WHILE")) {
      found.kind = S::while_;
      found.value = expression();
      body(found.body, "DO", "END_WHILE");
    } else if (accept("REPEAT")) {
      found.kind = S::repeat;
      nested(found.body);
      expect("UNTIL");
      found.value = expression();
      accept(";");
      expect("END_REPEAT");
    } else if (accept("EXIT")) {
      found.kind = S::exit;
    } else if (accept("CONTINUE")) {
      found.kind = S::continue_;
    } else if (accept("RETURN")) {
      found.kind = S::return_;
    } else if (is_name()) {
      found.target = postfix();
      if (accept(":=")) {
        found.value = expression();
      } else if (found.target->kind == Expr::call) {
        found.kind = S::call;
      } else {
        error("expected :=" + hint_for_assignment(*found.target));
      }
    } else {
      error("expected a statement" + hint_for(now().text));
    }
    if (!is_lost_ && !accept(";") && !ends_block(found.kind)) error("expected ;");
    if (!is_lost_) to.push_back(std::move(found));
  }
  /// Of a word that began a statement of another language, or of what stands where := is expected.
  [[nodiscard]] std::string hint_for_assignment(const Expression& target) const {
    if (target.kind == Expr::name && now().kind == Kind::name) {
      if (const std::string hint = hint_for(target.name); !hint.empty()) return hint;
      if (target.name == "LD" || target.name == "LDN")
        return " (lists of the standard are not there; write Structured Text)";
    }
    if (is("^")) return hint_for("POINTER");
    if (matches(ahead(1), "=") && is("REF")) return hint_for("REFERENCE");
    if (matches(ahead(1), "=") && (is("S") || is("R"))) return " (write IF and := TRUE or FALSE)";
    return {};
  }
  /// END_IF and its like may stand without a semicolon before another END.
  [[nodiscard]] bool ends_block(Statement::Kind kind) const {
    return kind >= Statement::Kind::if_ && kind <= Statement::Kind::repeat &&
           tokens_[at_ - 1].text.starts_with("END_");
  }

  void nested(Statements& to) {
    const unsigned outer = std::exchange(in_case_, 0);
    const bool was_lost = is_lost_;
    if (was_lost) recover();
    statements(to);
    in_case_ = outer;
  }
  void body(Statements& to, std::string_view begin, std::string_view end) {
    expect(begin);
    nested(to);
    expect(end);
  }

  void if_(Statement& to) {
    do {
      Branch branch{.at = now().at, .condition = expression(), .body = {}};
      expect("THEN");
      nested(branch.body);
      to.branches.push_back(std::move(branch));
    } while (accept("ELSIF"));
    if (accept("ELSE")) {
      Branch branch{.at = now().at, .body = {}};
      nested(branch.body);
      to.branches.push_back(std::move(branch));
    }
    expect("END_IF");
  }

  /// 1: or 1, 2..3: or Color#red: or name: but not name :=
  [[nodiscard]] bool is_case_label() const {
    for (std::size_t i = at_; i < tokens_.size() && i < at_ + 200; ++i) {
      const Token& token = tokens_[i];
      const bool is_typed_device = i == at_ + 1 && tokens_[at_].kind == Kind::name && !token.follows_blank &&
                                   !ahead(2).follows_blank && ahead(2).kind == Kind::name &&
                                   matches(ahead(3), ":=");
      if (matches(token, ":")) return !is_typed_device;  // D0:REAL := 1.5
      const bool is_in_label =
          token.kind == Kind::integer || token.kind == Kind::typed_literal || token.kind == Kind::string ||
          (token.kind == Kind::name && !is_keyword(token.text)) || matches(token, ",") ||
          matches(token, "..") || matches(token, "-") || matches(token, "+") || matches(token, "*") ||
          matches(token, ".") || matches(token, "TRUE") || matches(token, "FALSE");
      if (!is_in_label) return false;
    }
    return false;
  }

  void case_(Statement& to) {
    to.value = expression();
    expect("OF");
    while (!is_lost_ && !is_end() && !is("ELSE") && !is("END_CASE")) {
      Branch branch{.at = now().at, .body = {}};
      do {
        TypeNode::Range label;
        label.low = expression(true);
        if (accept("..")) label.high = expression(true);
        branch.labels.push_back(std::move(label));
      } while (!is_lost_ && accept(","));
      if (!is_lost_) expect(":");
      if (is_lost_) break;
      const unsigned outer = std::exchange(in_case_, 1);
      statements(branch.body);
      in_case_ = outer;
      to.branches.push_back(std::move(branch));
    }
    if (is_lost_) {
      recover();
      Statements rest;
      nested(rest);
    }
    if (accept("ELSE")) {
      Branch branch{.at = now().at, .body = {}};
      nested(branch.body);
      to.branches.push_back(std::move(branch));
    }
    expect("END_CASE");
  }

  // Expressions, from the operators that bind least [IEC 61131-3 7.3.2]

  ExpressionPtr make(Expr kind) {
    auto found = std::make_unique<Expression>();
    found->kind = kind;
    found->at = now().at;
    return found;
  }

  ExpressionPtr expression(bool is_label = false) {
    const bool outer = std::exchange(is_label_, is_label);
    auto found = binary(0);
    is_label_ = outer;
    return found;
  }

  [[nodiscard]] bool is_operator(unsigned level) const {
    switch (level) {
      case 0: return is("OR");
      case 1: return is("XOR");
      case 2: return is("AND") || is("&");
      case 3: return is("=") || is("<>");
      case 4: return is("<") || is(">") || is("<=") || is(">=");
      case 5: return is("+") || is("-");
      case 6: return is("*") || is("/") || is("MOD");
      default: return is("**");
    }
  }

  ExpressionPtr binary(unsigned level) {
    constexpr unsigned levels = 8;
    const Nesting nesting(*this);
    if (level == 0 && nesting.is_too_deep()) return make(Expr::wrong);
    if (level > 0) --depth_;
    auto left = level + 1 < levels ? binary(level + 1) : unary();
    while (!is_lost_ && is_operator(level)) {
      auto found = make(Expr::binary);
      found->name = now().text == "&" ? std::string_view("AND") : now().text;
      advance();
      auto right = level + 1 < levels ? binary(level + 1) : unary();
      found->children.push_back(std::move(left));
      found->children.push_back(std::move(right));
      measure(*found);
      left = std::move(found);
    }
    if (level > 0) ++depth_;
    if (level == 0 && (is("AND_THEN") || is("OR_ELSE")))
      error(std::string("expected ") + (is("AND_THEN") ? "AND" : "OR") + hint_for(now().text));
    return left;
  }

  ExpressionPtr unary() {
    if (!is("-") && !is("+") && !is("NOT")) return postfix();
    const Nesting nesting(*this);
    auto found = make(Expr::unary);
    if (nesting.is_too_deep()) return found;
    found->name = now().text;
    advance();
    found->children.push_back(unary());
    measure(*found);
    return found;
  }

  ExpressionPtr postfix() {
    auto found = primary();
    unsigned length = 0;
    while (!is_lost_) {
      if (++length > deepest) {
        error("expected at most " + std::to_string(deepest) + " elements of elements");
        break;
      }
      if (is("[")) {
        auto index = make(Expr::index);
        index->at = found->at;
        advance();
        index->children.push_back(std::move(found));
        do index->children.push_back(expression());
        while (!is_lost_ && accept(","));
        expect("]");
        found = std::move(index);
      } else if (is(".") && !matches(ahead(1), ".")) {
        advance();
        auto member = make(Expr::member);
        if (now().kind != Kind::name && now().kind != Kind::integer)
          error("expected the name of an element or the number of a bit");
        member->name = now().text;
        member->written = now().written;
        advance();
        member->children.push_back(std::move(found));
        found = std::move(member);
      } else if (is("^") && found->kind == Expr::name && found->name == "THIS") {
        advance();  // THIS^.x is THIS.x in CODESYS
      } else if (is("(") &&
                 (found->kind == Expr::name || found->kind == Expr::member || found->kind == Expr::index)) {
        found = call(std::move(found));
      } else if (!is_label_ && found->kind == Expr::name && is(":") && !now().follows_blank &&
                 !ahead(1).follows_blank && ahead(1).kind == Kind::name) {
        auto typed = make(Expr::typed_device);
        advance();
        typed->name = now().text;
        advance();
        typed->at = found->at;
        typed->children.push_back(std::move(found));
        found = std::move(typed);
      } else {
        break;
      }
      measure(*found);
    }
    return found;
  }

  /// The compiler goes through an expression recursively.
  void measure(Expression& expression) {
    for (const ExpressionPtr& child : expression.children)
      expression.depth = std::max(expression.depth, child->depth + 1);
    for (const Argument& argument : expression.arguments)
      if (argument.value) expression.depth = std::max(expression.depth, argument.value->depth + 1);
    if (expression.depth > deepest_tree) error("expected a simpler expression");
  }

  ExpressionPtr call(ExpressionPtr callee) {
    const Nesting nesting(*this);
    auto found = make(Expr::call);
    if (nesting.is_too_deep()) return found;
    found->at = callee->at;
    found->name = callee->name;
    found->written = callee->written;
    found->children.push_back(std::move(callee));
    expect("(");
    if (accept(")")) return found;
    do {
      Argument argument{.at = now().at};
      const std::size_t name_at = is("NOT") ? 1 : 0;
      if (ahead(name_at).kind == Kind::name &&
          (matches(ahead(name_at + 1), ":=") || matches(ahead(name_at + 1), "=>"))) {
        if (name_at == 1) {
          argument.is_negated = true;
          advance();
        }
        argument.name = now().text;
        advance();
        argument.is_output = is("=>");
        advance();
        if (is(",") || is(")")) {  // Q => , nothing is assigned
          argument.value = nullptr;
        } else {
          argument.value = expression();
        }
      } else {
        argument.value = expression();
      }
      found->arguments.push_back(std::move(argument));
    } while (!is_lost_ && accept(","));
    expect(")");
    return found;
  }

  ExpressionPtr primary() {
    const Token& token = now();
    auto found = make(Expr::wrong);
    found->written = token.written;
    switch (token.kind) {
      case Kind::integer:
        found->kind = Expr::integer;
        found->number = token.number;
        found->is_based = token.is_based;
        break;
      case Kind::real:
        found->kind = Expr::real;
        found->real = token.real;
        break;
      case Kind::string:
      case Kind::wide_string:
        found->kind = token.kind == Kind::string ? Expr::string : Expr::wide_string;
        found->name = token.text;
        if (!token.prefix.empty() && token.prefix != "STRING" && token.prefix != "WSTRING") {  // CHAR#'a'
          found->kind = Expr::typed_literal;
          found->name = token.prefix;
          found->written = token.text;
        }
        break;
      case Kind::typed_literal:
        found->kind = Expr::typed_literal;
        found->name = token.prefix;
        found->written = token.text;
        break;
      case Kind::name:
        if (is_keyword(token.text) && token.text != "TRUE" && token.text != "FALSE" &&
            !is_function_keyword()) {
          error("expected an expression");
          return found;
        }
        found->kind = Expr::name;
        found->name = token.text;
        break;
      default:
        if (accept("(")) {
          auto inner = expression();
          expect(")");
          return inner;
        }
        error("expected an expression");
        return found;
    }
    advance();
    return found;
  }
  /// AND(a, b): operators that are functions, too.
  [[nodiscard]] bool is_function_keyword() const {
    return matches(ahead(1), "(") && (is("AND") || is("OR") || is("XOR") || is("MOD"));
  }

  const std::vector<Token>& tokens_;
  std::vector<SourceError>& errors_;
  std::size_t at_ = 0;
  bool is_lost_ = false;
  bool is_label_ = false;
  unsigned depth_ = 0;
  unsigned in_case_ = 0;
};

}  // namespace

std::string_view text_of(Unit::Kind kind) {
  switch (kind) {
    case Unit::Kind::program: return "program";
    case Unit::Kind::function: return "function";
    case Unit::Kind::method: return "method";
    case Unit::Kind::block: break;
  }
  return "function block";
}

SyntaxTree parse(const std::vector<Token>& tokens, std::vector<SourceError>& errors) {
  return Parser(tokens, errors).run();
}

}  // namespace canopus::structured_text
