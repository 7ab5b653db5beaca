#include "canopus/cli/network_project/bus_objects.hpp"

#include <utility>

#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/client/sdo_request.hpp"

namespace canopus::cli {
namespace {

master::ObjectAccess::Failure failure_of(client::SdoFailure failure) {
  const bool is_silence =
      failure.code == canopen::AbortCode::none || failure.code == canopen::AbortCode::timed_out;
  return {.is_refused = !is_silence, .reason = std::move(failure.reason)};
}

}  // namespace

std::expected<std::vector<std::uint8_t>, BusObjects::Failure> BusObjects::read(text::ObjectName object,
                                                                               canopen::DataType type) {
  const auto came = sdo_.read(object);
  if (!came) return std::unexpected(failure_of(came.error()));
  const auto [bytes, remark] = client::value_of(*came, sdo_.speed(), type);
  if (!remark.empty())
    print_error("canopus: warning: node {}, {}: {}", node_id_, canopen::object_text(object.index, object.sub),
                remark);
  return std::vector<std::uint8_t>(bytes.begin(), bytes.end());
}

std::expected<void, BusObjects::Failure> BusObjects::write(text::ObjectName object,
                                                           std::span<const std::uint8_t> value) {
  auto done = sdo_.write(object, value);
  if (!done) return std::unexpected(failure_of(std::move(done.error())));
  return {};
}

ObjectProgress::ObjectProgress(const link::BusLoop& bus, std::string what)
    : bus_(bus), what_(std::move(what)), next_(bus.now() + std::chrono::milliseconds(500)) {}

ObjectProgress::~ObjectProgress() {
  if (is_shown_) end_progress();
}

master::Progress ObjectProgress::function() {
  return [this](std::size_t done, std::size_t of) {
    if (bus_.now() >= next_ && is_terminal(STDERR_FILENO)) {
      next_ = bus_.now() + std::chrono::milliseconds(100);
      is_shown_ = true;
      show_progress(Line("{}: {} of {}", what_, done, ascii::counted(of, "object")));
    }
    return true;
  };
}

}  // namespace canopus::cli
