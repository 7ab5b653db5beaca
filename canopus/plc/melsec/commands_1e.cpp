#include "canopus/plc/melsec/commands_1e.hpp"

#include <algorithm>
#include <string_view>

namespace canopus::plc::melsec {

namespace {

constexpr std::uint8_t own_pc_1e = 0xFF;
constexpr std::uint8_t reply_bit = 0x80;
constexpr Outcome1e completed{};

constexpr Outcome1e refused(EndCode1e end_code) { return {end_code, AbnormalCode::none}; }
constexpr Outcome1e refused(AbnormalCode code) { return {EndCode1e::cpu_refuses, code}; }

bool is_bit(Device device) { return device_info(device).is_bit; }

/// 00H means 256.
std::uint16_t points_of(std::uint8_t field) { return field == 0 ? 256 : field; }

/// The result of a complete request without another mistake.
Outcome1e verdict_1e(const FieldReader& data) {
  if (data.fault() == FieldReader::Fault::not_a_number) return refused(EndCode1e::not_convertible);
  if (data.fault() == FieldReader::Fault::none && data.at_end()) return completed;
  return refused(EndCode1e::points);
}

}  // namespace

const Rules1e& rules_1e_of(const CpuModel& model) noexcept {
  return model.family == CpuFamily::fx3 ? rules_1e_fx3 : rules_1e_q;
}

void Commands1e::refuse(std::uint8_t subheader, Outcome1e outcome, FieldWriter& out) {
  out.u8(static_cast<std::uint8_t>(subheader | reply_bit));
  out.u8(static_cast<std::uint8_t>(outcome.end_code));
  if (outcome.end_code != EndCode1e::cpu_refuses) return;
  out.u8(static_cast<std::uint8_t>(outcome.abnormal_code));
  out.u8(0);
}

void Commands1e::answer(std::span<const std::uint8_t> request, FieldWriter& out, WritePermission permission,
                        can::Time now) {
  FieldReader data(request, out.code());
  const std::uint8_t subheader = data.u8();
  const std::uint8_t pc = data.u8();
  (void)data.u16();  // monitoring timer: the answer is immediate
  const std::size_t begin = out.size();
  out.u8(static_cast<std::uint8_t>(subheader | reply_bit));
  out.u8(static_cast<std::uint8_t>(EndCode1e::completed));
  Outcome1e outcome = completed;
  if (data.fault() != FieldReader::Fault::none)
    outcome = refused(EndCode1e::not_convertible);
  else if (pc != own_pc_1e)
    outcome = refused(AbnormalCode::pc_number);
  else
    outcome = execute(static_cast<Command1e>(subheader), data, out, permission, now);
  if (outcome == completed) return;
  out.rewind(begin);
  refuse(subheader, outcome, out);
}

Outcome1e Commands1e::execute(Command1e command, FieldReader& data, FieldWriter& out,
                              WritePermission permission, can::Time now) {
  switch (command) {
    case Command1e::read_bits: return read_bits(data, out, now);
    case Command1e::read_words: return read_words(data, out, now);
    case Command1e::read_model: return read_model(out);
    case Command1e::loopback: return loopback(data, out);
    case Command1e::remote_run:
    case Command1e::remote_stop:
      if (permission == WritePermission::never) return refused(AbnormalCode::remote_request);
      rack_.set_cpu_state(command == Command1e::remote_run ? module::CpuState::run : module::CpuState::stop,
                          now);
      return completed;
    case Command1e::register_bits:
    case Command1e::monitor_bits:
      if (rules_.monitored_bits == 0) break;
      return command == Command1e::register_bits ? register_monitor(data, false)
                                                 : monitor_bits(data, out, now);
    case Command1e::register_words:
    case Command1e::monitor_words:
      if (rules_.monitored_words == 0) break;
      return command == Command1e::register_words ? register_monitor(data, true)
                                                  : monitor_words(data, out, now);
    case Command1e::read_buffer:
      if (!rules_.special_function_modules) break;
      return read_buffer(data, out, now);
    case Command1e::write_buffer:
      if (!rules_.special_function_modules) break;
      if (!may_write(permission, rack_)) return refused(EndCode1e::online_change_disabled);
      return write_buffer(data, now);
    case Command1e::write_bits:
    case Command1e::write_words:
    case Command1e::test_bits:
    case Command1e::test_words:
      if (!may_write(permission, rack_)) return refused(EndCode1e::online_change_disabled);
      if (command == Command1e::write_bits) return write_bits(data, now);
      if (command == Command1e::write_words) return write_words(data, now);
      return command == Command1e::test_bits ? test_bits(data, now) : test_words(data, now);
  }
  return refused(EndCode1e::unknown_subheader);
}

bool Commands1e::read_device(FieldReader& data, Point& point) {
  std::uint16_t code = 0;
  if (data.code() == DataCode::ascii) {  // the code first
    code = data.u16();
    point.number = data.u32();
  } else {
    point.number = data.u32();
    code = data.u16();
  }
  const auto device = device_of_1e(code);
  point.device = device.value_or(Device::d);
  return device.has_value();
}

Outcome1e Commands1e::check(const Point& point, std::uint32_t count, bool words) const {
  const bool bits = is_bit(point.device);
  if (!words && !bits) return refused(EndCode1e::head_device);
  if (words && bits && point.number % 16 != 0) return refused(EndCode1e::head_device);
  const std::uint32_t points = words && bits ? 16 * count : count;
  const bool reaches_wide = rules_.wide_counters && point.device == Device::cn && !is_wide(point) &&
                            point.number + count > first_wide_counter;
  if (reaches_wide) return refused(EndCode1e::points);  // values of another size
  const auto access = rack_.check(point.device, point.number, points);
  if (access) return completed;
  if (access.error() == AccessError::no_device) return refused(EndCode1e::wrong_device);
  // Already the first one, or only what follows?
  return refused(rack_.check(point.device, point.number, 1) ? EndCode1e::points : EndCode1e::head_device);
}

Outcome1e Commands1e::read_bits(FieldReader& data, FieldWriter& out, can::Time now) {
  Point point;
  const bool known = read_device(data, point);
  const std::uint16_t count = points_of(data.u8());
  (void)data.u8();  // fixed to 00H
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (!known) return refused(EndCode1e::wrong_device);
  if (count > rules_.read_bits) return refused(EndCode1e::points);
  if (const Outcome1e outcome = check(point, count, false); outcome != completed) return outcome;
  const auto bits = std::span(bits_).first(count);
  (void)rack_.read_bits(point.device, point.number, bits, now);  // checked above
  answer_bits(bits, out);
  return completed;
}

void Commands1e::answer_bits(std::span<const std::uint8_t> bits, FieldWriter& out) {
  out.bits(bits);
  if (out.code() == DataCode::ascii && bits.size() % 2 != 0)
    out.text("0");  // the other half of the last byte
}

Outcome1e Commands1e::read_words(FieldReader& data, FieldWriter& out, can::Time now) {
  Point point;
  const bool known = read_device(data, point);
  const std::uint16_t count = points_of(data.u8());
  (void)data.u8();  // fixed to 00H
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (!known) return refused(EndCode1e::wrong_device);
  if (count > (is_bit(point.device) ? rules_.read_bit_words : rules_.read_words))
    return refused(EndCode1e::points);
  if (const Outcome1e outcome = check(point, count, true); outcome != completed) return outcome;
  if (is_wide(point)) return read_wide_counters(point, count, out, now);
  const auto words = std::span(words_).first(count);
  (void)rack_.read_words(point.device, point.number, words, now);
  out.words(words);
  return completed;
}

Outcome1e Commands1e::write_bits(FieldReader& data, can::Time now) {
  Point point;
  const bool known = read_device(data, point);
  const std::uint16_t count = points_of(data.u8());
  (void)data.u8();  // fixed to 00H
  const auto bits = std::span(bits_).first(count);
  const bool are_bits = data.bits(bits);
  if (data.code() == DataCode::ascii && count % 2 != 0) (void)data.raw(1);  // dummy
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (!known) return refused(EndCode1e::wrong_device);
  if (count > rules_.write_bits) return refused(EndCode1e::points);
  if (!are_bits) return refused(EndCode1e::not_convertible);
  if (const Outcome1e outcome = check(point, count, false); outcome != completed) return outcome;
  (void)rack_.write_bits(point.device, point.number, bits, now);
  return completed;
}

Outcome1e Commands1e::write_words(FieldReader& data, can::Time now) {
  Point point;
  const bool known = read_device(data, point);
  const std::uint16_t count = points_of(data.u8());
  (void)data.u8();  // fixed to 00H
  const bool wide = known && is_wide(point);
  const auto words = std::span(words_).first(count);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::uint32_t value = wide ? data.u32() : data.u16();
    words[i] = static_cast<std::uint16_t>(value);
    high_words_[i] = static_cast<std::uint16_t>(value >> 16U);
  }
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (!known) return refused(EndCode1e::wrong_device);
  if (count > (is_bit(point.device) ? rules_.write_bit_words : rules_.write_words))
    return refused(EndCode1e::points);
  if (const Outcome1e outcome = check(point, count, true); outcome != completed) return outcome;
  (void)rack_.write_words(point.device, point.number, words, now);
  if (wide)
    (void)rack_.write_words(Device::hcn, point.number - first_wide_counter,
                            std::span(high_words_).first(count), now);
  return completed;
}

