// Every LED row and every error behaviour of spec/me3can1-q/errors.csv against the running module.

#include "scenarios/me3can1_q/error_table.hpp"

namespace canopus::scenario::me3can1_q_led_table_test {
namespace {

// --- LEDs

TEST(Me3ErrorTable, EveryLedRow_IsSeen) {
  RecordProperty("spec", "ME3-LED-001 ME3-LED-003 ME3-LED-006 ME3-LED-009");
  const std::map<std::string, std::function<void(IntelligentScenario&)>> shown_by{
      {"RUN ON", [](IntelligentScenario& s) { s.power_on(); }},
      {"RUN OFF",
       [](IntelligentScenario& s) {
         s.power_on();
         s.plug_in().inject(module::ModuleFault::watchdog_error, s.now());
       }},
      {"ERR. ON", [](IntelligentScenario& s) { s.power_on(), s.write(24, 300); }},
      {"CAN RUN ON", [](IntelligentScenario& s) { s.power_on_layer2(11), s.online(); }},
      {"CAN RUN flickering",
       [](IntelligentScenario& s) {
         s.power_on_as(1);
         for (const std::uint16_t index : Words{0x1F84, 0x1F85, 0x1F86, 0x1F87, 0x1F88})
           s.set_object(index, 5, 7, 4);
         s.set_object(0x1F80, 0, 1, 4);
         s.set_object(0x1F81, 5, 0x0D, 4);
         s.set_object(0x1F89, 0, 1000, 4);
         s.store_objects().restart();
         s.wait_bit(25, 10, true).ignore_tx();
       }},
      {"CAN RUN blinking", [](IntelligentScenario& s) { s.power_on(); }},
      {"CAN RUN single flash", [](IntelligentScenario& s) { s.power_on(), s.nmt(0x02); }},
      {"CAN RUN OFF", [](IntelligentScenario& s) { s.power_on_layer2(29); }},
      {"TX/RX ON", [](IntelligentScenario& s) { s.power_on(), s.rx(0x123, {1}); }},
      {"CAN ERR ON", [](IntelligentScenario& s) { s.power_on(), s.error_counters(256, 0); }},
      {"CAN ERR blinking", [](IntelligentScenario& s) { s.power_on(), s.write(24, 300); }},
      {"CAN ERR double flash",
       [](IntelligentScenario& s) {
         s.power_on();
         s.set_object(0x1016, 1, 0x00020064, 4);
         s.rx(0x702, {0x05}).advance(100ms);
       }},
      {"CAN ERR single flash", [](IntelligentScenario& s) { s.power_on(), s.error_counters(96, 0); }},
      {"CAN ERR OFF", [](IntelligentScenario& s) { s.power_on(); }},
  };
  for (const SpecRow& row : rows_of("LED", 15)) {
    const std::string& text = row["code"];
    IntelligentScenario s;
    const std::string key = text == "CAN ERR flickering" ? "CAN RUN flickering" : text;
    ASSERT_TRUE(shown_by.contains(key)) << row.place << ' ' << text;
    shown_by.at(key)(s);
    bool found = false;
    for (const module::Led& led : s.plug_in().leds(s.now())) {
      const std::string name(led.name);
      if (!text.starts_with(name + " ")) continue;
      found = true;
      std::string pattern = text.substr(name.size() + 1);
      if (pattern == "ON" || pattern == "OFF") pattern = pattern == "ON" ? "on" : "off";
      EXPECT_EQ(module::name(led.pattern), pattern) << row.place << ' ' << text;
    }
    EXPECT_TRUE(found) << text;
    s.ignore_tx();
    s.controller().sent.clear();
  }
}

// --- 1029H

TEST(Me3ErrorTable, EveryErrorBehavior_OnEveryCause) {
  RecordProperty("spec", "ME3-EB-001 ME3-EB-002 ME3-EB-003 ME3-EB-005 ME3-EB-006");
  const std::map<std::string, std::function<void(IntelligentScenario&)>> failures{
      {"bus-off", [](IntelligentScenario& s) { s.error_counters(256, 0); }},
      {"heartbeat",
       [](IntelligentScenario& s) {
         s.set_object(0x1016, 1, 0x00020064, 4);
         s.rx(0x702, {0x05}).advance(100ms);
       }},
      {"life guarding",
       [](IntelligentScenario& s) {
         s.set_object(0x100C, 0, 100, 2);
         s.set_object(0x100D, 0, 1, 1);
         s.rx_remote(0x701, 1).advance(100ms);
       }},
      {"internal failure",
       [](IntelligentScenario& s) { s.plug_in().inject(module::ModuleFault::hardware_error, s.now()); }},
      {"CPU stop", [](IntelligentScenario& s) { s.cpu(module::CpuState::stop); }},
  };
  for (const SpecRow& row : rows_of("Error behavior 1029H/01", 3)) {
    const auto value = static_cast<std::uint16_t>(row.number("code"));
    for (const auto& [name, fail] : failures) {
      for (const bool was_operational : {true, false}) {
        IntelligentScenario s;
        s.power_on_as(1);
        s.set_object(0x1029, 1, value, 1);
        if (was_operational) s.nmt(0x01, 1).expect(25, 0x0201);
        fail(s);
        const std::uint16_t unchanged = was_operational ? 0x0201 : 0x0100;
        const std::uint16_t after = value == 2                         ? 0x0000
                                    : value == 1 && name != "CPU stop" ? unchanged
                                                                       : 0x0100;
        EXPECT_EQ(s.read(25), after) << row.place << ' ' << name;
        // Start: refused only while the CPU is in STOP, and then only with 0 and 2.
        s.nmt(0x01, 1);
        EXPECT_EQ(s.read(25), name != "CPU stop" || value == 1 ? 0x0201 : after) << row.place << ' ' << name;
        s.ignore_tx();
      }
    }
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_led_table_test
