#include "canopus/trace/decode/message.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace canopus::trace {
namespace {

constexpr std::array<std::string_view, service_count> service_names{
    "nmt",  "failsafe", "flying-master", "sync", "time",   "emcy",       "pdo",
    "mpdo", "sdo",      "error-control", "lss",  "layer2", "error-frame"};

}  // namespace

std::string_view name(Service service) noexcept { return service_names[static_cast<std::size_t>(service)]; }

std::optional<Service> parse_service(std::string_view name) noexcept {
  const auto* const found = std::ranges::find(service_names, name);
  if (found == service_names.end()) return std::nullopt;
  return static_cast<Service>(found - service_names.begin());
}

std::string_view name(TransferEnd end) noexcept {
  switch (end) {
    case TransferEnd::done: return "done";
    case TransferEnd::aborted: return "aborted";
    case TransferEnd::unanswered: return "unanswered";
    case TransferEnd::unfinished: return "unfinished";
    case TransferEnd::overtaken: return "overtaken";
  }
  return "unknown";
}

std::string node_text(const Message& message) {
  if (message.node == 0) return message.service == Service::nmt ? "all" : "";
  if (message.node_name.empty()) return std::to_string(message.node);
  return fmt::format("{} ({})", message.node, message.node_name);
}

}  // namespace canopus::trace
