// Frames of CiA 305 as text.

#include <array>

#include <fmt/format.h>

#include "canopus/can/little_endian.hpp"
#include "canopus/lss/lss.hpp"
#include "canopus/trace/decode/service_text.hpp"

namespace canopus::trace {
namespace {

constexpr std::array<std::string_view, 4> parts{"vendor-ID", "product code", "revision number",
                                                "serial number"};

std::uint32_t number(const can::Frame& frame) noexcept { return can::load_as<std::uint32_t>(&frame.data[1]); }

/// "done", or what the device answers to configure and store commands.
std::string result(const can::Frame& frame, std::string_view refusal) {
  switch (frame.data[1]) {
    case 0: return "done";
    case 1: return fmt::format("refused: {}", refusal);
    case 2: return "failed: storage medium not accessible";
    case 0xFF: return fmt::format("device specific error {:02X}H", frame.data[2]);
    default: return fmt::format("error {:02X}H", frame.data[1]);
  }
}

std::string rate_text(const can::Frame& frame) {
  if (frame.data[1] != 0) return fmt::format("table {}, index {}", frame.data[1], frame.data[2]);
  const std::uint8_t index = frame.data[2];
  if (index == 9) return "automatic detection";
  if (index >= lss::bit_rates.size() || lss::bit_rates[index] == 0)
    return fmt::format("reserved index {}", index);
  return fmt::format("{} kbit/s", lss::bit_rates[index] / 1000);
}

std::string node_id_text(std::uint8_t node_id) {
  return node_id == 0xFF ? "none (FFH)" : fmt::format("{}", node_id);
}

LssText with_number(std::string_view kind, const can::Frame& frame) {
  return {kind, fmt::format("{} {:08X}H", kind, number(frame))};
}

LssText selective(const can::Frame& frame) {
  static constexpr std::array<std::string_view, 4> kinds{
      "switch state selective: vendor-ID", "switch state selective: product code",
      "switch state selective: revision number", "switch state selective: serial number"};
  return with_number(kinds[frame.data[0] & 3U], frame);
}

LssText identify(const can::Frame& frame) {
  static constexpr std::array<std::string_view, 6> kinds{"identify remote slaves: vendor-ID",
                                                         "identify remote slaves: product code",
                                                         "identify remote slaves: revision number from",
                                                         "identify remote slaves: revision number to",
                                                         "identify remote slaves: serial number from",
                                                         "identify remote slaves: serial number to"};
  return with_number(kinds[frame.data[0] - 0x46U], frame);
}

LssText inquire(const can::Frame& frame, bool from_master) {
  static constexpr std::array<std::string_view, 4> kinds{"inquire vendor-ID", "inquire product code",
                                                         "inquire revision number", "inquire serial number"};
  const auto part = static_cast<std::size_t>(frame.data[0] - 0x5AU);
  if (from_master) return {kinds[part], std::string(kinds[part])};
  return {kinds[part], fmt::format("{} is {:08X}H", parts[part], number(frame))};
}

LssText fastscan(const can::Frame& frame) {
  const unsigned bit = frame.data[5], sub = frame.data[6], next = frame.data[7];
  if (bit == 0x80) return {"fastscan", "fastscan: is any unconfigured device there?"};
  const std::string_view part = sub < 4 ? parts[sub] : "part of the LSS address that is none";
  return {"fastscan",
          fmt::format("fastscan: {} {:08X}H from bit {} on, next {}", part, number(frame), bit, next)};
}

LssText answer(const can::Frame& frame) {
  switch (frame.data[0]) {
    case 0x11: return {"configure node-ID", "configure node-ID: " + result(frame, "node-ID out of range")};
    case 0x13:
      return {"configure bit timing", "configure bit timing: " + result(frame, "bit rate not supported")};
    case 0x17: return {"store configuration", "store configuration: " + result(frame, "not supported")};
    case 0x44: return {"switch state selective", "the addressed device is in LSS configuration state"};
    case 0x4F: return {"identify slave", "a device has this LSS address"};
    case 0x50: return {"identify non-configured slave", "a device has no node-ID"};
    case 0x5A:
    case 0x5B:
    case 0x5C:
    case 0x5D: return inquire(frame, false);
    case 0x5E: return {"inquire node-ID", "node-ID is " + node_id_text(frame.data[1])};
    default: return {"unknown", fmt::format("unknown command specifier {:02X}H", frame.data[0])};
  }
}

}  // namespace

LssText lss_text(const can::Frame& frame, bool from_master) {
  if (!from_master) return answer(frame);
  switch (frame.data[0]) {
    case 0x04:
      switch (frame.data[1]) {
        case 0: return {"switch state global", "all devices to LSS waiting state"};
        case 1: return {"switch state global", "all devices to LSS configuration state"};
        default: return {"switch state global", fmt::format("unknown mode {}", frame.data[1])};
      }
    case 0x11: return {"configure node-ID", "configure node-ID " + node_id_text(frame.data[1])};
    case 0x13: return {"configure bit timing", "configure bit timing: " + rate_text(frame)};
    case 0x15:
      return {"activate bit timing",
              fmt::format("activate bit timing in {} ms", can::load_as<std::uint16_t>(&frame.data[1]))};
    case 0x17: return {"store configuration", "store configuration"};
    case 0x40:
    case 0x41:
    case 0x42:
    case 0x43: return selective(frame);
    case 0x46:
    case 0x47:
    case 0x48:
    case 0x49:
    case 0x4A:
    case 0x4B: return identify(frame);
    case 0x4C: return {"identify non-configured slaves", "which devices have no node-ID?"};
    case 0x51: return fastscan(frame);
    case 0x5A:
    case 0x5B:
    case 0x5C:
    case 0x5D: return inquire(frame, true);
    case 0x5E: return {"inquire node-ID", "inquire node-ID"};
    default: return {"unknown", fmt::format("unknown command specifier {:02X}H", frame.data[0])};
  }
}

}  // namespace canopus::trace
