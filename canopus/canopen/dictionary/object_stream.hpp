#pragma once
// Values that are handed over piece by piece instead of lying in memory as a whole: a DOMAIN of megabytes
// passes through an SDO server or client in pieces of at most about one kilobyte.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>

#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"

namespace canopus::canopen {

struct Entry;

/// Gives the bytes of a value from front to back.
class ByteSource {
 public:
  /// Fills `into` with the next bytes and says how many; fewer than asked for: that was the end.
  virtual std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t> into) = 0;

 protected:
  ~ByteSource() = default;
};

/// Gives bytes that lie in memory and stay there.
class MemorySource final : public ByteSource {
 public:
  MemorySource() = default;
  explicit MemorySource(std::span<const std::uint8_t> bytes) noexcept : rest_(bytes) {}
  std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t> into) override {
    const std::size_t count = std::min(into.size(), rest_.size());
    std::copy_n(rest_.begin(), count, into.begin());
    rest_ = rest_.subspan(count);
    return count;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Takes the bytes of a value from front to back.
class ByteSink {
 public:
  virtual AbortCode write(std::span<const std::uint8_t> bytes) = 0;

 protected:
  ~ByteSink() = default;
};

/// An object whose value streams (ObjectHandler::stream()). Transfers of one object through several SDO
/// servers at once may overlap; an implementation that cannot have that refuses the second open.
class ObjectStream : public ByteSource, public ByteSink {
 public:
  /// An upload begins. Returns the size, or nothing if it is not known yet.
  virtual std::expected<std::optional<std::size_t>, AbortCode> open_read(const Entry&, can::Time) {
    return std::unexpected(AbortCode::unsupported_access);
  }
  /// A download begins; its size, if the client indicated it.
  virtual AbortCode open_write(const Entry&, std::optional<std::size_t> /*size*/, can::Time) {
    return AbortCode::unsupported_access;
  }
  /// The transfer ended; `complete`: with all its bytes. A download may still be refused here.
  virtual AbortCode close(const Entry&, bool /*complete*/, can::Time) { return AbortCode::none; }

  std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t>) override {
    return std::unexpected(AbortCode::unsupported_access);
  }
  AbortCode write(std::span<const std::uint8_t>) override { return AbortCode::unsupported_access; }

 protected:
  ~ObjectStream() = default;
};

}  // namespace canopus::canopen
