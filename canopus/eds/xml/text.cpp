#include "canopus/eds/xml/text.hpp"

#include <algorithm>

namespace canopus::eds::xml {
namespace {

constexpr std::string_view blanks = " \t\r\n";
constexpr std::string_view cannot_say = "the value has characters that XML cannot say, or is not UTF-8 text";

}  // namespace

Text::Text(std::string text, std::shared_ptr<const Document> document, bool only_ascii)
    : text_(std::move(text)), document_(std::move(document)), only_ascii_(only_ascii) {}

std::expected<Text, Mistake> Text::parse(std::string_view text, bool only_ascii) {
  auto document = Document::parse(text);
  if (!document) return std::unexpected(std::move(document.error()));
  return Text(std::string(text), std::move(*document), only_ascii);
}

Text::Done Text::replace(Span span, std::string_view by) {
  std::string changed = text_;
  changed.replace(span.begin, span.end - span.begin, by);
  auto document = Document::parse(changed);
  if (!document) return std::unexpected("the text would be no XML any more: " + document.error().message);
  text_ = std::move(changed);
  document_ = std::move(*document);
  return {};
}

Text::Done Text::set(pugi::xml_node element, std::string_view name, std::string_view value) {
  if (const pugi::xml_attribute found = attribute(element, name)) {
    if (found.value() == value) return {};
    const Span span = document_->value_span(found);
    const auto written = escaped(value, text_[span.begin - 1], only_ascii_);
    if (!written) return std::unexpected(std::string(cannot_say));
    return replace(span, *written);
  }
  const auto written = escaped(value, '"', only_ascii_);
  if (!written) return std::unexpected(std::string(cannot_say));
  const pugi::xml_attribute last = element.last_attribute();
  const std::size_t place = last ? document_->value_span(last).end + 1 : document_->name_span(element).end;
  return replace({place, place}, ' ' + std::string(name) + "=\"" + *written + '"');
}

Text::Done Text::remove(pugi::xml_node element, std::string_view name) {
  const pugi::xml_attribute found = attribute(element, name);
  if (!found) return {};
  Span span = document_->name_span(found);
  span.begin = text_.find_last_not_of(blanks, span.begin - 1) + 1;
  span.end = document_->value_span(found).end + 1;
  return replace(span, "");
}

Text::Done Text::remove(pugi::xml_node element) {
  const std::string_view name = element.name();
  Span span = document_->name_span(element);
  --span.begin;  // its bracket
  char quote = 0;
  while (span.end < text_.size() && (quote != 0 || text_[span.end] != '>')) {
    const char c = text_[span.end++];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    }
  }
  if (text_[span.end - 1] != '/') {
    const std::string end_tag = "</" + std::string(name);
    const std::size_t end = text_.find(end_tag, span.end);
    if (end == std::string::npos || element.find_node([&](auto inner) { return inner.name() == name; }))
      return std::unexpected("the end of " + std::string(name) + " is not found");
    span.end = text_.find('>', end);
  }
  ++span.end;
  const std::size_t line = text_.find_last_not_of(" \t", span.begin - 1) + 1;
  const std::size_t rest = text_.find_first_not_of(" \t\r", span.end);
  const bool has_line_of_its_own =
      text_[line - 1] == '\n' && rest != std::string::npos && text_[rest] == '\n';
  return replace(has_line_of_its_own ? Span{line, rest + 1} : span, "");
}

Text::Done Text::append(pugi::xml_node parent, std::string_view name,
                        const std::vector<std::pair<std::string_view, std::string>>& attributes) {
  pugi::xml_node last = parent.last_child();
  while (last && last.type() != pugi::node_element) last = last.previous_sibling();
  if (!last) return std::unexpected("there is no element beside which " + std::string(name) + " could stand");
  // The prefix of its neighbours is that of the profile they belong to.
  const std::string_view neighbour = last.name();
  std::string element = '<' + std::string(neighbour.substr(0, neighbour.find(':') + 1)) + std::string(name);
  for (const auto& [key, value] : attributes) {
    const auto written = escaped(value, '"', only_ascii_);
    if (!written) return std::unexpected(std::string(key) + ": " + std::string(cannot_say));
    element += ' ' + std::string(key) + "=\"" + *written + '"';
  }
  element += "/>";
  const std::size_t first = document_->name_span(last).begin;
  const std::size_t end = text_.find("</" + std::string(parent.name()), first);
  if (end == std::string::npos)
    return std::unexpected("the end of " + std::string(parent.name()) + " is not found");
  const std::size_t line = text_.find_last_not_of(" \t", end - 1) + 1;
  if (text_[line - 1] != '\n') return replace({end, end}, element);
  const std::size_t line_of_last = text_.find_last_of('\n', first) + 1;
  const std::size_t indented = text_.find_first_not_of(" \t", line_of_last);
  const bool is_windows = line >= 2 && text_[line - 2] == '\r';
  return replace({line, line}, text_.substr(line_of_last, indented - line_of_last) + element +
                                   (is_windows ? "\r\n" : "\n"));
}

}  // namespace canopus::eds::xml
