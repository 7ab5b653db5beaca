#include "canopus/trace/filter/message_filter.hpp"

#include <algorithm>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::trace {
namespace {

std::vector<std::string_view> service_names() {
  std::vector<std::string_view> names;
  for (unsigned i = 0; i < service_count; ++i) names.push_back(name(static_cast<Service>(i)));
  return names;
}

std::optional<std::uint32_t> parse_number(std::string_view text, int base, std::uint32_t most) {
  const auto value = base == 16 ? ascii::parse_hexadecimal<std::uint32_t>(text)
                                : ascii::parse_number<std::uint32_t>(text, base);
  return value && *value <= most ? value : std::nullopt;
}

std::unexpected<std::string> wrong(std::string_view option, std::string_view text,
                                   std::string_view expected) {
  return std::unexpected(fmt::format("{}{}: expected {}", option, text, expected));
}

std::expected<std::optional<can::Duration>, std::string> parse_time(std::string_view option,
                                                                    const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto duration = text::parse_duration(text);
  if (!duration) return std::unexpected(fmt::format("{}{}", option, duration.error()));
  return *duration;
}

template <typename Value, typename List>
bool is_wanted(const List& list, const Value& value) {
  return list.empty() || std::ranges::find(list, value) != list.end();
}

}  // namespace

std::expected<MessageFilter, std::string> MessageFilter::read(const FilterOptions& options,
                                                              const FilterNames& names) {
  MessageFilter filter;
  for (const std::string& text : options.nodes) {
    if (!text.empty() && !ascii::is_digit(text.front()) && text.front() != '-') {
      filter.node_names_.push_back(ascii::lower(text));
      continue;
    }
    const auto node = parse_number(text, 10, 127);
    if (!node) return wrong(names.node, text, "a node-ID 1 to 127, 0 for all, or a name");
    filter.nodes_.push_back(*node);
  }
  for (const std::string& text : options.services) {
    const auto service = parse_service(text);
    if (!service) {
      return std::unexpected(fmt::format("{}{}: unknown service{}", names.service, text,
                                         text::suggestion(text, service_names())));
    }
    filter.services_.push_back(*service);
  }
  for (const std::string& text : options.objects) {
    const auto object = text::parse_object(text);
    if (!object) return std::unexpected(fmt::format("{}{}", names.object, object.error()));
    const bool has_sub = text.find(':') != std::string::npos;
    filter.objects_.push_back({object->index, has_sub ? std::optional(object->sub) : std::nullopt});
  }
  for (const std::string& text : options.identifiers) {
    const auto identifier = parse_number(text, 16, can::max_extended_identifier);
    if (!identifier)
      return wrong(names.identifier, text, "an identifier in hexadecimal digits, 0 to 1FFFFFFF");
    filter.identifiers_.push_back(*identifier);
  }
  for (const std::string& text : options.aborts) {
    const auto code = parse_number(text, 16, 0xFFFF'FFFF);
    if (!code) return wrong(names.abort, text, "an abort code in hexadecimal digits, 0 to FFFFFFFF");
    filter.aborts_.push_back(*code);
  }
  const auto from = parse_time(names.from, options.from);
  if (!from) return std::unexpected(from.error());
  const auto to = parse_time(names.to, options.to);
  if (!to) return std::unexpected(to.error());
  filter.from_ = *from;
  filter.to_ = *to;
  if (filter.from_ && filter.to_ && *filter.from_ > *filter.to_) {
    return std::unexpected(fmt::format("{} is later than {}", names.from.substr(0, names.from.size() - 2),
                                       names.to.substr(0, names.to.size() - 2)));
  }
  return filter;
}

std::optional<MessageFilter> MessageFilter::make(const FilterOptions& options, text::Output& err) {
  auto filter = read(options);
  if (filter) return std::move(*filter);
  err.line("canopus: {}", filter.error());
  return std::nullopt;
}

bool MessageFilter::has_object(const Message& message) const {
  return std::ranges::any_of(objects_, [&](const Object& object) {
    const auto same = [&](std::uint16_t index, std::uint8_t sub) {
      return index == object.index && (!object.sub || *object.sub == sub);
    };
    return (message.index && same(*message.index, message.sub)) ||
           std::ranges::any_of(message.signals,
                               [&](const Signal& signal) { return same(signal.index, signal.sub); });
  });
}

bool MessageFilter::has_node(const Message& message) const {
  if (nodes_.empty() && node_names_.empty()) return true;
  const auto begins_so = [name = ascii::lower(message.node_name)](const std::string& begin) {
    return name.starts_with(begin);
  };
  return std::ranges::find(nodes_, message.node) != nodes_.end() ||
         std::ranges::any_of(node_names_, begins_so);
}

bool MessageFilter::wants(const Message& message, can::Duration since) const {
  if ((from_ && since < *from_) || is_over(since)) return false;
  if (!aborts_.empty() && (!message.abort_code || !is_wanted(aborts_, *message.abort_code))) return false;
  return has_node(message) && is_wanted(services_, message.service) &&
         is_wanted(identifiers_, message.frame.identifier) && (objects_.empty() || has_object(message));
}

}  // namespace canopus::trace
