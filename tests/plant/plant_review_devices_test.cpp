// What `canopus check` says of nodes that cannot do what is asked of them, and the reasons that a run gives then.

#include "plant/plant_review.hpp"

namespace canopus::plant::plant_review_devices_test {
namespace {

using namespace plant_review;

TEST_F(PlantReviewTest, DeviceWithAnotherBitRate_IsAWarning) {
  write("t.eds", support::device_file(input));
  EXPECT_THAT(
      check(bus + device(3, "t.eds", "bit_rate = 500_000\n")),
      ElementsAre(
          "plant.toml:4:1: warning: node 3 (t3) has 500 kbit/s, and bus \"line1\" has 250 kbit/s: they "
          "destroy each other's frames, until LSS or a restart gives it the bit rate of the bus"));
  EXPECT_THAT(check(bus + device(3, "t.eds", "bit_rate = 250_000\n")), IsEmpty());
}

TEST_F(PlantReviewTest, ModuleWithAnotherBitRate_IsAWarning) {
  EXPECT_THAT(check(bus + master("buffer = { G24 = 125 }\n")),
              ElementsAre(HasSubstr(
                  "warning: node 1 (ME3CAN1-Q U0) has 125 kbit/s, and bus \"line1\" has 250 kbit/s")));
  EXPECT_THAT(check(bus + master("buffer = { G24 = 250 }\n")), IsEmpty());
}

std::string drive(const std::string& modes) {
  return support::device_file(support::variable("6040", 6, "0") + support::variable("6041", 6, "0") +
                              support::variable("6060", 2, "0") + support::variable("6061", 2, "0") +
                              support::variable("6064", 4, "0") + modes);
}

TEST_F(PlantReviewTest, DriveWithoutASimulatedMode_IsAWarning) {
  write("d.eds", drive(support::variable("6502", 7, "0")));
  const std::string with_drive = bus + device(3, "d.eds", "[device.drive]\n");
  EXPECT_THAT(
      check(with_drive),
      ElementsAre(
          "plant.toml:8:1: warning: node 3 (d3): drive: its 6502H (supported drive modes) is 00000000H, so "
          "6060H selects no mode and the axis does not move: bit 0 is profile position, bit 2 profile "
          "velocity, bit 5 homing, for example objects = { \"6502:00\" = 0x25 }"));
  write("d.eds", drive(support::variable("6502", 7, "0x80")));
  EXPECT_THAT(check(with_drive), SizeIs(1)) << "cyclic synchronous position alone is not simulated";
  write("d.eds", drive(support::variable("6502", 7, "0x4")));
  EXPECT_THAT(check(with_drive), IsEmpty());
  write("d.eds", drive(""));
  EXPECT_THAT(check(with_drive), IsEmpty()) << "a file without 6502H: every mode";
}

TEST_F(PlantReviewTest, MappingThatAPdoCannotCarry_IsAWarning) {
  write("t.eds", support::device_file(input + output + support::variable("2000", 5, "0") +
                                      pdo("1800", "1A00", "$NODEID+0x180", "255")));
  const auto mapped = [&](const std::string& entry) {
    return check(bus + device(3, "t.eds", "objects = { \"1A00:01\" = " + entry + " }\n"));
  };
  EXPECT_THAT(mapped("0x6000_0008"), IsEmpty());
  EXPECT_THAT(
      mapped("0x2000_0008"),
      ElementsAre(
          "plant.toml:8:13: warning: node 3 (t3): TPDO1 maps 2000:00, 8 bit, which it cannot carry: object "
          "cannot be mapped to the PDO; the PDO is not used"));
  EXPECT_THAT(mapped("0x6200_0008"), SizeIs(1)) << "an output, into a TPDO";
  EXPECT_THAT(mapped("0x6000_0010"), SizeIs(1)) << "of another length";
  EXPECT_THAT(mapped("0x9999_0008"),
              ElementsAre(HasSubstr("TPDO1 maps 9999:00, 8 bit, which it cannot carry: object does "
                                    "not exist")));
}

}  // namespace
}  // namespace canopus::plant::plant_review_devices_test
