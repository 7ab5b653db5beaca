// Transfer setups: their file, `canopus configure setup`, and --setup of commands that reach a PLC.

#include "canopus/cli/plc/transfer_setups.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/module_settings/configure_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/options/parser.hpp"
#include "canopus/serve/melsec_server.hpp"
#include "canopus/store/folder_lock.hpp"

#include "plc/conversation.hpp"

namespace canopus::cli::transfer_setups_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using Words = std::vector<std::string>;

class SetupClock final : public link::LoopClock {
 public:
  can::Time now() override { return can::Time(std::chrono::seconds(10)); }
  void touched() override {}
};

/// A state folder of the test's own.
class TransferSetupTest : public ::testing::Test {
 protected:
  TransferSetupTest() {
    std::string name = (fs::temp_directory_path() / "canopus-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder");
    state_ = name;
    if (const char* const before = std::getenv("XDG_STATE_HOME")) before_ = before;
    ::setenv("XDG_STATE_HOME", name.c_str(), 1);
  }
  ~TransferSetupTest() override {
    if (before_) {
      ::setenv("XDG_STATE_HOME", before_->c_str(), 1);
    } else {
      ::unsetenv("XDG_STATE_HOME");
    }
    fs::remove_all(state_);
  }

  struct Outcome {
    int exit_code = -1;
    std::string out;
    std::string err;
  };
  static Outcome run(Words words) {
    Command app;
    Outcome outcome;
    add_plc_command(app, outcome.exit_code);
    add_configure_command(app, outcome.exit_code);
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    std::string mistake;
    if (const Parsing parsing = parse_words(app, words); parsing.result != Parsing::Result::ran) {
      outcome.exit_code = 2;
      mistake = parsing.text;
    }
    outcome.out = ::testing::internal::GetCapturedStdout();
    outcome.err = ::testing::internal::GetCapturedStderr() + mistake;
    return outcome;
  }
  static Outcome setup(Words words) {
    words.insert(words.begin(), {"configure", "setup"});
    return run(std::move(words));
  }
  [[nodiscard]] fs::path file() const { return state_ / "canopus" / "transfer-setups"; }
  void write(const std::string& text) const {
    fs::create_directories(file().parent_path());
    std::ofstream(file()) << text;
  }
  [[nodiscard]] std::string text() const {
    std::ifstream in(file());
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path state_;
  std::optional<std::string> before_;
};

TEST_F(TransferSetupTest, Set_OfANewNameMakesOne_AndOfAKnownNameChangesWhatIsGiven) {
  EXPECT_EQ(setup({"list"}).out, "");
  EXPECT_EQ(setup({"set", "line 1", "--plc", "192.168.3.39:5010", "--udp", "--4e", "--ascii", "--timeout",
                   "1s", "--cpu", "3", "--cpu-type", "R08SF", "--module", "RJ71CN91"})
                .exit_code,
            0);
  const TransferSetup whole{.host = "192.168.3.39",
                            .port = 5010,
                            .frame = "4E",
                            .ascii = true,
                            .udp = true,
                            .timeout = "1s",
                            .cpu = 3,
                            .cpu_type = "R08SF",
                            .model = "RJ71CN91"};
  EXPECT_EQ(find_transfer_setup("line 1"), whole);
  EXPECT_EQ(setup({"set", "line 1", "--tcp", "--3e", "--binary", "--cpu", "none", "--cpu-type", "any",
                   "--module", "any"})
                .exit_code,
            0);
  EXPECT_EQ(find_transfer_setup("line 1"),
            (TransferSetup{.host = "192.168.3.39", .port = 5010, .timeout = "1s"}));
  EXPECT_EQ(setup({"set", "other"}).exit_code, 0);
  EXPECT_EQ(
      setup({"list"}).out,
      "line 1               192.168.3.39:5010, TCP, 3E\nother                127.0.0.1:5007, TCP, 3E\n");
  // Nobody else reads them.
  EXPECT_EQ(fs::status(file()).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(TransferSetupTest, Show_HasTheNamesThatTheToolPrints) {
  setup({"set", "line1", "--plc", "10.0.0.1", "--cpu", "2", "--cpu-type", "R16SF"});
  const std::string shown = setup({"show", "line1"}).out;
  for (const char* line : {"Select transfer setup   line1\n", "PC side I/F             Ethernet board\n",
                           "Connect module          CPU module\n", "Protocol                TCP\n",
                           "Time out                3s\n", "PLC side I/F            CPU module\n",
                           "\nCPU series              R Safety\n", "CPU type                R16SF\n",
                           "Host(IP Address)        10.0.0.1\n", "Station type            Host station\n",
                           "Connect CPU series      R Safety\n", "Multiple CPU            No.2\n"}) {
    EXPECT_THAT(shown, HasSubstr(line));
  }
  EXPECT_EQ(setup({"show", "line1", "--json"}).out,
            R"({"name":"line1","host":"10.0.0.1","port":null,"frame":"3E","code":"binary","protocol":"TCP",)"
            R"("timeout":"3s","cpu":2,"cpu_type":"R16SF","model":null})"
            "\n");
  EXPECT_THAT(setup({"show", "line2"}).err, HasSubstr("did you mean \"line1\"?"));
}

TEST_F(TransferSetupTest, RenameAndRemove_KeepTheRest) {
  setup({"set", "a", "--plc", "1"});
  setup({"set", "b", "--plc", "2"});
  EXPECT_EQ(setup({"rename", "a", "b"}).exit_code, 2);
  EXPECT_EQ(setup({"rename", "c", "d"}).exit_code, 2);
  EXPECT_EQ(setup({"rename", "a", "../a"}).exit_code, 2);
  EXPECT_EQ(read_transfer_setups()->size(), 2U);
  EXPECT_EQ(setup({"rename", "a", "c"}).exit_code, 0);
  EXPECT_EQ(find_transfer_setup("c")->port, 1);
  EXPECT_FALSE(find_transfer_setup("a"));
  EXPECT_EQ(setup({"remove", "a"}).exit_code, 2);
  EXPECT_EQ(setup({"remove", "c"}).exit_code, 0);
  EXPECT_EQ(setup({"list"}).out, "b                    127.0.0.1:2, TCP, 3E\n");
}

TEST_F(TransferSetupTest, WhatIsRefused_ChangesNothing) {
  setup({"set", "a", "--plc", "1"});
  const std::string before = text();
  struct Case {
    Words words;
    const char* expected;
  };
  const std::vector<Case> cases{
      {{"set", ""}, "expected 1 to 64 printable characters"},
      {{"set", std::string(65, 'x')}, "expected 1 to 64 printable characters"},
      {{"set", "a\nb"}, "\"a\\nb\" is no name"},
      {{"set", "\x1b[2J"}, "is no name"},
      {{"set", "\xff"}, "is no name"},
      {{"set", " a"}, "is no name"},
      {{"set", "../a"}, "is no name"},
      {{"set", "<New>"}, "is no name"},
      {{"set", "a", "--plc", ""}, "is no address of a PLC"},
      {{"set", "a", "--plc", "x y"}, "expected a name or an address"},
      {{"set", "a", "--plc", "0"}, "1 to 65535"},
      {{"set", "a", "--plc", "65536"}, "1 to 65535"},
      {{"set", "a", "--timeout", "0s"}, "a: timeout = \"0s\": expected at least 1ms"},
      {{"set", "a", "--timeout", "soon"}, "timeout: "},
      {{"set", "a", "--cpu", "5"}, "\"5\" is unknown"},
      {{"set", "a", "--cpu-type", "R5"}, "\"R5\" is unknown"},
      {{"set", "a", "--module", "X"}, "expected any or one of"},
      {{"set", "a", "--cpu", "1", "--1e"}, "a: cpu: a 1E frame names no CPU"},
      {{"set", "a", "--tcp", "--udp"}, "cannot be combined with"},
      {{"set", "a", "--3e", "--1e"}, "cannot be combined with"},
      {{"set", "a", "--password", "x"}, "not expected"},
  };
  for (const Case& one : cases) {
    const Outcome outcome = setup(one.words);
    EXPECT_EQ(outcome.exit_code, 2) << ::testing::PrintToString(one.words);
    EXPECT_THAT(outcome.err, HasSubstr(one.expected));
    EXPECT_EQ(text(), before);
  }
}

TEST_F(TransferSetupTest, WrongFile_IsSaidWithItsLine_AndLosesNothing) {
  const std::string good = R"({"name":"good","host":"10.0.0.1"})";
  struct Case {
    std::string line;
    const char* expected;
  };
  const std::vector<Case> cases{
      {"{", ":2: expected a JSON object"},
      {"", ":2: expected a JSON object"},
      {"[]", ":2: expected a JSON object"},
      {R"({"name":)" + std::string(100'000, '[') + std::string(100'000, ']') + "}",
       ":2: expected a JSON object"},
      {R"({"host":"a"})", ":2: expected \"name\", a text"},
      {R"({"name":5})", ":2: expected \"name\", a text"},
      {R"({"name":"a/b"})", ":2: \"a/b\" is no name"},
      {R"({"name":"good"})", ":2: a second setup \"good\""},
      {R"({"name":"x","host":5})", ":2: host: expected a text"},
      {R"({"name":"x","host":"-x"})", ":2: host = \"-x\": expected a name or an address"},
      {R"({"name":"x","udp":1})", ":2: udp: expected true or false"},
      {R"({"name":"x","port":65536})", ":2: port: expected a number from 0 to 65535"},
      {R"({"name":"x","port":-1})", ":2: port: expected a number from 0 to 65535"},
      {R"({"name":"x","cpu":5})", ":2: cpu: expected a number from 0 to 4"},
      {R"({"name":"x","frame":"2E"})", ":2: frame = \"2E\": expected 3E, 4E or 1E"},
      {R"({"name":"x","cpu_type":"Q03"})", ":2: cpu_type = \"Q03\": expected R00, "},
      {R"({"name":"x","password":"secret"})", ":2: password: unknown"},
      {"{\"name\":\"x\",\"\x1b\":1}", ":2: "},
  };
  for (const Case& one : cases) {
    const std::string wrong = good + "\n" + one.line + "\n" + R"({"name":"last"})" + "\n";
    write(wrong);
    for (const Words& words :
         {Words{"list"}, {"show", "good"}, {"set", "new"}, {"remove", "good"}, {"test", "good"}}) {
      const Outcome outcome = setup(words);
      EXPECT_EQ(outcome.exit_code, 2) << one.line;
      EXPECT_THAT(outcome.err, HasSubstr(file().string() + one.expected));
      EXPECT_EQ(text(), wrong);
    }
  }
}

TEST_F(TransferSetupTest, AtMost200_AndAFileThatIsNone) {
  std::string lines;
  for (std::size_t i = 0; i < most_transfer_setups; ++i)
    lines += R"({"name":")" + std::to_string(i) + "\"}\n";
  write(lines);
  EXPECT_THAT(setup({"set", "more"}).err, HasSubstr("200 transfer setups are kept at most"));
  EXPECT_EQ(text(), lines);
  EXPECT_EQ(setup({"remove", "7"}).exit_code, 0);
  EXPECT_EQ(setup({"set", "more"}).exit_code, 0);
  fs::remove(file());
  fs::create_directory(file());
  EXPECT_EQ(setup({"list"}).exit_code, 2);
  EXPECT_EQ(setup({"set", "a"}).exit_code, 2);
}

TEST_F(TransferSetupTest, WhoeverChangesThem_DoesItAlone) {
  setup({"set", "a"});
  const auto lock = store::FolderLock::acquire(file().parent_path());
  ASSERT_TRUE(lock);
  EXPECT_EQ(setup({"set", "b"}).exit_code, 1);
  EXPECT_EQ(setup({"list"}).exit_code, 0);
  EXPECT_EQ(read_transfer_setups()->size(), 1U);
}

/// The CPU that a request is for, as it is in its frame.
class CpuOfRequest : public TransferSetupTest {
 protected:
  std::string module_io(Words words, std::size_t at = 4) {
    boost::asio::io_context context;
    boost::asio::ip::tcp::acceptor acceptor(context, {boost::asio::ip::make_address("127.0.0.1"), 0});
    std::string head(16, '\0');
    std::thread peer([&] {
      auto client = acceptor.accept();
      boost::system::error_code error;
      boost::asio::read(client, boost::asio::buffer(head), error);
    });
    words.insert(words.end(), {"--plc", std::to_string(acceptor.local_endpoint().port())});
    EXPECT_EQ(run(std::move(words)).exit_code, 1);
    peer.join();
    return plc::testing::shown(head.substr(at, 2));
  }
};

TEST_F(CpuOfRequest, IsTheControlCpu_OrOneOfFour) {
  struct Case {
    const char* cpu;
    const char* in_frame;
  };
  for (const auto& [cpu, in_frame] : {Case{"none", "ff 03"}, Case{"1", "e0 03"}, Case{"2", "e1 03"},
                                      Case{"3", "e2 03"}, Case{"4", "e3 03"}}) {
    EXPECT_EQ(module_io({"plc", "read", "D0", "--cpu", cpu}), in_frame);
    EXPECT_EQ(module_io({"plc", "read", "D0", "--4e", "--cpu", cpu}, 8), in_frame);
    setup({"set", "a", "--cpu", cpu});
    EXPECT_EQ(module_io({"plc", "read", "D0", "--setup", "a"}), in_frame);
    EXPECT_EQ(module_io({"plc", "read", "D0", "--setup", "a", "--cpu", "4"}), "e3 03");
    EXPECT_EQ(module_io({"plc", "read", "D0", "--cpu", "4", "--setup", "a"}), "e3 03");
  }
  EXPECT_EQ(module_io({"plc", "read", "D0"}), "ff 03");
  EXPECT_EQ(module_io({"configure", "status", "--setup", "a"}), "e3 03");
}

TEST_F(TransferSetupTest, Cpu_IsOf3eAnd4eFramesAlone) {
  for (const char* other : {"--1e", "--modbus"}) {
    const Outcome outcome =
        run({"plc", "read", other == std::string("--1e") ? "D0" : "holding:0", other, "--cpu", "1"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--cpu: only 3E and 4E frames"));
  }
  EXPECT_THAT(run({"plc", "read", "D0", "--cpu", "5"}).err, HasSubstr("\"5\" is unknown"));
}

/// A rack of one CPU behind a port of TCP in 3E and 4E frames.
class SetupOfRack : public TransferSetupTest {
 protected:
  SetupOfRack() : server_(context_, plc_.rack, clock_) {
    EXPECT_TRUE(server_.listen("127.0.0.1", 0));
    port_ = std::to_string(server_.port());
    thread_ = std::thread([this] { context_.run(); });
  }
  ~SetupOfRack() override {
    boost::asio::post(context_, [this] { server_.stop(); });
    thread_.join();
  }

  SetupClock clock_;
  plc::testing::Plc plc_;
  boost::asio::io_context context_;
  serve::MelsecServer server_;
  std::string port_;
  std::thread thread_;
};

TEST_F(SetupOfRack, Test_IsWhatPlcTypeSays_AndKnowsAnotherCpuType) {
  setup({"set", "a", "--plc", port_});
  EXPECT_EQ(setup({"test", "a"}).out, run({"plc", "type", "--setup", "a"}).out);
  EXPECT_THAT(setup({"test", "a"}).out, StartsWith("R04CPU  "));
  EXPECT_EQ(setup({"test", "a", "--json"}).out, run({"plc", "type", "--setup", "a", "--json"}).out);
  setup({"set", "a", "--cpu-type", "R04"});
  EXPECT_EQ(setup({"test", "a"}).exit_code, 0);
  setup({"set", "a", "--cpu-type", "R04EN"});
  const Outcome outcome = setup({"test", "a"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("the CPU module is a R04CPU; CPU type of a is R04EN"));
  EXPECT_EQ(setup({"test", "a", "--password", std::string(33, 'x')}).exit_code, 2);
  setup({"set", "a", "--plc", "1"});
  EXPECT_EQ(setup({"test", "a"}).exit_code, 1);
}

TEST_F(SetupOfRack, EachOptionGoesBeforeTheSetup_WhereverItStands) {
  setup({"set", "a", "--plc", port_, "--ascii", "--4e"});
  EXPECT_EQ(run({"plc", "write", "D0", "7", "--setup", "a"}).exit_code, 0);
  setup({"set", "wrong", "--plc", "256.1.1.1:1", "--udp", "--1e", "--timeout", "1ms"});
  const Words right{"--plc",   "127.0.0.1:" + port_, "--tcp", "--3e", "--timeout", "3s", "--cpu", "none",
                    "--binary"};
  Words words{"plc", "read", "D0", "--format", "dec", "--setup", "wrong"};
  words.insert(words.end(), right.begin(), right.end());
  EXPECT_EQ(run(words).out, "D0  7\n");
  words = {"plc", "read", "D0", "--format", "dec"};
  words.insert(words.end(), right.begin(), right.end());
  words.insert(words.end(), {"--setup", "wrong"});
  EXPECT_EQ(run(words).out, "D0  7\n");
  EXPECT_EQ(run({"plc", "read", "D0", "--setup", "wrong"}).exit_code, 1);
  EXPECT_THAT(run({"plc", "read", "D0", "--setup", "none"}).err,
              HasSubstr("--setup: there is no transfer setup \"none\"; expected a or wrong"));
  EXPECT_THAT(run({"plc", "read", "D0", "--setup", "a", "--modbus"}).err,
              HasSubstr("cannot be combined with"));
}

TEST_F(SetupOfRack, CpuNo1IsTheRacksOwn_OthersAreNotThere) {
  EXPECT_EQ(run({"plc", "read", "D0", "--plc", port_, "--cpu", "1"}).exit_code, 0);
  for (const char* cpu : {"2", "3", "4"}) {
    const Outcome outcome = run({"plc", "read", "D0", "--plc", port_, "--cpu", cpu});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("the PLC answers C05FH"));
  }
}

}  // namespace
}  // namespace canopus::cli::transfer_setups_test
