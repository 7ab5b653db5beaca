// The commands that read and write devices and U\G: batch, random, several blocks, monitor.

#include <algorithm>

#include "canopus/plc/melsec/commands.hpp"
#include "canopus/plc/melsec/verdict.hpp"

namespace canopus::plc::melsec {

namespace {

bool is_bit_device(const Target& target) { return !target.is_buffer && device_info(target.device).is_bit; }

/// Points of a bit device behind `words`, or words.
std::uint32_t points(const Target& target, std::uint32_t words) {
  return is_bit_device(target) ? 16 * words : words;
}

bool half_limits(Layout layout) { return layout.iqr || layout.extended; }

}  // namespace

std::expected<Target, EndCode> Commands::read_target(FieldReader& data, Layout layout) {
  std::span<std::uint16_t> index_registers;
  if (layout.extended) {
    const auto count = std::min<std::size_t>(index_registers_.size(), rack_.model().points_of(Device::z));
    index_registers = std::span(index_registers_).first(count);
    if (!rack_.read_words(Device::z, 0, index_registers, {})) index_registers = {};
  }
  auto target = melsec::read_target(data, layout, index_registers);
  if (!target || target->is_buffer || rack_.model().points_of(target->device) != 0) return target;
  // Devices of the iQ-R series alone have no code elsewhere; a real FX5 accepts the code of RD, and then
  // refuses the access.
  if (target->device == Device::rd && rack_.model().family == CpuFamily::fx5)
    return std::unexpected(EndCode::wrong_contents);
  if (target->device == Device::rd || target->device == Device::hg)
    return std::unexpected(EndCode::device_not_accessible);
  return target;
}

EndCode Commands::check(const Target& target, std::uint32_t words) const {
  if (target.is_buffer) return end_code_of(rack_.check_buffer(target.head_address, target.number, words));
  return end_code_of(rack_.check(target.device, target.number, points(target, words)));
}

EndCode Commands::read(const Target& target, std::span<std::uint16_t> words, can::Time now) {
  if (target.is_buffer) return end_code_of(rack_.read_buffer(target.head_address, target.number, words, now));
  return end_code_of(rack_.read_words(target.device, target.number, words, now));
}

EndCode Commands::write(const Target& target, std::span<const std::uint16_t> words, can::Time now) {
  if (target.is_buffer)
    return end_code_of(rack_.write_buffer(target.head_address, target.number, words, now));
  return end_code_of(rack_.write_words(target.device, target.number, words, now));
}

EndCode Commands::read_batch(Kind kind, FieldReader& data, FieldWriter& out, can::Time now) {
  const auto target = read_target(data, kind.layout);
  const std::uint16_t count = data.u16();
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (!target) return target.error();
  if (!kind.bits) {
    if (count == 0 || count > maximum_words) return EndCode::word_points;
    const auto words = std::span(words_).first(count);
    const EndCode end_code = read(*target, words, now);
    if (end_code != EndCode::completed) return end_code;
    out.words(words);
    return EndCode::completed;
  }
  if (!is_bit_device(*target)) return EndCode::wrong_contents;
  const std::size_t limit = data.code() == DataCode::ascii ? maximum_bits_ascii : maximum_bits_binary;
  if (count == 0 || count > limit) return EndCode::bit_points;
  const auto bits = std::span(bits_).first(count);
  const EndCode end_code = end_code_of(rack_.read_bits(target->device, target->number, bits, now));
  if (end_code == EndCode::completed) out.bits(bits);
  return end_code;
}

EndCode Commands::write_batch(Kind kind, FieldReader& data, can::Time now) {
  const auto target = read_target(data, kind.layout);
  const std::uint16_t count = data.u16();
  if (data.fault() != FieldReader::Fault::none) return verdict(data);
  if (!target) return target.error();
  if (!kind.bits) {
    if (count == 0 || count > maximum_words) return EndCode::word_points;
    const auto words = std::span(words_).first(count);
    data.words(words);
    if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
    return write(*target, words, now);
  }
  if (!is_bit_device(*target)) return EndCode::wrong_contents;
  const std::size_t limit = data.code() == DataCode::ascii ? maximum_bits_ascii : maximum_bits_binary;
  if (count == 0 || count > limit) return EndCode::bit_points;
  const auto bits = std::span(bits_).first(count);
  const bool are_bits = data.bits(bits);
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (!are_bits) return EndCode::wrong_bit_data;
  return end_code_of(rack_.write_bits(target->device, target->number, bits, now));
}

EndCode Commands::read_points(Kind kind, FieldReader& data, std::array<Block, maximum_random_points>& blocks,
                              std::size_t& words, std::size_t& double_words) {
  words = data.u8();
  double_words = data.u8();
  if (data.fault() != FieldReader::Fault::none) return verdict(data);
  const std::size_t limit = half_limits(kind.layout) ? maximum_random_points / 2 : maximum_random_points;
  const std::size_t count = words + double_words;
  if (count == 0 || count > limit) return EndCode::random_word_points;
  EndCode first_error = EndCode::completed;
  for (std::size_t i = 0; i < count; ++i) {
    const auto target = read_target(data, kind.layout);
    const std::uint16_t size = i < words ? 1 : 2;
    blocks[i] = {target.value_or(Target{}), size, 0, 0};
    const EndCode end_code = target ? check(*target, size) : target.error();
    if (first_error == EndCode::completed) first_error = end_code;
  }
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  return first_error;
}

EndCode Commands::answer_points(const std::array<Block, maximum_random_points>& blocks, std::size_t words,
                                std::size_t double_words, FieldWriter& out, can::Time now) {
  for (std::size_t i = 0; i < words + double_words; ++i) {
    const auto value = std::span(words_).first(blocks[i].count);
    if (const EndCode end_code = read(blocks[i].target, value, now); end_code != EndCode::completed)
      return end_code;
    if (blocks[i].count == 1)
      out.u16(value[0]);
    else
      out.u32(value[0] | static_cast<std::uint32_t>(value[1]) << 16U);
  }
  return EndCode::completed;
}

EndCode Commands::read_random(Kind kind, FieldReader& data, FieldWriter& out, can::Time now) {
  std::size_t words = 0;
  std::size_t double_words = 0;
  const EndCode end_code = read_points(kind, data, blocks_, words, double_words);
  if (end_code != EndCode::completed) return end_code;
  return answer_points(blocks_, words, double_words, out, now);
}

EndCode Commands::write_random_words(Kind kind, FieldReader& data, can::Time now) {
  const std::size_t words = data.u8();
  const std::size_t double_words = data.u8();
  if (data.fault() != FieldReader::Fault::none) return verdict(data);
  const std::size_t limit = half_limits(kind.layout) ? maximum_random_write / 2 : maximum_random_write;
  const std::size_t count = words + double_words;
  if (count == 0 || 12 * words + 14 * double_words > limit) return EndCode::random_word_points;
  EndCode first_error = EndCode::completed;
  for (std::size_t i = 0; i < count; ++i) {
    const auto target = read_target(data, kind.layout);
    const std::uint16_t size = i < words ? 1 : 2;
    const std::uint32_t value = size == 1 ? data.u16() : data.u32();
    blocks_[i] = {target.value_or(Target{}), size, value, 0};
    const EndCode end_code = target ? check(*target, size) : target.error();
    if (first_error == EndCode::completed) first_error = end_code;
  }
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (first_error != EndCode::completed) return first_error;
  for (const Block& block : std::span(blocks_).first(count)) {
    const std::array value = {static_cast<std::uint16_t>(block.value),
                              static_cast<std::uint16_t>(block.value >> 16U)};
    if (const EndCode end_code = write(block.target, std::span(value).first(block.count), now);
        end_code != EndCode::completed)
      return end_code;
  }
  return EndCode::completed;
}

EndCode Commands::write_random_bits(Kind kind, FieldReader& data, can::Time now) {
  const std::size_t count = data.u8();
  if (data.fault() != FieldReader::Fault::none) return verdict(data);
  const std::size_t limit = half_limits(kind.layout) ? maximum_random_bits / 2 : maximum_random_bits;
  if (count == 0 || count > limit) return EndCode::random_bit_points;
  EndCode first_error = EndCode::completed;
  for (std::size_t i = 0; i < count; ++i) {
    const auto target = read_target(data, kind.layout);
    const std::uint16_t value = kind.layout.iqr ? data.u16() : data.u8();
    blocks_[i] = {target.value_or(Target{}), 1, value, 0};
    EndCode end_code = EndCode::completed;
    if (!target)
      end_code = target.error();
    else if (!is_bit_device(*target))
      end_code = EndCode::wrong_contents;
    else if (value > 1)
      end_code = EndCode::wrong_bit_data;
    else
      end_code = end_code_of(rack_.check(target->device, target->number, 1));
    if (first_error == EndCode::completed) first_error = end_code;
  }
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (first_error != EndCode::completed) return first_error;
  for (const Block& block : std::span(blocks_).first(count)) {
    const std::array value = {static_cast<std::uint8_t>(block.value)};
    (void)rack_.write_bits(block.target.device, block.target.number, value, now);  // checked above
  }
  return EndCode::completed;
}

EndCode Commands::read_block_list(Kind kind, FieldReader& data, bool with_data, std::size_t& count) {
  const std::size_t word_blocks = data.u8();
  const std::size_t bit_blocks = data.u8();
  count = word_blocks + bit_blocks;
  if (data.fault() != FieldReader::Fault::none) return verdict(data);
  const std::size_t limit = half_limits(kind.layout) ? maximum_blocks / 2 : maximum_blocks;
  if (count == 0 || count > limit) return EndCode::random_word_points;
  EndCode first_error = EndCode::completed;
  std::size_t total = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto target = read_target(data, kind.layout);
    const std::uint16_t words = data.u16();
    if (data.fault() != FieldReader::Fault::none) return verdict(data);
    if (words == 0 || words > maximum_words - total) return EndCode::word_points;
    blocks_[i] = {target.value_or(Target{}), words, 0, static_cast<std::uint16_t>(total)};
    if (with_data) data.words(std::span(words_).subspan(total, words));
    total += words;
    EndCode end_code = EndCode::completed;
    if (!target)
      end_code = target.error();
    else if (is_bit_device(*target) != (i >= word_blocks))
      end_code = EndCode::device_not_accessible;
    else
      end_code = check(*target, words);
    if (first_error == EndCode::completed) first_error = end_code;
  }
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  return first_error;
}

