#pragma once
// A rack with a module at 0000H and one at 0030H, and one client's session, for tests that write every byte
// themselves. Binary messages are hexadecimal text, ASCII ones are what they are.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "canopus/can/timeline.hpp"
#include "canopus/plc/melsec/password_guard.hpp"
#include "canopus/plc/melsec/session.hpp"
#include "canopus/plc/rack/rack.hpp"

#include "plc/fake_module.hpp"

namespace canopus::plc::testing {

/// "50 00 | 00 ff" -> the bytes; anything but hexadecimal digits is for the eye.
inline std::string bytes(std::string_view hexadecimal) {
  std::string result;
  int high = -1;
  for (const char c : hexadecimal) {
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
    if (digit < 0) continue;
    if (high < 0) {
      high = digit;
    } else {
      result += static_cast<char>(16 * high + digit);
      high = -1;
    }
  }
  return result;
}

/// "d0 00 00 ff", as messages are printed in manuals.
inline std::string shown(std::string_view data) {
  std::string result;
  for (const char c : data) {
    constexpr std::string_view digits = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(c);
    if (!result.empty()) result += ' ';
    result += digits[byte >> 4U];
    result += digits[byte & 0xFU];
  }
  return result;
}

struct Plc {
  explicit Plc(const CpuModel& model = r04cpu(), melsec::PortSettings settings = {})
      : rack(timeline, model), session(std::make_unique<melsec::Session>(rack, std::move(settings), &guard)) {
    timeline.add(module);
    rack.insert(0x00, module);
    timeline.add(other_module);
    rack.insert(0x30, other_module);
    rack.power_on(now);
  }

  /// What the session answers to these bytes, raw.
  std::string raw(std::string_view request) {
    std::string reply;
    while (!request.empty()) {
      const auto space = session->space();
      const std::size_t count = std::min(space.size(), request.size());
      std::copy_n(request.begin(), count, space.begin());
      session->received(count);
      request.remove_prefix(count);
      do {
        session->process(now);
        const auto output = session->output();
        reply.append(output.begin(), output.end());
        session->sent(output.size());
      } while (session->process(now) != 0);
      if (session->over()) break;
    }
    return reply;
  }
  /// What the session answers to a datagram of these bytes, raw.
  std::string datagram(std::string_view request) {
    session->datagram({reinterpret_cast<const std::uint8_t*>(request.data()), request.size()}, now);
    const auto output = session->output();
    return {output.begin(), output.end()};
  }
  /// Binary, both ways as hexadecimal text.
  std::string request(std::string_view request) { return shown(raw(bytes(request))); }

  void word(Device device, std::uint32_t number, std::uint16_t value) {
    (void)rack.write_words(device, number, {&value, 1}, now);
  }
  std::uint16_t word(Device device, std::uint32_t number) {
    std::uint16_t value = 0xDEAD;
    (void)rack.read_words(device, number, {&value, 1}, now);
    return value;
  }
  bool bit(Device device, std::uint32_t number) {
    std::uint8_t value = 2;
    (void)rack.read_bits(device, number, {&value, 1}, now);
    return value == 1;
  }
  void bit(Device device, std::uint32_t number, bool on) {
    const std::uint8_t value = on ? 1 : 0;
    (void)rack.write_bits(device, number, {&value, 1}, now);
  }

  can::Time now{std::chrono::seconds(10)};
  can::Timeline timeline;
  FakeModule module;
  FakeModule other_module{16, 512};
  Rack rack;
  melsec::PasswordGuard guard;
  std::unique_ptr<melsec::Session> session;
};

}  // namespace canopus::plc::testing
