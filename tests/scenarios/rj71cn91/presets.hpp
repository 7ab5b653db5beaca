#pragma once
// What stands in a module's object dictionary before its first start.

#include "canopus/canopen/dictionary/object_dictionary.hpp"

#include "scenarios/me3can1_q/concise_dcf.hpp"
#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::rj71cn91_presets {

struct PresetObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint32_t value = 0;
  unsigned length = 4;  ///< bytes
};

/// An RJ71CN91 with this node-ID and these objects stored, and this pause before each command of the start-up (G70, ms);
/// supply on up to its boot-up frame.
inline void start_with_delay(IntelligentScenario& s, std::uint16_t delay, std::uint8_t node_id,
                             const std::vector<PresetObject>& objects, Where where = Where::current()) {
  ASSERT_TRUE(s.plug_in().preset_node_id(node_id));
  ASSERT_TRUE(s.plug_in().preset_word(70, delay));
  for (const PresetObject& object : objects) {
    EXPECT_EQ(s.plug_in().preset_object(object.index, object.sub,
                                        canopen::little_endian(object.value, object.length)),
              canopen::AbortCode::none)
        << std::hex << object.index;
  }
  s.supply_on().wait_tx(0x700U + node_id, {0x00}, 20s, where);
}

/// The same without a pause, so that a test sees at once what a slave's boot leads to.
inline void start_as(IntelligentScenario& s, std::uint8_t node_id, const std::vector<PresetObject>& objects,
                     Where where = Where::current()) {
  start_with_delay(s, 0, node_id, objects, where);
}

/// The NMT master's questions and a slave's answers.
inline const Bytes ask_1000{0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0};
inline const Bytes is_0191{0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00};
inline const Bytes no_error(8, 0);

/// The slave's boot-up message and its answer to the question for 1000H.
inline void boots(IntelligentScenario& s, std::uint8_t node_id, Where where = Where::current()) {
  s.rx(0x700U + node_id, {0x00}).wait_tx(0x600U + node_id, ask_1000, 20s, where);
  s.rx(0x580U + node_id, is_0191);
}

/// EMCY 8F00H + node-ID of module `own`.
inline void expect_node_lost(IntelligentScenario& s, std::uint8_t own, std::uint8_t node_id,
                             Where where = Where::current()) {
  s.wait_tx(0x080U + own, {node_id, 0x8F, 0x11, 0, 0, 0, 0, 0}, 20s, where);
}

/// Codes of the events since the history had `first` entries.
inline std::vector<std::uint16_t> event_codes(IntelligentScenario& s, std::size_t first = 0) {
  std::vector<std::uint16_t> codes;
  const auto history = s.plug_in().event_history();
  for (std::size_t i = first; i < history.size(); ++i) codes.push_back(history[i].code);
  return codes;
}

/// Codes of the errors that module diagnostics show.
inline std::vector<std::uint16_t> error_codes(IntelligentScenario& s) {
  std::vector<std::uint16_t> codes;
  for (const auto& error : s.plug_in().module_errors()) codes.push_back(error.code);
  return codes;
}

}  // namespace canopus::scenario::rj71cn91_presets