Outcome1e Commands1e::read_wide_counters(const Point& first, std::uint16_t count, FieldWriter& out,
                                         can::Time now) {
  const auto low = std::span(words_).first(count);
  const auto high = std::span(high_words_).first(count);
  (void)rack_.read_words(Device::cn, first.number, low, now);
  (void)rack_.read_words(Device::hcn, first.number - first_wide_counter, high, now);
  for (std::size_t i = 0; i < count; ++i) out.u32(low[i] | std::uint32_t{high[i]} << 16U);
  return completed;
}

Outcome1e Commands1e::test_bits(FieldReader& data, can::Time now) {
  const std::uint16_t count = points_of(data.u8());
  (void)data.u8();  // fixed to 00H
  Outcome1e first_error = completed;
  for (Point& point : std::span(points_).first(count)) {
    const bool known = read_device(data, point);
    point.value = data.u8();
    const Outcome1e outcome = !known            ? refused(EndCode1e::wrong_device)
                              : point.value > 1 ? refused(EndCode1e::not_convertible)
                                                : check(point, 1, false);
    if (first_error == completed) first_error = outcome;
  }
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (count > rules_.test_bits) return refused(EndCode1e::points);
  if (first_error != completed) return first_error;
  for (const Point& point : std::span(points_).first(count)) {
    const auto bit = static_cast<std::uint8_t>(point.value);
    (void)rack_.write_bits(point.device, point.number, {&bit, 1}, now);
  }
  return completed;
}

