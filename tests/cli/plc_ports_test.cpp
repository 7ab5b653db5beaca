// `canopus plc` against ports of every kind: 1E, UDP, a remote password, Modbus TCP.

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/options/parser.hpp"
#include "canopus/client/plc_point.hpp"
#include "canopus/plc/modbus/as300_map.hpp"
#include "canopus/serve/melsec_server.hpp"
#include "canopus/serve/modbus_server.hpp"

#include "plc/conversation.hpp"

namespace canopus::cli::plc_ports_test {
namespace {

using ::testing::HasSubstr;
using ::testing::internal::CaptureStderr;
using ::testing::internal::CaptureStdout;
using ::testing::internal::GetCapturedStderr;
using ::testing::internal::GetCapturedStdout;
using Words = std::vector<std::string>;

class StandingClock final : public link::LoopClock {
 public:
  can::Time now() override { return can::Time(std::chrono::seconds(10)); }
  void touched() override {}
};

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// A rack with one server, which runs in a thread of its own.
class ServedPlc {
 public:
  explicit ServedPlc(serve::MelsecPort port, const plc::CpuModel& model = plc::r04cpu()) : plc_(model) {
    server_ = std::make_unique<serve::MelsecServer>(context_, plc_.rack, clock_, serve::MelsecServerOptions{},
                                                    link::ClientReport{}, std::move(port));
    start(*server_);
  }
  explicit ServedPlc(serve::ModbusPort port, const plc::CpuModel& model = plc::as300()) : plc_(model) {
    modbus_ = std::make_unique<serve::ModbusServer>(context_, plc_.rack, clock_, std::move(port));
    start(*modbus_);
  }
  ~ServedPlc() {
    boost::asio::post(context_, [this] { stop_(); });
    thread_.join();
  }
  ServedPlc(const ServedPlc&) = delete;
  ServedPlc& operator=(const ServedPlc&) = delete;

  /// `arguments` of canopus plc, with `options` of the port behind them.
  Outcome run(Words arguments, const Words& options) const {
    arguments.insert(arguments.begin(), "plc");
    arguments.insert(arguments.end(), {"--plc", std::to_string(port_)});
    arguments.insert(arguments.end(), options.begin(), options.end());
    Command app;
    Outcome outcome;
    add_plc_command(app, outcome.exit_code);
    CaptureStdout();
    CaptureStderr();
    if (const Parsing parsing = parse_words(app, arguments); parsing.result != Parsing::Result::ran) {
      outcome.exit_code = 100;
      outcome.err = parsing.text;
    }
    outcome.out = GetCapturedStdout();
    outcome.err += GetCapturedStderr();
    return outcome;
  }

 private:
  template <typename Server>
  void start(Server& server) {
    EXPECT_TRUE(server.listen("127.0.0.1", 0));
    port_ = server.port();
    stop_ = [&server] { server.stop(); };
    thread_ = std::thread([this] { context_.run(); });
  }

  StandingClock clock_;
  plc::testing::Plc plc_;
  boost::asio::io_context context_;
  std::unique_ptr<serve::MelsecServer> server_;
  std::unique_ptr<serve::ModbusServer> modbus_;
  std::function<void()> stop_;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

serve::MelsecPort port_1e() { return {.settings = {.takes_3e = false, .takes_1e = true}}; }
serve::MelsecPort udp(serve::MelsecPort port = {}) {
  port.udp = true;
  return port;
}

void expect_all_work(const ServedPlc& plc, const Words& options) {
  SCOPED_TRACE(::testing::PrintToString(options));
  EXPECT_EQ(plc.run({"write", "D100", "1234", "-5", "0FFFFH"}, options).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "D100", "-n", "3", "--format", "dec", "--signed"}, options).out,
            "D100  1234\nD101  -5\nD102  -1\n");
  EXPECT_EQ(plc.run({"write", "U0\\G13000", "7", "8"}, options).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "U0\\G13000", "-n", "2", "--format", "hex"}, options).out,
            "U0\\G13000  0007H\nU0\\G13001  0008H\n");
  EXPECT_EQ(plc.run({"write", "M5", "ON", "OFF", "ON"}, options).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "M4", "-n", "4"}, options).out, "M4  OFF\nM5  ON\nM6  OFF\nM7  ON\n");
  EXPECT_EQ(plc.run({"set", "Y1F"}, options).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "Y1F"}, options).out, "Y1F  ON\n");
  EXPECT_EQ(plc.run({"write", "D1000", "9"}, options).exit_code, 0);
  EXPECT_THAT(plc.run({"read", "D0", "-n", "1001", "--format", "dec"}, options).out, HasSubstr("D1000  9\n"));
  EXPECT_THAT(plc.run({"read", "M0", "-n", "1001"}, options).out, HasSubstr("M1000  OFF\n"));
  EXPECT_EQ(plc.run({"stop"}, options).exit_code, 0);
  EXPECT_EQ(plc.run({"run"}, options).exit_code, 0);
  EXPECT_EQ(plc.run({"type"}, options).out, "R04CPU  4800H\n");
  EXPECT_EQ(plc.run({"watch", "D100", "--csv", "--interval", "1ms", "--for", "2ms"}, options).exit_code, 0);
}

