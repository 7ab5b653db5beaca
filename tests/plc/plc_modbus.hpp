#pragma once
// A PLC with a Modbus map of some of everything.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/plc/modbus/as300_map.hpp"
#include "canopus/plc/modbus/session.hpp"

#include "plc/conversation.hpp"

namespace canopus::plc {

using modbus::Table;
using testing::bytes;
using testing::shown;

inline modbus::Settings some_map() {
  modbus::Settings settings;
  const auto add = [&](Table table, modbus::Range range) { EXPECT_TRUE(settings.map.add(table, range)); };
  add(Table::coils, {0, 64, {false, Device::y, 0, 0}});
  add(Table::coils, {64, 64, {false, Device::m, 0, 0}});           // goes on behind the outputs
  add(Table::coils, {1000, 32, {true, Device::d, 0x30, 0}});       // bits of U3\G0 and U3\G1
  add(Table::coils, {2000, 8, {false, Device::m, 0, 100}, true});  // to be read only
  add(Table::discrete_inputs, {0, 64, {false, Device::x, 0, 0}});
  add(Table::holding_registers, {0, 200, {false, Device::d, 0, 0}});
  add(Table::holding_registers, {200, 100, {true, Device::d, 0x00, 10000}});
  add(Table::holding_registers, {300, 4, {false, Device::m, 0, 0}});      // 16 points each
  add(Table::holding_registers, {400, 600, {true, Device::d, 0x30, 0}});  // the module has 512 words
  add(Table::holding_registers, {5000, 1, {true, Device::d, 0x500, 0}});  // no module
  add(Table::input_registers, {0, 10, {false, Device::sd, 0, 200}});
  settings.identification.objects = {"Canopus", "R04CPU", "1.0", "", "PLC", "", ""};
  return settings;
}

struct ModbusPlc : testing::Plc {
  explicit ModbusPlc(modbus::Settings the_settings = some_map(),
                     WritePermission permission = WritePermission::always, const CpuModel& model = r04cpu())
      : Plc(model),
        settings(std::move(the_settings)),
        modbus(std::make_unique<modbus::Session>(rack, settings, permission)) {}

  std::string raw_modbus(std::string_view request) {
    std::string reply;
    while (!request.empty() && !modbus->over()) {
      const auto space = modbus->space();
      const std::size_t count = std::min(space.size(), request.size());
      std::copy_n(request.begin(), count, space.begin());
      modbus->received(count);
      request.remove_prefix(count);
      while (modbus->process(now) != 0 || !modbus->output().empty()) {
        const auto output = modbus->output();
        reply.append(output.begin(), output.end());
        modbus->sent(output.size());
      }
    }
    return reply;
  }
  /// Function and data in, function and data out, as hexadecimal text.
  std::string pdu(const std::string& text) {
    const std::string data = bytes(text);
    std::string request = bytes("12 34 00 00 00 00 ff") + data;
    request[4] = static_cast<char>((data.size() + 1) >> 8U);
    request[5] = static_cast<char>(data.size() + 1);
    const std::string reply = raw_modbus(request);
    if (reply.size() < 8) return shown(reply);
    EXPECT_EQ(shown(reply.substr(0, 4)), "12 34 00 00");
    EXPECT_EQ(static_cast<std::size_t>(static_cast<unsigned char>(reply[5])), reply.size() - 6);
    return shown(reply.substr(7));
  }

  modbus::Settings settings;
  std::unique_ptr<modbus::Session> modbus;
};

}  // namespace canopus::plc
