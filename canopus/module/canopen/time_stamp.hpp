#pragma once
// Clock of a module and its words for the PLC: producer/consumer, year, month, day, hour, minute, second, day
// of the week, transmission interval, daily correction, at ten addresses in this order
// [ME3CAN1-Q 3.5.11, 4.6.9].
//
// The clock stands until the PLC sets it or, as a consumer, a TIME object comes. It counts whole seconds from
// 2000-01-01 00:00:00 to 2079-12-31 23:59:59 and then begins anew.

#include <chrono>
#include <cstdint>
#include <optional>

#include "canopus/canopen/node/node.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

struct TimeStampLayout {
  BufferAddress first = 0;      ///< of the ten words
  bool two_digit_year = false;  ///< 14 for 2014, and either is taken; else 2014 only
  int first_year = 1980;        ///< that is taken
  /// Producer/consumer takes effect when the program sets the clock, not at once [RJ71CN91 App. 1 Y12].
  bool role_with_clock = false;
  /// A received time beyond 2079 counts as 2000-01-01, as one before 2000; else the clock begins anew from there
  /// [RJ71CN91 1.6].
  bool late_time_is_first = false;
  int last_year = 2079;  ///< that is taken; the clock begins anew after it
  /// The last two digits of a year count, in the century from 2000 on, whatever stands before them [FX3U-CAN 6.19].
  bool year_of_century = false;
  /// A write of the transmission interval sends the time, and then every interval; setting the clock does not
  /// [FX3U-CAN 6.19].
  bool interval_starts = false;
  /// What a consumer alone writes is not even stored [FX3U-CAN 6.19].
  bool consumer_words_fixed = false;
};

class TimeStamp final : public BufferArea {
 public:
  /// Everything must outlive it. Without a layout there is no clock.
  TimeStamp(const std::optional<TimeStampLayout>& layout, BufferMemory& memory, canopen::Node& node);

  /// The clock stands at what the words say (their initial values).
  void reset();
  /// 1012H may have changed: the producer/consumer word shows its bits 31 and 30.
  void show_role();

  /// Takes the role over, if that is its moment; then the words as the time, if the module is a producer. The address of a word that is out of range, or
  /// nothing; then the clock runs, and next_transmission() is now if a transmission interval is set.
  std::optional<BufferAddress> set_from_words(can::Time now);
  /// The first word that is out of range as a time, or as a transmission interval.
  [[nodiscard]] std::optional<BufferAddress> wrong_word() const;
  /// Puts the time into the words.
  void show(can::Time now);
  /// A TIME object was received: the clock runs from there; before 2000 counts as 2000-01-01 00:00:00.
  void receive(const canopen::TimeOfDay& time, can::Time now);
  /// The daily correction is to be read again: others than the program have changed its word.
  void correction_changed(can::Time now);

  /// When the next TIME object is due, never = none; then tick() sends it, if 1012H, the role and the state
  /// allow.
  [[nodiscard]] can::Time next_transmission() const noexcept { return next_; }
  [[nodiscard]] can::Alarm& alarm() noexcept { return next_; }
  void tick(can::Time now);

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time) const override {
    return memory_->word(address);
  }
  /// Producer/consumer and daily correction act at once; the others when the program sets the clock.
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

 private:
  [[nodiscard]] bool produces() const { return (memory_->word(layout_->first) & 2U) != 0; }
  /// Bits 31 (consume) and 30 (produce) of 1012H follow the word, if they may.
  void change_role(std::uint16_t role_bits, can::Time now);
  [[nodiscard]] canopen::TimeOfDay time_of_day(can::Time now) const;
  /// Seconds since 2000-01-01 00:00:00.
  [[nodiscard]] std::int64_t seconds(can::Time now) const;
  [[nodiscard]] std::int64_t seconds_of_day() const;  ///< as the words say
  [[nodiscard]] std::chrono::year_month_day date_of_words() const;
  void run_from(std::int64_t seconds, can::Time now);
  /// The first TIME object is due now, if there is an interval.
  void start_interval(can::Time now);
  [[nodiscard]] std::int64_t span() const;  ///< seconds until the clock begins anew
  [[nodiscard]] std::uint16_t word(BufferAddress offset) const {
    return memory_->written(layout_->first + offset);
  }
  void set_word(BufferAddress offset, std::int64_t value) {
    memory_->set_word(layout_->first + offset, static_cast<std::uint16_t>(value));
  }

  std::optional<TimeStampLayout> layout_;
  BufferMemory* memory_;
  canopen::Node* node_;
  bool running_ = false;
  std::int64_t base_ = 0;  // the clock, in seconds since 2000, at since_
  can::Time since_{};
  std::int64_t correction_ = 0;  // seconds per day
  can::Duration interval_{};
  can::Alarm next_;
};

}  // namespace canopus::module
