// FileVersion and FileRevision of the device files of nodes.

#include "canopus/cli/module_settings/node_files.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::cli::node_files_test {
namespace {

namespace fs = std::filesystem;

class NodeFilesTest : public ::testing::Test {
 protected:
  NodeFilesTest() {
    std::string name = (fs::temp_directory_path() / "canopus-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder");
    folder_ = name;
  }
  ~NodeFilesTest() override { fs::remove_all(folder_); }
  std::string write(const std::string& name, unsigned version, unsigned revision) const {
    const fs::path path = folder_ / name;
    std::ofstream(path) << "[FileInfo]\nFileName=" << name << "\nFileVersion=" << version
                        << "\nFileRevision=" << revision << R"(
EDSVersion=4.0
[DeviceInfo]
VendorName=A
VendorNumber=0x123
ProductName=B
ProductNumber=0x45
RevisionNumber=0x10002
[MandatoryObjects]
SupportedObjects=1
1=0x1000
[1000]
ParameterName=Device type
ObjectType=0x7
DataType=0x0007
AccessType=ro
DefaultValue=0
PDOMapping=0
)";
    return path.string();
  }
  fs::path folder_;
};

TEST_F(NodeFilesTest, AFolder_IsReadAsFarAsItHasDeviceFiles) {
  write("b.EDS", 2, 7);
  write("a.eds", 1, 3);
  write("c.txt", 9, 9);
  std::ofstream(folder_ / "wrong.eds") << "[[";
  const auto files = read_node_files({folder_.string()});
  ASSERT_TRUE(files) << files.error();
  ASSERT_EQ(files->size(), 2U);
  EXPECT_EQ((*files)[0].version, 1U);
  EXPECT_EQ((*files)[0].revision, 3U);
  EXPECT_EQ((*files)[1].version, 2U);
  EXPECT_EQ((*files)[1].revision, 7U);
  EXPECT_EQ((*files)[0].vendor, 0x123U);
  EXPECT_EQ((*files)[0].product, 0x45U);
  EXPECT_EQ((*files)[0].device_revision, 0x10002U);
}

TEST_F(NodeFilesTest, AFile_MustBeOne) {
  const std::string wrong = (folder_ / "wrong.eds").string();
  std::ofstream(wrong) << "[[";
  for (const std::string& name : {wrong, (folder_ / "none.eds").string()}) {
    const auto files = read_node_files({name});
    ASSERT_FALSE(files);
    EXPECT_THAT(files.error(), ::testing::HasSubstr(name));
  }
  EXPECT_TRUE(read_node_files({}) && read_node_files({})->empty());
}

TEST(NodeFile, IsThatOfTheWholeIdentity) {
  const std::vector<NodeFile> files{
      {.version = 1, .vendor = 1, .product = 2},
      {.version = 2, .vendor = 1, .product = 2, .device_revision = 3},
      {.version = 3, .vendor = 1, .product = 9, .device_revision = 3},
  };
  struct Case {
    std::uint32_t vendor, product, revision, version;
  };
  for (const Case& one :
       {Case{1, 2, 3, 2}, {1, 2, 4, 1}, {1, 9, 3, 3}, {1, 9, 4, 0}, {2, 2, 3, 0}, {1, 3, 3, 0}}) {
    const NodeFile* const found = file_of_node(files, one.vendor, one.product, one.revision);
    EXPECT_EQ(found == nullptr ? 0 : found->version, one.version)
        << one.vendor << one.product << one.revision;
  }
}

}  // namespace
}  // namespace canopus::cli::node_files_test
