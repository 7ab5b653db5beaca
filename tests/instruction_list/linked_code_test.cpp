// Lists at random in a rack's CPU: what a machine does to the devices, with its code linked to their memory, and what the same list does by the
// functions of the devices alone.

#include "canopus/program/linked_code.hpp"

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/plc/execution/cpu_devices.hpp"

#include "list_plc.hpp"
#include "support/reference_machine.hpp"

namespace instruction_list_linked_code_test {
namespace {

using namespace canopus;
using list_plc::Family;

template <typename... Texts>
std::string one_of(Texts... texts) {
  return *rc::gen::element(std::string(texts)...);
}
std::string number(int below) { return std::to_string(*rc::gen::inRange(0, below)); }
std::string bit() {
  return *rc::gen::inRange(0, 8) == 0 ? "D" + number(3) + "." + number(10)
                                      : one_of("M", "M", "M", "Y", "X", "L") + number(8);
}
std::string word() { return one_of("D", "D", "D", "R", "Z") + number(5); }
std::string value() { return *rc::gen::inRange(0, 3) == 0 ? "K" + number(20) : word(); }
std::string contact() { return one_of("", "", "", "T", "C").empty() ? bit() : one_of("T", "C") + number(2); }

void add_contacts(std::vector<std::string>& lines, int depth) {
  lines.push_back(*rc::gen::inRange(0, 6) == 0 ? one_of("LD=", "LD<", "LD>") + " " + value() + " " + value()
                                               : one_of("LD", "LDI", "LDP") + " " + contact());
  for (int i = *rc::gen::inRange(0, 6); i > 0; --i) {
    switch (*rc::gen::inRange(0, 8)) {
      case 0:
        if (depth == 0) break;
        add_contacts(lines, depth - 1);
        lines.push_back(one_of("ANB", "ORB"));
        break;
      case 1: lines.push_back(one_of("INV", "MEP")); break;
      case 2: lines.push_back(one_of("AND=", "OR<>") + " " + value() + " " + value()); break;
      case 3: lines.push_back(one_of("ANDP", "ORF") + " " + contact()); break;
      default: lines.push_back(one_of("AND", "ANI", "OR", "ORI") + " " + contact());
    }
  }
}

void add_output(std::vector<std::string>& lines) {
  switch (*rc::gen::inRange(0, 14)) {
    case 0: lines.push_back("OUT T" + number(2) + " K" + number(4)); break;
    case 1: lines.push_back("OUT C" + number(2) + " K" + number(4)); break;
    case 2: lines.push_back("RST C" + number(2)); break;
    case 3: lines.push_back(one_of("INC", "DEC", "INCP", "DINC") + " D" + number(5)); break;
    case 4: lines.push_back(one_of("+", "-", "D+", "D-") + " " + value() + " D" + number(5)); break;
    case 5: lines.push_back(one_of("MOV", "MOVP", "DMOV") + " " + value() + " " + word()); break;
    case 6: lines.push_back("MOV K" + one_of("1", "2", "4") + "M" + number(8) + " " + word()); break;
    case 7: lines.push_back("MOV " + word() + " K" + one_of("1", "2", "4") + "M" + number(8)); break;
    case 8: lines.push_back(one_of("SET", "RST", "PLS", "PLF") + " M" + number(8)); break;
    case 9: lines.push_back("BMOV D0 R0 K" + number(5)); break;
    default: lines.push_back("OUT " + bit());
  }
}

std::vector<std::string> any_list() {
  std::vector<std::string> lines;
  for (int rung = *rc::gen::inRange(1, 20); rung > 0; --rung) {
    if (*rc::gen::inRange(0, 8) == 0) {
      add_contacts(lines, 0);
      lines.push_back("CJ P" + std::to_string(rung));
      add_contacts(lines, 1);
      add_output(lines);
      lines.push_back("P" + std::to_string(rung));
    }
    add_contacts(lines, 2);
    for (int outputs = *rc::gen::inRange(1, 4); outputs > 0; --outputs) add_output(lines);
  }
  lines.emplace_back("END");
  return lines;
}

struct Cpu {
  can::Timeline timeline;
  plc::Rack rack{timeline, list_plc::model_of(Family::q), std::chrono::milliseconds(10)};
  plc::CpuDevices devices{rack};

  Cpu() { rack.power_on(can::Time{}); }
  std::vector<std::uint16_t> words() {
    std::vector<std::uint16_t> all;
    for (const plc::Device device :
         {plc::Device::x, plc::Device::y, plc::Device::m, plc::Device::l, plc::Device::ts, plc::Device::tc,
          plc::Device::cs, plc::Device::cc, plc::Device::d, plc::Device::r, plc::Device::z, plc::Device::tn,
          plc::Device::cn}) {
      std::array<std::uint16_t, 16> some{};
      EXPECT_TRUE(rack.read_words(device, 0, some, can::Time{}));
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }
};

RC_GTEST_PROP(LinkedLists, LeaveTheSameDevices_AsByTheFunctionsOfTheDevices, ()) {
  const std::vector<std::string> lines = any_list();
  const plc::CpuDeviceNames names(list_plc::model_of(Family::q));
  const std::vector<list_plc::il::Source> sources = {{"MAIN.csv", list_plc::csv(lines)}};
  auto made = list_plc::il::compile(sources, Family::q, names);
  RC_ASSERT(list_plc::text(made.errors) == "");
  const std::shared_ptr<const program::Program> program = std::move(made.program);

  Cpu linked;
  Cpu reference;
  program::Machine machine(program);
  testing_support::ReferenceMachine by_functions(program);
  for (int scan = 0; scan < 6; ++scan) {
    const auto inputs = *rc::gen::arbitrary<std::uint16_t>();
    for (Cpu* cpu : {&linked, &reference})
      RC_ASSERT(cpu->rack.write_words(plc::Device::x, 0, std::array{inputs}, can::Time{}).has_value());
    const std::int64_t now = 70'000'000LL * scan;
    const auto a = machine.scan(now, &linked.devices);
    const auto b = by_functions.scan(now, reference.devices);
    RC_ASSERT(a.has_value() == b.has_value());
    RC_ASSERT(linked.words() == reference.words());
    if (a) {
      RC_ASSERT(a->code == b->code);
      RC_ASSERT(a->position.line == b->position.line);
      return;
    }
  }
}

// Otherwise the test above would compare the same with the same.
TEST(LinkedLists, HaveARungAsOneInstruction) {
  const plc::CpuDeviceNames names(list_plc::model_of(Family::q));
  const std::vector<list_plc::il::Source> sources = {
      {"MAIN.csv", list_plc::csv({"LD M0", "ANI M1", "OR M2", "OUT M3", "END"})}};
  const auto made = list_plc::il::compile(sources, Family::q, names);
  Cpu cpu;
  program::LinkedCode linked;
  std::vector<program::Slot> memory = made.program->initial;
  linked.link(*made.program, memory, &cpu.devices);
  const std::uint32_t entry = made.program->functions[made.program->programs.front()].entry;
  const program::Instruction rung = linked.code()[entry];
  EXPECT_TRUE(rung.code == program::Opcode::bits_3);
  EXPECT_TRUE(linked.code()[entry + rung.extra].code == program::Opcode::end);
}

}  // namespace
}  // namespace instruction_list_linked_code_test