TEST(PlcPorts, In1e_OverTcpAndUdp_InBinaryAndAscii) {
  const ServedPlc tcp(port_1e());
  expect_all_work(tcp, {"--1e"});
  expect_all_work(tcp, {"--1e", "--ascii"});
  const ServedPlc datagrams(udp(port_1e()));
  expect_all_work(datagrams, {"--1e", "--udp"});
  expect_all_work(datagrams, {"--1e", "--udp", "--ascii"});
}

TEST(PlcPorts, In3eAnd4e_OverUdp) {
  const ServedPlc plc(udp());
  for (const Words& options :
       {Words{"--udp"}, {"--udp", "--4e"}, {"--udp", "--ascii"}, {"--udp", "--4e", "--ascii"}})
    expect_all_work(plc, options);
}

TEST(PlcPorts, In1e_WhatIsRefusedIsSaidInWords) {
  const ServedPlc plc(port_1e());
  Outcome outcome = plc.run({"read", "D99999"}, {"--1e"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err,
            "canopus plc: the PLC answers 58H: device number beyond the CPU's last one, or a word device in "
            "bits\n");
  EXPECT_THAT(plc.run({"read", "U5\\G0"}, {"--1e"}).err,
              HasSubstr("answers 5BH 12H: no module with this number"));
  outcome = plc.run({"read", "ZR0"}, {"--1e"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("1E frames cannot name ZR"));
  outcome = plc.run({"pause"}, {"--1e"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err, "canopus plc: 1E frames have no remote PAUSE and reset; 3E frames do\n");
  EXPECT_EQ(plc.run({"reset-cpu"}, {"--1e"}).exit_code, 2);
}

TEST(PlcPorts, ARemoteReset_IsDoneWhereItIsAllowed) {
  const serve::MelsecPort allowed{.settings = {.remote_reset = true}};
  for (const bool over_udp : {false, true}) {
    const ServedPlc plc(over_udp ? udp(allowed) : allowed);
    const Words options = over_udp ? Words{"--udp", "--timeout", "300ms"} : Words{};
    EXPECT_EQ(plc.run({"write", "D100", "7"}, options).exit_code, 0);
    EXPECT_THAT(plc.run({"reset-cpu"}, options).err,
                HasSubstr("4013H: not possible while the CPU is in RUN"));
    EXPECT_EQ(plc.run({"stop"}, options).exit_code, 0);
    EXPECT_EQ(plc.run({"reset-cpu"}, options).exit_code, 0);
    EXPECT_EQ(plc.run({"read", "D100", "--format", "dec"}, options).out, "D100  0\n");
    EXPECT_EQ(plc.run({"read", "SM203"}, options).out, "SM203  OFF\n") << "it comes up as its switch says";
  }
  const ServedPlc refuses{serve::MelsecPort{}};
  EXPECT_THAT(refuses.run({"reset-cpu"}, {}).err, HasSubstr("408BH"));
}

TEST(PlcPorts, AnFx3_IsKnownByItsCode_AndItsLongCountersAreNoWords) {
  const ServedPlc plc(port_1e(), plc::fx3u());
  EXPECT_EQ(plc.run({"type"}, {"--1e"}).out, "FX3U  00F3H\n");
  EXPECT_EQ(plc.run({"set", "Y17"}, {"--1e", "--octal"}).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "YF"}, {"--1e"}).out, "YF  ON\n");
  const Outcome outcome = plc.run({"read", "CN200"}, {"--1e", "--octal"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("C200 to C255 of an FX have 32 bits"));
}

TEST(PlcPorts, AnFx5InAscii_GetsItsOctalNumbers) {
  const ServedPlc plc(serve::MelsecPort{}, plc::fx5u());
  EXPECT_EQ(plc.run({"set", "Y17"}, {"--ascii", "--octal"}).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "YF"}, {}).out, "YF  ON\n");
  EXPECT_EQ(plc.run({"read", "YF"}, {"--ascii"}).exit_code, 1);
}

