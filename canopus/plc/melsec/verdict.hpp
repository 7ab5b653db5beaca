#pragma once
// From what went wrong to the end code a CPU answers.

#include "canopus/plc/melsec/end_code.hpp"
#include "canopus/plc/melsec/field.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plc::melsec {

/// Whether a request was well-formed and read to its last byte.
[[nodiscard]] inline EndCode verdict(const FieldReader& reader) noexcept {
  if (reader.fault() == FieldReader::Fault::not_a_number) return EndCode::not_convertible;
  if (reader.fault() == FieldReader::Fault::none && reader.at_end()) return EndCode::completed;
  return reader.code() == DataCode::ascii ? EndCode::text_length : EndCode::data_length;
}

[[nodiscard]] inline EndCode end_code_of(const Rack::Access& access) noexcept {
  if (access) return EndCode::completed;
  switch (access.error()) {
    case AccessError::no_device: return EndCode::no_such_device;
    case AccessError::wrong_unit: return EndCode::wrong_contents;
    case AccessError::out_of_range: return EndCode::device_out_of_range;
    case AccessError::no_module: return EndCode::no_module;
    case AccessError::beyond_buffer: break;
  }
  return EndCode::beyond_buffer_memory;
}

}  // namespace canopus::plc::melsec
