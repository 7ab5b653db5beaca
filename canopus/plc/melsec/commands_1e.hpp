#pragma once
// Executes the commands of 1E frames: batch read and write (00 to 03), test (04, 05), registering and reading
// of monitored devices (06 to 09), buffer memory of special function modules (0E, 0F), remote RUN and STOP
// (13, 14), CPU model (15), loopback (16). One object per connection: it keeps the monitored devices.
//
// A request is checked as a whole before anything is written: a refused one has changed nothing.

#include <array>
#include <cstdint>
#include <expected>
#include <span>

#include "canopus/can/time.hpp"
#include "canopus/plc/melsec/frame_1e.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/plc/rack/write_permission.hpp"

namespace canopus::plc::melsec {

/// Points per request, and which commands there are. Bit devices in words count 16 points a word.
struct Rules1e {
  std::uint16_t read_bits = 256;
  std::uint16_t read_bit_words = 128;
  std::uint16_t read_words = 256;
  std::uint16_t write_bits = 256;
  std::uint16_t write_bit_words = 40;
  std::uint16_t write_words = 256;
  std::uint16_t test_bits = 80;
  std::uint16_t test_words = 40;
  std::uint16_t monitored_bits = 40;   ///< 0: 06 and 08 are not there
  std::uint16_t monitored_words = 20;  ///< 07 and 09
  std::uint16_t loopback = 256;
  bool wide_counters = false;            ///< CN from 200 on have 32 bits
  bool special_function_modules = true;  ///< 0E and 0F
};
/// An Ethernet module of the Q series, and of the A series. [SH-080811 5.1.2, SH-080008 18]
inline constexpr Rules1e rules_1e_q{};
/// FX3U-ENET, FX3U-ENET-ADP. [FX3U-ENET 9.3.1]
inline constexpr Rules1e rules_1e_fx3{.read_bits = 256,
                                      .read_bit_words = 32,
                                      .read_words = 64,
                                      .write_bits = 160,
                                      .write_bit_words = 10,
                                      .write_words = 64,
                                      .test_bits = 80,
                                      .test_words = 10,
                                      .monitored_bits = 0,
                                      .monitored_words = 0,
                                      .loopback = 254,
                                      .wide_counters = true,
                                      .special_function_modules = false};

/// Those of the Ethernet module that goes with a CPU.
[[nodiscard]] const Rules1e& rules_1e_of(const CpuModel& model) noexcept;

/// Why a request is refused; completed: it is not.
struct Outcome1e {
  EndCode1e end_code = EndCode1e::completed;
  AbnormalCode abnormal_code = AbnormalCode::none;

  friend bool operator==(const Outcome1e&, const Outcome1e&) = default;
};

class Commands1e {
 public:
  /// Both must outlive this.
  Commands1e(Rack& rack, const Rules1e& rules) noexcept : rack_(rack), rules_(rules) {}

  /// `request`: a complete one, as read_request_1e() found it. The whole reply goes into `out`, which has room for
  /// maximum_reply bytes or characters.
  void answer(std::span<const std::uint8_t> request, FieldWriter& out, WritePermission permission,
              can::Time now);
  /// The reply to a request that cannot be read.
  static void refuse(std::uint8_t subheader, Outcome1e outcome, FieldWriter& out);

  static constexpr std::size_t maximum_reply = 4 + 4 * 256;

 private:
  struct Point {
    Device device = Device::d;
    std::uint32_t number = 0;
    std::uint16_t value = 0;
  };

  Outcome1e execute(Command1e command, FieldReader& data, FieldWriter& out, WritePermission permission,
                    can::Time now);
  Outcome1e read_bits(FieldReader& data, FieldWriter& out, can::Time now);
  Outcome1e read_words(FieldReader& data, FieldWriter& out, can::Time now);
  Outcome1e write_bits(FieldReader& data, can::Time now);
  Outcome1e write_words(FieldReader& data, can::Time now);
  Outcome1e test_bits(FieldReader& data, can::Time now);
  Outcome1e test_words(FieldReader& data, can::Time now);
  Outcome1e register_monitor(FieldReader& data, bool words);
  Outcome1e monitor_bits(FieldReader& data, FieldWriter& out, can::Time now);
  Outcome1e monitor_words(FieldReader& data, FieldWriter& out, can::Time now);
  Outcome1e read_buffer(FieldReader& data, FieldWriter& out, can::Time now);
  Outcome1e write_buffer(FieldReader& data, can::Time now);
  Outcome1e read_model(FieldWriter& out) const;
  Outcome1e loopback(FieldReader& data, FieldWriter& out);

  /// The device a request names; false: there is none with this code.
  static bool read_device(FieldReader& data, Point& point);
  /// C200 and further of an FX3: the low words of their values are CN, the high ones HCN.
  [[nodiscard]] bool is_wide(const Point& point) const noexcept {
    return rules_.wide_counters && point.device == Device::cn && point.number >= first_wide_counter;
  }
  Outcome1e read_wide_counters(const Point& first, std::uint16_t count, FieldWriter& out, can::Time now);
  static void answer_bits(std::span<const std::uint8_t> bits, FieldWriter& out);
  /// Whether `count` points (bit devices: single ones, or words of 16) can be accessed.
  [[nodiscard]] Outcome1e check(const Point& point, std::uint32_t count, bool words) const;
  [[nodiscard]] Outcome1e check_buffer(std::uint16_t head_address, std::uint32_t start,
                                       std::uint32_t bytes) const;

  Rack& rack_;
  const Rules1e& rules_;
  std::array<std::uint16_t, 256> words_{};
  std::array<std::uint16_t, 256> high_words_{};  // of 32-bit counters
  std::array<std::uint8_t, 256> bits_{};
  std::array<Point, 256> points_{};
  std::array<Point, 40> monitored_bits_{};
  std::array<Point, 20> monitored_words_{};
  std::size_t monitored_bit_count_ = 0;
  std::size_t monitored_word_count_ = 0;
};

}  // namespace canopus::plc::melsec
