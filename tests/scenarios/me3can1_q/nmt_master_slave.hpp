#pragma once
// A module as NMT master, and slave 2 answered by hand.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::nmt_master_slave {

inline constexpr std::uint32_t optional = 0x05;   // 1F81H: assigned, boot slave
inline constexpr std::uint32_t mandatory = 0x0D;  // and mandatory

struct Object {
  std::uint16_t index;
  std::uint8_t sub;
  std::uint32_t value;
};

/// Node 1 with these objects stored, and G70 as it is; supply on up to its boot-up frame.
inline void boot_master_with_its_delay(IntelligentScenario& s, std::initializer_list<Object> objects,
                                       Where where = Where::current()) {
  s.plug_in().preset_word(27, 1);
  for (const Object& object : objects) {
    const unsigned length = object.index == 0x1017 || object.index == 0x100C ? 2
                            : object.index == 0x1029                         ? 1
                                                                             : 4;
    EXPECT_EQ(
        s.plug_in().preset_object(object.index, object.sub, canopen::little_endian(object.value, length)),
        canopen::AbortCode::none);
  }
  s.supply_on().wait_tx(0x701, {0x00}, 20s, where);
}

/// The same without a pause before each command of the RJ71CN91, which rj71cn91/command_delay_test.cpp is about.
inline void boot_master(IntelligentScenario& s, std::initializer_list<Object> objects,
                        Where where = Where::current()) {
  if (s.is_rj71cn91()) s.plug_in().preset_word(70, 0);
  boot_master_with_its_delay(s, objects, where);
}

inline const Bytes ask_1000{0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0};
inline const Bytes is_0191{0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00};

inline const Bytes time_out{0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05};

/// The next question for 1000H, after the end of the one that was just asked: G71, then 1 s.
inline void asked_again(IntelligentScenario& s, Where where = Where::current()) {
  const can::Time asked = s.now();
  s.wait_tx(0x602, time_out, 20s, where);
  EXPECT_EQ(s.now() - asked, 500ms);
  s.wait_tx(0x602, ask_1000, 20s, where);
  EXPECT_EQ(s.now() - asked, 1500ms);
}

/// Slave 2 comes after its reset, is identified, and is started.
inline void slave_2_boots(IntelligentScenario& s, Where where = Where::current()) {
  s.rx(0x702, {0x00}).tx(0x602, ask_1000, where).rx(0x582, is_0191);
}

inline const Bytes no_error{0, 0, 0, 0, 0, 0, 0, 0};

/// The same after its heartbeat was missing: the module takes its emergency message back.
inline void slave_2_boots_again(IntelligentScenario& s, Where where = Where::current()) {
  s.rx(0x702, {0x00}).tx(0x081, no_error, where).tx(0x602, ask_1000, where).rx(0x582, is_0191);
}

/// Slave 2 (heartbeat watched, 1500 ms) was booted and started and is heard.
inline void run_with_slave_2(IntelligentScenario& s, std::uint32_t start_up, std::uint32_t assignment,
                             Where where = Where::current()) {
  boot_master(s, {{0x1F80, 0, start_up}, {0x1F81, 2, assignment}, {0x1016, 1, 0x000205DC}}, where);
  s.tx(0x000, {0x82, 0x00}, where);
  slave_2_boots(s, where);
  s.advance(10ms).rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}, where);
  s.advance(10ms).rx(0x702, {0x05}).no_tx(where);
  s.expect(602, 5, where).expect_bit(25, 0, true, where).expect_bit(25, 14, false, where);
}

inline can::Duration since(const IntelligentScenario& s, can::Time from) { return s.now() - from; }

}  // namespace canopus::scenario::nmt_master_slave