Outcome1e Commands1e::test_words(FieldReader& data, can::Time now) {
  const std::uint16_t count = points_of(data.u8());
  (void)data.u8();  // fixed to 00H
  Outcome1e first_error = completed;
  for (Point& point : std::span(points_).first(count)) {
    const bool known = read_device(data, point);
    point.value = data.u16();
    // Two bytes cannot hold the value of a 32-bit counter.
    const Outcome1e outcome =
        known && !is_wide(point) ? check(point, 1, true) : refused(EndCode1e::wrong_device);
    if (first_error == completed) first_error = outcome;
  }
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (count > rules_.test_words) return refused(EndCode1e::points);
  if (first_error != completed) return first_error;
  for (const Point& point : std::span(points_).first(count))
    (void)rack_.write_words(point.device, point.number, {&point.value, 1}, now);
  return completed;
}

Outcome1e Commands1e::register_monitor(FieldReader& data, bool words) {
  const std::uint16_t count = points_of(data.u8());
  (void)data.u8();  // fixed to 00H
  Outcome1e first_error = completed;
  for (Point& point : std::span(points_).first(count)) {
    const bool known = read_device(data, point);
    const Outcome1e outcome = known ? check(point, 1, words) : refused(EndCode1e::wrong_device);
    if (first_error == completed) first_error = outcome;
  }
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (count > (words ? rules_.monitored_words : rules_.monitored_bits)) return refused(EndCode1e::points);
  if (first_error != completed) return first_error;
  if (words) {
    std::copy_n(points_.begin(), count, monitored_words_.begin());
    monitored_word_count_ = count;
  } else {
    std::copy_n(points_.begin(), count, monitored_bits_.begin());
    monitored_bit_count_ = count;
  }
  return completed;
}

