#pragma once

#include <cstdint>

namespace canopus::plc::melsec {

/// The coding of numbers: low byte first, or as upper-case hexadecimal text with the high digit first.
enum class DataCode : std::uint8_t { binary, ascii };

}  // namespace canopus::plc::melsec
