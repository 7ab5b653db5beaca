// A device held against its DCF, written, refused, and cut off in the middle.

#include "canopus/master/device_configuration.hpp"

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "canopus/can/little_endian.hpp"
#include "canopus/eds/configuration_text.hpp"

#include "paths.hpp"

namespace canopus::master::device_configuration_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string drive_eds() {
  std::ifstream file(CANOPUS_SOURCE_DIR "/examples/devices/drive.eds", std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The DCF of node 5 with these values.
std::shared_ptr<const eds::DeviceFile> dcf(
    const std::vector<std::pair<text::ObjectName, std::string>>& values) {
  eds::IniText text(drive_eds());
  for (const auto& [object, value] : values) {
    const auto done = eds::set_parameter_value(text, object.index, object.sub, value);
    EXPECT_TRUE(done) << done.error();
  }
  return eds::read_device_file(text.text()).file;
}

/// Has what its EDS says, but for what is changed.
class Device final : public ObjectAccess {
 public:
  std::map<std::pair<unsigned, unsigned>, Bytes> values;
  std::map<std::pair<unsigned, unsigned>, canopen::DataType> types;  // as which they were read
  std::set<std::pair<unsigned, unsigned>> refused;
  std::size_t answers = 1000;  // the supply fails after so many
  std::string log;

  void set(unsigned index, unsigned sub, std::uint64_t value, unsigned length) {
    values[{index, sub}] = can::little_endian(value, length);
  }
  std::expected<Bytes, Failure> read(text::ObjectName object, canopen::DataType type) override {
    types[{object.index, object.sub}] = type;
    if (answers == 0) return std::unexpected(Failure{false, "no answer"});
    --answers;
    if (const auto found = values.find({object.index, object.sub}); found != values.end())
      return found->second;
    const auto& dictionary = *file_->dictionary;
    const auto entry = dictionary.find(object.index, object.sub);
    if (!entry) return std::unexpected(Failure{true, "no object"});
    if (canopen::is_variable_length(entry.description->type)) return dictionary.default_slot(entry.offset);
    return can::little_endian(dictionary.default_value(entry, 5), entry.description->length);
  }
  std::expected<void, Failure> write(text::ObjectName object, std::span<const std::uint8_t> value) override {
    if (answers == 0) return std::unexpected(Failure{false, "no answer"});
    --answers;
    log += fmt::format("{:04X}:{:02X}={:X}\n", object.index, object.sub, can::load_value(value));
    if (refused.contains({object.index, object.sub})) return std::unexpected(Failure{true, "value range"});
    values[{object.index, object.sub}] = Bytes(value.begin(), value.end());
    return {};
  }

 private:
  std::shared_ptr<const eds::DeviceFile> file_ = eds::read_device_file(drive_eds()).file;
};

std::string_view name(ComparedValue::State state) {
  constexpr std::string_view names[] = {"same", "different", "refused", "not answered"};
  return names[static_cast<unsigned>(state)];
}
std::string_view name(WriteStep::State state) {
  constexpr std::string_view names[] = {"not tried", "written", "refused", "not answered"};
  return names[static_cast<unsigned>(state)];
}

std::string shown(const std::vector<ComparedValue>& values) {
  std::string text;
  for (const ComparedValue& value : values) {
    text += fmt::format("{:04X}:{:02X} {:X} {}", value.object.index, value.object.sub,
                        can::load_value(value.wanted), name(value.state));
    if (!value.found.empty()) text += fmt::format(" {:X}", can::load_value(value.found));
    text += '\n';
  }
  return text;
}
std::string shown(const std::vector<WriteStep>& steps) {
  std::string text;
  for (const WriteStep& step : steps) {
    text += fmt::format("{:04X}:{:02X}={:X} {}\n", step.object.index, step.object.sub,
                        can::load_value(step.value), name(step.state));
  }
  return text;
}

TEST(DeviceConfiguration, WhatTheDcfConfigures_IsCompared) {
  const auto file = dcf({{{0x1017, 0}, "500"}, {{0x1016, 1}, "0x00030300"}, {{0x6081, 0}, "2000"}});
  Device device;
  device.set(0x1017, 0, 500, 2);
  device.set(0x6081, 0, 1500, 4);
  EXPECT_EQ(shown(compare_configuration(*file, 5, device, {})),
            "1016:01 30300 different 0\n"
            "1017:00 1F4 same 1F4\n"
            "6081:00 7D0 different 5DC\n");
}

TEST(DeviceConfiguration, EveryValue_IsReadByItsType) {
  const auto file = dcf({{{0x1017, 0}, "500"}, {{0x1016, 1}, "0x00030300"}, {{0x6060, 0}, "1"}});
  Device device;
  (void)compare_configuration(*file, 5, device, {});
  (void)compare_identity(*file, device);
  using enum canopen::DataType;
  EXPECT_EQ(device.types.at({0x1017, 0}), unsigned16);
  EXPECT_EQ(device.types.at({0x1016, 1}), unsigned32);
  EXPECT_EQ(device.types.at({0x6060, 0}), integer8);
  EXPECT_EQ(device.types.at({0x1018, 2}), unsigned32);
}

TEST(DeviceConfiguration, WhatCannotBeRead_IsSaid_AndSilenceEndsIt) {
  const auto file = dcf({{{0x1016, 1}, "1"}, {{0x1017, 0}, "500"}, {{0x6081, 0}, "2000"}});
  Device device;
  device.answers = 1;
  const auto values = compare_configuration(*file, 5, device, {});
  EXPECT_EQ(shown(values), "1016:01 1 different 0\n1017:00 1F4 not answered\n6081:00 7D0 not answered\n");
  EXPECT_EQ(values[1].reason, "no answer");
  EXPECT_EQ(values[2].reason, "");
}

TEST(DeviceConfiguration, Progress_CanEndIt) {
  const auto file = dcf({{{0x1016, 1}, "1"}, {{0x1017, 0}, "500"}});
  Device device;
  std::string log;
  const auto values = compare_configuration(*file, 5, device, [&](std::size_t done, std::size_t of) {
    log += fmt::format("{}/{} ", done, of);
    return done < 1;
  });
  EXPECT_EQ(log, "0/2 1/2 ");
  EXPECT_EQ(values[1].state, ComparedValue::State::not_answered);
}

TEST(DeviceConfiguration, Identity_IsWhatTheFileSays) {
  Device device;
  device.set(0x1018, 2, 0x999, 4);
  EXPECT_EQ(shown(compare_identity(*dcf({}), device)),
            "1000:00 20192 same 20192\n1018:02 402 different 999\n1018:03 10000 same 10000\n");
}

TEST(DeviceConfiguration, Changed_IsConfigurationAndNotProcessData) {
  const auto file = dcf({{{0x1017, 0}, "500"}});
  Device device;
  device.set(0x1017, 0, 500, 2);
  device.set(0x6081, 0, 1500, 4);  // profile velocity
  device.set(0x6040, 0, 0x0F, 2);  // controlword: process data
  device.set(0x1003, 0, 3, 1);     // errors that were
  device.set(0x1800, 1, 0x1AB, 4);
  EXPECT_EQ(shown(find_changed(*file, 5, device, {})),
            "1800:01 185 different 1AB\n6081:00 3E8 different 5DC\n");
}

TEST(DeviceConfiguration, Writes_AreWhatDiffers_APdoAsAWhole) {
  const auto file = dcf({{{0x1017, 0}, "500"},
                         {{0x1800, 1}, "0x1AB"},
                         {{0x1A00, 0}, "2"},
                         {{0x1A00, 2}, "0x60610008"},
                         {{0x1801, 2}, "1"}});
  Device device;
  device.set(0x1017, 0, 500, 2);
  device.set(0x1801, 2, 1, 1);
  auto steps = plan_writes(*file, 5, compare_configuration(*file, 5, device, {}));
  EXPECT_EQ(shown(steps),
            "1800:01=800001AB not tried\n"
            "1A00:00=0 not tried\n"
            "1A00:02=60610008 not tried\n"
            "1A00:00=2 not tried\n"
            "1800:01=1AB not tried\n");
  write(steps, device, {});
  EXPECT_EQ(device.log, "1800:01=800001AB\n1A00:00=0\n1A00:02=60610008\n1A00:00=2\n1800:01=1AB\n");
  for (const ComparedValue& value : compare_configuration(*file, 5, device, {})) {
    EXPECT_EQ(value.state, ComparedValue::State::same);
  }
  EXPECT_TRUE(plan_writes(*file, 5, compare_configuration(*file, 5, device, {})).empty());
}

TEST(DeviceConfiguration, ARefusedMapping_LeavesThePdoOff_AndTheRestIsWritten) {
  const auto file = dcf({{{0x1800, 1}, "0x1AB"}, {{0x1A00, 1}, "0x60610008"}, {{0x6081, 0}, "2000"}});
  Device device;
  device.refused = {{0x1A00, 1}};
  auto steps = plan_writes(*file, 5, compare_configuration(*file, 5, device, {}));
  write(steps, device, {});
  EXPECT_EQ(shown(steps),
            "1800:01=800001AB written\n"
            "1A00:00=0 written\n"
            "1A00:01=60610008 refused\n"
            "1A00:00=1 not tried\n"
            "1800:01=1AB not tried\n"
            "6081:00=7D0 written\n");
  EXPECT_EQ(steps[3].reason, "not tried: the PDO stays off, as another part of it was refused");
  EXPECT_EQ(shown(compare_configuration(*file, 5, device, {})),
            "1800:01 1AB different 800001AB\n1A00:01 60610008 different 60410010\n6081:00 7D0 same 7D0\n");
}

TEST(DeviceConfiguration, APowerCut_LeavesTheRestUntried) {
  const auto file = dcf({{{0x1016, 1}, "1"}, {{0x1017, 0}, "500"}, {{0x6081, 0}, "2000"}});
  Device device;
  auto steps = plan_writes(*file, 5, compare_configuration(*file, 5, device, {}));
  device.answers = 1;
  write(steps, device, {});
  EXPECT_EQ(shown(steps), "1016:01=1 written\n1017:00=1F4 not answered\n6081:00=7D0 not tried\n");
  EXPECT_EQ(steps[1].reason, "no answer");
}

TEST(DeviceConfiguration, TheDateOfTheConfiguration_ComesLast_AndNotAfterAFailure) {
  const std::string with_date =
      drive_eds() +
      "[1020]\nParameterName=Verify configuration\nObjectType=8\nSubNumber=3\n"
      "[1020sub0]\nParameterName=n\nDataType=5\nAccessType=ro\nDefaultValue=2\n"
      "[1020sub1]\nParameterName=date\nDataType=7\nAccessType=rw\nParameterValue=100\n"
      "[1020sub2]\nParameterName=time\nDataType=7\nAccessType=rw\nParameterValue=200\n";
  eds::IniText text(with_date);
  ASSERT_TRUE(eds::set_parameter_value(text, 0x1017, 0, "500"));
  ASSERT_TRUE(eds::set_parameter_value(text, 0x6081, 0, "2000"));
  const auto file = eds::read_device_file(text.text()).file;
  Device device;
  device.set(0x1020, 1, 100, 4);
  device.set(0x1020, 2, 200, 4);
  device.refused = {{0x1017, 0}};
  auto steps = plan_writes(*file, 5, compare_configuration(*file, 5, device, {}));
  write(steps, device, {});
  EXPECT_EQ(shown(steps),
            "1017:00=1F4 refused\n6081:00=7D0 written\n1020:01=64 not tried\n1020:02=C8 not tried\n");
  device.refused.clear();
  steps = plan_writes(*file, 5, compare_configuration(*file, 5, device, {}));
  write(steps, device, {});
  EXPECT_EQ(shown(steps), "1017:00=1F4 written\n1020:01=64 written\n1020:02=C8 written\n");
}

TEST(DeviceConfiguration, CommandsAndWhatIsNotToBeRead_AreLeftAlone) {
  const std::string with_more =
      drive_eds() +
      "[1010]\nParameterName=Store\nObjectType=8\nSubNumber=2\n[1010sub0]\nDataType=5\nAccessType="
      "ro\nDefaultValue=1\n"
      "[1010sub1]\nDataType=7\nAccessType=rw\nParameterValue=1\n"
      "[2000]\nParameterName=reset at read\nDataType=7\nAccessType=rw\nObjFlags=2\nParameterValue=7\n"
      "[2001]\nParameterName=plain\nDataType=7\nAccessType=rw\nParameterValue=7\n";
  const auto file = eds::read_device_file(with_more).file;
  Device device;
  device.set(0x1010, 1, 3, 4);
  device.set(0x2000, 0, 3, 4);
  device.set(0x2001, 0, 3, 4);
  EXPECT_EQ(shown(compare_configuration(*file, 5, device, {})), "2001:00 7 different 3\n");
  EXPECT_EQ(shown(find_changed(*file, 5, device, {})), "2001:00 7 different 3\n");
}

TEST(DeviceConfiguration, Values_AreWrittenAsDcfsHaveThem) {
  using canopen::DataType;
  const auto text = [](unsigned index, unsigned sub, DataType type, const Bytes& value) {
    return value_text({static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)}, type, value)
        .value_or("-");
  };
  EXPECT_EQ(text(0x1017, 0, DataType::unsigned16, {0xF4, 1}), "500");
  EXPECT_EQ(text(0x1800, 1, DataType::unsigned32, {0xAB, 1, 0, 0x40}), "0x400001AB");
  EXPECT_EQ(text(0x1A00, 1, DataType::unsigned32, {0x10, 0, 0x41, 0x60}), "0x60410010");
  EXPECT_EQ(text(0x1A00, 0, DataType::unsigned8, {2}), "2");
  EXPECT_EQ(text(0x6060, 0, DataType::integer8, {0xFF}), "-1");
  EXPECT_EQ(text(0x2000, 0, DataType::integer24, {0x00, 0x00, 0x80}), "-8388608");
  EXPECT_EQ(text(0x2000, 0, DataType::unsigned64, Bytes(8, 0xFF)), "18446744073709551615");
  EXPECT_EQ(text(0x2000, 0, DataType::real32, {0, 0, 0xC0, 0x3F}), "1.5");
  EXPECT_EQ(text(0x2000, 0, DataType::real64, {0, 0, 0, 0, 0, 0, 0xF8, 0xBF}), "-1.5");
  EXPECT_EQ(text(0x2000, 0, DataType::visible_string, {'a', 'b'}), "ab");
  EXPECT_EQ(text(0x2000, 0, DataType::octet_string, {0x0A, 0xFF}), "0AFF");
  EXPECT_EQ(text(0x2000, 0, DataType::domain, {1}), "-");
  EXPECT_EQ(text(0x1017, 0, DataType::unsigned16, {0xF4}), "-");
}

}  // namespace
}  // namespace canopus::master::device_configuration_test
