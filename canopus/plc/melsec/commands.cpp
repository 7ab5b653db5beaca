// Dispatch, and the commands that are not about devices: module buffer memory, CPU model, loopback, remote
// operation.

#include "canopus/plc/melsec/commands.hpp"

#include <algorithm>
#include <optional>

#include "canopus/plc/melsec/password_guard.hpp"
#include "canopus/plc/melsec/verdict.hpp"

namespace canopus::plc::melsec {

namespace {

/// 0000 0001 0002 0003 0080 0081 0082 0083; bit 0: single bits, bit 1: iQ-R, bit 7: extended.
std::optional<unsigned> device_subcommand(std::uint16_t subcommand, const CpuModel& model) {
  if ((subcommand & ~0x0083U) != 0) return std::nullopt;
  if ((subcommand & 2U) != 0 && !model.iqr) return std::nullopt;
  return subcommand;
}

constexpr std::uint16_t normal_operation = 1;
constexpr std::uint16_t forced_operation = 3;

}  // namespace

EndCode Commands::execute(const Command& command, FieldReader& data, FieldWriter& out, can::Time now) {
  has_reset_ = false;
  const auto [number, subcommand] = command;
  if (number == 0x1630 && subcommand == 0) return unlock(data, now);
  if (number == 0x1631 && subcommand == 0) return lock(data, now);
  if (locked_) return EndCode::port_locked;
  switch (number) {
    case 0x0401:
    case 0x1401:
    case 0x0403:
    case 0x1402:
    case 0x0406:
    case 0x1406:
    case 0x0801: {
      const std::optional<unsigned> found = device_subcommand(subcommand, rack_.model());
      if (!found) return EndCode::unknown_command;
      const Kind kind{{(*found & 2U) != 0, (*found & 0x80U) != 0, octal_io_}, (*found & 1U) != 0};
      const bool writes = number >= 0x1000;
      if (writes && !may_write()) return EndCode::online_change_disabled;
      switch (number) {
        case 0x0401: return read_batch(kind, data, out, now);
        case 0x1401: return write_batch(kind, data, now);
        case 0x1402:
          return kind.bits ? write_random_bits(kind, data, now) : write_random_words(kind, data, now);
        default: break;
      }
      if (kind.bits) return EndCode::unknown_command;
      switch (number) {
        case 0x0403: return read_random(kind, data, out, now);
        case 0x0406: return read_blocks(kind, data, out, now);
        case 0x1406: return write_blocks(kind, data, now);
        default: return register_monitor(kind, data);
      }
    }
    default: break;
  }
  if (subcommand != 0) return EndCode::unknown_command;
  const bool writes_buffer = number == 0x1601 || number == 0x1613;
  if (writes_buffer && !may_write()) return EndCode::online_change_disabled;
  const bool is_remote_operation = number >= 0x1001 && number <= 0x1006;
  if (is_remote_operation && settings_.write == WritePermission::never)
    return EndCode::remote_request_refused;
  switch (number) {
    case 0x0802: return read_monitor(data, out, now);
    case 0x0601: return read_module_buffer(data, out, now);
    case 0x1601: return write_module_buffer(data, now);
    case 0x0613: return read_own_buffer(data, out);
    case 0x1613: return write_own_buffer(data);
    case 0x0101: return read_model(data, out);
    case 0x0619: return loopback(data, out);
    case 0x1001: return remote_run(data, now);
    case 0x1002: return remote_stop(data, now);
    case 0x1003: return remote_pause(data, now);
    case 0x1005: return remote_latch_clear(data);
    case 0x1006: return remote_reset(data, now);
    case 0x1617: return verdict(data);  // there is no error to clear
    default: return EndCode::unknown_command;
  }
}

EndCode Commands::read_module_buffer(FieldReader& data, FieldWriter& out, can::Time now) {
  const std::uint32_t start = data.u32();
  const std::uint16_t bytes = data.u16();
  const std::uint16_t module_number = data.u16();
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (bytes < 2 || bytes > maximum_buffer_bytes) return EndCode::word_points;
  // Byte addresses, but the modules have words only.
  if (start % 2 != 0 || bytes % 2 != 0 || module_number > 0xFF) return EndCode::wrong_request_data;
  const auto words = std::span(words_).first(bytes / 2U);
  const auto head_address = static_cast<std::uint16_t>(16 * module_number);
  const EndCode end_code = end_code_of(rack_.read_buffer(head_address, start / 2, words, now));
  if (end_code != EndCode::completed) return end_code;
  for (const std::uint16_t word : words) {  // in the order of the byte addresses
    out.u8(static_cast<std::uint8_t>(word));
    out.u8(static_cast<std::uint8_t>(word >> 8U));
  }
  return EndCode::completed;
}

EndCode Commands::write_module_buffer(FieldReader& data, can::Time now) {
  const std::uint32_t start = data.u32();
  const std::uint16_t bytes = data.u16();
  const std::uint16_t module_number = data.u16();
  if (data.fault() != FieldReader::Fault::none) return verdict(data);
  if (bytes < 2 || bytes > maximum_buffer_bytes) return EndCode::word_points;
  if (start % 2 != 0 || bytes % 2 != 0 || module_number > 0xFF) return EndCode::wrong_request_data;
  const auto words = std::span(words_).first(bytes / 2U);
  for (std::uint16_t& word : words) {
    const unsigned low = data.u8();
    word = static_cast<std::uint16_t>(low | static_cast<unsigned>(data.u8()) << 8U);
  }
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  const auto head_address = static_cast<std::uint16_t>(16 * module_number);
  return end_code_of(rack_.write_buffer(head_address, start / 2, words, now));
}

EndCode Commands::read_own_buffer(FieldReader& data, FieldWriter& out) {
  const std::span<const std::uint16_t> buffer = rack_.own_buffer();
  if (buffer.empty()) return EndCode::unknown_command;
  const std::uint32_t start = data.u32();
  const std::uint16_t count = data.u16();
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (count < 1 || count > maximum_own_buffer_words) return EndCode::word_points;
  if (start >= buffer.size() || count > buffer.size() - start) return EndCode::beyond_buffer_memory;
  out.words(buffer.subspan(start, count));
  return EndCode::completed;
}

EndCode Commands::write_own_buffer(FieldReader& data) {
  const std::span<std::uint16_t> buffer = rack_.own_buffer();
  if (buffer.empty()) return EndCode::unknown_command;
  const std::uint32_t start = data.u32();
  const std::uint16_t count = data.u16();
  if (data.fault() != FieldReader::Fault::none) return verdict(data);
  if (count < 1 || count > maximum_own_buffer_words) return EndCode::word_points;
  const auto words = std::span(words_).first(count);
  data.words(words);
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (start >= buffer.size() || count > buffer.size() - start) return EndCode::beyond_buffer_memory;
  std::ranges::copy(words, buffer.subspan(start).begin());
  return EndCode::completed;
}

EndCode Commands::read_model(FieldReader& data, FieldWriter& out) {
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  constexpr std::size_t name_size = 16;
  const CpuModel& model = rack_.model();
  out.text(model.name);
  for (std::size_t i = model.name.size(); i < name_size; ++i) out.text(" ");
  out.u16(model.code);
  return EndCode::completed;
}

EndCode Commands::loopback(FieldReader& data, FieldWriter& out) {
  const std::uint16_t count = data.u16();
  if (data.fault() != FieldReader::Fault::none) return verdict(data);
  if (count == 0 || count > maximum_loopback) return EndCode::wrong_contents;
  const auto text = data.raw(count);
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  out.u16(count);
  out.raw(text);
  return EndCode::completed;
}

EndCode Commands::remote_run(FieldReader& data, can::Time now) {
  enum : std::uint8_t { keep, clear_unlatched, clear_all };
  const std::uint16_t mode = data.u16();
  const std::uint8_t clear = data.u8();
  const std::uint8_t fixed = data.u8();
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if ((mode != normal_operation && mode != forced_operation) || clear > clear_all || fixed != 0)
    return EndCode::wrong_contents;
  // Memory is cleared on the way from STOP to RUN only.
  if (rack_.cpu_state() == module::CpuState::stop && clear != keep)
    rack_.clear_devices(clear == clear_all, now);
  rack_.set_cpu_state(module::CpuState::run, now);
  return EndCode::completed;
}

EndCode Commands::remote_stop(FieldReader& data, can::Time now) {
  const std::uint16_t mode = data.u16();
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (mode != normal_operation && mode != forced_operation) return EndCode::wrong_contents;
  rack_.set_cpu_state(module::CpuState::stop, now);
  return EndCode::completed;
}

EndCode Commands::remote_pause(FieldReader& data, can::Time now) {
  const std::uint16_t mode = data.u16();
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (mode != normal_operation && mode != forced_operation) return EndCode::wrong_contents;
  rack_.pause(now);  // in STOP completed as well, without a PAUSE [SH-080931 11.2]
  return EndCode::completed;
}

EndCode Commands::remote_latch_clear(FieldReader& data) {
  const std::uint16_t mode = data.u16();
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (mode != normal_operation) return EndCode::wrong_contents;
  if (rack_.cpu_state() == module::CpuState::run) return EndCode::not_while_running;
  rack_.clear_latched();
  return EndCode::completed;
}

EndCode Commands::remote_reset(FieldReader& data, can::Time now) {
  const std::uint16_t mode = data.u16();
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (mode != normal_operation) return EndCode::wrong_contents;
  if (!settings_.remote_reset) return EndCode::remote_request_refused;  // as in a new project
  if (rack_.cpu_state() == module::CpuState::run) return EndCode::not_while_running;
  rack_.reset_cpu(now);
  locked_ = !settings_.remote_password.empty();
  monitored_words_ = monitored_double_words_ = 0;
  has_reset_ = true;
  return EndCode::completed;
}

EndCode Commands::check_password(FieldReader& data, bool already_so, can::Time now) {
  const std::uint16_t length = data.u16();
  const auto password = data.raw(length);
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (already_so) return EndCode::completed;  // the password is not checked [SH-080008 11.3]
  const bool iqr = rack_.model().iqr;
  if (guard_ != nullptr && guard_->is_locked_out(now))
    return iqr ? EndCode::password_locked_out : EndCode::wrong_password_q;
  if (!std::ranges::equal(password, settings_.remote_password, {}, {},
                          [](char character) { return static_cast<std::uint8_t>(character); })) {
    if (guard_ != nullptr) guard_->failed(now);
    return iqr ? EndCode::wrong_password_iqr : EndCode::wrong_password_q;
  }
  if (guard_ != nullptr) guard_->succeeded();
  return EndCode::completed;
}

EndCode Commands::unlock(FieldReader& data, can::Time now) {
  const EndCode end_code = check_password(data, !locked_, now);
  if (end_code == EndCode::completed) locked_ = false;
  return end_code;
}

EndCode Commands::lock(FieldReader& data, can::Time now) {
  const bool has_password = !settings_.remote_password.empty();
  const EndCode end_code = check_password(data, locked_ || !has_password, now);
  if (end_code == EndCode::completed) locked_ = has_password;
  return end_code;
}

}  // namespace canopus::plc::melsec
