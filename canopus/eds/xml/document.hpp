#pragma once
// An XML text as a tree whose elements and attributes have their positions, for untrusted files: nothing is
// expanded or fetched, and texts that are too deep or declare entities are refused.

#include <cstddef>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

namespace canopus::eds::xml {

/// A position in the text; both from 1, the column in bytes.
struct Position {
  unsigned line = 1;
  unsigned column = 1;
};

/// Why a text is no XML document that is read here.
struct Mistake {
  Position position;
  std::string message;
};

/// From one byte to behind the last one.
struct Span {
  std::size_t begin = 0;
  std::size_t end = 0;
};

class Document {
 public:
  /// Parses UTF-8 text, with a byte order mark or without. Refused: what is not well-formed, more than one root,
  /// zero bytes, more than 8 MiB, more than 64 levels of elements, and entities of its own.
  [[nodiscard]] static std::expected<std::unique_ptr<Document>, Mistake> parse(std::string_view text);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  /// The root element.
  [[nodiscard]] pugi::xml_node root() const { return tree_.document_element(); }
  [[nodiscard]] Position position(pugi::xml_node element) const;
  /// Of the value.
  [[nodiscard]] Position position(pugi::xml_attribute attribute) const;

  /// The bytes of an attribute's value between its quotes, as the file has them (with references such as &amp;).
  [[nodiscard]] Span value_span(pugi::xml_attribute attribute) const;
  /// Of an attribute's name, and of an element's in its start tag.
  [[nodiscard]] Span name_span(pugi::xml_attribute attribute) const;
  [[nodiscard]] Span name_span(pugi::xml_node element) const;

 private:
  explicit Document(std::string_view text);
  [[nodiscard]] Position position_of(std::size_t offset) const;
  [[nodiscard]] Span span_of(std::string_view name) const;

  std::string text_;    // as it came
  std::string buffer_;  // the same, changed by the parser: its strings point into it
  pugi::xml_document tree_;
  std::vector<std::size_t> line_starts_;
};

/// An element's or attribute's name without the prefix of its namespace.
[[nodiscard]] std::string_view local_name(std::string_view name) noexcept;
/// The first child element or attribute of this local name; empty: none.
[[nodiscard]] pugi::xml_node child(pugi::xml_node element, std::string_view name);
[[nodiscard]] pugi::xml_attribute attribute(pugi::xml_node element, std::string_view name);

/// The first child element of this name whose language (attribute lang) is English or, where none is, the first.
[[nodiscard]] pugi::xml_node english_child(pugi::xml_node element, std::string_view name);

/// Text as it may stand in an attribute between these quotes, on one line. Nothing: it has characters that XML has
/// no way to write (most below 20H), or is not UTF-8. `only_ascii`: other letters are written as references.
[[nodiscard]] std::optional<std::string> escaped(std::string_view text, char quote, bool only_ascii = false);

}  // namespace canopus::eds::xml
