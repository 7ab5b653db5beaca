// Modular devices.

#include <gmock/gmock.h>

#include "eds/reading.hpp"

namespace canopus::eds::module_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;
using testing::ElementsAre;

const std::string modules =
    "[SupportedModules]\nNrOfEntries=2\n[M1ModuleInfo]\nProductName=8 DI\nOrderCode=DI8\n"
    "[M1SubExtends]\nNrOfEntries=1\n1=0x6000\n"
    "[M1SubExt6000]\nParameterName=Inputs\nDataType=5\nAccessType=ro\nPDOMapping=1\nCount=1\nObjExtend=0\n"
    "[M1FixedObjects]\nNrOfEntries=1\n1=0x6005\n[M1Fixed6005]\nParameterName=Enable\nDataType=1\nAccessType="
    "rw\n"
    "[M2ModuleInfo]\nProductName=4 "
    "DI\n[M2SubExt6000]\nParameterName=Inputs\nDataType=5\nAccessType=ro\nCount=0;4\n";

TEST(Modules, PluggedModules_AddTheirObjects) {
  const auto result = read_device_file(base + modules + "[ConnectedModules]\nNrOfEntries=2\n1=1\n2=1\n");
  ASSERT_NE(result.file, nullptr);
  EXPECT_EQ(result.file->modules[0].product_name, "8 DI");
  EXPECT_THAT(result.file->connected, ElementsAre(1, 1));
  EXPECT_THAT(value(result, 0x6000, 0), ElementsAre(2));
  EXPECT_TRUE(result.file->dictionary->find(0x6000, 2).description->tpdo_mappable);
  EXPECT_FALSE(result.file->dictionary->find(0x6000, 3));
  EXPECT_TRUE(result.file->dictionary->find(0x6005, 0));
  EXPECT_EQ(all_problems(result), "");
}

TEST(Modules, ThatShareASubIndex_FillIt) {
  const auto result = read_device_file(base + modules + "[ConnectedModules]\nNrOfEntries=3\n1=2\n2=2\n3=2\n");
  EXPECT_THAT(value(result, 0x6000, 0), ElementsAre(2));
}

TEST(Modules, NotPlugged_AddNothing) {
  const auto result = read_device_file(base + modules);
  EXPECT_EQ(result.file->dictionary->find(0x6000), nullptr);
  EXPECT_EQ(problem(result, 34),
            "note: a modular device, and no [ConnectedModules]: no module is plugged in");
}

TEST(Modules, OfATypeThatIsNotThere_LeaveTheSlotEmpty) {
  const auto result = read_device_file(base + modules + "[ConnectedModules]\nNrOfEntries=1\n1=3\n");
  EXPECT_TRUE(result.file->connected.empty());
  EXPECT_EQ(problem(result, 65),
            "loss: 1=3 in [ConnectedModules]: there are modules 1 to 2: slot left empty");
}

}  // namespace
}  // namespace canopus::eds::module_test
