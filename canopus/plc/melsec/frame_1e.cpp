#include "canopus/plc/melsec/frame_1e.hpp"

#include <algorithm>
#include <array>

namespace canopus::plc::melsec {

namespace {

constexpr std::size_t header_size = 4;  // subheader, PC number, monitoring timer; in bytes

struct DeviceCode1e {
  std::uint16_t code;
  Device device;
};
constexpr std::array codes_1e = {
    DeviceCode1e{0x5820, Device::x},  DeviceCode1e{0x5920, Device::y},  DeviceCode1e{0x4D20, Device::m},
    DeviceCode1e{0x4C20, Device::l},  DeviceCode1e{0x4620, Device::f},  DeviceCode1e{0x4220, Device::b},
    DeviceCode1e{0x5453, Device::ts}, DeviceCode1e{0x5443, Device::tc}, DeviceCode1e{0x4353, Device::cs},
    DeviceCode1e{0x4343, Device::cc}, DeviceCode1e{0x4420, Device::d},  DeviceCode1e{0x5720, Device::w},
    DeviceCode1e{0x5220, Device::r},  DeviceCode1e{0x544E, Device::tn}, DeviceCode1e{0x434E, Device::cn},
    DeviceCode1e{0x5320, Device::s},
};

/// The form of a request without its data, and the position of its number of points.
struct Form {
  std::size_t fixed_size;  // bytes behind the header before the data
  std::size_t count_at;    // byte behind the header that counts them
  enum class Data : std::uint8_t { none, bits, items, count_may_be_zero } data;
  std::size_t item_size;  // bytes
};

std::optional<Form> form_of(std::uint8_t subheader) {
  using Data = Form::Data;
  switch (static_cast<Command1e>(subheader)) {
    case Command1e::read_bits:
    case Command1e::read_words: return Form{8, 6, Data::none, 0};
    case Command1e::write_bits: return Form{8, 6, Data::bits, 0};
    case Command1e::write_words: return Form{8, 6, Data::items, 2};
    case Command1e::test_bits: return Form{2, 0, Data::items, 7};
    case Command1e::test_words: return Form{2, 0, Data::items, 8};
    case Command1e::register_bits:
    case Command1e::register_words: return Form{2, 0, Data::items, 6};
    case Command1e::read_buffer: return Form{6, 3, Data::none, 0};
    case Command1e::write_buffer: return Form{6, 3, Data::items, 1};
    case Command1e::monitor_bits:
    case Command1e::monitor_words:
    case Command1e::remote_run:
    case Command1e::remote_stop:
    case Command1e::read_model: return Form{0, 0, Data::none, 0};
    case Command1e::loopback: return Form{1, 0, Data::count_may_be_zero, 1};
  }
  return std::nullopt;
}

/// `fields` begin with a device.
bool names_wide_counter(std::span<const std::uint8_t> fields, DataCode code) {
  FieldReader data(fields, code);
  const std::uint16_t leading = code == DataCode::ascii ? data.u16() : std::uint16_t{0};
  const std::uint32_t number = data.u32();
  const std::uint16_t name = code == DataCode::ascii ? leading : data.u16();
  return device_of_1e(name) == Device::cn && number >= first_wide_counter;
}

}  // namespace

std::optional<std::uint16_t> device_code_1e(Device device) noexcept {
  const auto* found = std::ranges::find(codes_1e, device, &DeviceCode1e::device);
  return found == codes_1e.end() ? std::nullopt : std::optional(found->code);
}

std::optional<Device> device_of_1e(std::uint16_t code) noexcept {
  const auto* found = std::ranges::find(codes_1e, code, &DeviceCode1e::code);
  return found == codes_1e.end() ? std::nullopt : std::optional(found->device);
}

Request1e read_request_1e(std::span<const std::uint8_t> bytes, DataCode code, bool wide_counters) noexcept {
  Request1e request;
  const std::size_t scale = code == DataCode::ascii ? 2 : 1;
  if (bytes.size() < scale) return request;
  FieldReader subheader(bytes.first(scale), code);
  request.subheader = subheader.u8();
  if (subheader.fault() != FieldReader::Fault::none) {
    request.state = Request1e::State::not_a_number;
    return request;
  }
  const auto form = form_of(request.subheader);
  if (!form) {
    request.state = Request1e::State::unknown;
    return request;
  }
  const std::size_t head = scale * (header_size + form->fixed_size);
  if (bytes.size() < head) return request;
  request.size = head;
  if (form->data != Form::Data::none) {
    FieldReader count_field(bytes.subspan(scale * (header_size + form->count_at), scale), code);
    std::size_t count = count_field.u8();
    if (count_field.fault() != FieldReader::Fault::none) {
      request.state = Request1e::State::not_a_number;
      return request;
    }
    if (count == 0 && form->data != Form::Data::count_may_be_zero) count = 256;
    const bool is_wide =
        wide_counters && static_cast<Command1e>(request.subheader) == Command1e::write_words &&
        names_wide_counter(bytes.subspan(scale * header_size, scale * form->fixed_size), code);
    const std::size_t item_size = is_wide ? 2 * form->item_size : form->item_size;
    // Single bits: half a byte or a character each, and one more where their number is odd.
    request.size += form->data == Form::Data::bits ? scale * ((count + 1) / 2) : scale * count * item_size;
  }
  if (bytes.size() >= request.size) request.state = Request1e::State::complete;
  return request;
}

}  // namespace canopus::plc::melsec
