#pragma once
// The lines of a Value Change Dump, in one buffer that is handed on when it is full.

#include <charconv>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/can/time.hpp"

namespace canopus::sim {

class WaveformText {
 public:
  using Sink = std::function<void(std::string_view)>;

  /// How a signal is called in the lines of its changes.
  struct Code {
    char text[7];  // and a line feed behind it
    std::uint8_t size;
    [[nodiscard]] std::string_view name() const noexcept { return {text, size - std::size_t{1}}; }
  };
  static_assert(sizeof(Code) == 8);
  [[nodiscard]] static Code code(std::size_t signal) noexcept;

  WaveformText(Sink sink, can::Duration resolution)
      : sink_(std::move(sink)), resolution_(resolution), buffer_(capacity) {}

  [[nodiscard]] can::Duration resolution() const noexcept { return resolution_; }
  void write(std::string_view text);
  /// Lines of levels, ready to be written: of signals in their order.
  static void append_level(std::string& lines, bool high, const Code& code) {
    lines += high ? '1' : '0';
    lines.append(code.text, code.size);
  }
  /// What follows happens then. A line of its own if it is later than what was there, in the unit of the dump.
  void time(can::Time now) {
    if (now <= latest_) return;
    latest_ = now;
    const std::int64_t tick = now.time_since_epoch() / resolution_;
    if (tick == written_) return;
    written_ = tick;
    make_room();
    buffer_[size_++] = '#';
    append_number(tick);
    buffer_[size_++] = '\n';
  }
  void level(bool high, const Code& code) {
    make_room();
    buffer_[size_++] = high ? '1' : '0';
    append_code(code);
  }
  void number(int value, const Code& code) {
    make_room();
    buffer_[size_++] = 'r';  // libsigrok 0.5.2 stops at a vector
    append_number(value);
    buffer_[size_++] = ' ';
    append_code(code);
  }
  void hand_over();

 private:
  static constexpr std::size_t capacity = 64 * 1024;
  static constexpr std::size_t longest_line = 40;

  void make_room() {
    if (capacity - size_ < longest_line) hand_over();
  }
  template <typename Number>
  void append_number(Number number) {
    char* at = buffer_.data() + size_;
    size_ += static_cast<std::size_t>(std::to_chars(at, at + longest_line / 2, number).ptr - at);
  }
  void append_code(const Code& code) {
    std::memcpy(buffer_.data() + size_, &code, sizeof code);  // more than it has, in one store
    size_ += code.size;
  }

  Sink sink_;
  can::Duration resolution_;
  std::vector<char> buffer_;
  std::size_t size_ = 0;
  can::Time latest_{can::Duration(-1)};
  std::int64_t written_ = -1;
};

}  // namespace canopus::sim
