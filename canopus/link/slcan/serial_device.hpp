#pragma once
// A serial line without any processing of its bytes (termios, raw, no flow control).

#include <cstdint>
#include <expected>
#include <string>

namespace canopus::link {

/// Opens the device for this process alone; does not block. The descriptor is the caller's to close. The error is a
/// sentence of what to do where that is known.
[[nodiscard]] std::expected<int, std::string> open_serial_device(const std::string& path,
                                                                 std::uint32_t speed);

}  // namespace canopus::link
