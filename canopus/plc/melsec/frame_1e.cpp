#include "canopus/plc/melsec/frame_1e.hpp"

#include <optional>

namespace canopus::plc::melsec {

namespace {

constexpr std::size_t header_size = 4;  // subheader, PC number, monitoring timer; in bytes

/// A request without its data, and where it says how much data there is.
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
    case Command1e::read_buffer: return Form{6, 3, Data::none, 0};
    case Command1e::write_buffer: return Form{6, 3, Data::items, 1};
    case Command1e::remote_run:
    case Command1e::remote_stop:
    case Command1e::read_model: return Form{0, 0, Data::none, 0};
    case Command1e::loopback: return Form{1, 0, Data::count_may_be_zero, 1};
  }
  return std::nullopt;
}

}  // namespace

Request1e read_request_1e(std::span<const std::uint8_t> bytes, DataCode code) noexcept {
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
    // Single bits: half a byte or a character each, and one more where their number is odd.
    request.size +=
        form->data == Form::Data::bits ? scale * ((count + 1) / 2) : scale * count * form->item_size;
  }
  if (bytes.size() >= request.size) request.state = Request1e::State::complete;
  return request;
}

}  // namespace canopus::plc::melsec
