#pragma once
// Concise DCF [CiA 302-3]: what is to be written to a slave, as 1F22H holds it: U32 number of entries, then
// per entry U16 index, U8 sub-index, U32 length, and that many bytes as an SDO carries them.

#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace canopus::manager {

struct ConciseEntry {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::span<const std::uint8_t> data;
};

/// Goes through a concise DCF entry by entry, without copying; the bytes must stay valid.
class ConciseDcfReader {
 public:
  ConciseDcfReader() = default;
  explicit ConciseDcfReader(std::span<const std::uint8_t> file) noexcept;

  /// The next entry; nothing at the end, or where the file is damaged (then !intact()).
  std::optional<ConciseEntry> next() noexcept;
  /// False once something was found that does not fit: the file is too short for what it announces.
  [[nodiscard]] bool intact() const noexcept { return intact_; }
  /// Entries that the file announces and next() has not delivered yet.
  [[nodiscard]] std::uint32_t remaining() const noexcept { return remaining_; }
  /// Entries that the file announces.
  [[nodiscard]] std::uint32_t announced() const noexcept { return announced_; }
  /// What next() has not delivered: behind the last entry, or from the damaged entry on.
  [[nodiscard]] std::span<const std::uint8_t> rest() const noexcept { return rest_; }
  /// What does not fit, for people: "entry 3 says 70000 bytes, 12 are left"; empty while intact().
  [[nodiscard]] std::string damage() const;

 private:
  std::span<const std::uint8_t> rest_;
  std::uint32_t announced_ = 0;
  std::uint32_t remaining_ = 0;
  bool intact_ = true;
};

/// A file that holds nothing to write: no bytes, one byte 00H (which deletes an entry of 1F22H), or a count
/// of 0.
[[nodiscard]] bool is_empty_concise_dcf(std::span<const std::uint8_t> file) noexcept;

/// Checks a whole file: the number of entries, or what is wrong and at which byte.
[[nodiscard]] std::expected<std::uint32_t, std::string> check_concise_dcf(std::span<const std::uint8_t> file);

/// Puts a concise DCF together.
class ConciseDcfWriter {
 public:
  ConciseDcfWriter& add(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data);
  /// `length` low bytes of `value`, little-endian. length 1..8.
  ConciseDcfWriter& add(std::uint16_t index, std::uint8_t sub, std::uint64_t value, unsigned length);
  [[nodiscard]] const std::vector<std::uint8_t>& file() const noexcept { return file_; }

 private:
  std::vector<std::uint8_t> file_{0, 0, 0, 0};
};

}  // namespace canopus::manager
