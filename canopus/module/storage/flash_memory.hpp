#pragma once
// Flash memory that wears: every blob carries how often the memory had been written when it was, so that the
// count survives like the content. A blob that cannot be what was written counts as damaged.

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "canopus/module/interface/non_volatile_memory.hpp"

namespace canopus::module {

class FlashMemory final : public NonVolatileMemory {
 public:
  /// `names`: all blobs that will be read or written. `medium` and the names' characters must outlive it.
  FlashMemory(NonVolatileMemory& medium, std::initializer_list<std::string_view> names)
      : medium_(&medium), names_(names) {}

  /// Learns the count from what is stored: at each start, before anything else.
  void load();

  [[nodiscard]] Content read(std::string_view name) override;
  bool write(std::string_view name, std::span<const std::uint8_t> bytes) override;
  /// Wears like a write, if there is something to erase.
  bool erase(std::string_view name) override;

  /// Writes and erasures so far, over all runs.
  [[nodiscard]] std::uint32_t writes() const noexcept { return writes_; }

 private:
  enum class Kind : std::uint8_t { content = 1, erased = 2 };
  bool put(Kind kind, std::string_view name, std::span<const std::uint8_t> bytes);

  NonVolatileMemory* medium_;
  std::vector<std::string_view> names_;
  std::uint32_t writes_ = 0;
};

}  // namespace canopus::module
