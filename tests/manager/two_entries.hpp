#pragma once

#include <cstdint>
#include <vector>

namespace canopus::manager::test {

/// A concise DCF of two: heartbeat 1000 ms; TPDO1 disabled with identifier 181H.
inline const std::vector<std::uint8_t> two_entries{0x02, 0x00, 0x00, 0x00, 0x17, 0x10, 0x00, 0x02,
                                                   0x00, 0x00, 0x00, 0xE8, 0x03, 0x00, 0x18, 0x01,
                                                   0x04, 0x00, 0x00, 0x00, 0x81, 0x01, 0x00, 0x80};

}  // namespace canopus::manager::test
