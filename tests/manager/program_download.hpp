#pragma once
// A master whose slave takes programs.

#include <gmock/gmock.h>

#include "canopus/manager/configuration/configuration_manager.hpp"

#include "master_bench.hpp"

namespace canopus::manager::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

inline const ScriptedSlave::Key data{0x1F50, 1};
inline const ScriptedSlave::Key control{0x1F51, 1};
inline const ScriptedSlave::Key version{0x1F56, 1};
inline const ScriptedSlave::Key flash{0x1F57, 1};

/// Node 2 takes programs: it runs version 11H, 22H is expected, "0123456789" is the program for it.
class ProgramDownload : public MasterBench {
 public:
  ProgramDownload() {
    object(0x1F80, 0, 0x01);
    object(0x1F81, 2, 0x6D);  // assigned, boot slave, mandatory, check version, update allowed
    object(0x1F55, 2, 0x22);
    programs[2] = {'0', '1', '2', '3', '4', '5', '6', '7', '8', '9'};
    slave(2);
    device().objects[control] = {1};
    device().objects[version] = {0x11, 0, 0, 0};
    device().objects[flash] = {0, 0, 0, 0};
    device().on_write = [this](const ScriptedSlave::Key& key) {
      if (key == data) {
        device().objects[version] = {new_version, 0, 0, 0};
        downloaded = device().objects[data];
      }
      return key == control ? on_control(device().objects[control][0]) : 0U;
    };
    on_control = [this](std::uint8_t command) {
      if (command == 3) device().objects[control] = {2};
      return 0U;
    };
  }
  ScriptedSlave& device() { return slaves.front(); }
  [[nodiscard]] const BootRecord& record() const { return master.boot_record(2); }
  [[nodiscard]] std::string words() const { return explain(record(), 2, now); }

  std::function<std::uint32_t(std::uint8_t command)> on_control;
  std::uint8_t new_version = 0x22;
  Bytes downloaded;
};

}  // namespace canopus::manager::test
