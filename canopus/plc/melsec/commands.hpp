#pragma once
// Executes the commands: decodes the part of a request behind command and subcommand, accesses the rack,
// writes the reply's data. A command is read to its end and checked before anything is written, so a refused
// request has changed nothing.
//
//   0401 1401  batch read, write           0403 1402  random read, write      0406 1406  several blocks
//   0801 0802  register and read monitor   0601 1601  module buffer memory    0613 1613  own buffer memory
//   0101  CPU model                        0619  loopback                     1617  clear error
//   1001 1002 1003 1005 1006  remote RUN, STOP, PAUSE, latch clear, reset     1630 1631  remote password
//
// One object per connection: it remembers what 0801 registered, and whether 1630 has unlocked it.

#include <array>
#include <cstdint>
#include <expected>

#include "canopus/can/time.hpp"
#include "canopus/plc/melsec/frame.hpp"
#include "canopus/plc/melsec/port_settings.hpp"
#include "canopus/plc/melsec/target.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plc::melsec {

class PasswordGuard;

/// Points per request [SH-080008 appendix 5].
inline constexpr std::size_t maximum_words = 960;
inline constexpr std::size_t maximum_bits_binary = 7168;
inline constexpr std::size_t maximum_bits_ascii = 3584;
inline constexpr std::size_t maximum_buffer_bytes = 0x780;
inline constexpr std::size_t maximum_own_buffer_words = 480;
inline constexpr std::size_t maximum_loopback = 960;
inline constexpr std::size_t maximum_random_points = 192;  // 0403, 0801; iQ-R and extended: half
inline constexpr std::size_t maximum_random_bits = 188;    // 1402; iQ-R and extended: half
inline constexpr std::size_t maximum_random_write = 1920;  // 12 x words + 14 x double words; iQ-R: half
inline constexpr std::size_t maximum_blocks = 120;         // 0406, 1406; iQ-R and extended: half

/// Largest data of a reply, in bytes or characters: 960 words in ASCII.
inline constexpr std::size_t maximum_reply_data = 4 * maximum_words;

class Commands {
 public:
  /// All must outlive this. `guard` counts wrong passwords; a port without a password needs none.
  Commands(Rack& rack, const PortSettings& settings, PasswordGuard* guard) noexcept
      : rack_(rack),
        settings_(settings),
        guard_(guard),
        octal_io_(rack.model().number_base(Device::x) == 8),
        locked_(!settings.remote_password.empty()) {}

  /// `data` is what follows the subcommand; the reply's data go to `out`. With an end code other than
  /// completed, what is in `out` counts for nothing.
  [[nodiscard]] EndCode execute(const Command& command, FieldReader& data, FieldWriter& out, can::Time now);
  /// The last command was a remote reset: the CPU restarts, and no reply is sent.
  [[nodiscard]] bool has_reset() const noexcept { return has_reset_; }

 private:
  struct Kind {
    Layout layout;
    bool bits = false;
  };
  /// A block of 0406/1406, or a point of 0403/0801/1402.
  struct Block {
    Target target;
    std::uint16_t count = 0;    // words; bit devices: 16 points each
    std::uint32_t value = 0;    // to write
    std::uint16_t data_at = 0;  // first of its words in words_
  };

  EndCode read_batch(Kind kind, FieldReader& data, FieldWriter& out, can::Time now);
  EndCode write_batch(Kind kind, FieldReader& data, can::Time now);
  EndCode read_random(Kind kind, FieldReader& data, FieldWriter& out, can::Time now);
  EndCode write_random_words(Kind kind, FieldReader& data, can::Time now);
  EndCode write_random_bits(Kind kind, FieldReader& data, can::Time now);
  EndCode read_blocks(Kind kind, FieldReader& data, FieldWriter& out, can::Time now);
  EndCode write_blocks(Kind kind, FieldReader& data, can::Time now);
  EndCode register_monitor(Kind kind, FieldReader& data);
  EndCode read_monitor(FieldReader& data, FieldWriter& out, can::Time now);
  EndCode read_module_buffer(FieldReader& data, FieldWriter& out, can::Time now);
  EndCode write_module_buffer(FieldReader& data, can::Time now);
  EndCode read_own_buffer(FieldReader& data, FieldWriter& out);
  EndCode write_own_buffer(FieldReader& data);
  EndCode read_model(FieldReader& data, FieldWriter& out);
  EndCode loopback(FieldReader& data, FieldWriter& out);
  EndCode remote_run(FieldReader& data, can::Time now);
  EndCode remote_stop(FieldReader& data, can::Time now);
  EndCode remote_pause(FieldReader& data, can::Time now);
  EndCode remote_latch_clear(FieldReader& data);
  EndCode remote_reset(FieldReader& data, can::Time now);
  EndCode unlock(FieldReader& data, can::Time now);
  EndCode lock(FieldReader& data, can::Time now);
  EndCode check_password(FieldReader& data, bool already_so, can::Time now);

  /// A target of the request; index registers have the values of this moment.
  [[nodiscard]] std::expected<Target, EndCode> read_target(FieldReader& data, Layout layout);

  [[nodiscard]] bool may_write() const noexcept { return plc::may_write(settings_.write, rack_); }

  /// The points of 0403 and 0801, into `blocks`.
  EndCode read_points(Kind kind, FieldReader& data, std::array<Block, maximum_random_points>& blocks,
                      std::size_t& words, std::size_t& double_words);
  EndCode answer_points(const std::array<Block, maximum_random_points>& blocks, std::size_t words,
                        std::size_t double_words, FieldWriter& out, can::Time now);
  /// The block lists of 0406 and 1406, into blocks_; for 1406 with the data, into words_.
  EndCode read_block_list(Kind kind, FieldReader& data, bool with_data, std::size_t& count);

  [[nodiscard]] EndCode check(const Target& target, std::uint32_t words) const;
  EndCode read(const Target& target, std::span<std::uint16_t> words, can::Time now);
  EndCode write(const Target& target, std::span<const std::uint16_t> words, can::Time now);

  Rack& rack_;
  const PortSettings& settings_;
  PasswordGuard* guard_;
  bool octal_io_;
  bool locked_;
  bool has_reset_ = false;
  std::array<std::uint16_t, maximum_words> words_{};
  std::array<std::uint8_t, maximum_bits_binary> bits_{};
  std::array<std::uint16_t, 20> index_registers_{};
  std::array<Block, maximum_random_points> blocks_{};
  std::array<Block, maximum_random_points> monitored_{};
  std::size_t monitored_words_ = 0;
  std::size_t monitored_double_words_ = 0;
};

}  // namespace canopus::plc::melsec
