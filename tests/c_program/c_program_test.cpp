// PLC programs in C: compiled here by the C compiler, loaded, and run scan by scan.

#include "canopus/c_program/c_program.hpp"

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "canopus/program/machine.hpp"

#include "paths.hpp"
#include "structured_text/memory_devices.hpp"

namespace c_program_test {
namespace {

namespace fs = std::filesystem;
using canopus::program::Machine;
using Loaded = std::expected<std::shared_ptr<const canopus::program::Program>, std::string>;

class CProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("gcc --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gcc is not installed";
    std::string name = (fs::temp_directory_path() / "c_program_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder = name;
  }
  void TearDown() override {
    if (!folder.empty()) fs::remove_all(folder);
  }

  /// Its path; the compiler must have nothing to say.
  [[nodiscard]] std::string compile(const fs::path& source) const {
    std::string object = (folder / "main.so").string();
    const std::string command =
        "gcc -O2 -Wall -Wextra -Wpedantic -Werror -shared -fPIC -I " CANOPUS_SOURCE_DIR
        "/canopus/program -o " +
        object + " " + source.string();
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return object;
  }
  [[nodiscard]] Loaded load_text(const std::string& text) {
    const fs::path source = folder / "main.c";
    std::ofstream(source) << text;
    return canopus::c_program::load(compile(source), devices);
  }
  /// A program of these declarations, a table of variables, and a body of scan().
  [[nodiscard]] static std::string source(const std::string& declarations, const std::string& table,
                                          const std::string& scan) {
    return "#include <canopus_program.h>\n" + declarations +
           "\nstatic const char *scan(const canopus_image *image, int64_t now_ns) {\n(void)image; "
           "(void)now_ns;\n" +
           scan + "\nreturn 0;\n}\nstatic const canopus_variable variables[] = {\n" + table +
           "\n};\nstatic const canopus_program_info info = {CANOPUS_PROGRAM_ABI, sizeof variables / sizeof "
           "*variables, variables, 0, scan};\n"
           "const canopus_program_info *canopus_program(void) { return &info; }\n";
  }
  /// The fault's text; empty: none.
  std::string scan(Machine& machine, int scans = 1) {
    for (int i = 0; i < scans; ++i) {
      const auto fault = machine.scan(now, &devices);
      now += 10'000'000;
      if (fault) return fault_text(machine.program(), *fault);
    }
    return {};
  }

  fs::path folder;
  memory_devices::MemoryDevices devices;
  std::int64_t now = 0;
};

TEST_F(CProgram, Example_FillsTheTank) {
  const Loaded program =
      canopus::c_program::load(compile(CANOPUS_SOURCE_DIR "/examples/c-program/main.c"), devices);
  ASSERT_TRUE(program) << program.error();
  Machine machine(*program);
  EXPECT_EQ(machine.read("limit"), "2.5");
  EXPECT_EQ(scan(machine), "");
  EXPECT_EQ(devices.word('Y', 020), 0);
  devices.word('X', 010) = 1;
  EXPECT_EQ(scan(machine), "");
  EXPECT_EQ(devices.word('Y', 020), 1);
  EXPECT_EQ(machine.read("pump"), "TRUE");
  EXPECT_EQ(machine.read("fillings"), "1");
  devices.word('X', 010) = 0;
  EXPECT_EQ(scan(machine, 100), "");
  // 101 scans of 10 ms with the pump ON.
  EXPECT_EQ(machine.read("running_time"), "T#1s10ms");
  EXPECT_NEAR(std::stod(machine.read("level").value()), 0.101, 1e-5);
  const float level =
      std::bit_cast<float>(devices.word('D', 100) | std::uint32_t{devices.word('D', 101)} << 16U);
  EXPECT_NEAR(level, 0.101, 1e-5);
  // By name, as a client does.
  EXPECT_TRUE(machine.write("level", "2.4995"));
  EXPECT_EQ(scan(machine), "");
  EXPECT_EQ(machine.read("pump"), "FALSE");
  EXPECT_EQ(devices.word('Y', 020), 0);
  // RETAIN over a power cut; the others begin anew.
  machine.warm_start();
  EXPECT_EQ(machine.read("fillings"), "1");
  EXPECT_EQ(machine.read("level"), "0.0");
  machine.cold_start();
  EXPECT_EQ(machine.read("fillings"), "0");
  EXPECT_TRUE(machine.write("limit", "0.0"));
  EXPECT_EQ(scan(machine), (folder / "main.so").string() + ": the limit of the level is not above 0");
}

TEST_F(CProgram, EachType_IsReadAndWrittenByName) {
  const Loaded program = load_text(source(
      "static uint8_t b = 1, us = 200; static int8_t s = -3; static int16_t i = -300; static int32_t d = "
      "-70000;\n"
      "static int64_t l = -5000000000; static uint16_t u = 60000; static uint32_t ud = 4000000000u;\n"
      "static uint64_t ul = 18000000000000000000u; static float r = 1.5f; static double lr = 0.1;\n"
      "static int64_t t = 1500000000, date = 86400000000000; static char text[6] = \"hello\"; static "
      "uint16_t w[3] = {1, 2, 3};\n"
      "static char names[2][4] = {\"ab\", \"cde\"};",
      "{\"b\", CANOPUS_BOOL, 0, 0, 0, &b, 0}, {\"s\", CANOPUS_SINT, 0, 0, 0, &s, 0}, {\"us\", CANOPUS_USINT, "
      "0, "
      "0, 0, &us, 0}, {\"i\", CANOPUS_INT, 0, 0, 0, &i, 0}, {\"d\", CANOPUS_DINT, 0, 0, 0, &d, 0}, {\"l\", "
      "CANOPUS_LINT, 0, 0, 0, &l, 0}, {\"u\", CANOPUS_UINT, 0, 0, 0, &u, 0}, {\"ud\", CANOPUS_UDINT, 0, 0, "
      "0, "
      "&ud, 0}, {\"ul\", CANOPUS_ULINT, 0, 0, 0, &ul, 0}, {\"r\", CANOPUS_REAL, 0, 0, 0, &r, 0}, {\"lr\", "
      "CANOPUS_LREAL, 0, 0, 0, &lr, 0}, {\"t\", CANOPUS_TIME, 0, 0, 0, &t, 0}, {\"date\", CANOPUS_DATE, 0, "
      "0, 0, "
      "&date, 0}, {\"text\", CANOPUS_STRING, 0, 5, 0, text, 0}, {\"w\", CANOPUS_WORD, 3, 0, 0, w, 0}, "
      "{\"names\", "
      "CANOPUS_STRING, 2, 3, 0, names, 0}, {\"fixed\", CANOPUS_INT, 0, 0, CANOPUS_CONSTANT, &i, 0}",
      "s = (int8_t)(s - 1); i = (int16_t)(i * 2); text[1] = 'a'; w[2] = 0x1234;"));
  ASSERT_TRUE(program) << program.error();
  Machine machine(*program);
  const std::pair<const char*, const char*> initial[] = {{"b", "TRUE"},
                                                         {"s", "-3"},
                                                         {"us", "200"},
                                                         {"i", "-300"},
                                                         {"d", "-70000"},
                                                         {"l", "-5000000000"},
                                                         {"u", "60000"},
                                                         {"ud", "4000000000"},
                                                         {"ul", "18000000000000000000"},
                                                         {"r", "1.5"},
                                                         {"lr", "0.1"},
                                                         {"t", "T#1s500ms"},
                                                         {"date", "DATE#1970-01-02"},
                                                         {"text", "'hello'"},
                                                         {"w", "[16#0001, 16#0002, 16#0003]"},
                                                         {"names[1]", "'cde'"},
                                                         {"w[1]", "16#0002"}};
  for (const auto& [name, value] : initial) EXPECT_EQ(machine.read(name), value) << name;
  EXPECT_TRUE(machine.write("s", "-128"));
  EXPECT_TRUE(machine.write("text", "'xyz'"));
  EXPECT_TRUE(machine.force("d", "7"));
  EXPECT_EQ(scan(machine), "");
  EXPECT_EQ(machine.read("s"), "127");
  EXPECT_EQ(machine.read("i"), "-600");
  EXPECT_EQ(machine.read("text"), "'xaz'");
  EXPECT_EQ(machine.read("w[2]"), "16#1234");
  EXPECT_EQ(machine.read("d"), "7");
  EXPECT_EQ(machine.write("fixed", "1").error(), "'fixed' is a constant");
}

TEST_F(CProgram, Devices_AreReadBeforeTheScanAndWrittenBehindIt) {
  const Loaded program = load_text(source(
      "static uint8_t in[3], out[3]; static uint16_t points, copy[2]; static int32_t d;",
      "{\"in\", CANOPUS_BOOL, 3, 0, CANOPUS_INPUT, in, \"X4\"}, {\"out\", CANOPUS_BOOL, 3, 0, "
      "CANOPUS_OUTPUT, out, "
      "\"Y4\"}, {\"points\", CANOPUS_WORD, 0, 0, CANOPUS_INPUT | CANOPUS_OUTPUT, &points, \"M16\"}, "
      "{\"copy\", "
      "CANOPUS_WORD, 2, 0, 0, copy, \"U0\\\\G5\"}, {\"d\", CANOPUS_DINT, 0, 0, CANOPUS_INPUT, &d, \"D0\"}",
      "for (int i = 0; i < 3; ++i) out[i] = in[2 - i];\n"
      "++points; if (image->read(image, 3) != 0) return \"no buffer memory\"; copy[1] = (uint16_t)(copy[0] + "
      "d);\n"
      "if (image->write(image, 3) != 0) return \"no buffer memory\";\n"
      "if (image->read(image, 99) == 0) return "
      "\"a variable that is not there\";"));
  ASSERT_TRUE(program) << program.error();
  Machine machine(*program);
  devices.word('X', 4) = 1;
  devices.word('M', 16) = devices.word('M', 17) = devices.word('M', 31) = 1;  // 16#8003
  devices.buffer[5] = 40;
  devices.word('D', 0) = 0xFFFE;
  devices.word('D', 1) = 0xFFFF;  // -2
  EXPECT_EQ(scan(machine), "");
  EXPECT_EQ(devices.word('Y', 4), 0);
  EXPECT_EQ(devices.word('Y', 6), 1);
  EXPECT_EQ(machine.read("points"), "16#8004");
  EXPECT_EQ(devices.word('M', 16), 0);
  EXPECT_EQ(devices.word('M', 18), 1);
  EXPECT_EQ(devices.buffer[6], 38);
}

TEST_F(CProgram, TwoOfOneFile_HaveVariablesOfTheirOwn) {
  const std::string text = source("static int32_t n;", "{\"n\", CANOPUS_DINT, 0, 0, 0, &n, 0}",
                                  "static int32_t scans; n = ++scans;");
  const Loaded first = load_text(text);
  ASSERT_TRUE(first) << first.error();
  const Loaded second = canopus::c_program::load((folder / "main.so").string(), devices);
  ASSERT_TRUE(second) << second.error();
  Machine one(*first);
  Machine other(*second);
  EXPECT_EQ(scan(one, 3), "");
  EXPECT_EQ(scan(other), "");
  EXPECT_EQ(one.read("n"), "3");
  EXPECT_EQ(other.read("n"), "1");
  // The online change takes the file as it is now, and keeps the variables.
  const Loaded changed =
      load_text(source("static int32_t n;", "{\"n\", CANOPUS_DINT, 0, 0, 0, &n, 0}", "n += 10;"));
  ASSERT_TRUE(changed) << changed.error();
  one.change(*changed);
  EXPECT_EQ(scan(one), "");
  EXPECT_EQ(one.read("n"), "13");
}

TEST_F(CProgram, WrongFile_IsAnErrorThatSaysWhatWasExpected) {
  EXPECT_EQ(canopus::c_program::load((folder / "none.so").string(), devices).error(),
            "No such file or directory");
  fs::create_directory(folder / "folder.so");
  EXPECT_EQ(canopus::c_program::load((folder / "folder.so").string(), devices).error(), "expected a file");
  ASSERT_EQ(::mkfifo((folder / "fifo.so").c_str(), 0600), 0);
  EXPECT_EQ(canopus::c_program::load((folder / "fifo.so").string(), devices).error(), "expected a file")
      << "it is not waited for its other end";
  std::ofstream(folder / "text.so") << "PROGRAM P END_PROGRAM";
  EXPECT_EQ(canopus::c_program::load((folder / "text.so").string(), devices).error(),
            "expected a shared object of this machine: file too short");
  EXPECT_EQ(load_text("int a_function(void);\nint a_function(void) { return 1; }\n").error(),
            "expected a function canopus_program() in it");
  EXPECT_EQ(
      load_text("#include <canopus_program.h>\nstatic const canopus_program_info info = {99, 0, 0, 0, 0};\n"
                "const canopus_program_info *canopus_program(void) { return &info; }\n")
          .error(),
      "expected version 1 of canopus_program.h, found 99");
  EXPECT_EQ(
      load_text("#include <canopus_program.h>\nstatic const canopus_program_info info = {1, 0, 0, 0, 0};\n"
                "const canopus_program_info *canopus_program(void) { return &info; }\n")
          .error(),
      "expected a function for a scan");
  const auto error_of = [&](const std::string& table) {
    return load_text(source("static int16_t n; static uint8_t b;", table, "n = b;")).error();
  };
  EXPECT_EQ(error_of("{\"1n\", CANOPUS_INT, 0, 0, 0, &n, 0}"),
            "variable 0: expected a name of letters, digits and _ that begins with no digit");
  EXPECT_EQ(error_of("{\"n\", CANOPUS_INT, 0, 0, 0, &n, 0}, {\"N\", CANOPUS_INT, 0, 0, 0, &n, 0}"),
            "variable N: expected another name: it is there twice");
  EXPECT_EQ(error_of("{\"n\", 77, 0, 0, 0, &n, 0}"),
            "variable n: expected one of the types of canopus_program.h");
  EXPECT_EQ(error_of("{\"n\", CANOPUS_INT, 0, 0, 0, 0, 0}"), "variable n: expected a place of its value");
  EXPECT_EQ(error_of("{\"n\", CANOPUS_STRING, 0, 0, 0, &n, 0}"),
            "variable n: expected a length from 1 to 1024 of a STRING, and 0 of any other type");
  EXPECT_EQ(error_of("{\"n\", CANOPUS_INT, 0, 0, 64, &n, 0}"),
            "variable n: expected flags of canopus_program.h");
  EXPECT_EQ(error_of("{\"n\", CANOPUS_INT, 4000001, 0, 0, &n, 0}"),
            "variable n: the program's variables are too large");
  EXPECT_EQ(error_of("{\"n\", CANOPUS_INT, 0, 0, CANOPUS_INPUT, &n, 0}"),
            "variable n: expected a device of an input or output");
  EXPECT_EQ(error_of("{\"n\", CANOPUS_INT, 0, 0, 0, &n, \"Q5\"}"), "variable n: Q5: expected a device");
  EXPECT_EQ(error_of("{\"b\", CANOPUS_BOOL, 0, 0, 0, &b, \"D5\"}"),
            "variable b: D5: expected a BOOL at a bit device, or a type of 16, 32 or 64 bits at any device");
}

TEST_F(CProgram, DeviceThatIsNotThere_StopsTheCpu) {
  const Loaded program = load_text(
      source("static uint16_t n[50];", "{\"n\", CANOPUS_WORD, 50, 0, CANOPUS_INPUT, n, \"D250\"}", ""));
  ASSERT_TRUE(program) << program.error();
  Machine machine(*program);
  EXPECT_EQ(scan(machine), "D250: the CPU or the module has no such device");
}

}  // namespace
}  // namespace c_program_test
