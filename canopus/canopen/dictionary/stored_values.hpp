#pragma once
// How values of objects lie in a memory that keeps them while the power is off: one after another, each with
// its index (2 bytes), sub-index (1), length (4, or 2 in the flash memory of a module) and bytes, everything
// little-endian. Whether the memory's content is what was written is the memory's to say; what does not
// decode is damaged all the same.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/canopen/dictionary/stored_length.hpp"

namespace canopus::canopen {

class ObjectDictionary;

/// A value. The bytes are those that the reader reads from.
struct StoredValue {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::span<const std::uint8_t> bytes;
};

/// Appends one. `value`: up to longest_stored_value() bytes.
void append_stored_value(std::vector<std::uint8_t>& image, StoredLength form, std::uint16_t index,
                         std::uint8_t sub, std::span<const std::uint8_t> value);

/// Goes through an image value by value.
class StoredValueReader {
 public:
  StoredValueReader(std::span<const std::uint8_t> image, StoredLength form) noexcept
      : rest_(image), form_(form) {}

  /// The next value; nothing at the end, or where the image is damaged (then !intact()).
  std::optional<StoredValue> next() noexcept;
  /// False once something was found that is no value.
  [[nodiscard]] bool intact() const noexcept { return intact_; }

 private:
  std::span<const std::uint8_t> rest_;
  StoredLength form_;
  bool intact_ = true;
};

/// The image decodes from its first byte to its last.
[[nodiscard]] bool are_stored_values(std::span<const std::uint8_t> image, StoredLength form) noexcept;

/// Puts the values that are `wanted` into the dictionary, without checks or handlers. Those of objects that
/// no longer exist, or whose length has changed, are left out. False when there is one of another length, or
/// the image does not decode; of such an image nothing is put in.
bool apply_stored_values(std::span<const std::uint8_t> image, StoredLength form, ObjectDictionary& dictionary,
                         const std::function<bool(const Entry&)>& wanted);

}  // namespace canopus::canopen
