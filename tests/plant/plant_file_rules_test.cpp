// Plant files: what servers, faults, racks and CPUs may be.

#include "plant/good_plant.hpp"

namespace canopus::plant::plant_file_rules_test {
namespace {

struct Servers {
  std::string_view bus;
  std::string_view plc;
  bool clash;
};
class PlantFileWithTwoServers : public testing::TestWithParam<Servers> {};

TEST_P(PlantFileWithTwoServers, OnOnePort_IsAMistake) {
  const auto errors = errors_of(
      "[[bus]]\nname = \"a\"\nbit_rate = 250_000\nserve = \"socketcand:" + std::string(GetParam().bus) +
      "\"\nallow = \"10.0.0.0/8\"\n[[plc]]\nname = \"p\"\nallow = \"10.0.0.0/8\"\nlisten = \"" +
      std::string(GetParam().plc) + "\"\n");
  if (!GetParam().clash) {
    EXPECT_THAT(errors, IsEmpty());
  } else {
    EXPECT_THAT(errors, ElementsAre("plant.toml:4:9: serve: port 5007 is taken already, by PLC \"p\" in line "
                                    "9; give each server its own"));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Addresses, PlantFileWithTwoServers,
    testing::Values(
        Servers{"127.0.0.1:5007", "127.0.0.1:5007", true}, Servers{"localhost:5007", "5007", true},
        Servers{"0.0.0.0:5007", "127.0.0.1:5007", true}, Servers{"127.0.0.1:5007", "0.0.0.0:5007", true},
        Servers{"[::]:5007", "127.0.0.1:5007", true}, Servers{"0.0.0.0:5007", "[::]:5007", true},
        Servers{"[::1]:5007", "[0:0::1]:5007", true},
        Servers{"[::ffff:127.0.0.1]:5007", "127.0.0.1:5007", true},
        Servers{"[::1]:5007", "0.0.0.0:5007", false}, Servers{"0.0.0.0:5007", "[::1]:5007", false},
        Servers{"[::1]:5007", "127.0.0.1:5007", false}, Servers{"127.0.0.1:5007", "127.0.0.1:5008", false},
        Servers{"127.0.0.1:5007", "127.0.0.2:5007", false}, Servers{"127.0.0.1:0", "127.0.0.1:0", false}));

TEST(PlantFile, TheControlServerHasAPortOfItsOwn) {
  const auto with_control = [](const std::string& control) {
    return errors_of("[plant]\ncontrol = \"" + control + "\"\n[[bus]]\nname = \"a\"\nbit_rate = 250_000\n" +
                     "serve = \"socketcand:127.0.0.1:5008\"\n[[plc]]\n");
  };
  EXPECT_THAT(with_control("127.0.0.1:29540"), IsEmpty());
  EXPECT_THAT(
      with_control("127.0.0.1:5007"),
      ElementsAre("plant.toml:7:1: listen: port 5007 is taken already, by the control server in line 2; "
                  "give each server its own"));
  EXPECT_THAT(
      with_control("localhost:5008"),
      ElementsAre("plant.toml:6:9: serve: port 5008 is taken already, by the control server in line 2; "
                  "give each server its own"));
}

TEST(PlantFile, TwoPlcsWithoutAnAddress_ListenOnOnePort) {
  EXPECT_THAT(
      errors_of("[[bus]]\nname = \"a\"\nbit_rate = 250_000\n[[plc]]\n[[plc]]\n"),
      ElementsAre("plant.toml:5:1: listen: port 5007 is taken already, by a PLC without a name in line "
                  "4; give each server its own"));
}

TEST(PlantFile, FaultsOfABusAreRead) {
  const PlantReading reading = read_plant(
      "[[bus]]\nname = \"a\"\nbit_rate = 250000\n"
      "[[bus.fault]]\nkind = \"corrupt\"\nidentifier = 0x183\nbit = 20\nevery = 10\nfrom = \"1s\"\nuntil = "
      "\"2s\"\n"
      "[[bus.fault]]\nkind = \"babble\"\nports = [\"drive\"]\nframe = { identifier = 1, data = [1, 255] "
      "}\ninterval = \"1ms\"\n",
      "plant.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  ASSERT_EQ(reading.plant.buses.at(0).faults.size(), 2U);
  const sim::Fault& corrupt = reading.plant.buses[0].faults[0].fault;
  EXPECT_EQ(corrupt.kind, sim::FaultKind::corrupt);
  EXPECT_EQ(corrupt.identifier, 0x183U);
  EXPECT_EQ(corrupt.bit, 20U);
  EXPECT_EQ(corrupt.every, 10U);
  EXPECT_EQ(corrupt.from, can::Time{1s});
  EXPECT_EQ(corrupt.until, can::Time{2s});
  const sim::Fault& babble = reading.plant.buses[0].faults[1].fault;
  EXPECT_THAT(babble.ports, ElementsAre("drive"));
  EXPECT_EQ(babble.frame, can::data_frame(0x001, {1, 255}));
  EXPECT_EQ(babble.interval, 1ms);
}

TEST(PlantFile, ABabbledFrameKeepsOnlyTheBytesThatItsDlcSends) {
  const PlantReading reading = read_plant(
      "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[bus.fault]]\nkind = \"babble\"\nports = [\"drive\"]\n"
      "frame = { identifier = 1, data = [1, 2, 3], dlc = 1 }\n",
      "plant.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  EXPECT_EQ(reading.plant.buses[0].faults[0].fault.frame, can::data_frame(0x001, {1}));
}

TEST(PlantFile, AFaultTakesOnlyTheKeysOfItsKind) {
  const std::string bus = "[[bus]]\nname = \"a\"\nbit_rate = 250000\n[[bus.fault]]\n";
  EXPECT_THAT(
      errors_of(bus + "kind = \"jam\"\nports = [\"a\"]\nbit = 3\n"),
      ElementsAre(
          "plant.toml:7:1: bus.fault: unknown key bit; expected one of capacity, from, kind, ports, until"));
  EXPECT_THAT(
      errors_of(bus + "kind = \"break\"\n"),
      ElementsAre(
          "plant.toml:5:8: kind = \"break\": expected one of drop, corrupt, duplicate, delay, babble, "
          "stuck dominant, jam, cut, drive, stuck recessive, late, noise, overload, single-shot, "
          "early, termination"));
  EXPECT_THAT(
      errors_of(bus + "kind = \"noise\"\nbit_error_rate = 2\n"),
      ElementsAre(
          "plant.toml:6:18: bit_error_rate = 2: expected a number above 0, up to 1, for example 1e-5"));
  EXPECT_THAT(errors_of(bus + "kind = \"overload\"\nports = [\"a\"]\noverload_frames = 3\n"),
              ElementsAre("plant.toml:7:19: overload_frames = 3: expected 1 or 2 overload frames"));
  EXPECT_THAT(errors_of(bus + "kind = \"early\"\nports = [\"a\"]\nearly_bits = 11\n"),
              ElementsAre("plant.toml:7:14: early_bits = 11: expected 1 to 10 bits"));
  EXPECT_THAT(
      errors_of(bus + "kind = \"termination\"\nresistors = 21\nlength = -1\n"),
      ElementsAre("plant.toml:6:13: resistors = 21: expected 0 to 20 resistors; 2 are as it should be",
                  "plant.toml:7:10: length = -1: expected 0 to 10000 m"));
  EXPECT_THAT(errors_of(bus + "kind = \"drop\"\nfrom = \"2s\"\nuntil = \"1s\"\n"),
              ElementsAre("plant.toml:7:9: until = \"1s\": must be later than from"));
}

TEST(PlantFile, ABitDriver_IsWhatItsKeysSay) {
  const PlantReading reading = read_plant(
      "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n"
      "[[bus.fault]]\nkind = \"drive\"\nfrom = \"100ms\"\nbits = \"0*6 1R\"\nbit_time = \"3us\"\n"
      "[[bus.fault]]\nkind = \"drive\"\nidentifier = 0x181\nfield = \"CRC delimiter\"\nbits = \"0\"\ncount = "
      "1\n",
      "plant.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  const sim::Fault& timed = reading.plant.buses[0].faults[0].fault;
  EXPECT_EQ(timed.kind, sim::FaultKind::drive);
  EXPECT_EQ(timed.from, can::Time(std::chrono::milliseconds(100)));
  EXPECT_EQ(timed.bit_time, std::chrono::microseconds(3));
  EXPECT_EQ(timed.levels.size(), 8U);
  EXPECT_EQ(timed.levels.back(), sim::DrivenLevel::recessive);
  EXPECT_FALSE(timed.field.has_value());
  EXPECT_EQ(reading.plant.buses[0].faults[1].fault.field, can::FrameField::crc_delimiter);
}

TEST(PlantFile, AWrongBitDriver_IsToldWithItsField) {
  const std::string bus = "[[bus]]\nname = \"a\"\nbit_rate = 250000\n[[bus.fault]]\nkind = \"drive\"\n";
  EXPECT_THAT(
      errors_of(bus + "bits = \"012\"\n"),
      ElementsAre("plant.toml:6:8: bits = character 3: expected 0 (dominant), 1 (released), R (forced "
                  "recessive), * or blanks"));
  EXPECT_THAT(errors_of(bus),
              ElementsAre("plant.toml:4:1: bus.fault: bits is missing; expected text in quotes"));
  EXPECT_THAT(
      errors_of(bus + "bits = \"0\"\nfield = \"CRD\"\n"),
      ElementsAre("plant.toml:7:9: field = \"CRD\": expected one of SOF, ID.28-21, ID.20-18, RTR, IDE, "
                  "ID.17-13, ID.12-5, ID.4-0, RTR (extended), r1, r0, DLC, data, CRC, CRC delimiter, ACK "
                  "slot, ACK delimiter, EOF, intermission"));
  EXPECT_THAT(errors_of(bus + "bits = \"0\"\nbit_time = \"0s\"\n"),
              ElementsAre("plant.toml:7:12: bit_time = \"0s\": expected a time longer than 0"));
  EXPECT_THAT(
      errors_of(bus + "bits = \"0\"\nidentifier = 3\n"),
      ElementsAre(
          "plant.toml:7:14: identifier = 3: needs a `field` or `bit` of a frame where the bits begin"));
}

RC_GTEST_PROP(PlantFile, NoTextWhateverMakesItFail, (const std::string& text)) {
  (void)read_plant(text, "plant.toml");
}

RC_GTEST_PROP(PlantFile, EveryErrorOfADamagedFileHasALine, ()) {
  std::string text(good_plant);
  const auto changes = *rc::gen::inRange(1, 6);
  for (int i = 0; i < changes; ++i) {
    const auto place = *rc::gen::inRange<std::size_t>(0, text.size());
    text[place] = *rc::gen::arbitrary<char>();
  }
  for (const text::FileError& error : read_plant(text, "plant.toml").errors)
    RC_ASSERT(error.place.line >= 1U);
}

TEST(PlantFile, Recover_IsAboutTheBuiltInProgram) {
  constexpr std::string_view head =
      "[[bus]]\nname = \"a\"\nbit_rate = 250000\n[[plc]]\n[[plc.module]]\n"
      "model = \"ME3CAN1-Q\"\nrecover = false\n";
  EXPECT_THAT(errors_of(head),
              ElementsAre("plant.toml:7:11: recover = false: is about the built-in PLC program, "
                          "which runs with exchange = \"20ms\" or the like"));
  const PlantReading reading = read_plant(std::string(head) + "exchange = \"10ms\"\n", "plant.toml");
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_FALSE(reading.plant.plcs[0].modules[0].recover);
}

constexpr std::string_view bus_that_serves = "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n";

/// Errors of this text and a bus behind it.
std::vector<std::string> errors_with_bus(std::string_view text) {
  return errors_of(std::string(text) + std::string(bus_that_serves));
}

TEST(PlantFile, ServerBeyondThisMachineWithoutAllow_IsRefusedWithASentence) {
  EXPECT_THAT(
      errors_with_bus("[[plc]]\nlisten = \"0.0.0.0:5007\"\n"),
      ElementsAre("plant.toml:2:10: listen: other machines can reach 0.0.0.0, and the MC protocol has no "
                  "password here; say which may connect, for example allow = [\"192.168.1.0/24\"], or listen "
                  "on 127.0.0.1"));
  EXPECT_THAT(errors_of(std::string(bus_that_serves) + "serve = \"socketcand:[::]:29536\"\n"),
              ElementsAre(HasSubstr(
                  "plant.toml:4:9: serve: other machines can reach ::, and the socketcand protocol")));
}

TEST(PlantFile, ServerOfThisMachine_NeedsNoAllow) {
  for (const std::string_view place :
       {"127.0.0.1:5007", "localhost:5007", "[::1]:5007", ":5007", "5007", "127.9.9.9:0"}) {
    SCOPED_TRACE(place);
    EXPECT_THAT(errors_with_bus("[[plc]]\nlisten = \"" + std::string(place) + "\"\n"), IsEmpty());
  }
}

TEST(PlantFile, Allow_SaysWhoMayConnect) {
  const PlantReading reading = read_plant(
      "[[plc]]\nlisten = \"0.0.0.0:5007\"\nallow = [\"192.168.1.0/24\", \"fd00::7\"]\n" +
          std::string(bus_that_serves) + "serve = \"socketcand:192.168.1.5:29536\"\nallow = \"10.0.0.7\"\n",
      "plant.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  const auto plc_allows = [&](std::string_view address) {
    return reading.plant.plcs[0].ports[0].allowed.allows(link::parse_internet_address(address).value());
  };
  EXPECT_TRUE(plc_allows("192.168.1.7"));
  EXPECT_TRUE(plc_allows("fd00::7"));
  EXPECT_FALSE(plc_allows("192.168.2.7"));
  EXPECT_TRUE(reading.plant.buses[0].allowed.allows(link::parse_internet_address("10.0.0.7").value()));
  EXPECT_FALSE(reading.plant.buses[0].allowed.allows(link::parse_internet_address("10.0.0.8").value()));
}

TEST(PlantFile, WrongAllow_IsAnErrorAtTheNetwork) {
  EXPECT_THAT(
      errors_with_bus("[[plc]]\nlisten = \"0.0.0.0:5007\"\nallow = [\"10.0.0.7/8\",\n  7]\n"),
      ElementsAre(
          HasSubstr("plant.toml:3:10: allow: \"10.0.0.7/8\" has bits behind its prefix; expected 10.0.0.0/8"),
          "plant.toml:4:3: allow: 7: expected networks such as \"192.168.1.0/24\""));
  EXPECT_THAT(errors_with_bus("[[plc]]\nlisten = \"off\"\nallow = \"10.0.0.7\"\n"),
              ElementsAre("plant.toml:3:9: allow = \"10.0.0.7\": no client can connect: listen is missing, "
                          "the address where it listens"));
}

TEST(PlantFile, CpuModelAndDevices_AreTheCpus) {
  const PlantReading reading = read_plant(
      "[[plc]]\ncpu_model = \"Q03UDVCPU\"\ndevices = { D = 8192, M = 16384, T = 512, ZR = 98304 }\n" +
          std::string(bus_that_serves),
      "plant.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  const plc::CpuModel& model = reading.plant.plcs[0].cpu_model;
  EXPECT_EQ(model.name, "Q03UDVCPU");
  EXPECT_EQ(model.points_of(plc::Device::d), 8192U);
  EXPECT_EQ(model.points_of(plc::Device::m), 16384U);
  EXPECT_EQ(model.points_of(plc::Device::ts), 512U);
  EXPECT_EQ(model.points_of(plc::Device::tn), 512U);
  EXPECT_EQ(model.points_of(plc::Device::zr), 98304U);
  EXPECT_EQ(model.points_of(plc::Device::r), 32768U);
}

TEST(PlantFile, AFamily_HasItsUsualCpu_AndItsOwnNamesForTheModulesPlace) {
  const auto model = [](std::string_view keys) {
    return read_plant("[[bus]]\nname = \"a\"\nbit_rate = 250_000\n[[plc]]\n" + std::string(keys), "p")
        .plant.plcs[0]
        .cpu_model;
  };
  EXPECT_EQ(model("family = \"Q\"\n").name, "Q03UDVCPU");
  EXPECT_EQ(model("family = \"iQ-R\"\n").name, "R04CPU");
  EXPECT_EQ(model("family = \"FX3\"\n").name, "FX3U");
  EXPECT_EQ(model("family = \"FX5\"\n").name, "FX5U");
  EXPECT_EQ(model("family = \"AS300\"\n").name, "AS300");
  EXPECT_EQ(model("cpu_model = \"FX3U\"\n").family, plc::CpuFamily::fx3);
  EXPECT_EQ(model("").name, "R04CPU");
}

TEST(PlantFile, AFamilyThatIsNone_OrThatOfAnotherCpu_IsAnError) {
  EXPECT_THAT(
      errors_with_bus("[[plc]]\nfamily = \"FX\"\n"),
      ElementsAre(
          "plant.toml:2:10: family = \"FX\": expected one of \"Q\", \"iQ-R\", \"FX3\", \"FX5\", \"AS300\""));
  EXPECT_THAT(
      errors_with_bus("[[plc]]\nfamily = \"FX3\"\ncpu_model = \"R04CPU\"\n"),
      ElementsAre(
          "plant.toml:3:13: cpu_model = \"R04CPU\": is a CPU of the family iQ-R, and family says FX3"));
  EXPECT_THAT(
      errors_with_bus("[[plc]]\nfamily = \"FX3\"\ndevices = { D = 4000 }\n"),
      ElementsAre("plant.toml:3:13: devices: D = 4000: expected none: the devices of an FX3U are fixed"));
}

TEST(PlantFile, AModuleThatDoesNotFitIntoTheRack_AndAPlaceThatIsNone_AreErrors) {
  const auto module = [](std::string_view family, std::string_view place) {
    return errors_with_bus("[[plc]]\nfamily = \"" + std::string(family) +
                           "\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nnode = 1\n" + std::string(place));
  };
  EXPECT_THAT(module("Q", "head = 0x30\n"), IsEmpty());
  const auto no_fit = [](std::string_view family) {
    return "plant.toml:4:9: model = \"ME3CAN1-Q\": its [[plc]] needs family = \"Q\" or \"iQ-R\"; this one "
           "has \"" +
           std::string(family) + "\"";
  };
  EXPECT_THAT(module("FX3", "position = 7\n"), ElementsAre(no_fit("FX3")));
  EXPECT_THAT(module("AS300", "card = 2\n"), ElementsAre(no_fit("AS300")));
  EXPECT_THAT(
      module("FX3", "position = 8\n"),
      ElementsAre(
          no_fit("FX3"),
          "plant.toml:6:12: position = 8: special function blocks are number 0 to 7, from the main unit on"));
  EXPECT_THAT(module("FX5", "unit = 0\n"),
              ElementsAre(no_fit("FX5"),
                          "plant.toml:6:8: unit = 0: unit numbers are 1 to 16, from the CPU module on"));
  EXPECT_THAT(module("FX5", "head = 0\n"), ElementsAre(no_fit("FX5")))
      << "head is right with the family that it needs";
  EXPECT_THAT(module("Q", "position = 0\n"),
              ElementsAre(HasSubstr("unknown key position; did you mean head?")));
  EXPECT_THAT(
      module("Q", "head = 8\n"),
      ElementsAre("plant.toml:6:8: head = 8: a head I/O number is a multiple of 10H from 0 to 0FF0H"));
}

TEST(PlantFile, AScan_IsATimeThatACpuTakes) {
  const PlantReading good = read_plant(
      "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n[[plc]]\nscan = \"2500us\"\n[[plc]]\nlisten = \"off\"\n",
      "plant.toml");
  ASSERT_THAT(good.errors, IsEmpty());
  EXPECT_EQ(good.plant.plcs[0].scan, 2500us);
  EXPECT_EQ(good.plant.plcs[1].scan, std::nullopt);
  EXPECT_THAT(errors_with_bus("[[plc]]\nscan = \"0s\"\n"),
              ElementsAre("plant.toml:2:8: scan = \"0s\": a scan takes 100us to 2s"));
  EXPECT_THAT(errors_with_bus("[[plc]]\nscan = \"2001ms\"\n"),
              ElementsAre(HasSubstr("a scan takes 100us to 2s")));
  EXPECT_THAT(
      errors_with_bus("[[plc]]\nscan = 10\n"),
      ElementsAre("plant.toml:2:8: scan = 10: expected a time with a unit in quotes, for example \"20ms\""));
  EXPECT_THAT(errors_with_bus("[[plc]]\nscan = \"10\"\n"), ElementsAre(HasSubstr("plant.toml:2:8: scan = ")));
}

TEST(PlantFile, DevicesACpuCannotHave_AreErrorsWithTheirLimits) {
  EXPECT_THAT(errors_with_bus("[[plc]]\ncpu_model = \"R08\"\n"),
              ElementsAre("plant.toml:2:13: cpu_model = \"R08\": expected one of \"R04CPU\", \"Q03UDVCPU\", "
                          "\"FX3U\", \"FX5U\", \"AS300\""));
  EXPECT_THAT(
      errors_with_bus("[[plc]]\ndevices = 5\n"),
      ElementsAre("plant.toml:2:11: devices = 5: expected a table, for example { D = 20480, M = 16384 "
                  "}"));
  EXPECT_THAT(
      errors_with_bus("[[plc]]\ndevices = { D = 20481 }\n"),
      ElementsAre("plant.toml:2:13: devices: D = 20481: expected 0 to 40960 points (R04CPU), a multiple of "
                  "4"));
  EXPECT_THAT(errors_with_bus("[[plc]]\ncpu_model = \"Q03UDVCPU\"\n[plc.devices]\nZR = 99328\nM = -16\n"),
              ElementsAre("plant.toml:4:1: devices: ZR = 99328: expected 0 to 98304 points (Q03UDVCPU), a "
                          "multiple of 1024",
                          "plant.toml:5:1: devices: M = -16: expected 0 to 61440 points (Q03UDVCPU), a "
                          "multiple of 16"));
  EXPECT_THAT(
      errors_with_bus("[[plc]]\ndevices = { X = 64 }\n"),
      ElementsAre("plant.toml:2:13: devices: X = 64: expected a device whose points can be set: M, L, F, V, "
                  "B, SB, T, ST, C, D, W, SW, ZR"));
  EXPECT_THAT(errors_with_bus("[[plc]]\ncpu_model = \"Q03UDVCPU\"\ndevices = { D = 20480 }\n"),
              ElementsAre("plant.toml:3:11: devices: with those that are not set here they need 37120 words; "
                          "expected at most 29696 (Q03UDVCPU, ZR not counted)"));
  EXPECT_THAT(errors_with_bus("[[plc]]\ndevices = { D = 20480, M = 16384 }\n"), IsEmpty());
}

TEST(PlantFile, MistakesOfTheCpu_AreFoundTogetherAndWithOthers) {
  EXPECT_THAT(
      errors_with_bus("[[plc]]\ncpu_model = 4\ndevices = { D = \"1K\", M = 7, q = 16 }\ncpu = \"off\"\n"),
      ElementsAre("plant.toml:2:13: cpu_model = 4: expected text in quotes",
                  "plant.toml:3:13: devices: D = \"1K\": expected a number of points",
                  "plant.toml:3:30: devices: q = 16: expected a device whose points can be set: M, L, "
                  "F, V, B, SB, T, ST, C, D, W, SW, ZR",
                  "plant.toml:4:7: cpu = \"off\": expected \"run\" or \"stop\""))
      << "M = 7 may be right or wrong: nobody knows of which CPU";
}

TEST(PlantFile, PlaceToListenThatIsNoAddress_IsAnError) {
  EXPECT_THAT(errors_with_bus("[[plc]]\nlisten = \"plc.local:5007\"\n"),
              ElementsAre(HasSubstr("plant.toml:2:10: listen: \"plc.local\" is not an address")));
}

}  // namespace
}  // namespace canopus::plant::plant_file_rules_test
