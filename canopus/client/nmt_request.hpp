#pragma once
// An NMT command as a person asks for it, in words, and its answer as a JSON row: the same for `canopus nmt` and for the page.

#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::client {

struct NmtService {
  const char* name;
  const char* help;
  canopen::NmtCommand command;
  canopen::NmtState state;  ///< that the node's heartbeat or boot-up message shows when it obeyed
  std::uint8_t request;     ///< the same as a value of 1F82H [CiA 302-2]
};
[[nodiscard]] std::span<const NmtService> nmt_services() noexcept;

struct NmtRequest {
  const NmtService* service = nullptr;
  std::uint8_t node = 0;  ///< 0: all
  std::uint8_t master =
      0;               ///< node-ID of the active NMT master that is to send the command; 0: its client does
  bool waits = false;  ///< until the node shows its state

  /// `node`: a node-ID or "all"; `master`: a node-ID, or empty. The error is a sentence.
  [[nodiscard]] static std::expected<NmtRequest, std::string> parse(const NmtService& service,
                                                                    const std::string& node,
                                                                    const std::string& master, bool waits);
  /// The command, where no master sends it.
  [[nodiscard]] can::Frame frame() const;
  /// Of the master's request NMT (1F82H) [CiA 302-2]: where `request` of the service is written.
  [[nodiscard]] text::ObjectName object() const;
  /// "node 5", "all nodes"
  [[nodiscard]] std::string addressee() const;
  /// {"command", "node"}, with a master "master", and "state" where it was waited for.
  [[nodiscard]] text::Json row() const;
  /// Sentences: the master did not write its object; the node does not show its state within this time.
  [[nodiscard]] std::string refused(std::string_view reason) const;
  [[nodiscard]] std::string not_shown(can::Duration time_out) const;
};

/// Waits for a node to show its state.
class NmtStateWatch final : public can::Listener {
 public:
  explicit NmtStateWatch(const NmtRequest& request) : node_(request.node), wanted_(request.service->state) {}
  [[nodiscard]] bool seen() const noexcept { return seen_; }

  void receive(const can::Frame& frame, can::Time now) override;

 private:
  std::uint8_t node_;
  canopen::NmtState wanted_;
  bool seen_ = false;
};

}  // namespace canopus::client