Outcome1e Commands1e::monitor_bits(FieldReader& data, FieldWriter& out, can::Time now) {
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (monitored_bit_count_ == 0) return refused(EndCode1e::points);
  const auto bits = std::span(bits_).first(monitored_bit_count_);
  for (std::size_t i = 0; i < bits.size(); ++i) {
    const Point& point = monitored_bits_[i];
    (void)rack_.read_bits(point.device, point.number, bits.subspan(i, 1), now);
  }
  answer_bits(bits, out);
  return completed;
}

Outcome1e Commands1e::monitor_words(FieldReader& data, FieldWriter& out, can::Time now) {
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (monitored_word_count_ == 0) return refused(EndCode1e::points);
  for (const Point& point : std::span(monitored_words_).first(monitored_word_count_)) {
    std::uint16_t word = 0;
    (void)rack_.read_words(point.device, point.number, {&word, 1}, now);
    out.u16(word);
  }
  return completed;
}

/// Byte addresses, but the modules have words only.
Outcome1e Commands1e::check_buffer(std::uint16_t head_address, std::uint32_t start,
                                   std::uint32_t bytes) const {
  if (start % 2 != 0) return refused(EndCode1e::head_device);
  if (bytes % 2 != 0) return refused(EndCode1e::points);
  const auto access = rack_.check_buffer(head_address, start / 2, bytes / 2);
  if (access) return completed;
  if (access.error() == AccessError::no_module) return refused(AbnormalCode::special_function_module);
  return refused(rack_.check_buffer(head_address, start / 2, 1) ? EndCode1e::points : EndCode1e::head_device);
}

Outcome1e Commands1e::read_buffer(FieldReader& data, FieldWriter& out, can::Time now) {
  const std::uint32_t start = data.u24();
  const std::uint16_t bytes = points_of(data.u8());
  const auto head_address = static_cast<std::uint16_t>(16 * data.u8());
  (void)data.u8();  // fixed to 00H
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (const Outcome1e outcome = check_buffer(head_address, start, bytes); outcome != completed)
    return outcome;
  const auto words = std::span(words_).first(bytes / 2U);
  (void)rack_.read_buffer(head_address, start / 2, words, now);
  for (const std::uint16_t word : words) {  // in the order of the byte addresses
    out.u8(static_cast<std::uint8_t>(word));
    out.u8(static_cast<std::uint8_t>(word >> 8U));
  }
  return completed;
}

Outcome1e Commands1e::write_buffer(FieldReader& data, can::Time now) {
  const std::uint32_t start = data.u24();
  const std::uint16_t bytes = points_of(data.u8());
  const auto head_address = static_cast<std::uint16_t>(16 * data.u8());
  (void)data.u8();  // fixed to 00H
  const auto words = std::span(words_).first(bytes / 2U);
  for (std::uint16_t& word : words) {
    const unsigned low = data.u8();
    word = static_cast<std::uint16_t>(low | static_cast<unsigned>(data.u8()) << 8U);
  }
  if (bytes % 2 != 0) (void)data.u8();
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (const Outcome1e outcome = check_buffer(head_address, start, bytes); outcome != completed)
    return outcome;
  (void)rack_.write_buffer(head_address, start / 2, words, now);
  return completed;
}

Outcome1e Commands1e::read_model(FieldWriter& out) const {
  const std::uint16_t code = rack_.model().code;
  out.u8(static_cast<std::uint8_t>(code));
  out.u8(static_cast<std::uint8_t>(code >> 8U));
  return completed;
}

Outcome1e Commands1e::loopback(FieldReader& data, FieldWriter& out) {
  const std::uint8_t count = data.u8();
  const bool ascii = data.code() == DataCode::ascii;
  const auto text = data.raw(ascii ? 2U * count : count);
  if (const Outcome1e outcome = verdict_1e(data); outcome != completed) return outcome;
  if (count == 0 || count > rules_.loopback) return refused(EndCode1e::points);
  out.u8(count);
  out.raw(text);
  return completed;
}

}  // namespace canopus::plc::melsec
