#include "canopus/plant/plcopen_source.hpp"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/eds/xml/document.hpp"

namespace canopus::plant {

namespace {

using pugi::xml_node;

constexpr int deepest_nesting = 16;
constexpr std::size_t longest_source = 4'000'000;

/// The kinds of variables of an interface, in XML and in Structured Text.
constexpr std::array<std::pair<const char*, const char*>, 8> variable_lists = {
    {{"localVars", "VAR"},
     {"tempVars", "VAR_TEMP"},
     {"inputVars", "VAR_INPUT"},
     {"outputVars", "VAR_OUTPUT"},
     {"inOutVars", "VAR_IN_OUT"},
     {"externalVars", "VAR_EXTERNAL"},
     {"globalVars", "VAR_GLOBAL"},
     {"accessVars", "VAR_ACCESS"}}};

std::string_view element_name(xml_node node) { return eds::xml::local_name(node.name()); }
xml_node child_of(xml_node parent, std::string_view name) { return eds::xml::child(parent, name); }

bool is_added(xml_node data, std::string_view kind) {
  return element_name(data) == "data" &&
         std::string_view(data.attribute("name").value()).ends_with(std::string("/plcopenxml/").append(kind));
}
/// <addData><data name="http://www.3s-software.com/plcopenxml/KIND">, as CODESYS writes it.
xml_node added(xml_node to, std::string_view kind) {
  for (const xml_node data : child_of(to, "addData").children())
    if (is_added(data, kind)) return data;
  return {};
}

xml_node first_element_of(xml_node parent) {
  for (const xml_node node : parent.children())
    if (node.type() == pugi::node_element) return node;
  return {};
}

class PlcopenWriter {
 public:
  PlcopenWriter(const std::string& file, const eds::xml::Document& document, PlcopenSource& to)
      : file_(file), document_(document), to_(to) {}

  void write(xml_node project) {
    walk(project, 0);
    if (units_ == 0) error(project, "expected a <pou> with a body of <ST>");
    if (is_too_long_)
      error(project, fmt::format("expected at most {} bytes of Structured Text", longest_source));
  }

 private:
  void error(xml_node at, std::string message) {
    constexpr std::size_t most_errors = 100;
    if (to_.errors.size() >= most_errors) return;
    const eds::xml::Position place = document_.position(at);
    to_.errors.push_back({file_, place.line, place.column, std::move(message)});
  }

  /// Continues in that line of the file, if the text is not yet behind it.
  void go_to(unsigned line) {
    for (; line_ < line; ++line_) to_.text += '\n';
  }
  void add(std::string_view text) {
    is_too_long_ = is_too_long_ || to_.text.size() + text.size() > longest_source;
    if (is_too_long_) return;
    to_.text += text;
    for (const char c : text)
      if (c == '\n') ++line_;
  }