EndCode Commands::read_blocks(Kind kind, FieldReader& data, FieldWriter& out, can::Time now) {
  std::size_t count = 0;
  const EndCode end_code = read_block_list(kind, data, false, count);
  if (end_code != EndCode::completed) return end_code;
  for (const Block& block : std::span(blocks_).first(count)) {
    const auto words = std::span(words_).first(block.count);
    if (const EndCode failed = read(block.target, words, now); failed != EndCode::completed) return failed;
    out.words(words);
  }
  return EndCode::completed;
}

EndCode Commands::write_blocks(Kind kind, FieldReader& data, can::Time now) {
  std::size_t count = 0;
  const EndCode end_code = read_block_list(kind, data, true, count);
  if (end_code != EndCode::completed) return end_code;
  for (const Block& block : std::span(blocks_).first(count)) {
    const auto words = std::span(words_).subspan(block.data_at, block.count);
    if (const EndCode failed = write(block.target, words, now); failed != EndCode::completed) return failed;
  }
  return EndCode::completed;
}

EndCode Commands::register_monitor(Kind kind, FieldReader& data) {
  std::size_t words = 0;
  std::size_t double_words = 0;
  const EndCode end_code = read_points(kind, data, blocks_, words, double_words);
  if (end_code != EndCode::completed) return end_code;
  monitored_ = blocks_;
  monitored_words_ = words;
  monitored_double_words_ = double_words;
  return EndCode::completed;
}

EndCode Commands::read_monitor(FieldReader& data, FieldWriter& out, can::Time now) {
  if (const EndCode end_code = verdict(data); end_code != EndCode::completed) return end_code;
  if (monitored_words_ + monitored_double_words_ == 0) return EndCode::nothing_registered;
  return answer_points(monitored_, monitored_words_, monitored_double_words_, out, now);
}

}  // namespace canopus::plc::melsec
