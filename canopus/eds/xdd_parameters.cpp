#include "canopus/eds/xdd_parameters.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using xml::attribute;
using xml::child;
using xml::local_name;

/// The types of IEC 61131-3.
struct SimpleType {
  std::string_view word;
  std::string_view data_type;
};
constexpr SimpleType simple_types[] = {
    {"BOOL", "0x0001"},   {"SINT", "0x0002"},    {"INT", "0x0003"},       {"DINT", "0x0004"},
    {"LINT", "0x0015"},   {"USINT", "0x0005"},   {"UINT", "0x0006"},      {"UDINT", "0x0007"},
    {"ULINT", "0x001B"},  {"BYTE", "0x0005"},    {"WORD", "0x0006"},      {"DWORD", "0x0007"},
    {"LWORD", "0x001B"},  {"CHAR", "0x0002"},    {"REAL", "0x0008"},      {"LREAL", "0x0011"},
    {"STRING", "0x0009"}, {"WSTRING", "0x000B"}, {"BITSTRING", "0x000A"},
};

constexpr std::pair<std::string_view, std::string_view> parameter_access[] = {
    {"const", "const"},        {"read", "ro"},
    {"write", "wo"},           {"readWrite", "rw"},
    {"readWriteInput", "rwr"}, {"readWriteOutput", "rww"},
};

void add_at(Section& section, std::string_view key, std::string_view shown, std::string_view value,
            xml::Position position) {
  if (section.find(key) != nullptr) return;
  section.items.push_back({std::string(key), printable(local_name(shown)), std::string(trim(value)),
                           position.line, position.column});
}

/// Only a single range becomes a limit: CiA 306 cannot express more.
void add_limits(Section& facts, const xml::Document& document, pugi::xml_node allowed, Problems& problems) {
  const pugi::xml_node range = child(allowed, "range");
  bool is_single = range && !child(allowed, "value");
  for (pugi::xml_node other = range.next_sibling(); other; other = other.next_sibling()) {
    is_single = is_single && local_name(other.name()) != "range";
  }
  if (!is_single) {
    if (!allowed.first_child()) return;
    const xml::Position place = document.position(allowed);
    return problems.report(Problem::Severity::loss, place.line,
                           "allowedValues of parameter " +
                               printable(attribute(allowed.parent(), "uniqueID").value()) +
                               " has single values or several ranges: no limits",
                           place.column);
  }
  for (const auto& [key, name] : {std::pair{"lowlimit", "minValue"}, std::pair{"highlimit", "maxValue"}}) {
    const auto value = attribute(child(range, name), "value");
    add_item(facts, document, key, value, value.value());
  }
}

}  // namespace

void add_item(Section& section, const xml::Document& document, std::string_view key,
              pugi::xml_attribute given, std::string_view value) {
  if (given) add_at(section, key, given.name(), value, document.position(given));
}

void add_item(Section& section, const xml::Document& document, std::string_view key, pugi::xml_node given) {
  const auto is_xml_blank = [](char c) { return ascii::is_blank(c) || c == '\r' || c == '\n'; };
  if (!given) return;
  const std::string_view text = ascii::trim(given.child_value(), is_xml_blank);
  add_at(section, key, given.name(), text, document.position(given));
}

std::string_view simple_type_word(canopen::DataType type) noexcept {
  const std::string text = "0x" + ascii::hex(static_cast<unsigned>(type), 4);
  const auto* const known = std::ranges::find(simple_types, text, &SimpleType::data_type);
  return known == std::end(simple_types) ? "BITSTRING" : known->word;
}

XddParameters::XddParameters(const xml::Document& document, pugi::xml_node process, Problems& problems)
    : document_(document), problems_(problems) {
  const auto each = [&](std::string_view list, auto&& visit) {
    for (const pugi::xml_node element : child(process, list)) {
      if (const auto id = attribute(element, "uniqueID")) visit(id.value(), element);
    }
  };
  each("dataTypeList", [&](std::string_view id, pugi::xml_node element) {
    const std::string_view kind = local_name(element.name());
    if (kind == "enum" || kind == "derived") types_.try_emplace(id, type_in(element));
  });
  each("parameterList",
       [&](std::string_view id, pugi::xml_node element) { parameters_.try_emplace(id, Parameter{element}); });
  each("templateList",
       [&](std::string_view id, pugi::xml_node element) { templates_.try_emplace(id, Parameter{element}); });
}

const Section* XddParameters::find(std::string_view id) { return find(parameters_, id); }

const Section* XddParameters::find(Parameters& parameters, std::string_view id) const {
  const auto place = parameters.find(id);
  if (place == parameters.end()) return nullptr;
  if (!std::exchange(place->second.is_read, true)) read(place->second);
  return &place->second.facts;
}

void XddParameters::read(Parameter& parameter) const {
  const pugi::xml_node element = parameter.element;
  Section& facts = parameter.facts;
  add_item(facts, document_, "parametername", xml::english_child(element, "label"));
  add_item(facts, document_, "description", xml::english_child(element, "description"));
  add_item(facts, document_, "denotation", xml::english_child(child(element, "denotation"), "label"));
  add_type(facts, element);
  if (const auto access = attribute(element, "access")) {
    const auto known = std::ranges::find(parameter_access, std::string_view(access.value()),
                                         [](const auto& pair) { return pair.first; });
    add_item(facts, document_, "accesstype", access,
             known == std::end(parameter_access) ? std::string_view(access.value()) : known->second);
  }
  for (const auto& [key, name] :
       {std::pair{"defaultvalue", "defaultValue"}, std::pair{"parametervalue", "actualValue"}}) {
    const auto value = attribute(child(element, name), "value");
    add_item(facts, document_, key, value, value.value());
  }
  add_limits(facts, document_, child(element, "allowedValues"), problems_);
  if (local_name(element.name()) == "parameterTemplate") return;
  if (const Section* model = find(templates_, attribute(element, "templateIDRef").value())) {
    for (const Item& item : model->items) {
      if (facts.find(item.folded_key) == nullptr) facts.items.push_back(item);
    }
  }
  add_at(facts, "accesstype", "access", "ro", document_.position(element));  // the schema's default
}

XddParameters::Type XddParameters::type_in(pugi::xml_node holder) const {
  for (const pugi::xml_node element : holder) {
    const std::string_view name = local_name(element.name());
    const auto simple = std::ranges::find(simple_types, name, &SimpleType::word);
    if (simple != std::end(simple_types)) return {name, simple->data_type, {}, document_.position(element)};
    if (name == "dataTypeIDRef") return {{}, {}, attribute(element, "uniqueIDRef").value(), {}};
  }
  return {};
}

void XddParameters::add_type(Section& facts, pugi::xml_node parameter) const {
  constexpr int most_steps = 8;  // a type may be made from another one, and a circle of them has no end
  Type type = type_in(parameter);
  for (int step = 0; type.data_type.empty() && step < most_steps; ++step) {
    const auto next = types_.find(type.reference);
    if (next == types_.end()) return;
    type = next->second;
  }
  if (!type.data_type.empty()) add_at(facts, "datatype", type.word, type.data_type, type.position);
}

}  // namespace canopus::eds
