#include "canopus/module/canopen/time_stamp.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::module {

namespace {

// Offsets of the words.
enum : BufferAddress { role, year, month, day, hour, minute, second, day_of_week, interval, correction };
constexpr BufferAddress word_count = correction + 1;

constexpr std::int64_t seconds_per_day = 86'400;
constexpr std::chrono::sys_days clock_begin{std::chrono::year{2000} / 1 / 1};
constexpr std::chrono::sys_days time_of_day_epoch{std::chrono::year{1984} / 1 / 1};
constexpr std::int64_t clock_begin_in_time_of_day = (clock_begin - time_of_day_epoch).count();
constexpr std::uint16_t longest_interval = 1440;

// 80..99 stand for 1980..1999, where the century is not fixed.
int full_year(std::uint16_t word, const TimeStampLayout& layout) {
  if (layout.year_of_century) return 2000 + word % 100;
  if (word >= 100 || !layout.two_digit_year) return word;
  return word < 80 ? 2000 + word : 1900 + word;
}

}  // namespace

TimeStamp::TimeStamp(const std::optional<TimeStampLayout>& layout, BufferMemory& memory, canopen::Node& node)
    : layout_(layout), memory_(&memory), node_(&node) {
  if (layout) memory.attach(layout->first, layout->first + word_count - 1, *this);
}

void TimeStamp::reset() {
  running_ = false;
  next_ = can::never;
  if (!layout_) return;
  const std::chrono::sys_days date{std::chrono::year{full_year(word(year), *layout_)} / word(month) /
                                   word(day)};
  base_ = (date - clock_begin).count() * seconds_per_day + seconds_of_day();
  since_ = {};
  correction_ = static_cast<std::int16_t>(word(correction));
}

std::int64_t TimeStamp::seconds_of_day() const {
  return (std::int64_t{word(hour)} * 60 + word(minute)) * 60 + word(second);
}

void TimeStamp::show_role() {
  if (!layout_) return;
  const auto cob_id = node_->dictionary().get<std::uint32_t>(0x1012, 0);
  set_word(role, (cob_id >> 31 & 1U) | (cob_id >> 29 & 2U));
}

// Takes effect directly: bits 31 (consume) and 30 (produce) of 1012H [ME3CAN1-Q 3.5.11, 4.6.9].
void TimeStamp::change_role(std::uint16_t role_bits, can::Time now) {
  canopen::ObjectDictionary& objects = node_->dictionary();
  const std::uint32_t cob_id = (objects.get<std::uint32_t>(0x1012, 0) & 0x3FFF'FFFFU) |
                               (role_bits & 1U) << 31 | (role_bits & 2U) << 29;
  if (objects.write(0x1012, 0, canopen::little_endian(cob_id, 4), now) != canopen::AbortCode::none)
    show_role();
}

WriteResult TimeStamp::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  constexpr std::uint16_t consumer = 1;
  if (layout_->consumer_words_fixed && address != layout_->first && word(role) == consumer)
    return WriteResult::ignored;
  memory_->store(address, value);
  if (address == layout_->first + interval && layout_->interval_starts && produces()) start_interval(now);
  if (address == layout_->first + role && !layout_->role_with_clock) change_role(value, now);
  if (address == layout_->first + correction) correction_changed(now);
  return WriteResult::done;
}

void TimeStamp::start_interval(can::Time now) {
  interval_ = std::chrono::minutes(word(interval));
  next_ = interval_ == can::Duration{} ? can::never : now;
}

std::int64_t TimeStamp::span() const {
  const std::chrono::sys_days end{std::chrono::year{layout_->last_year + 1} / 1 / 1};
  return (end - clock_begin).count() * seconds_per_day;
}

std::int64_t TimeStamp::seconds(can::Time now) const {
  if (!running_) return base_;
  // The correction is spread over the day.
  const auto elapsed = std::chrono::duration_cast<std::chrono::milliseconds>(now - since_).count();
  const std::int64_t total = base_ + elapsed * (seconds_per_day + correction_) / seconds_per_day / 1000;
  return total >= span() ? (total - span()) % span() : total;
}