  /// A name of the file, which is to stand in the text as a word: nothing else can hide in it.
  std::string word(xml_node at, const char* attribute) {
    const std::string name = at.attribute(attribute).value();
    const bool is_word = !name.empty() && name.find_first_not_of(
                                              "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                              "0123456789_") == std::string::npos;
    if (is_word) return name;
    error(at, fmt::format("{}: expected a name of letters, digits and _", attribute));
    return "x";
  }

  std::string type_text(xml_node holder, int depth = 0) {
    const xml_node type = first_element_of(holder);
    if (type.empty() || depth > deepest_nesting) {
      error(holder, type.empty() ? "expected a type" : "the type is nested too deep");
      return "INT";
    }
    const std::string_view name = element_name(type);
    if (name == "derived") return word(type, "name");
    if (name == "string" || name == "wstring") {
      const unsigned length = type.attribute("length").as_uint(0);
      const std::string upper = ascii::upper(name);
      return length == 0 ? upper : fmt::format("{}[{}]", upper, length);
    }
    if (name == "array") return array_text(type, depth);
    if (name == "struct" || name == "enum" || name == "subrangeSigned" || name == "subrangeUnsigned")
      return nested_text(type, name, depth);
    if (name == "pointer" || name == "function_block") {
      error(type, fmt::format("<{}> is not there", name));
      return "INT";
    }
    return ascii::upper(name);
  }

  std::string array_text(xml_node type, int depth) {
    std::string text = "ARRAY[";
    bool is_first = true;
    for (const xml_node dimension : type.children()) {
      if (element_name(dimension) != "dimension") continue;
      text += fmt::format("{}{}..{}", is_first ? "" : ", ", number(dimension, "lower"),
                          number(dimension, "upper"));
      is_first = false;
    }
    return text + "] OF " + type_text(child_of(type, "baseType"), depth + 1);
  }

  /// A number, or the name of a constant.
  std::string number(xml_node at, const char* attribute) {
    const std::string text = at.attribute(attribute).value();
    if (!text.empty() &&
        text.find_first_not_of("-0123456789_abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ") ==
            std::string::npos)
      return text;
    error(at, fmt::format("{}: expected a number", attribute));
    return "0";
  }

  std::string nested_text(xml_node type, std::string_view name, int depth) {
    if (name == "struct") {
      std::string text = "STRUCT ";
      for (const xml_node variable : type.children())
        if (element_name(variable) == "variable") text += variable_text(variable, depth + 1);
      return text + "END_STRUCT";
    }
    if (name == "enum") {
      std::string text = "(";
      for (const xml_node value : child_of(type, "values").children()) {
        if (element_name(value) != "value") continue;
        text += (text.size() == 1 ? "" : ", ") + word(value, "name");
        if (!value.attribute("value").empty()) text += " := " + number(value, "value");
      }
      return text + ")";
    }
    const xml_node range = child_of(type, "range");
    return fmt::format("{}({}..{})", type_text(child_of(type, "baseType"), depth + 1), number(range, "lower"),
                       number(range, "upper"));
  }

  /// "name AT %MW0 : INT := 5; "
  std::string variable_text(xml_node variable, int depth = 0) {
    std::string text = word(variable, "name");
    if (const pugi::xml_attribute address = variable.attribute("address"); !address.empty())
      text += fmt::format(" AT {}", one_line(variable, address.value()));
    text += " : " + type_text(child_of(variable, "type"), depth);
    if (const xml_node initial = child_of(variable, "initialValue"); !initial.empty())
      text += " := " + value_text(initial, depth + 1);
    return text + "; ";
  }

  std::string value_text(xml_node holder, int depth) {
    const xml_node value = first_element_of(holder);
    const std::string_view name = element_name(value);
    if (depth <= deepest_nesting && name == "simpleValue")
      return one_line(value, value.attribute("value").value());
    if (depth <= deepest_nesting && (name == "arrayValue" || name == "structValue")) {
      const bool is_array = name == "arrayValue";
      std::string text;
      for (const xml_node element : value.children()) {
        if (element_name(element) != "value") continue;
        if (!text.empty()) text += ", ";
        const std::string one = value_text(element, depth + 1);
        const unsigned times = element.attribute("repetitionValue").as_uint(1);
        text += !is_array    ? word(element, "member") + " := " + one
                : times == 1 ? one
                             : fmt::format("{}({})", times, one);
      }
      return is_array ? "[" + text + "]" : "(" + text + ")";
    }
    error(holder, "expected <simpleValue>, <arrayValue> or <structValue>");
    return "0";
  }

  /// Text of one expression: it must not end the declaration that it stands in.
  std::string one_line(xml_node at, const std::string& text) {
    if (!text.empty() && text.find_first_of(";\n\r") == std::string::npos &&
        text.find("*)") == std::string::npos && text.find("(*") == std::string::npos &&
        text.find("//") == std::string::npos && text.find("/*") == std::string::npos)
      return text;
    error(at, "expected one value");
    return "0";
  }

  void variables(xml_node list, std::string_view keyword) {
    std::string words(keyword);
    for (const auto& [attribute, word] : {std::pair("constant", "CONSTANT"), std::pair("retain", "RETAIN"),
                                          std::pair("persistent", "PERSISTENT")})
      if (list.attribute(attribute).as_bool()) words += fmt::format(" {}", word);
    go_to(document_.position(list).line);
    add(words + ' ');
    for (const xml_node variable : list.children()) {
      if (element_name(variable) != "variable") continue;
      go_to(document_.position(variable).line);
      add(variable_text(variable));
    }
    add("END_VAR ");
  }

  void data_type(xml_node type) {
    if (!added(type, "datatypeinheritance").empty())
      error(type, fmt::format("EXTENDS of {} is not there; expected a STRUCT with all its elements",
                              type.attribute("name").value()));
    go_to(document_.position(type).line);
    add(fmt::format("TYPE {} : {}", word(type, "name"), type_text(child_of(type, "baseType"))));
    if (const xml_node initial = child_of(type, "initialValue"); !initial.empty())
      add(" := " + value_text(initial, 1));
    add("; END_TYPE ");
  }

  /// <ST>, with <xhtml> in it, or its paragraphs.
  void add_text(xml_node node, int depth) {
    go_to(document_.position(node).line);
    for (const xml_node inner : node.children()) {
      if (inner.type() == pugi::node_pcdata || inner.type() == pugi::node_cdata) add(inner.value());
      if (inner.type() == pugi::node_element && depth < deepest_nesting) add_text(inner, depth + 1);
    }
  }

  /// Types, global variables and units in the order of the file, wherever they stand: TC6 has them below <types> and <instances>,
  /// CODESYS also in <addData> of the resource or the project.
  void walk(xml_node node, int depth) {
    for (const xml_node inner : node.children()) {
      const std::string_view name = element_name(inner);
      if (name == "dataType") {
        data_type(inner);
      } else if (name == "globalVars") {
        globals(inner);
      } else if (name == "pou") {
        unit(inner);
      } else if (depth < deepest_nesting) {
        walk(inner, depth + 1);
      }
    }
  }

  /// Lists with several attributes have them once more in <addData>, one for each attribute.
  void globals(xml_node list) {
    const xml_node mixed = child_of(added(list, "mixedattrsvarlist"), "MixedAttrsVarList");
    if (mixed.empty()) return variables(list, "VAR_GLOBAL");
    for (const xml_node one : mixed.children())
      if (element_name(one) == "globalVars") variables(one, "VAR_GLOBAL");
  }

  void unit(xml_node pou) {
    ++units_;
    const std::string_view type = pou.attribute("pouType").value();
    const std::string_view keyword = type == "program"         ? "PROGRAM"
                                     : type == "functionBlock" ? "FUNCTION_BLOCK"
                                     : type == "function"      ? "FUNCTION"
                                                               : "";
    if (keyword.empty()) return error(pou, "pouType: expected program, functionBlock or function");
    if (!added(pou, "pouinheritance").empty())
      error(pou, fmt::format("EXTENDS and IMPLEMENTS of {} are not there; expected a block of its own",
                             pou.attribute("name").value()));
    const xml_node body = text_body(pou);
    if (body.empty()) return;
    go_to(document_.position(pou).line);
    add(fmt::format("{} {}", keyword, word(pou, "name")));
    interface_text(pou, keyword == "FUNCTION");
    const bool is_block = keyword == "FUNCTION_BLOCK";
    for (const xml_node action : child_of(pou, "actions").children())
      if (element_name(action) == "action") is_block ? method(action) : no_action(pou, action);
    add_text(body, 0);
    for (const xml_node data : child_of(pou, "addData").children()) {
      if (is_added(data, "property"))
        error(data, fmt::format("property {} is not there; expected methods",
                                first_element_of(data).attribute("name").value()));
      if (is_added(data, "method")) method(first_element_of(data));
    }
    add(fmt::format("\nEND_{} ", keyword));  // behind a comment
  }

  /// <body><ST>; empty, and reported: there is another one, or none.
  xml_node text_body(xml_node holder) {
    const xml_node body = child_of(child_of(holder, "body"), "ST");
    if (body.empty()) {
      const xml_node other = first_element_of(child_of(holder, "body"));
      error(other.empty() ? holder : other,
            fmt::format("the body of {} is {}; expected <ST>", holder.attribute("name").value(),
                        other.empty() ? "missing" : fmt::format("<{}>", element_name(other))));
    }
    return body;
  }

  /// Result and variables.
  void interface_text(xml_node holder, bool has_result) {
    const xml_node interface = child_of(holder, "interface");
    if (const xml_node result = child_of(interface, "returnType"); has_result && !result.empty())
      add(" : " + type_text(result));
    add(" ");
    for (const xml_node list : interface.children())
      for (const auto& [element, words] : variable_lists)
        if (element_name(list) == element) variables(list, words);
  }

  /// A method of CODESYS, or an action: one without variables of its own.
  void method(xml_node from) {
    const std::string name = word(from, "name");
    if (const std::string upper = ascii::upper(name);
        upper == "FB_INIT" || upper == "FB_REINIT" || upper == "FB_EXIT")
      return error(from, fmt::format("{} is not called by itself here; expected initial values", name));
    const xml_node body = text_body(from);
    if (body.empty()) return;
    add("\n");  // behind a comment
    go_to(document_.position(from).line);
    add("METHOD " + name);
    interface_text(from, true);
    add_text(body, 0);
    add("\nEND_METHOD ");
  }

  void no_action(xml_node pou, xml_node action) {
    error(
        action,
        fmt::format("action {}: only a function block has actions; expected its statements in the body of {}",
                    action.attribute("name").value(), pou.attribute("name").value()));
  }

  const std::string& file_;
  const eds::xml::Document& document_;
  PlcopenSource& to_;
  unsigned line_ = 1;
  std::size_t units_ = 0;
  bool is_too_long_ = false;
};

}  // namespace

PlcopenSource structured_text_of_plcopen(const std::string& file, std::string_view bytes) {
  PlcopenSource source;
  const auto document = eds::xml::Document::parse(bytes);
  if (!document) {
    source.errors.push_back(
        {file, document.error().position.line, document.error().position.column, document.error().message});
    return source;
  }
  const xml_node root = (*document)->root();
  if (element_name(root) != "project") {
    const eds::xml::Position place = (*document)->position(root);
    source.errors.push_back({file, place.line, place.column, "expected PLCopen XML: <project>"});
    return source;
  }
  PlcopenWriter(file, **document, source).write(root);
  return source;
}

}  // namespace canopus::plant
