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
    char* at = room();
    *at++ = '#';
    end_line(append_number(at, tick));
  }
  void level(bool high, Code code) {
    char* at = room();
    *at = high ? '1' : '0';
    append_code(at + 1, code);
  }
  void number(int value, Code code) {
    char* at = room();
    *at++ = 'r';  // libsigrok 0.5.2 stops at a vector
    at = append_number(at, value);
    *at++ = ' ';
    append_code(at, code);
  }
  void hand_over();

 private:
  static constexpr std::size_t capacity = 64 * 1024;
  static constexpr std::size_t longest_line = 40;

  /// For one line.
  [[nodiscard]] char* room() {
    if (capacity - size_ < longest_line) hand_over();
    return buffer_.data() + size_;
  }
  template <typename Number>
  [[nodiscard]] static char* append_number(char* at, Number number) {
    return std::to_chars(at, at + longest_line / 2, number).ptr;
  }
  void append_code(char* at, Code code) {
    std::memcpy(at, &code, sizeof code);  // more than it has, in one store
    size_ = static_cast<std::size_t>(at - buffer_.data()) + code.size;
  }
  void end_line(char* at) {
    *at++ = '\n';
    size_ = static_cast<std::size_t>(at - buffer_.data());
  }

  Sink sink_;
  can::Duration resolution_;
  std::vector<char> buffer_;
  std::size_t size_ = 0;
  can::Time latest_{can::Duration(-1)};
  std::int64_t written_ = -1;
};

}  // namespace canopus::sim
