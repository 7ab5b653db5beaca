#include "canopus/plc/modbus/rtu_frame.hpp"

#include <algorithm>
#include <array>

namespace canopus::plc::modbus {
namespace {

constexpr std::size_t crc_size = 2;
constexpr std::size_t longest = 256;  // on a serial line

/// Bytes of a request from its unit to the end of what has a fixed length; `count_at`: where the number of bytes behind that
/// is, 0: there are none. [Modbus Application Protocol V1.1b3 6]
struct RequestForm {
  std::uint8_t function;
  std::uint8_t bytes;
  std::uint8_t count_at = 0;
};
constexpr std::array forms{
    RequestForm{1, 6},       RequestForm{2, 6},     RequestForm{3, 6},     RequestForm{4, 6},
    RequestForm{5, 6},       RequestForm{6, 6},     RequestForm{7, 2},     RequestForm{8, 6},
    RequestForm{11, 2},      RequestForm{12, 2},    RequestForm{15, 7, 6}, RequestForm{16, 7, 6},
    RequestForm{17, 2},      RequestForm{20, 3, 2}, RequestForm{21, 3, 2}, RequestForm{22, 8},
    RequestForm{23, 11, 10}, RequestForm{24, 4},    RequestForm{43, 5},
};

}  // namespace

std::uint16_t rtu_crc(std::span<const std::uint8_t> bytes) noexcept {
  constexpr unsigned polynomial = 0xA001;
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1U ^ polynomial : crc >> 1U;
  }
  return static_cast<std::uint16_t>(crc);
}

RtuSize rtu_request_size(std::span<const std::uint8_t> waiting) noexcept {
  if (waiting.size() < 2) return {};
  const auto form = std::ranges::find(forms, waiting[1], &RequestForm::function);
  if (form == forms.end()) return {.is_none = true};
  std::size_t size = form->bytes + crc_size;
  if (form->count_at != 0) {
    if (waiting.size() <= form->count_at) return {};
    size += waiting[form->count_at];
  }
  if (size > longest) return {.is_none = true};
  return {.is_known = true, .bytes = size};
}

bool has_good_crc(std::span<const std::uint8_t> frame) noexcept {
  if (frame.size() <= crc_size) return false;
  const auto crc = frame.last(crc_size);
  return rtu_crc(frame.first(frame.size() - crc_size)) == (crc[0] | crc[1] << 8U);
}

bool is_rtu_request(std::span<const std::uint8_t> waiting) noexcept {
  const RtuSize size = rtu_request_size(waiting);
  return size.is_known && size.bytes == waiting.size() && has_good_crc(waiting);
}

}  // namespace canopus::plc::modbus
