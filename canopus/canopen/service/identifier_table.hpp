#pragma once
// Which service of a node a received frame belongs to: a small hash table over the identifier, the frame
// format and RTR. Built anew when a COB-ID changes; a look-up is one multiplication and, on average, less
// than two comparisons, whatever the number of identifiers. One identifier may lead to several services (two
// RPDOs may listen to one TPDO). In a large table, that of a master, identifiers that follow each other are neighbours:
// frames of many nodes mostly come in order, and eight places are a cache line.

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "canopus/can/frame.hpp"

namespace canopus::canopen {

enum class ServiceKind : std::uint8_t {
  none,     ///< an empty place of the table
  several,  ///< more than one route has this key
  nmt,
  sync,
  time_stamp,
  rpdo,                ///< number: position among the node's RPDOs
  tpdo_request,        ///< remote frame; number: position among the node's TPDOs
  sdo_server,          ///< number: position among the node's SDO servers
  emcy,                ///< number: sub-index of 1028H
  heartbeat,           ///< number: position in 1016H, from 0
  node_guard_request,  ///< remote frame of the NMT master
  sam_mpdo,            ///< MPDO in source addressing mode
};

class IdentifierTable {
 public:
  static constexpr std::uint32_t empty = 0xFFFF'FFFF;
  struct Route {
    std::uint32_t key = 0;
    ServiceKind kind = ServiceKind::none;
    std::uint16_t number = 0;
  };

  /// Identifier, bit 29 = extended, bit 30 = remote.
  [[nodiscard]] static constexpr std::uint32_t key(std::uint32_t identifier, bool extended,
                                                   bool remote) noexcept {
    return identifier | (extended ? 1U << 29 : 0U) | (remote ? 1U << 30 : 0U);
  }
  [[nodiscard]] static constexpr std::uint32_t key(const can::Frame& frame) noexcept {
    return key(frame.identifier, frame.extended, frame.remote);
  }

  void build(std::span<const Route> routes);
  /// Nothing is found any more, until build().
  void close() noexcept {
    places_ = nothing.data();
    mask_ = static_cast<std::uint32_t>(nothing.size() - 1);
    factor_ = scattering;
    shift_ = 31;
  }

  struct Slot {
    std::uint32_t key = empty;
    /// What a frame is for: none, where there is no route; several, where for_each() says for what.
    ServiceKind found = ServiceKind::none;
    ServiceKind kind = ServiceKind::none;  ///< of this route
    std::uint16_t number = 0;
  };
  /// The first route of this key, or nullptr.
  [[nodiscard]] const Slot* first(std::uint32_t wanted) const noexcept {
    return wanted == empty ? nullptr : find(wanted);
  }
  /// The same, but `empty`, which no frame has, may find an empty slot.
  [[nodiscard]] const Slot* find(std::uint32_t wanted) const noexcept {
    for (std::size_t place = start(wanted);; place = (place + 1) & mask_) {
      const Slot& slot = places_[place];
      if (slot.key == wanted) [[likely]]
        return &slot;
      if (slot.key == empty) return nullptr;
    }
  }
  /// Calls `visit(kind, number)` for every route of this key, in the order they were given to build().
  template <typename Visit>
  void for_each(std::uint32_t wanted, Visit&& visit) const {
    for (std::size_t place = start(wanted); places_[place].key != empty; place = (place + 1) & mask_) {
      const Slot slot = places_[place];  // a copy: a visit may build the table anew
      if (slot.key != wanted) continue;
      visit(slot.kind, slot.number);
      if (slot.found != ServiceKind::several) return;
    }
  }
  /// Calls `visit(key)` for every route, in no order.
  template <typename Visit>
  void for_each_key(Visit&& visit) const {
    for (std::size_t place = 0; place <= mask_; ++place) {
      if (places_[place].key != empty) visit(places_[place].key);
    }
  }
  [[nodiscard]] bool contains(std::uint32_t wanted) const noexcept { return first(wanted) != nullptr; }

 private:
  [[nodiscard]] std::size_t start(std::uint32_t wanted) const noexcept {
    return (wanted * factor_) >> shift_;
  }
  std::size_t fill(std::span<const Route> routes);

  static constexpr std::uint32_t scattering = 0x9E37'79B1;
  static const std::array<Slot, 2> nothing;  // the places of a table that is closed

  std::unique_ptr<Slot[]> slots_;  // a power of two, at least twice as many as there are routes
  const Slot* places_ = nothing.data();
  std::uint32_t mask_ = 1;
  std::uint32_t factor_ = scattering;
  unsigned shift_ = 31;
};

}  // namespace canopus::canopen
