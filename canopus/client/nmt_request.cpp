#include "canopus/client/nmt_request.hpp"

#include <array>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/client/node_id.hpp"

namespace canopus::client {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;

constexpr std::array<NmtService, 5> services{{
    {"start", "Start remote node: to Operational", NmtCommand::start, NmtState::operational, 0x05},
    {"stop", "Stop remote node: to Stopped", NmtCommand::stop, NmtState::stopped, 0x04},
    {"preop", "Enter Pre-operational", NmtCommand::enter_pre_operational, NmtState::pre_operational, 0x7F},
    {"reset", "Reset node: as after power-on", NmtCommand::reset_node, NmtState::initialising, 0x06},
    {"reset-comm", "Reset communication", NmtCommand::reset_communication, NmtState::initialising, 0x07},
}};

constexpr std::uint16_t request_nmt = 0x1F82;
constexpr std::uint8_t request_for_all = 0x80;  ///< sub-index for all nodes, the master with them

}  // namespace

std::span<const NmtService> nmt_services() noexcept { return services; }

std::expected<NmtRequest, std::string> NmtRequest::parse(const NmtService& service, const std::string& node,
                                                         const std::string& master, bool waits) {
  const bool all = node == "all";
  NmtRequest request{.service = &service,
                     .node = static_cast<std::uint8_t>(parse_node(node)),
                     .master = static_cast<std::uint8_t>(parse_node(master)),
                     .waits = waits};
  if (!all && request.node == 0) {
    return std::unexpected(fmt::format("\"{}\" is not a node; expected a node-ID 1 to 127, or all", node));
  }
  if (!master.empty() && request.master == 0) {
    return std::unexpected(
        fmt::format("--master: \"{}\" is not a node; expected a node-ID 1 to 127", master));
  }
  if (all && waits) return std::unexpected("--wait needs a single node");
  return request;
}

can::Frame NmtRequest::frame() const {
  return can::data_frame(canopen::cob_id::nmt, {static_cast<std::uint8_t>(service->command), node});
}

text::ObjectName NmtRequest::object() const {
  return {.index = request_nmt, .sub = node == 0 ? request_for_all : node};
}

std::string NmtRequest::addressee() const { return node == 0 ? "all nodes" : fmt::format("node {}", node); }

text::Json NmtRequest::row() const {
  text::Json line;
  line["command"] = service->name;
  line["node"] = node;
  if (master != 0) line["master"] = master;
  if (waits) line["state"] = canopen::name(service->state);
  return line;
}

std::string NmtRequest::refused(std::string_view reason) const {
  return fmt::format("master {} did not take {:02X}H for {} (request NMT): {}", master, service->request,
                     canopen::object_text(request_nmt, object().sub), reason);
}

std::string NmtRequest::not_shown(can::Duration time_out) const {
  const bool boots = service->state == NmtState::initialising;
  return fmt::format("node {} does not show {} within {}", node,
                     boots ? "its boot-up message" : canopen::name(service->state),
                     text::describe_duration(time_out));
}

void NmtStateWatch::receive(const can::Frame& frame, can::Time) {
  if (frame.extended || frame.remote || frame.length() != 1) return;
  if (frame.identifier != canopen::cob_id::error_control + node_) return;
  if ((frame.data[0] & 0x7FU) == static_cast<unsigned>(wanted_)) seen_ = true;  // bit 7: guarding's toggle
}

}  // namespace canopus::client