TEST(PlcPorts, ARemotePassword_UnlocksThePort) {
  const serve::MelsecPort locked{.settings = {.remote_password = "secret"}};
  for (const bool over_udp : {false, true}) {
    const ServedPlc plc(over_udp ? udp(locked) : locked);
    Words options = over_udp ? Words{"--udp"} : Words{};
    Outcome outcome = plc.run({"read", "D0"}, options);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("C201H: locked by a remote password"));
    options.insert(options.end(), {"--password", "secret"});
    expect_all_work(plc, options);
    options.push_back("--ascii");
    expect_all_work(plc, options);
    outcome = plc.run({"read", "D0"},
                      over_udp ? Words{"--udp", "--password", "wrong!"} : Words{"--password", "wrong!"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("C810H: wrong remote password"));
    EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("wrong!")));
  }
}

TEST(PlcPorts, NobodyBehindAUdpPort_IsSaid) {
  const ServedPlc plc(port_1e());  // TCP: the UDP port of this number is nobody's
  const Outcome outcome = plc.run({"read", "D0"}, {"--udp", "--timeout", "2s"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("Connection refused. Is `canopus run` running"));
  EXPECT_THAT(outcome.err, HasSubstr("for the MC protocol, UDP\n"));
}

TEST(PlcPorts, OptionsThatDoNotGoTogether_AreUsage) {
  const ServedPlc plc(port_1e());
  for (const Words& options : {Words{"--1e", "--3e"},
                               {"--1e", "--4e"},
                               {"--3e", "--4e"},
                               {"--modbus", "--1e"},
                               {"--modbus", "--udp"},
                               {"--modbus", "--ascii"},
                               {"--modbus", "--octal"},
                               {"--unit", "5"},
                               {"--1e", "--password", "secret"},
                               {"--modbus", "--password", "secret"},
                               {"--password", std::string(33, 'x')}}) {
    const Outcome outcome = plc.run({"read", "D0"}, options);
    EXPECT_EQ(outcome.exit_code, 2) << ::testing::PrintToString(options);
    EXPECT_THAT(outcome.err, ::testing::StartsWith("canopus plc: --"));
  }
  EXPECT_EQ(plc.run({"read", "D0"}, {"--modbus", "--unit", "256"}).exit_code, 100);
}

// --- Modbus TCP ---

serve::ModbusPort as300_port() {
  return {.settings = {.map = plc::modbus::as300_map(plc::as300()), .limits = plc::modbus::as300_limits()}};
}

const Words modbus = {"--modbus"};

TEST(PlcModbus, AnAs300_IsReadAndWrittenByItsDevices) {
  const ServedPlc plc(as300_port());
  EXPECT_EQ(plc.run({"write", "D29998", "1234", "-5"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "D29998", "-n", "2", "--format", "dec", "--signed"}, modbus).out,
            "D29998  1234\nD29999  -5\n");
  EXPECT_EQ(plc.run({"write", "SR100", "7"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "sr100", "--format", "dec"}, modbus).out, "SR100  7\n");
  EXPECT_EQ(plc.run({"set", "Y1.15"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "Y1.14", "-n", "3"}, modbus).out, "Y1.14  OFF\nY1.15  ON\nY2.0   OFF\n");
  EXPECT_EQ(plc.run({"read", "Y1", "--format", "hex"}, modbus).out, "Y1  8000H\n");
  EXPECT_EQ(plc.run({"write", "Y1", "1"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "Y1.0"}, modbus).out, "Y1.0  ON\n");
  EXPECT_EQ(plc.run({"read", "X63.15"}, modbus).out, "X63.15  OFF\n");
  EXPECT_EQ(plc.run({"read", "X63", "--format", "dec"}, modbus).out, "X63  0\n");
  EXPECT_EQ(plc.run({"write", "M8190", "ON", "ON"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "M8191"}, modbus).out, "M8191  ON\n");
  EXPECT_EQ(plc.run({"read", "SM400"}, modbus).out, "SM400  ON\n");
  EXPECT_EQ(plc.run({"write", "T5", "50"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "T5", "--format", "dec"}, modbus).out, "T5  50\n");
  EXPECT_EQ(plc.run({"set", "CS3"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "D0", "-n", "1000", "--format", "dec"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "M0", "-n", "4000"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"dump", "Y0.14..Y1.1", "D29999", "X2..X3"}, modbus).out,
            "address,value\nY0.14,OFF\nY0.15,OFF\nY1.0,ON\nY1.1,OFF\nD29999,65531\nX2,0\nX3,0\n");
}

TEST(PlcModbus, AddressesThemselves) {
  const ServedPlc plc(as300_port());
  EXPECT_EQ(plc.run({"write", "holding:100", "77"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "D100", "--format", "dec"}, modbus).out, "D100  77\n");
  EXPECT_EQ(plc.run({"set", "coil:40960"}, modbus).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "Y0.0"}, modbus).out, "Y0.0  ON\n");
  EXPECT_EQ(plc.run({"read", "discrete:24576"}, modbus).out, "discrete:24576  OFF\n");
  EXPECT_EQ(plc.run({"read", "input:32768", "--format", "dec"}, modbus).out, "input:32768  0\n");
  EXPECT_EQ(plc.run({"write", "holding:64513", "1", "2", "--no-verify"}, modbus).exit_code, 0) << "HC1";
  EXPECT_EQ(plc.run({"read", "holding:64513", "-n", "2", "--format", "dec"}, modbus).out,
            "holding:64513  1\nholding:64514  2\n");
  EXPECT_THAT(plc.run({"write", "input:5", "1"}, modbus).err, HasSubstr("input:5 can only be read"));
  EXPECT_THAT(plc.run({"set", "discrete:5"}, modbus).err, HasSubstr("discrete:5 can only be read"));
}

