#include "canopus/plc/modbus/functions.hpp"

#include <algorithm>

namespace canopus::plc::modbus {

namespace {

constexpr std::uint16_t coil_on = 0xFF00;
constexpr std::uint16_t coil_off = 0x0000;
constexpr std::uint8_t exception_bit = 0x80;
constexpr std::uint8_t device_identification = 0x0E;  // the MEI type of function 43

/// Addresses first to first + count - 1 are addresses.
bool fit(unsigned first, unsigned count) { return first + count <= 0x10000; }

bool writes(std::uint8_t function) {
  switch (function) {
    case 5:
    case 6:
    case 15:
    case 16:
    case 22:
    case 23: return true;
    default: return false;
  }
}

}  // namespace

std::size_t Functions::execute(Request pdu, std::span<std::uint8_t, maximum_pdu> reply,
                               WritePermission permission, can::Time now) {
  Reply out{reply};
  out.u8(pdu[0]);
  const Exception exception = dispatch(pdu, out, permission, now);
  if (exception == Exception::none) return out.size;
  reply[0] = static_cast<std::uint8_t>(pdu[0] | exception_bit);
  reply[1] = static_cast<std::uint8_t>(exception);
  return 2;
}

Exception Functions::dispatch(Request pdu, Reply& reply, WritePermission permission, can::Time now) {
  const Limits& limits = settings_.limits;
  const std::uint8_t function = pdu[0];
  // "The server is in the wrong state to process a request of this type" is what exception 01 is for, too.
  if (writes(function) && !may_write(permission, rack_)) return Exception::illegal_function;
  switch (function) {
    case 1: return read_bits(Table::coils, pdu, reply, now);
    case 2: return read_bits(Table::discrete_inputs, pdu, reply, now);
    case 3: return read_words(Table::holding_registers, pdu, reply, now);
    case 4: return read_words(Table::input_registers, pdu, reply, now);
    case 5: return write_coil(pdu, reply, now);
    case 6: return write_register(pdu, reply, now);
    case 15: return write_coils(pdu, reply, now);
    case 16: return write_registers(pdu, reply, now);
    case 22: return limits.mask_write ? mask_write(pdu, reply, now) : Exception::illegal_function;
    case 23: return write_and_read(pdu, reply, now);
    case 43: return limits.identification ? identify(pdu, reply) : Exception::illegal_function;
    default: return Exception::illegal_function;
  }
}

Exception Functions::read_bits(Table table, Request pdu, Reply& reply, can::Time now) {
  if (pdu.size() != 5) return Exception::illegal_data_value;
  const unsigned first = word_at(pdu, 1);
  const unsigned count = word_at(pdu, 3);
  if (count == 0 || count > settings_.limits.read_bits) return Exception::illegal_data_value;
  if (!fit(first, count)) return Exception::illegal_data_address;
  const auto bits = std::span(bits_).first(count);
  const Exception exception =
      settings_.map.read_bits(rack_, table, static_cast<std::uint16_t>(first), bits, now);
  if (exception != Exception::none) return exception;
  const unsigned bytes = (count + 7) / 8;
  reply.u8(bytes);
  for (unsigned byte = 0; byte < bytes; ++byte) {
    unsigned value = 0;
    for (unsigned bit = 0; bit < 8 && 8 * byte + bit < count; ++bit)
      value |= static_cast<unsigned>(bits[8 * byte + bit]) << bit;
    reply.u8(value);
  }
  return Exception::none;
}

Exception Functions::read_words(Table table, Request pdu, Reply& reply, can::Time now) {
  if (pdu.size() != 5) return Exception::illegal_data_value;
  const unsigned first = word_at(pdu, 1);
  const unsigned count = word_at(pdu, 3);
  if (count == 0 || count > settings_.limits.read_words) return Exception::illegal_data_value;
  if (!fit(first, count)) return Exception::illegal_data_address;
  const auto words = std::span(words_).first(count);
  const Exception exception =
      settings_.map.read_words(rack_, table, static_cast<std::uint16_t>(first), words, now);
  if (exception != Exception::none) return exception;
  reply.u8(2 * count);
  for (const std::uint16_t word : words) reply.u16(word);
  return Exception::none;
}

Exception Functions::write_coil(Request pdu, Reply& reply, can::Time now) {
  if (pdu.size() != 5) return Exception::illegal_data_value;
  const unsigned first = word_at(pdu, 1);
  const unsigned value = word_at(pdu, 3);
  if (value != coil_on && value != coil_off) return Exception::illegal_data_value;
  const std::uint8_t bit = value == coil_on ? 1 : 0;
  const Exception exception =
      settings_.map.write_bits(rack_, static_cast<std::uint16_t>(first), {&bit, 1}, now);
  reply.u16(first);
  reply.u16(value);
  return exception;
}

Exception Functions::write_register(Request pdu, Reply& reply, can::Time now) {
  if (pdu.size() != 5) return Exception::illegal_data_value;
  const unsigned first = word_at(pdu, 1);
  const auto word = static_cast<std::uint16_t>(word_at(pdu, 3));
  const Exception exception =
      settings_.map.write_words(rack_, static_cast<std::uint16_t>(first), {&word, 1}, now);
  reply.u16(first);
  reply.u16(word);
  return exception;
}

Exception Functions::write_coils(Request pdu, Reply& reply, can::Time now) {
  constexpr std::size_t head = 6;
  if (pdu.size() < head) return Exception::illegal_data_value;
  const unsigned first = word_at(pdu, 1);
  const unsigned count = word_at(pdu, 3);
  if (count == 0 || count > settings_.limits.write_bits) return Exception::illegal_data_value;
  if (pdu[5] != (count + 7) / 8 || pdu.size() != head + pdu[5]) return Exception::illegal_data_value;
  if (!fit(first, count)) return Exception::illegal_data_address;
  const auto bits = std::span(bits_).first(count);
  for (unsigned i = 0; i < count; ++i)
    bits[i] = static_cast<std::uint8_t>(static_cast<unsigned>(pdu[head + i / 8]) >> i % 8 & 1U);
  reply.u16(first);
  reply.u16(count);
  return settings_.map.write_bits(rack_, static_cast<std::uint16_t>(first), bits, now);
}

Exception Functions::write_registers(Request pdu, Reply& reply, can::Time now) {
  constexpr std::size_t head = 6;
  if (pdu.size() < head) return Exception::illegal_data_value;
  const unsigned first = word_at(pdu, 1);
  const unsigned count = word_at(pdu, 3);
  if (count == 0 || count > settings_.limits.write_words) return Exception::illegal_data_value;
  if (pdu[5] != 2 * count || pdu.size() != head + pdu[5]) return Exception::illegal_data_value;
  if (!fit(first, count)) return Exception::illegal_data_address;
  const auto words = std::span(words_).first(count);
  for (unsigned i = 0; i < count; ++i) words[i] = static_cast<std::uint16_t>(word_at(pdu, head + 2 * i));
  reply.u16(first);
  reply.u16(count);
  return settings_.map.write_words(rack_, static_cast<std::uint16_t>(first), words, now);
}

Exception Functions::mask_write(Request pdu, Reply& reply, can::Time now) {
  if (pdu.size() != 7) return Exception::illegal_data_value;
  const auto first = static_cast<std::uint16_t>(word_at(pdu, 1));
  const unsigned and_mask = word_at(pdu, 3);
  const unsigned or_mask = word_at(pdu, 5);
  Exception exception = settings_.map.check_write(rack_, Table::holding_registers, first, 1);
  if (exception != Exception::none) return exception;
  std::uint16_t word = 0;
  exception = settings_.map.read_words(rack_, Table::holding_registers, first, {&word, 1}, now);
  if (exception != Exception::none) return exception;
  word = static_cast<std::uint16_t>((word & and_mask) | (or_mask & ~and_mask));
  reply.u16(first);
  reply.u16(and_mask);
  reply.u16(or_mask);
  return settings_.map.write_words(rack_, first, {&word, 1}, now);
}

Exception Functions::write_and_read(Request pdu, Reply& reply, can::Time now) {
  constexpr std::size_t head = 10;
  if (pdu.size() < head) return Exception::illegal_data_value;
  const unsigned read_first = word_at(pdu, 1);
  const unsigned read_count = word_at(pdu, 3);
  const unsigned write_first = word_at(pdu, 5);
  const unsigned write_count = word_at(pdu, 7);
  const Limits& limits = settings_.limits;
  if (read_count == 0 || read_count > limits.read_words_of_23 || write_count == 0 ||
      write_count > limits.write_words_of_23)
    return Exception::illegal_data_value;
  if (pdu[9] != 2 * write_count || pdu.size() != head + pdu[9]) return Exception::illegal_data_value;
  if (!fit(read_first, read_count) || !fit(write_first, write_count)) return Exception::illegal_data_address;
  constexpr Table table = Table::holding_registers;
  // Both parts are judged before the first is done.
  Exception exception =
      settings_.map.check_read(rack_, table, static_cast<std::uint16_t>(read_first), read_count);
  if (exception != Exception::none) return exception;
  const auto written = std::span(words_).first(write_count);
  for (unsigned i = 0; i < write_count; ++i)
    written[i] = static_cast<std::uint16_t>(word_at(pdu, head + 2 * i));
  exception = settings_.map.write_words(rack_, static_cast<std::uint16_t>(write_first), written, now);
  if (exception != Exception::none) return exception;
  const auto words = std::span(words_).first(read_count);
  exception = settings_.map.read_words(rack_, table, static_cast<std::uint16_t>(read_first), words, now);
  if (exception != Exception::none) return exception;
  reply.u8(2 * read_count);
  for (const std::uint16_t word : words) reply.u16(word);
  return Exception::none;
}

Exception Functions::identify(Request pdu, Reply& reply) const {
  enum : std::uint8_t { basic = 1, regular = 2, extended = 3, individual = 4 };
  constexpr unsigned conformity = 0x82;  // basic and regular objects, as a stream and one by one
  if (pdu.size() < 2) return Exception::illegal_data_value;
  if (pdu[1] != device_identification) return Exception::illegal_function;
  if (pdu.size() != 4) return Exception::illegal_data_value;
  const std::uint8_t category = pdu[2];
  if (category < basic || category > individual) return Exception::illegal_data_value;
  const auto& objects = settings_.identification.objects;
  const auto is_there = [&](std::size_t id) { return id < objects.size() && !objects[id].empty(); };
  std::size_t id = pdu[3];
  if (category == individual && !is_there(id)) return Exception::illegal_data_address;
  const std::size_t end = category == individual ? id + 1
                          : category == basic    ? Identification::basic_count
                                                 : Identification::object_count;
  if (id >= end) id = 0;  // an unknown object restarts the stream
  reply.u8(device_identification);
  reply.u8(category);
  reply.u8(conformity);
  const std::size_t more_at = reply.size;
  reply.u8(0);  // more follows
  reply.u8(0);  // the object it goes on with
  reply.u8(0);  // number of objects
  for (; id < end; ++id) {
    if (!is_there(id)) continue;
    constexpr std::size_t head = 2;
    const std::size_t room = maximum_pdu - reply.size;
    const bool is_first = reply.bytes[more_at + 2] == 0;
    if (!is_first && room < head + objects[id].size()) {
      reply.bytes[more_at] = 0xFF;
      reply.bytes[more_at + 1] = static_cast<std::uint8_t>(id);
      break;
    }
    const std::string_view value = std::string_view(objects[id]).substr(0, room - head);
    reply.u8(static_cast<unsigned>(id));
    reply.u8(static_cast<unsigned>(value.size()));
    for (const char character : value) reply.u8(static_cast<unsigned char>(character));
    ++reply.bytes[more_at + 2];
  }
  return Exception::none;
}

}  // namespace canopus::plc::modbus
