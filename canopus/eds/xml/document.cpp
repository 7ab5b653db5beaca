#include "canopus/eds/xml/document.hpp"

#include <algorithm>

namespace canopus::eds::xml {
namespace {

constexpr int most_levels = 64;                           // the deepest known device file has 12
constexpr std::size_t most_bytes = std::size_t{8} << 20;  // the largest known device file has 0.2 MB

constexpr std::size_t most_attributes = 64;  // of one element

/// Finds mistakes that the parser accepts. Walks the tree without recursion.
struct StructureCheck : pugi::xml_tree_walker {
  bool for_each(pugi::xml_node& node) override {
    place = node;
    if (depth() >= most_levels) {
      mistake = "elements are nested more than " + std::to_string(most_levels) + " deep";
      return false;
    }
    std::vector<std::string_view> names;
    for (const pugi::xml_attribute attribute : node.attributes()) {
      if (names.size() == most_attributes) {
        mistake = "an element with more than " + std::to_string(most_attributes) + " attributes";
        return false;
      }
      if (std::ranges::find(names, std::string_view(attribute.name())) != names.end()) {
        mistake = "an element has an attribute twice";
        return false;
      }
      names.emplace_back(attribute.name());
    }
    return true;
  }
  pugi::xml_node place;
  std::string mistake;
};

std::string reason(pugi::xml_parse_status status) {
  switch (status) {
    case pugi::status_no_document_element: return "there is no element in it";
    case pugi::status_end_element_mismatch:
      return "an end tag that does not belong to the element it would end";
    case pugi::status_bad_attribute: return "an attribute is not name=\"value\"";
    case pugi::status_bad_start_element: return "a start tag is not complete";
    case pugi::status_bad_end_element: return "an end tag is not complete";
    case pugi::status_bad_pi: return "a processing instruction or the XML declaration is not complete";
    case pugi::status_bad_comment: return "a comment has no end";
    case pugi::status_bad_cdata: return "a CDATA section has no end";
    case pugi::status_bad_doctype: return "the DOCTYPE is not complete";
    case pugi::status_unrecognized_tag: return "a '<' that begins no tag";
    default: return "this is no XML";
  }
}

/// A code point of UTF-8 text that is taken off its start. Nothing: no UTF-8.
std::optional<char32_t> next_code_point(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (length > text.size() || (first >= 0x80 && first < 0xC2) || first > 0xF4) return std::nullopt;
  char32_t code = length == 1 ? first : first & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return std::nullopt;
    code = code << 6 | (byte(i) & 0x3FU);
  }
  text.remove_prefix(length);
  return code;
}

bool is_xml_character(char32_t code) noexcept {
  if (code < 0x20) return code == '\t' || code == '\n' || code == '\r';
  return code < 0xD800 || (code >= 0xE000 && code <= 0x10FFFF && code != 0xFFFE && code != 0xFFFF);
}

}  // namespace

Document::Document(std::string_view text) : text_(text), buffer_(text), line_starts_{0} {
  for (std::size_t i = 0; i < text_.size(); ++i) {
    if (text_[i] == '\n') line_starts_.push_back(i + 1);
  }
}

std::expected<std::unique_ptr<Document>, Mistake> Document::parse(std::string_view text) {
  if (text.size() > most_bytes) {
    return std::unexpected(Mistake{{},
                                   "the text has " + std::to_string(text.size()) +
                                       " bytes; expected at most " + std::to_string(most_bytes)});
  }
  std::unique_ptr<Document> document(new Document(text));
  const auto mistake = [&](std::size_t offset, std::string message) {
    return std::unexpected(Mistake{document->position_of(offset), std::move(message)});
  };
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    return mistake(zero, "a zero byte: no XML text has one");
  }
  const pugi::xml_parse_result result =
      document->tree_.load_buffer_inplace(document->buffer_.data(), document->buffer_.size(),
                                          pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result) {
    return mistake(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)),
                   reason(result.status));
  }
  bool has_root = false;
  for (const pugi::xml_node node : document->tree_) {
    if (node.type() == pugi::node_doctype &&
        std::string_view(node.value()).find("<!ENTITY") != std::string_view::npos) {
      return mistake(static_cast<std::size_t>(node.value() - document->buffer_.data()),
                     "the file declares entities, which no device file needs: they are not expanded");
    }
    if (node.type() != pugi::node_element) continue;
    if (has_root) return mistake(document->name_span(node).begin, "a second root element");
    has_root = true;
  }
  StructureCheck check;
  document->tree_.traverse(check);
  if (!check.mistake.empty()) return mistake(document->name_span(check.place).begin, check.mistake);
  return document;
}

Position Document::position_of(std::size_t offset) const {
  const auto next = std::ranges::upper_bound(line_starts_, offset);
  const std::size_t line = static_cast<std::size_t>(next - line_starts_.begin());
  return {static_cast<unsigned>(line), static_cast<unsigned>(offset - *(next - 1) + 1)};
}

Position Document::position(pugi::xml_node element) const { return position_of(name_span(element).begin); }

Position Document::position(pugi::xml_attribute attribute) const {
  return position_of(value_span(attribute).begin);
}

// The parser works in its buffer: what it read begins where the text has it, and may be shorter.
Span Document::value_span(pugi::xml_attribute attribute) const {
  const auto begin = static_cast<std::size_t>(attribute.value() - buffer_.data());
  return {begin, text_.find(text_[begin - 1], begin)};
}

Span Document::span_of(std::string_view name) const {
  const auto begin = static_cast<std::size_t>(name.data() - buffer_.data());
  return {begin, begin + name.size()};
}

Span Document::name_span(pugi::xml_attribute attribute) const { return span_of(attribute.name()); }

Span Document::name_span(pugi::xml_node element) const {
  if (element.type() != pugi::node_element) element = element.parent();
  return span_of(element.name());
}

std::string_view local_name(std::string_view name) noexcept {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

pugi::xml_node child(pugi::xml_node element, std::string_view name) {
  return element.find_child([&](pugi::xml_node node) { return local_name(node.name()) == name; });
}

pugi::xml_attribute attribute(pugi::xml_node element, std::string_view name) {
  return element.find_attribute([&](pugi::xml_attribute found) { return local_name(found.name()) == name; });
}

pugi::xml_node english_child(pugi::xml_node element, std::string_view name) {
  const pugi::xml_node english = element.find_child([&](pugi::xml_node node) {
    return local_name(node.name()) == name &&
           std::string_view(attribute(node, "lang").value()).starts_with("en");
  });
  return english ? english : child(element, name);
}

std::optional<std::string> escaped(std::string_view text, char quote, bool only_ascii) {
  std::string result;
  while (!text.empty()) {
    const std::string_view before = text;
    const auto code = next_code_point(text);
    if (!code || !is_xml_character(*code)) return std::nullopt;
    const std::string_view bytes = before.substr(0, before.size() - text.size());
    if (*code == '&') {
      result += "&amp;";
    } else if (*code == '<') {
      result += "&lt;";
    } else if (*code == static_cast<unsigned char>(quote)) {
      result += quote == '"' ? "&quot;" : "&apos;";
    } else if (*code < 0x20 || *code == 0x7F || (only_ascii && *code >= 0x80)) {
      result += "&#" + std::to_string(static_cast<std::uint32_t>(*code)) + ';';
    } else {
      result += bytes;
    }
  }
  return result;
}

}  // namespace canopus::eds::xml
