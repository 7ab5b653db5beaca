#pragma once
// An XML text that is changed at the requested places and nowhere else: comments, the order, blanks, line ends, quotes and
// the way references are written stay byte for byte.

#include <utility>

#include "canopus/eds/xml/document.hpp"

namespace canopus::eds::xml {

class Text {
 public:
  /// UTF-8, as Document::parse() takes it. `only_ascii`: other letters are written as references.
  [[nodiscard]] static std::expected<Text, Mistake> parse(std::string_view text, bool only_ascii = false);

  /// The text as it is now. Unchanged, these are the bytes it was made from.
  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  /// The elements of the text. The next change makes all of them invalid.
  [[nodiscard]] const Document& document() const noexcept { return *document_; }

  using Done = std::expected<void, std::string>;
  /// Gives an attribute of an element this value: one line differs afterwards, or none when it had it. One that is not
  /// there becomes the element's last one. Refused, with the reason and without any change: text that XML cannot represent.
  [[nodiscard]] Done set(pugi::xml_node element, std::string_view name, std::string_view value);
  /// Takes an attribute out; no such attribute: nothing happens.
  [[nodiscard]] Done remove(pugi::xml_node element, std::string_view name);
  /// Removes an element with its contents, and its line if that has nothing else.
  [[nodiscard]] Done remove(pugi::xml_node element);
  /// Adds an element behind the last one in `parent`: on a line of its own and as far in, when the end of `parent` has
  /// one. Refused as set() does, and when there is no element in `parent` yet.
  [[nodiscard]] Done append(pugi::xml_node parent, std::string_view name,
                            const std::vector<std::pair<std::string_view, std::string>>& attributes);

 private:
  Text(std::string text, std::shared_ptr<const Document> document, bool only_ascii);
  [[nodiscard]] Done replace(Span span, std::string_view by);

  std::string text_;
  std::shared_ptr<const Document> document_;  // of text_; copies share it
  bool only_ascii_ = false;
};

}  // namespace canopus::eds::xml
