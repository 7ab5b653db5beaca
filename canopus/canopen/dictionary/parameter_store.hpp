#pragma once
// Where the values that 1010H saves are kept while the node is off. Implemented above this room: a file, a
// module's non-volatile memory, a test's vector.

#include <cstdint>
#include <span>
#include <vector>

#include "canopus/canopen/dictionary/abort_code.hpp"

namespace canopus::canopen {

class ParameterStore {
 public:
  /// What save() was last given; empty if never.
  [[nodiscard]] virtual std::vector<std::uint8_t> load() = 0;
  /// Replaces all that is kept. 06060000H (hardware_error) if the memory fails: the old image is then still
  /// there.
  virtual AbortCode save(std::span<const std::uint8_t> image) = 0;
  /// What load() has returned does not decode, and the defaults hold; or values that do not fit their objects
  /// were left out.
  virtual void found_damaged() {}

 protected:
  ~ParameterStore() = default;
};

}  // namespace canopus::canopen
