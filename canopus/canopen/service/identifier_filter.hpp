#pragma once
// Which frames cannot concern a node, by the low six bits of the identifier alone: on a bus that hands
// every frame to every node, most frames carry another node's number there. One word, which lies in the node
// itself: a frame for another node costs five instructions and one cache line.

#include <cstdint>

namespace canopus::canopen {

class IdentifierFilter {
 public:
  [[nodiscard]] bool may_pass(std::uint32_t identifier) const noexcept {
    return (bits_ >> (identifier & 63U) & 1U) != 0;
  }
  void clear() noexcept { bits_ = 0; }
  void add(std::uint32_t identifier) noexcept { bits_ |= 1ULL << (identifier & 63U); }
  void pass_all() noexcept { bits_ = ~0ULL; }

 private:
  std::uint64_t bits_ = ~0ULL;
};

}  // namespace canopus::canopen
