#pragma once
// What the page shows of the wire of a simulated bus as long as a client has the view: which node lost the arbitration to a frame and at
// which bit, and the levels around an error.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/bus/wire/wire_observer.hpp"

namespace canopus::web {

/// Listens to a bus from its making on, and never makes it go bit by bit.
class ArbitrationProbe final : private sim::WireObserver {
 public:
  static constexpr std::size_t most_frames = 16;    ///< identifiers that are looked at, the latest ones
  static constexpr std::size_t most_changes = 512;  ///< of the level that are kept

  /// The bus must outlive this.
  explicit ArbitrationProbe(sim::Bus& bus) : bus_(bus) { bus_.add_observer(*this); }
  ~ArbitrationProbe() { bus_.remove_observer(*this); }
  ArbitrationProbe(const ArbitrationProbe&) = delete;
  ArbitrationProbe& operator=(const ArbitrationProbe&) = delete;

  /// The nodes that began to send with the latest frame of an identifier.
  struct Arbitration {
    std::uint32_t identifier = 0;
    bool extended = false;
    can::Time start = can::never;  ///< of its SOF; never: there was none since it is looked at
    std::vector<sim::WireFrame::Sender> senders{};
  };
  /// From now on of this identifier, too. What is known of it.
  [[nodiscard]] const Arbitration& arbitration_of(std::uint32_t identifier, bool extended);
  /// The level of the wire; nothing: that is not known any more, or was not reported bit by bit.
  [[nodiscard]] std::optional<bool> is_dominant(can::Time at) const noexcept;

 private:
  struct Change {
    can::Time at = can::never;
    bool dominant = false;
  };

  void note(const can::Frame& frame, can::Time start, std::span<const sim::WireFrame::Sender> senders);
  // sim::WireObserver
  [[nodiscard]] bool needs_bits() const noexcept override { return false; }
  void frame_passed(const sim::WireFrame& frame) override;
  void arbitration_passed(const sim::WireArbitration& arbitration) override;
  void level_changed(bool dominant, can::Time now) override;
  void transmit_changed(const can::Port& /*port*/, bool /*dominant*/, can::Time /*now*/) override {}
  void activity_changed(const can::Port& /*port*/, bool /*flagging*/, bool /*arbitrating*/,
                        can::Time /*now*/) override {}

  sim::Bus& bus_;
  std::vector<Arbitration> frames_;
  std::size_t next_frame_ = 0;
  std::array<Change, most_changes> changes_{};
  std::size_t next_change_ = 0;
};

}  // namespace canopus::web
