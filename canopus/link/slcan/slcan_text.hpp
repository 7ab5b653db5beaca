#pragma once
// The lines of a Lawicel CAN adapter ("slcan"), without any I/O. Each ends with CR:
//
//   t6018401810010000000 0    a data frame (without the blank): 3 digits identifier, 1 length, 2 per byte
//   T1FFFFFFF0                extended: 8 digits identifier
//   r7051  R000000018         remote frames, with the length asked for
//   S5  s031C  O  C  F  V  N  bit rate, bit timing registers, open, close, status flags, version, serial number
//
// The adapter answers in order: CR, `z` CR or `Z` CR (frame taken), `F00` CR and the like, or BEL: refused. Between
// its answers it sends the frames it receives, with four digits of time behind them where that is switched on.
// [Lawicel CAN232 manual; Linux drivers/net/can/slcan]

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "canopus/can/frame.hpp"

namespace canopus::link {

inline constexpr std::size_t slcan_max_line = 32;
/// Bytes without the end of a line that are too many for any adapter, also for noise at a wrong speed.
inline constexpr std::size_t slcan_most_without_end = 4096;

/// Writes a frame with its CR and returns its length. Lengths above 8 are sent as 8.
std::size_t write_slcan_frame(std::span<char, slcan_max_line> out, const can::Frame& frame) noexcept;

/// The command that sets a bit rate, without its CR: "S5" for the nine of the protocol, otherwise the registers of an
/// SJA1000 at 16 MHz ("s0B1C", sample point between 75 and 90 %). None: there is no such setting.
[[nodiscard]] std::optional<std::string> slcan_bit_rate(std::uint32_t bit_rate);

/// A line from the adapter.
struct SlcanLine {
  enum class Kind : std::uint8_t {
    frame,    ///< of the bus
    done,     ///< CR alone: the command is done
    taken,    ///< z or Z: the frame is taken
    refused,  ///< BEL
    flags,    ///< F with two digits: `flags`
    other,    ///< version, serial number, or what is not understood: `text`
  };
  Kind kind = Kind::other;
  can::Frame frame{};
  std::uint8_t flags = 0;
  std::string_view text{};  ///< valid during the call
};

/// Status flags of `F`.
inline constexpr std::uint8_t slcan_receive_queue_full = 0x01;
inline constexpr std::uint8_t slcan_transmit_queue_full = 0x02;
inline constexpr std::uint8_t slcan_error_warning = 0x04;
inline constexpr std::uint8_t slcan_overrun = 0x08;
inline constexpr std::uint8_t slcan_error_passive = 0x20;
inline constexpr std::uint8_t slcan_bus_error = 0x80;

/// Cuts what comes from an adapter into lines. What is longer than any line is thrown away up to its end.
class SlcanReader {
 public:
  /// `line(const SlcanLine&)` is called for each.
  template <typename Line>
  void receive(std::string_view bytes, Line line) {
    for (const char c : bytes) {
      if (c == '\n') continue;
      if (c != '\r' && c != '\a') {
        if (size_ < input_.size()) input_[size_] = c;
        if (size_ <= input_.size()) ++size_;
        if (without_end_ < slcan_most_without_end) ++without_end_;
        continue;
      }
      without_end_ = 0;
      const SlcanLine found = end_of_line(c);
      size_ = 0;
      line(found);
    }
  }
  void clear() noexcept { size_ = without_end_ = 0; }
  /// The limit of bytes without an end of line is reached: the other side is no adapter.
  [[nodiscard]] bool is_endless() const noexcept { return without_end_ == slcan_most_without_end; }

 private:
  [[nodiscard]] SlcanLine end_of_line(char end) const noexcept;

  std::array<char, 64> input_;
  std::size_t size_ = 0;  // input_.size() + 1: too long
  std::size_t without_end_ = 0;
};

}  // namespace canopus::link
