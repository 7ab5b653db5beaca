// The ports of a PLC in a plant file: [[plc.port]], and the key listen.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plant/file/plant_file.hpp"

namespace canopus::plant::plant_ports_test {
namespace {

using plc::WritePermission;
using plc::melsec::DataCode;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A plant needs a bus.
PlantReading read(const std::string& text) {
  return read_plant(text + "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n", "plant.toml");
}

std::vector<std::string> errors(const std::string& text) {
  std::vector<std::string> lines;
  for (const text::FileError& error : read(text).errors) lines.push_back(describe(error, "plant.toml"));
  return lines;
}

TEST(PlantPorts, WithoutAnything_OneTcpPortFor3eAnd4e) {
  const PlantReading reading = read("[[plc]]\n");
  ASSERT_THAT(reading.errors, IsEmpty());
  const auto& ports = reading.plant.plcs[0].ports;
  ASSERT_EQ(ports.size(), 1U);
  EXPECT_EQ(ports[0].listen.port, 5007);
  EXPECT_FALSE(ports[0].udp);
  EXPECT_TRUE(ports[0].settings.takes_3e);
  EXPECT_FALSE(ports[0].settings.takes_1e);
  EXPECT_EQ(ports[0].settings.write, WritePermission::always);
  EXPECT_EQ(protocol_name(ports[0]), "MC protocol");
}

TEST(PlantPorts, RemoteResetIsAParameterOfTheCpu) {
  const PlantReading reading =
      read("[[plc]]\nremote_reset = true\nlisten = \"5007\"\n[[plc.port]]\nlisten = \"5010\"\n");
  ASSERT_THAT(reading.errors, IsEmpty());
  for (const auto& port : reading.plant.plcs[0].ports) EXPECT_TRUE(port.settings.remote_reset);
  EXPECT_FALSE(read("[[plc]]\n").plant.plcs[0].ports[0].settings.remote_reset);
  EXPECT_THAT(errors("[[plc]]\nremote_reset = 1\n"),
              ElementsAre(::testing::HasSubstr("plant.toml:2:16: remote_reset")));
}

TEST(PlantPorts, EachHasItsOpenSettings) {
  const PlantReading reading = read(R"(
[[plc]]
listen = "127.0.0.1:5007"
[[plc.port]]
listen = "0.0.0.0:5007"
transport = "udp"
allow = ["192.168.1.0/24"]
allow_write = "192.168.1.20"
[[plc.port]]
listen = "5010"
frame = "1E"
code = "ascii"
write_in_run = false
[[plc.port]]
listen = "0.0.0.0:5011"
frame = "3E/4E"
code = "binary"
remote_password = "secret"
[[plc.port]]
listen = "5012"
frame = "any"
code = "any"
transport = "tcp"
)");
  ASSERT_THAT(reading.errors, IsEmpty());
  const auto& ports = reading.plant.plcs[0].ports;
  ASSERT_EQ(ports.size(), 5U);
  EXPECT_TRUE(ports[1].udp);
  EXPECT_TRUE(ports[1].allowed.allows(link::parse_internet_address("192.168.1.7").value()));
  EXPECT_FALSE(ports[1].writers->allows(link::parse_internet_address("192.168.1.7").value()));
  EXPECT_TRUE(ports[1].writers->allows(link::parse_internet_address("192.168.1.20").value()));
  EXPECT_EQ(protocol_name(ports[1]), "MC protocol UDP");
  EXPECT_FALSE(ports[2].settings.takes_3e);
  EXPECT_TRUE(ports[2].settings.takes_1e);
  EXPECT_EQ(ports[2].settings.code, DataCode::ascii);
  EXPECT_EQ(ports[2].settings.write, WritePermission::in_stop);
  EXPECT_FALSE(ports[2].writers.has_value());
  EXPECT_EQ(protocol_name(ports[2]), "MC protocol 1E");
  EXPECT_EQ(ports[3].settings.remote_password, "secret");
  EXPECT_TRUE(ports[3].allowed.allows(link::parse_internet_address("8.8.8.8").value()));
  EXPECT_TRUE(ports[3].allowed.allows(link::parse_internet_address("2001:db8::1").value()));
  EXPECT_TRUE(ports[4].settings.takes_3e);
  EXPECT_TRUE(ports[4].settings.takes_1e);
  EXPECT_EQ(ports[4].settings.code, std::nullopt);
}

TEST(PlantPorts, WhoListsPorts_MeansThese) {
  const PlantReading reading = read("[[plc]]\n[[plc.port]]\nlisten = \"5010\"\n");
  ASSERT_THAT(reading.errors, IsEmpty());
  ASSERT_EQ(reading.plant.plcs[0].ports.size(), 1U);
  EXPECT_EQ(reading.plant.plcs[0].ports[0].listen.port, 5010);
  const PlantReading off = read("[[plc]]\nlisten = \"off\"\n[[plc.port]]\nlisten = \"5010\"\n");
  EXPECT_EQ(off.plant.plcs[0].ports.size(), 1U);
}

TEST(PlantPorts, WrongKeys_AreErrorsWithTheirPlace) {
  EXPECT_THAT(
      errors("[[plc]]\n[[plc.port]]\nlisten = \"5010\"\n  transport = \"sctp\"\nframe = \"2E\"\ncode = 7\n"
             "write_in_run = \"no\"\nallow_write = [\"here\"]\ncolour = 1\n"),
      ElementsAre(
          "plant.toml:4:15: transport = \"sctp\": expected \"tcp\" or \"udp\"",
          "plant.toml:5:9: frame = \"2E\": expected \"3E/4E\", \"1E\" or \"any\"",
          "plant.toml:6:8: code = 7: expected text in quotes",
          "plant.toml:7:16: write_in_run = \"no\": expected true or false",
          "plant.toml:8:16: allow_write: \"here\" is not an address; expected numbers such as 192.168.1.7 or "
          "fd00::7, or a network such as 192.168.1.0/24",
          "plant.toml:9:1: plc.port: unknown key colour; expected one of allow, allow_write, code, frame, "
          "listen, remote_password, transport, write_in_run"));
}

TEST(PlantPorts, APortWithoutAnAddress_IsAnError) {
  EXPECT_THAT(errors("[[plc]]\n[[plc.port]]\nframe = \"1E\"\n"),
              ElementsAre("plant.toml:2:1: plc.port: listen is missing; expected text in quotes"));
}

TEST(PlantPorts, APublicAddress_NeedsAListOrAPassword) {
  EXPECT_THAT(
      errors("[[plc]]\n[[plc.port]]\nlisten = \"0.0.0.0:5010\"\ntransport = \"udp\"\n"),
      ElementsAre("plant.toml:3:10: listen: other machines can reach 0.0.0.0, and the MC protocol has no "
                  "password here; say which may connect, for example allow = [\"192.168.1.0/24\"], or listen "
                  "on 127.0.0.1"));
}

TEST(PlantPorts, Passwords_AreAsLongAsTheCpuTakesThem_AndStayOutOfTheMessage) {
  const std::string port = "[[plc.port]]\nlisten = \"5010\"\nremote_password = ";
  EXPECT_THAT(errors("[[plc]]\n" + port + "\"short\"\n"),
              ElementsAre("plant.toml:4:19: remote_password: expected 6 to 32 characters of ASCII (R04CPU)"));
  EXPECT_THAT(errors("[[plc]]\ncpu_model = \"Q03UDVCPU\"\n" + port + "\"secret\"\n"),
              ElementsAre("plant.toml:5:19: remote_password: expected 4 characters of ASCII (Q03UDVCPU)"));
  EXPECT_THAT(errors("[[plc]]\ncpu_model = \"Q03UDVCPU\"\n" + port + "\"ABCD\"\n"), IsEmpty());
  EXPECT_THAT(errors("[[plc]]\n" + port + "\"\"\n").size(), 1U);
  EXPECT_THAT(
      errors("[[plc]]\n" + port + "\"secret\"\nframe = \"1E\"\n"),
      ElementsAre(
          "plant.toml:5:9: frame = \"1E\": 1E frames cannot bring a remote password; expected \"3E/4E\""));
}

TEST(PlantPorts, TwoServersOnOnePort_AreAnError_TcpAndUdpOfOneNumberAreNot) {
  EXPECT_THAT(errors("[[plc]]\nlisten = \"5007\"\n[[plc.port]]\nlisten = \"5007\"\ntransport = \"udp\"\n"),
              IsEmpty());
  EXPECT_THAT(
      errors("[[plc]]\nname = \"press\"\nlisten = \"5007\"\n[[plc.port]]\nlisten = \"5007\"\n"),
      ElementsAre(
          "plant.toml:5:10: listen: port 5007 is taken already, by PLC \"press\" in line 3; give each "
          "server its own"));
  EXPECT_THAT(
      errors("[[plc]]\nname = \"press\"\n[[plc.port]]\nlisten = \"5007\"\ntransport = \"udp\"\n[[plc.port]]\n"
             "listen = \"0.0.0.0:5007\"\nallow = \"10.0.0.1\"\ntransport = \"udp\"\n"),
      ElementsAre(
          "plant.toml:7:10: listen: port 5007 is taken already, by PLC \"press\" in line 4; give each "
          "server its own"));
}

TEST(PlantModbus, HasAMapOfItsOwn) {
  const PlantReading reading = read(R"(
[[plc]]
[[plc.module]]
model = "ME3CAN1-Q"
head = 0x30
bus = "line1"
node = 1
[[plc.modbus]]
listen = "127.0.0.1:1502"
unit = 1
write_in_run = false
coils = [{ at = 0, count = 64, device = "Y0" }, { at = 64, count = 16, device = "M100", read_only = true }]
holding_registers = [{ at = 0, count = 1000, device = "D0" }, { at = 1000, count = 64, device = 'U3\G10000' }]
[[plc.modbus]]
listen = "0.0.0.0:1503"
allow = "10.0.0.0/8"
allow_write = "10.0.0.7"
)");
  ASSERT_THAT(reading.errors, IsEmpty());
  const auto& ports = reading.plant.plcs[0].modbus_ports;
  ASSERT_EQ(ports.size(), 2U);
  EXPECT_EQ(reading.plant.plcs[0].ports.size(), 1U);  // the MC protocol stays
  EXPECT_EQ(ports[0].settings.unit, 1);
  EXPECT_EQ(ports[0].settings.write, WritePermission::in_stop);
  using plc::modbus::Table;
  ASSERT_EQ(ports[0].settings.map.ranges(Table::coils).size(), 2U);
  EXPECT_TRUE(ports[0].settings.map.ranges(Table::coils)[1].read_only);
  EXPECT_EQ(ports[0].settings.map.ranges(Table::holding_registers)[1].at.head_address, 0x30);
  EXPECT_TRUE(ports[0].settings.map.ranges(Table::discrete_inputs).empty());
  EXPECT_EQ(ports[1].settings.map.ranges(Table::discrete_inputs).size(), 1U);  // as the CPU has them
  EXPECT_FALSE(ports[1].writers->allows(link::parse_internet_address("10.0.0.8").value()));
}

TEST(PlantModbus, Framing_IsTcpOrRtu) {
  const auto framing = [](const std::string& key) {
    return read("[[plc]]\n[[plc.modbus]]\nlisten = \"1502\"\n" + key)
        .plant.plcs[0]
        .modbus_ports[0]
        .settings.framing;
  };
  EXPECT_EQ(framing(""), plc::modbus::Framing::mbap);
  EXPECT_EQ(framing("framing = \"tcp\"\n"), plc::modbus::Framing::mbap);
  EXPECT_EQ(framing("framing = \"rtu\"\n"), plc::modbus::Framing::rtu);
  EXPECT_THAT(errors("[[plc]]\n[[plc.modbus]]\nlisten = \"1502\"\nframing = \"ascii\"\n"),
              ElementsAre("plant.toml:4:11: framing = \"ascii\": expected \"tcp\" or \"rtu\""));
}

TEST(PlantBuses, Announce_NeedsAServer) {
  EXPECT_THAT(errors("[[bus]]\nname = \"a\"\nbit_rate = 250_000\nannounce = true\n"),
              ElementsAre("plant.toml:4:12: announce = true: nothing to announce: the bus has no serve = "
                          "\"socketcand:...\""));
  const PlantReading reading =
      read("[[bus]]\nname = \"a\"\nbit_rate = 250_000\nserve = \"socketcand:1\"\nannounce = true\n");
  EXPECT_THAT(reading.errors, IsEmpty());
}

TEST(PlantModbus, WrongKeys_AreErrorsWithTheirPlace) {
  EXPECT_THAT(
      errors("[[plc]]\n[[plc.modbus]]\nlisten = \"1502\"\nunit = 255\n"
             "coils = [{ at = 0, count = 10, device = \"Q1\" }, { at = 70000, count = 0 }]\n"
             "holding_registers = [{ at = 0, count = 100, device = \"D18400\" },\n"
             "  { at = 100, count = 10, device = 'U3\\G0' },\n"
             "  { at = 105, count = 10, device = \"D0\" }]\n"
             "input_registers = 7\n"),
      ElementsAre(
          "plant.toml:4:8: unit = 255: a unit identifier is 1 to 247",
          "plant.toml:5:41: device = 'Q1' is no device; expected a device (D100, M0, X1F, W2A) or buffer "
          "memory "
          "(U0\\G25)",
          "plant.toml:5:49: coils: device is missing; expected text in quotes",
          "plant.toml:5:56: at = 70000: an address is 0 to 65535",
          "plant.toml:5:71: count = 0: expected 1 to 65536 addresses",
          "plant.toml:6:54: device: 100 addresses from D18400 on end at D18499; the R04CPU has 18432 of it",
          "plant.toml:7:36: device: the PLC has no module at head = 0x30",
          "plant.toml:8:10: at: holding registers 100 to 109 are U3\\G0 already",
          "plant.toml:9:19: input_registers = 7: expected tables, written as [[input_registers]]"));
}

TEST(PlantModbus, APublicAddressAndATakenPort_AreErrors) {
  EXPECT_THAT(
      errors("[[plc]]\n[[plc.modbus]]\nlisten = \"0.0.0.0:1502\"\n"),
      ElementsAre(::testing::HasSubstr("plant.toml:3:10: listen: other machines can reach 0.0.0.0, and the "
                                       "Modbus protocol has no password here")));
  EXPECT_THAT(
      errors("[[plc]]\nlisten = \"1502\"\n[[plc.modbus]]\nlisten = \"1502\"\n"),
      ElementsAre(
          "plant.toml:4:10: listen: port 1502 is taken already, by a PLC without a name in line 2; give "
          "each server its own"));
}

}  // namespace
}  // namespace canopus::plant::plant_ports_test
