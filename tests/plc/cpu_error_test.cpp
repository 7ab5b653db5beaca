// What a run-time error leaves in each family's CPU: STOP, the error code in its registers, and the line of the source.

#include "canopus/plc/execution/cpu_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/structured_text/compiler.hpp"

namespace canopus::plc::cpu_error_test {
namespace {

using namespace std::chrono_literals;

struct FamilyCase {
  const CpuModel* model;
  const char* code_register;      // of an error in an instruction
  const char* watchdog_register;  // of a scan that takes too long
  const char* first_relay;        // ON with an error
};

struct ErrorCase {
  const char* name;
  std::string program;   // the error is in line 4
  const char* text;      // how the report ends
  unsigned q, iqr, fx3;  // codes
  bool is_watchdog = false;
};

/// 70 functions, each of which calls the next one.
std::string deep_calls() {
  std::string functions;
  for (int i = 70; i > 0; --i)
    functions += "FUNCTION F" + std::to_string(i) + " : INT F" + std::to_string(i) +
                 " := " + (i == 70 ? std::string("1") : "F" + std::to_string(i + 1) + "()") +
                 "; END_FUNCTION ";
  return functions + "\nPROGRAM P\n\nD0 := F1();\nEND_PROGRAM";
}

const std::vector<ErrorCase> cases = {
    {"division by zero", "PROGRAM P\nVAR n : INT; END_VAR\n\nD0 := 5 / n;\nEND_PROGRAM", "division by zero",
     4100, 0x3400, 6706},
    {"value", "PROGRAM P\nVAR r : REAL := 1.0E9; END_VAR\n\nD0 := REAL_TO_INT(r);\nEND_PROGRAM",
     "value 1000000000 is outside of -32768 to 32767", 4100, 0x3401, 6706},
    {"BCD",
     "PROGRAM P\nVAR w : WORD := 16#A; END_VAR\n\nD0 := UINT_TO_INT(WORD_BCD_TO_UINT(w));\nEND_PROGRAM", "",
     4100, 0x3401, 6706},
    {"text", "PROGRAM P\nVAR s : STRING := 'x'; END_VAR\n\nD0 := STRING_TO_INT(s);\nEND_PROGRAM", "", 4100,
     0x3401, 6706},
    {"array", "PROGRAM P\nVAR a : ARRAY[1..10] OF INT; n : INT := 11; END_VAR\n\nD0 := a[n];\nEND_PROGRAM",
     "array index 11 is outside of 1 to 10", 4101, 0x2820, 6706},
    {"device", "PROGRAM P\n\nZ0 := 32767;\nD1 := D5000Z0;\nEND_PROGRAM",
     "D5000Z0: the CPU or the module has no such device", 4101, 0x2820, 6706},
    {"module", "PROGRAM P\n\n\nD1 := U7\\G0;\nEND_PROGRAM", "there is no module", 2110, 0x2801, 6708},
    {"watchdog", "PROGRAM P\n\n\nWHILE TRUE DO D0 := 1; END_WHILE;\nEND_PROGRAM",
     "the scan takes too long: a loop may not end", 5001, 0x3000, 6105, true},
};

class ErrorOfFamily : public ::testing::TestWithParam<FamilyCase> {};

INSTANTIATE_TEST_SUITE_P(Families, ErrorOfFamily,
                         ::testing::Values(FamilyCase{&q03udvcpu(), "SD0", "SD0", "SM0"},
                                           FamilyCase{&r04cpu(), "SD0", "SD0", "SM0"},
                                           FamilyCase{&fx5u(), "SD0", "SD0", "SM0"},
                                           FamilyCase{&fx3u(), "D8067", "D8061", "M8004"},
                                           FamilyCase{&as300(), "", "", ""}),
                         [](const auto& test) {
                           std::string name(test.param.model->name);
                           std::erase_if(name, [](char c) { return c == '-' || c == ' '; });
                           return name;
                         });

std::uint16_t word(Rack& rack, const std::string& name, can::Time now) {
  CpuDevices devices(rack);
  devices.set_time(now);
  const auto point = CpuDeviceNames(rack.model()).point(name);
  std::uint16_t word = 0;
  std::uint32_t bit = 0;
  if (!point) return 0xFFFF;
  if (!point->is_bit)
    return devices.read_words(*point, {&word, 1}) == program::DeviceError::none ? word : 0xFFFF;
  return devices.read_bits(*point, 1, bit) == program::DeviceError::none ? static_cast<std::uint16_t>(bit)
                                                                         : 0xFFFF;
}

TEST_P(ErrorOfFamily, StopsTheCpuWithItsCodeAndTheLine) {
  const FamilyCase& family = GetParam();
  std::vector<ErrorCase> all = cases;
  all.push_back({"calls", deep_calls(), "", 4210, 0x3361, 6702});
  for (const ErrorCase& each : all) {
    SCOPED_TRACE(each.name);
    const CpuDeviceNames names(*family.model);
    std::string text = each.program;
    if (family.model->family == CpuFamily::as300) {  // it has no Z, and other addresses of modules
      if (std::string_view("device module").contains(each.name)) continue;
    }
    const std::vector<structured_text::Source> sources = {{"main.st", text}};
    auto made = structured_text::compile(sources, &names);
    ASSERT_TRUE(made.errors.empty()) << made.errors.front().message;
    can::Timeline timeline;
    Rack rack(timeline, *family.model, 5ms);
    std::vector<std::string> reports;
    ProgramExecution execution(timeline, rack, {.program = std::move(made.program)},
                               [&](const std::string& report, can::Time) { reports.push_back(report); });
    rack.power_on(can::Time{});
    timeline.run_until(can::Time{10ms});
    EXPECT_EQ(rack.cpu_state(), module::CpuState::stop);
    ASSERT_EQ(reports.size(), 1U);
    EXPECT_THAT(reports[0], ::testing::EndsWith(each.text));
    ASSERT_TRUE(execution.error());
    EXPECT_EQ(execution.error()->position.line, each.name == std::string("calls") ? 1U : 4U);
    const unsigned expected = family.model->family == CpuFamily::as300 ? 0
                              : family.model->family == CpuFamily::q   ? each.q
                              : family.model->family == CpuFamily::fx3 ? each.fx3
                                                                       : each.iqr;
    EXPECT_EQ(execution.error()->code, expected);
    if (expected == 0) continue;
    const can::Time now = timeline.now();
    EXPECT_EQ(word(rack, each.is_watchdog ? family.watchdog_register : family.code_register, now), expected);
    EXPECT_EQ(word(rack, family.first_relay, now), 1);
    rack.set_cpu_state(module::CpuState::stop, now);
    EXPECT_EQ(word(rack, each.is_watchdog ? family.watchdog_register : family.code_register, now), expected)
        << "until RUN";
  }
}

}  // namespace
}  // namespace canopus::plc::cpu_error_test
