// A device in the place of another one: what of the project follows, and what stays.

#include "canopus/network_project/device_acceptance.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "network_project/project_folder.hpp"

namespace canopus::network_project::device_acceptance_test {
namespace {

using namespace canopus;
using network_project::AcceptedValue;
using network_project::IdentityValue;
using network_project::NetworkProject;
using test::ProjectFolder;

std::string shown(const std::vector<AcceptedValue>& values) {
  std::string text;
  for (const AcceptedValue& one : values)
    text +=
        fmt::format("{} {:04X}:{:02X} {:X}->{:X}\n", one.node_id, one.index, one.sub, one.before, one.after);
  return text;
}

/// A manager with lists of what it expects of its slaves.
const std::string manager =
    "[DeviceInfo]\nProductName=master\n[1000]\nParameterName=type\nDataType=7\nAccessType=ro\n[1001]"
    "\nParameterName=error\n"
    "DataType=5\nAccessType=ro\n"
    "[1F85]\nParameterName=vendor\nObjectType=8\nDataType=7\nAccessType=rw\nCompactSubObj=127\n"
    "[1F88]\nParameterName=serial\nObjectType=8\nDataType=7\nAccessType=rw\nCompactSubObj=127\n";

TEST(DeviceAcceptance, AnotherSerialNumber_IsOneValue_AndTheManagersThatChecksIt) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}, {6, "io-block"}});
  ASSERT_EQ(project.add_node({.node_id = 1, .name = "Master", .eds = manager}), 1);
  ASSERT_TRUE(project.set_value(1, 0x1F88, 5, "0x11"));
  ASSERT_TRUE(project.set_value(1, 0x1F85, 6, "0x99"));
  folder.use(project);
  std::string& dcf = folder.files.at("master.dcf");
  const std::size_t place = dcf.find("NodeName=Master");
  ASSERT_NE(place, std::string::npos) << dcf;
  dcf.insert(place, "CANopenManager=1\n");
  project = folder.open();
  const auto before = project.find(5)->device;
  const eds::Identity identity = eds::identity(*before);
  const std::vector<IdentityValue> found{{0x1000, 0, identity.device_type.value()},
                                         {0x1018, 1, 0x55},
                                         {0x1018, 2, identity.product_code.value()},
                                         {0x1018, 3, identity.revision.value()},
                                         {0x1018, 4, 0x77}};
  const auto values = find_accepted_values(project, 5, found);
  EXPECT_EQ(shown(values), fmt::format("5 1018:01 {:X}->55\n5 1018:04 {:X}->77\n1 1F88:05 11->77\n",
                                       identity.vendor_id.value(), identity.serial_number.value()));
  ASSERT_TRUE(accept_values(project, values));
  EXPECT_EQ(project.find(5)->value(0x1018, 4), 0x77U);
  EXPECT_EQ(project.find(1)->value(0x1F88, 5), 0x77U);
  EXPECT_EQ(project.find(1)->value(0x1F85, 5), 0U) << "a check that is off stays off";
  EXPECT_EQ(project.changes().size(), 2U);
  EXPECT_EQ(shown(find_accepted_values(project, 5, found)), "");
  EXPECT_EQ(shown(find_accepted_values(project, 7, found)), "");
}

TEST(DeviceAcceptance, WhatADeviceHasNot_IsLeft_AndARefusalChangesNothing) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  EXPECT_EQ(shown(find_accepted_values(project, 5, {})), "");
  const std::vector<AcceptedValue> wrong{{5, 0x1018, 1, 0, 1}, {5, 0x3FFF, 0, 0, 1}};
  EXPECT_FALSE(accept_values(project, wrong));
  EXPECT_TRUE(project.changes().empty());
}

}  // namespace
}  // namespace canopus::network_project::device_acceptance_test
