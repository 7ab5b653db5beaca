#pragma once
// The medium on which a module keeps what must survive power-off.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace canopus::module {

/// Where a module keeps what must survive power-off. Named blobs, written whole; a write is done or not done,
/// never half (room store implements it; tests use memory).
class NonVolatileMemory {
 public:
  virtual ~NonVolatileMemory() = default;
  /// Content of `name`. Empty optional: never written. A damaged content is reported once as such.
  struct Content {
    enum class State : std::uint8_t { missing, good, damaged } state = State::missing;
    std::vector<std::uint8_t> bytes;
  };
  [[nodiscard]] virtual Content read(std::string_view name) = 0;
  /// False when the medium failed; the old content is still there then.
  virtual bool write(std::string_view name, std::span<const std::uint8_t> bytes) = 0;
  virtual bool erase(std::string_view name) = 0;
};

}  // namespace canopus::module