void TimeStamp::run_from(std::int64_t time, can::Time now) {
  base_ = time;
  since_ = now;
  running_ = true;
}

std::chrono::year_month_day TimeStamp::date_of_words() const {
  return {std::chrono::year{full_year(word(year), *layout_)}, std::chrono::month{word(month)},
          std::chrono::day{word(day)}};
}

std::optional<BufferAddress> TimeStamp::wrong_word() const {
  const auto date = date_of_words();
  const int y = static_cast<int>(date.year());
  if (y < layout_->first_year || y > layout_->last_year) return layout_->first + year;
  if (word(month) < 1 || word(month) > 12) return layout_->first + month;
  if (word(day) > 31 || !date.ok()) return layout_->first + day;
  if (word(hour) > 23) return layout_->first + hour;
  if (word(minute) > 59) return layout_->first + minute;
  if (word(second) > 59) return layout_->first + second;
  if (word(interval) > longest_interval) return layout_->first + interval;
  return std::nullopt;
}

std::optional<BufferAddress> TimeStamp::set_from_words(can::Time now) {
  if (!layout_) return std::nullopt;
  if (layout_->role_with_clock) change_role(word(role), now);
  if (!produces()) return std::nullopt;  // what a consumer writes is ignored
  if (const auto wrong = wrong_word()) return wrong;
  const std::int64_t days = (std::chrono::sys_days{date_of_words()} - clock_begin).count();
  run_from(days * seconds_per_day + seconds_of_day(), now);
  if (!layout_->interval_starts) start_interval(now);
  show(now);
  return std::nullopt;
}

void TimeStamp::show(can::Time now) {
  if (!layout_) return;
  if (layout_->role_with_clock) show_role();
  const std::int64_t time = seconds(now);
  const std::int64_t days = (time >= 0 ? time : time - seconds_per_day + 1) / seconds_per_day;
  const std::int64_t in_day = time - days * seconds_per_day;
  const std::chrono::sys_days date = clock_begin + std::chrono::days(days);
  const std::chrono::year_month_day calendar{date};
  const int y = static_cast<int>(calendar.year());
  set_word(year, layout_->two_digit_year ? y % 100 : y);
  set_word(month, static_cast<unsigned>(calendar.month()));
  set_word(day, static_cast<unsigned>(calendar.day()));
  set_word(hour, in_day / 3600);
  set_word(minute, in_day / 60 % 60);
  set_word(second, in_day % 60);
  set_word(day_of_week, std::chrono::weekday{date}.c_encoding());
}

void TimeStamp::receive(const canopen::TimeOfDay& time, can::Time now) {
  if (!layout_) return;
  const std::int64_t days = time.days - clock_begin_in_time_of_day;
  const std::int64_t received = days * seconds_per_day + time.milliseconds / 1000;
  const bool is_late = received >= span() && layout_->late_time_is_first;
  run_from(days < 0 || is_late ? 0 : received % span(), now);
}

canopen::TimeOfDay TimeStamp::time_of_day(can::Time now) const {
  const std::int64_t since_epoch =
      std::max<std::int64_t>(seconds(now) + clock_begin_in_time_of_day * seconds_per_day, 0);
  return {.milliseconds = static_cast<std::uint32_t>(since_epoch % seconds_per_day * 1000),
          .days = static_cast<std::uint16_t>(since_epoch / seconds_per_day)};
}

void TimeStamp::correction_changed(can::Time now) {
  if (!layout_) return;
  if (running_) run_from(seconds(now), now);
  correction_ = static_cast<std::int16_t>(word(correction));
}

void TimeStamp::tick(can::Time now) {
  node_->send_time(time_of_day(now), now);
  next_ = can::later(now, interval_);
}

}  // namespace canopus::module
