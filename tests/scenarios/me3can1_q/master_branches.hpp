#pragma once
// A master with a slave that it configures: what the tests of its branches have in common.

#include "scenarios/me3can1_q/concise_dcf.hpp"
#include "scenarios/me3can1_q/nmt_master_slave.hpp"

namespace canopus::scenario::nmt_master_slave {

inline constexpr std::uint32_t only_watched = 0x01;  // 1F81H: assigned
inline constexpr std::uint32_t kept_alive = 0x1D;    // and not to be reset while Operational

inline const Bytes ask_date{0x40, 0x20, 0x10, 0x01, 0, 0, 0, 0};
inline const Bytes ask_time{0x40, 0x20, 0x10, 0x02, 0, 0, 0, 0};
inline const Bytes write_1017{0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0};
inline const Bytes written_1017{0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0};
inline const Bytes write_1800{0x23, 0x00, 0x18, 0x01, 0x81, 0x01, 0x00, 0x80};
inline const Bytes written_1800{0x60, 0x00, 0x18, 0x01, 0, 0, 0, 0};

inline Bytes answer(std::uint8_t sub, std::uint32_t value) {
  return {0x43,
          0x20,
          0x10,
          sub,
          static_cast<std::uint8_t>(value & 0xFF),
          static_cast<std::uint8_t>(value >> 8 & 0xFF),
          static_cast<std::uint8_t>(value >> 16 & 0xFF),
          static_cast<std::uint8_t>(value >> 24)};
}

inline void set(IntelligentScenario& s, std::initializer_list<Object> objects,
                Where where = Where::current()) {
  for (const Object& object : objects) s.set_object(object.index, object.sub, object.value, 4, where);
}

/// 1F22H/02: 1017:00 = 1000, 1800:01 = 80000181H.
inline void store_concise_dcf(IntelligentScenario& s, Where where = Where::current()) {
  const Bytes file{2,    0, 0,    0, 0x17, 0x10, 0, 2, 0,    0,    0,    0xE8,
                   0x03, 0, 0x18, 1, 4,    0,    0, 0, 0x81, 0x01, 0x00, 0x80};
  if (write_concise_dcf(s, 2, file) != 0) ADD_FAILURE_AT(where.file_name(), static_cast<int>(where.line()));
}

/// Node 1 with these objects stored, after a restart: Reset communication was sent just now.
inline void start_with(IntelligentScenario& s, std::initializer_list<Object> objects,
                       Where where = Where::current()) {
  set(s, objects, where);
  s.store_objects(where);
  s.y(0x02, true).wait_x(0x02, true, 60s, where).y(0x02, false);
}

}  // namespace canopus::scenario::nmt_master_slave
