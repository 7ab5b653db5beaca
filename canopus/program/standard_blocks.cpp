// Bistable, edge, counter and timer blocks [IEC 61131-3 6.6.3.5].

#include <algorithm>
#include <array>
#include <limits>

#include "canopus/program/standard_functions.hpp"
#include "canopus/program/standard_timer.hpp"

namespace canopus::program {

namespace {

using Variable = StandardBlock::Variable;
using enum MemberKind;
constexpr Elementary bool_type = Elementary::boolean;

bool set_dominant(NativeCall& call) {
  Slot& q = call.slots[2];
  q = call.slots[0] != 0 || (call.slots[1] == 0 && q != 0) ? 1 : 0;
  return true;
}

bool reset_dominant(NativeCall& call) {
  Slot& q = call.slots[2];
  q = call.slots[1] == 0 && (call.slots[0] != 0 || q != 0) ? 1 : 0;
  return true;
}

/// What CLK was before is kept inverted by F_TRIG: as the standard writes it, Q is TRUE at the first call with CLK FALSE.
bool rising(NativeCall& call) {
  auto& [clock, q, memory] = *reinterpret_cast<std::array<Slot, 3>*>(call.slots);
  q = clock != 0 && memory == 0 ? 1 : 0;
  memory = clock;
  return true;
}

bool falling(NativeCall& call) {
  auto& [clock, q, memory] = *reinterpret_cast<std::array<Slot, 3>*>(call.slots);
  q = clock == 0 && memory == 0 ? 1 : 0;
  memory = clock == 0 ? 1 : 0;
  return true;
}

bool rises(Slot input, Slot& before) {
  const bool edge = input != 0 && before == 0;
  before = input;
  return edge;
}

template <typename Integer>
Integer counter_value(Slot slot) {
  return static_cast<Integer>(slot);
}
template <typename Integer>
Slot counter_slot(Integer value) {
  return static_cast<Slot>(
      static_cast<std::conditional_t<std::is_signed_v<Integer>, std::int64_t, std::uint64_t>>(value));
}

template <typename Integer>
void count(Slot& value, bool up) {
  const auto number = counter_value<Integer>(value);
  if (number == (up ? std::numeric_limits<Integer>::max() : std::numeric_limits<Integer>::min())) return;
  value = counter_slot(static_cast<Integer>(up ? number + 1 : number - 1));
}

template <typename Integer>
bool count_up(NativeCall& call) {  // CU R PV Q CV, CU before
  Slot* const s = call.slots;
  const bool edge = rises(s[0], s[5]);
  if (s[1] != 0) {
    s[4] = 0;
  } else if (edge) {
    count<Integer>(s[4], true);
  }
  s[3] = counter_value<Integer>(s[4]) >= counter_value<Integer>(s[2]) ? 1 : 0;
  return true;
}

template <typename Integer>
bool count_down(NativeCall& call) {  // CD LD PV Q CV, CD before
  Slot* const s = call.slots;
  const bool edge = rises(s[0], s[5]);
  if (s[1] != 0) {
    s[4] = s[2];
  } else if (edge) {
    count<Integer>(s[4], false);
  }
  s[3] = counter_value<Integer>(s[4]) <= 0 ? 1 : 0;
  return true;
}

template <typename Integer>
bool count_both(NativeCall& call) {  // CU CD R LD PV QU QD CV, CU and CD before
  Slot* const s = call.slots;
  const bool up = rises(s[0], s[8]);
  const bool down = rises(s[1], s[9]);
  if (s[2] != 0) {
    s[7] = 0;
  } else if (s[3] != 0) {
    s[7] = s[4];
  } else if (up != down) {
    count<Integer>(s[7], up);
  }
  s[5] = counter_value<Integer>(s[7]) >= counter_value<Integer>(s[4]) ? 1 : 0;
  s[6] = counter_value<Integer>(s[7]) <= 0 ? 1 : 0;
  return true;
}

Timer& timer_of(NativeCall& call) { return *reinterpret_cast<Timer*>(call.slots); }

bool off_delay(NativeCall& call) {
  Timer& t = timer_of(call);
  if (t.in != 0) {
    t.q = 1;
    t.elapsed = t.is_running = 0;
  } else {
    if (t.before != 0) t.start(call.now);
    if (t.is_running != 0 && t.run(call.now) == 0) t.q = t.is_running = 0;
  }
  t.before = t.in;
  return true;
}

bool pulse(NativeCall& call) {
  Timer& t = timer_of(call);
  const bool edge = rises(t.in, t.before);
  if (edge && t.q == 0) {
    t.start(call.now);
    t.q = 1;
  }
  if (t.q != 0 && t.run(call.now) == 0) t.q = 0;
  if (t.q == 0 && t.in == 0) t.elapsed = 0;
  return true;
}

constexpr std::array sr_variables = {Variable{"S1", bool_type, input}, Variable{"R", bool_type, input},
                                     Variable{"Q1", bool_type, output}};
constexpr std::array rs_variables = {Variable{"S", bool_type, input}, Variable{"R1", bool_type, input},
                                     Variable{"Q1", bool_type, output}};
constexpr std::array edge_variables = {Variable{"CLK", bool_type, input}, Variable{"Q", bool_type, output},
                                       Variable{"M", bool_type, local}};

template <Elementary type>
constexpr std::array up_variables = {
    Variable{"CU", bool_type, input}, Variable{"R", bool_type, input},
    Variable{"PV", type, input},      Variable{"Q", bool_type, output},
    Variable{"CV", type, output},     Variable{"before CU", bool_type, hidden}};
template <Elementary type>
constexpr std::array down_variables = {
    Variable{"CD", bool_type, input}, Variable{"LD", bool_type, input},
    Variable{"PV", type, input},      Variable{"Q", bool_type, output},
    Variable{"CV", type, output},     Variable{"before CD", bool_type, hidden}};
template <Elementary type>
constexpr std::array both_variables = {Variable{"CU", bool_type, input},
                                       Variable{"CD", bool_type, input},
                                       Variable{"R", bool_type, input},
                                       Variable{"LD", bool_type, input},
                                       Variable{"PV", type, input},
                                       Variable{"QU", bool_type, output},
                                       Variable{"QD", bool_type, output},
                                       Variable{"CV", type, output},
                                       Variable{"before CU", bool_type, hidden},
                                       Variable{"before CD", bool_type, hidden}};
template <Elementary type>
constexpr std::array timer_variables = {Variable{"IN", bool_type, input},
                                        Variable{"PT", type, input},
                                        Variable{"Q", bool_type, output},
                                        Variable{"ET", type, output},
                                        Variable{"since", Elementary::lint, hidden},
                                        Variable{"before IN", bool_type, hidden},
                                        Variable{"is running", bool_type, hidden}};

constexpr std::array blocks = {
    StandardBlock{"SR", sr_variables, set_dominant},
    StandardBlock{"RS", rs_variables, reset_dominant},
    StandardBlock{"R_TRIG", edge_variables, rising},
    StandardBlock{"F_TRIG", edge_variables, falling},
    StandardBlock{"CTU", up_variables<Elementary::int_>, count_up<std::int16_t>},
    StandardBlock{"CTU_DINT", up_variables<Elementary::dint>, count_up<std::int32_t>},
    StandardBlock{"CTU_LINT", up_variables<Elementary::lint>, count_up<std::int64_t>},
    StandardBlock{"CTU_UDINT", up_variables<Elementary::udint>, count_up<std::uint32_t>},
    StandardBlock{"CTU_ULINT", up_variables<Elementary::ulint>, count_up<std::uint64_t>},
    StandardBlock{"CTD", down_variables<Elementary::int_>, count_down<std::int16_t>},
    StandardBlock{"CTD_DINT", down_variables<Elementary::dint>, count_down<std::int32_t>},
    StandardBlock{"CTD_LINT", down_variables<Elementary::lint>, count_down<std::int64_t>},
    StandardBlock{"CTD_UDINT", down_variables<Elementary::udint>, count_down<std::uint32_t>},
    StandardBlock{"CTD_ULINT", down_variables<Elementary::ulint>, count_down<std::uint64_t>},
    StandardBlock{"CTUD", both_variables<Elementary::int_>, count_both<std::int16_t>},
    StandardBlock{"CTUD_DINT", both_variables<Elementary::dint>, count_both<std::int32_t>},
    StandardBlock{"CTUD_LINT", both_variables<Elementary::lint>, count_both<std::int64_t>},
    StandardBlock{"CTUD_UDINT", both_variables<Elementary::udint>, count_both<std::uint32_t>},
    StandardBlock{"CTUD_ULINT", both_variables<Elementary::ulint>, count_both<std::uint64_t>},
    StandardBlock{"TP", timer_variables<Elementary::time>, pulse},
    StandardBlock{"TP_TIME", timer_variables<Elementary::time>, pulse},
    StandardBlock{"TP_LTIME", timer_variables<Elementary::ltime>, pulse},
    StandardBlock{"TON", timer_variables<Elementary::time>, on_delay},
    StandardBlock{"TON_TIME", timer_variables<Elementary::time>, on_delay},
    StandardBlock{"TON_LTIME", timer_variables<Elementary::ltime>, on_delay},
    StandardBlock{"TOF", timer_variables<Elementary::time>, off_delay},
    StandardBlock{"TOF_TIME", timer_variables<Elementary::time>, off_delay},
    StandardBlock{"TOF_LTIME", timer_variables<Elementary::ltime>, off_delay},
};

}  // namespace

bool on_delay(NativeCall& call) {
  timer_of(call).run_on_delay(call.now);
  return true;
}

std::span<const StandardBlock> standard_blocks() noexcept { return blocks; }

}  // namespace canopus::program
