#pragma once
// The scenario language with the shorthands of spec/me3can1-q/scenarios.md, for MELSEC's intelligent function modules:
// the ME3CAN1-Q and the RJ71CN91. What both manuals say alike is one test that runs with both:
//
//   CANOPUS_OF_BOTH_MODULES(Signals);
//   TEST_P(Signals, X11_...) {
//     spec("ME3-IO-019", "RJ71-EMCY-015");
//     IntelligentScenario s(GetParam());

#include <memory>
#include <string_view>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"
#include "canopus/module/models/rj71cn91/rj71cn91.hpp"

#include "scenarios/scenario.hpp"

namespace canopus::scenario {

inline constexpr std::string_view me3can1_q = "ME3CAN1-Q";
inline constexpr std::string_view rj71cn91 = "RJ71CN91";

[[nodiscard]] std::unique_ptr<module::ModuleEngine> make_module(std::string_view model,
                                                                can::Controller& controller,
                                                                module::NonVolatileMemory& memory);

/// Holds what must live longer than a scenario's steps: the module's memory, its controller, the module.
struct IntelligentBench {
  explicit IntelligentBench(std::string_view model) : module(make_module(model, bus, memory)) {}
  RamMemory memory;
  FreeBus bus;
  std::unique_ptr<module::ModuleEngine> module;
};

class IntelligentScenario : private IntelligentBench, public ModuleScenario {
 public:
  explicit IntelligentScenario(std::string_view model = me3can1_q)
      : IntelligentBench(model), ModuleScenario(*IntelligentBench::module, IntelligentBench::bus) {}

  [[nodiscard]] RamMemory& flash() { return memory; }
  [[nodiscard]] FreeBus& controller() { return bus; }
  [[nodiscard]] module::ModuleEngine& plug_in() { return *IntelligentBench::module; }
  [[nodiscard]] std::uint32_t inputs() const { return signals_->inputs(); }
  [[nodiscard]] std::uint32_t outputs() const { return signals_->outputs(); }
  [[nodiscard]] bool is_rj71cn91() { return plug_in().model() == rj71cn91; }
  /// What clears latched errors: 0 to G29, or YF where G29 takes no writes.
  IntelligentScenario& clear_errors();

  /// Supply on, initialization over, boot-up frame gone by.
  IntelligentScenario& power_on(Where where = Where::current());
  /// As a node with another node-ID than the factory's 127, settings saved.
  IntelligentScenario& power_on_as(std::uint8_t node_id, Where where = Where::current());
  /// As node 1, Operational, its frames gone by.
  IntelligentScenario& power_on_operational(Where where = Where::current());
  /// As node 1 and active NMT master, started anew: Pre-operational, no slaves, its frames gone by.
  IntelligentScenario& power_on_as_master(Where where = Where::current());
  /// In a Layer 2 mode (11 or 29), saved, started anew, offline.
  IntelligentScenario& power_on_layer2(std::uint16_t mode = 11, Where where = Where::current());
  /// Y03=1 -> X03 1. What the RJ71CN91 sends then does not matter.
  IntelligentScenario& online(Where where = Where::current());
  /// Y03=0 -> X03 0.
  IntelligentScenario& offline(Where where = Where::current());
  /// `save`: G22=1; Y1F=1; wait X1F -> 1 (G22 -> 0); Y1F=0.
  IntelligentScenario& save(std::uint16_t g22 = 1, Where where = Where::current());
  /// `restart`: Y02=1; wait X02 -> 1; Y02=0. The frames of the restart do not matter.
  IntelligentScenario& restart(Where where = Where::current());
  /// Command words to G1000 on, then `cif`: Y17=1; wait X17 -> 1; Y17=0; X17 -> 0.
  IntelligentScenario& cif(const Words& command, Where where = Where::current());
  /// The command at G1000 failed with this SDO abort code: error 000FH, class 0003H (SDO), the node, the code.
  IntelligentScenario& expect_abort(std::uint32_t code, std::uint16_t node = 0,
                                    Where where = Where::current());
  /// Y01=1; wait X01 -> 1; Y01=0; X01 -> 0.
  IntelligentScenario& exchange(Where where = Where::current());
  /// Writes an object of the module itself through the CIF (node 0), which must succeed.
  IntelligentScenario& set_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length,
                                  Where where = Where::current());
  /// Reads an object of the module itself through the CIF (node 0), which must succeed and have this value.
  IntelligentScenario& expect_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                                     unsigned length, Where where = Where::current());
  /// NMT master's command to this node or all.
  IntelligentScenario& nmt(std::uint8_t command, std::uint8_t node = 0);
  /// 1010H/01 = "save".
  IntelligentScenario& store_objects(Where where = Where::current());

 private:
  IntelligentScenario& request(unsigned number, Where where);
};

/// What the LED of this name does.
inline module::LedPattern led(IntelligentScenario& s, std::string_view name) {
  for (const module::Led& each : s.plug_in().leds(s.now())) {
    if (each.name == name) return each.pattern;
  }
  ADD_FAILURE() << "no LED " << name;
  return module::LedPattern::off;
}

/// A test that runs with both modules; GetParam() is the model.
class OfBothModules : public testing::TestWithParam<std::string_view> {
 protected:
  /// The rows of each module's features.csv that the test shows.
  void spec(const char* of_me3can1_q, const char* of_rj71cn91) {
    RecordProperty("spec", is_rj71cn91() ? of_rj71cn91 : of_me3can1_q);
  }
  [[nodiscard]] static bool is_rj71cn91() { return GetParam() == rj71cn91; }
  /// What the model at hand shows where the two differ.
  [[nodiscard]] static std::uint16_t either(std::uint16_t of_me3can1_q, std::uint16_t of_rj71cn91) {
    return is_rj71cn91() ? of_rj71cn91 : of_me3can1_q;
  }
};

// NOLINTBEGIN(cppcoreguidelines-macro-usage): GoogleTest's own way
#define CANOPUS_OF_BOTH_MODULES(suite)                                                                  \
  class suite : public OfBothModules {};                                                                \
  INSTANTIATE_TEST_SUITE_P(Module, suite, testing::Values(me3can1_q, rj71cn91), [](const auto& model) { \
    return model.param == rj71cn91 ? "RJ71CN91" : "ME3CAN1Q";                                           \
  })
// NOLINTEND(cppcoreguidelines-macro-usage)

}  // namespace canopus::scenario
