// What can be mapped into the PDOs of a module, by name: as the lists of the tools' details windows.

#include "canopus/module_settings/mappable_objects.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/module/models/fx3u_can/configuration_tool.hpp"
#include "canopus/module/models/rj71cn91/configuration_tool.hpp"

namespace canopus::module_settings::mappable_objects_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Window& window_of(const module::ConfigurationTool& model, std::string_view word) {
  for (const Window& window : model.windows) {
    if (window.word == word) return window;
  }
  throw std::invalid_argument("no such window");
}

/// "name: count, the first description to the last one"
std::vector<std::string> lists(const module::ConfigurationTool& model, std::string_view word) {
  std::vector<std::string> lines;
  for (const MappableObjects& named : mappable_objects(model, window_of(model, word))) {
    const MappableObject &first = named.objects.front(), &last = named.objects.back();
    lines.push_back(named.name + ": " + std::to_string(named.objects.size()) +
                    (first.description.empty() ? "" : ", " + first.description + " to " + last.description));
  }
  return lines;
}

TEST(MappableObjects, OfTheRj71cn91_AreTheListsOfItsDetailsWindows) {
  const std::string area = "Buffer Memory Area ";
  EXPECT_THAT(lists(module::rj71cn91::configuration_tool, "tpdo"),
              ElementsAre(area + "Integer8: 2048, Un\\G13000 LByte to Un\\G14023 HByte",
                          area + "Unsigned8: 2048, Un\\G13000 LByte to Un\\G14023 HByte",
                          area + "Integer16: 1024, Un\\G13000 to Un\\G14023",
                          area + "Unsigned16: 1024, Un\\G13000 to Un\\G14023",
                          area + "Integer32: 512, Un\\G13000-Un\\G13001 to Un\\G14022-Un\\G14023",
                          area + "Unsigned32: 512, Un\\G13000-Un\\G13001 to Un\\G14022-Un\\G14023",
                          area + "Real32: 512, Un\\G13000-Un\\G13001 to Un\\G14022-Un\\G14023"));
  const auto received = lists(module::rj71cn91::configuration_tool, "rpdo");
  ASSERT_EQ(received.size(), 13U);
  EXPECT_EQ(received[0], area + "Integer8: 2048, Un\\G10000 LByte to Un\\G11023 HByte");
  EXPECT_THAT(std::vector(received.begin() + 7, received.end()),
              ElementsAre("Dummy Signed 8 bit: 1", "Dummy Signed 16 bit: 1", "Dummy Signed 32 bit: 1",
                          "Dummy Unsigned 8 bit: 1", "Dummy Unsigned 16 bit: 1", "Dummy Unsigned 32 bit: 1"));
}

TEST(MappableObjects, OfTheFx3uCan_HaveItsBufferMemory) {
  const auto sent = lists(module::fx3u_can::configuration_tool, "tpdo");
  ASSERT_EQ(sent.size(), 7U);
  EXPECT_EQ(sent[3], "BFM Area Unsigned16 (PLC write access): 320, BFM#11000 (TO) to BFM#11319 (TO)");
}

TEST(MappableObjects, EachIsWhatItsMappingEntryIsCalled) {
  for (const module::ConfigurationTool* const model :
       {&module::rj71cn91::configuration_tool, &module::fx3u_can::configuration_tool}) {
    for (const char* word : {"tpdo", "rpdo"}) {
      for (const MappableObjects& named : mappable_objects(*model, window_of(*model, word))) {
        for (const MappableObject& one : named.objects) {
          const std::uint32_t entry = std::uint32_t{one.index} << 16 | one.sub << 8U | named.bits;
          const std::string called = model->object_name(entry);
          ASSERT_EQ(one.description.empty() ? named.name : named.name + ", " + one.description, called);
        }
      }
    }
  }
}

TEST(MappableObjects, OfWindowsWithoutMapping_AreNone) {
  EXPECT_THAT(mappable_objects(module::rj71cn91::configuration_tool,
                               window_of(module::rj71cn91::configuration_tool, "master")),
              IsEmpty());
}

}  // namespace
}  // namespace canopus::module_settings::mappable_objects_test