TEST(PlcModbus, WhatIsRefused_IsSaidInWords) {
  serve::ModbusPort port = as300_port();
  port.settings.unit = 3;
  const ServedPlc plc(port);
  EXPECT_EQ(plc.run({"read", "D0"}, {"--modbus", "--unit", "3"}).exit_code, 0);
  EXPECT_EQ(plc.run({"read", "D0"}, modbus).exit_code, 0) << "255 is the device that has the port";
  Outcome outcome = plc.run({"read", "D0"}, {"--modbus", "--unit", "4"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err, "canopus plc: the PLC answers exception 0BH: no device has this unit identifier\n");
  EXPECT_EQ(plc.run({"set", "X0.0"}, modbus).err,
            "canopus plc: the PLC answers exception 02H: no such address, or it cannot be written\n");
  outcome = plc.run({"read", "D29999", "-n", "2"}, modbus);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err, "canopus plc: D30000 is beyond the last one of an AS300\n");
  EXPECT_THAT(plc.run({"type"}, modbus).err, HasSubstr("exception 01H: this function is not there"));
  EXPECT_EQ(plc.run({"stop"}, modbus).err, "canopus plc: Modbus TCP has no remote operation of a CPU\n");
  for (const char* address :
       {"ZR5", "X1.16", "X", "D", "U0\\G5", "D1F", "relay:5", "holding:65536", "holding:", "X1.", ".5", ""})
    EXPECT_EQ(plc.run({"read", address}, modbus).exit_code, 2) << address;
  EXPECT_THAT(plc.run({"read", "HC5"}, modbus).err, HasSubstr("its value two words from holding:64512 on"));
}

TEST(PlcModbus, AnotherPlc_SaysWhatItIs) {
  serve::ModbusPort port{.settings = {.map = plc::modbus::default_map(plc::r04cpu())}};
  port.settings.identification.objects = {"Canopus", "R04CPU", "1.0", "", "", "", ""};
  const ServedPlc plc(port, plc::r04cpu());
  EXPECT_EQ(plc.run({"type"}, modbus).out, "Canopus R04CPU 1.0\n");
}

}  // namespace
}  // namespace canopus::cli::plc_ports_test
