#pragma once
// A CPU's devices and the buffer memory of its modules, as a program reaches them. The owner of a program implements it.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "canopus/program/data_type.hpp"

namespace canopus::program {

/// A device by the numbers of the image: what they mean is the image's business.
struct DevicePoint {
  std::uint16_t device = 0;
  std::uint16_t unit = 0;  ///< of a module's buffer memory
  std::uint32_t number = 0;
  bool is_buffer = false;  ///< a word of a module: U0\G25
  bool is_bit = false;     ///< a bit device
};

enum class DeviceError : std::uint8_t { none, out_of_range, no_module };

class DeviceImage {
 public:
  /// `words.size()` words from a word device or a word of buffer memory on. Nothing is changed by what is refused.
  virtual DeviceError read_words(const DevicePoint& first, std::span<std::uint16_t> words) = 0;
  virtual DeviceError write_words(const DevicePoint& first, std::span<const std::uint16_t> words) = 0;
  /// `count` points, at most 32, of a bit device, the first one in bit 0.
  virtual DeviceError read_bits(const DevicePoint& first, unsigned count, std::uint32_t& bits) = 0;
  virtual DeviceError write_bits(const DevicePoint& first, unsigned count, std::uint32_t bits) = 0;
  /// `count` X of modules become those of this moment, or as many Y go out to modules, before END does it.
  virtual DeviceError refresh(const DevicePoint& /*first*/, std::uint32_t /*count*/) {
    return DeviceError::none;
  }
  /// Sets the CPU's clock. An image without one does nothing.
  virtual void set_clock(std::chrono::local_seconds /*clock*/) {}

  /// `count` words from this one on, in a row, where reading and writing them does nothing else: a program does so without the functions
  /// above while memory_layout() is the same. nullptr: only by these functions.
  [[nodiscard]] virtual std::uint16_t* words_in_memory(const DevicePoint& /*first*/, unsigned /*count*/) {
    return nullptr;
  }
  /// The same for a point of a bit device: a byte that is 0 or 1.
  [[nodiscard]] virtual std::uint8_t* bit_in_memory(const DevicePoint& /*point*/) { return nullptr; }
  /// Another number whenever the two above return something else; no two images have the same.
  [[nodiscard]] std::uint64_t memory_layout() const noexcept { return memory_layout_; }

 protected:
  DeviceImage() = default;
  DeviceImage(const DeviceImage&) = delete;
  DeviceImage& operator=(const DeviceImage&) = delete;
  ~DeviceImage() = default;
  void memory_layout_changed() noexcept { memory_layout_ = next_memory_layout(); }

 private:
  static std::uint64_t next_memory_layout() noexcept {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
  }

  std::uint64_t memory_layout_ = next_memory_layout();
};

/// The names of a CPU's devices.
class DeviceNames {
 public:
  /// "X10", "D100", "U0\G25". The error says what was expected.
  [[nodiscard]] virtual std::expected<DevicePoint, std::string> point(std::string_view name) const = 0;
  /// Its first letters are those of a device, and a number follows: M0, but not MOTOR.
  [[nodiscard]] virtual bool looks_like_device(std::string_view name) const = 0;

 protected:
  ~DeviceNames() = default;
};

/// How an instruction reads and writes devices.
struct DeviceAccess {
  enum class Form : std::uint8_t {
    bit,          ///< X10
    bit_of_word,  ///< D100.3
    points,       ///< K4M0: 16 points of a bit device
    words         ///< D0, and D0:REAL, which is two
  };
  DevicePoint point;
  Form form = Form::words;
  std::uint8_t count = 1;  ///< points or words; of bit_of_word the bit's number
  Elementary type = Elementary::word;
  bool is_indexed = false;  ///< D0Z1: the value of the index register is added to the number
  DevicePoint index{};
  std::string text{};  ///< as it is written
};

}  // namespace canopus::program
