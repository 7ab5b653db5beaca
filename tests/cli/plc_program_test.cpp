// `canopus plc` and the program of a simulated PLC: variables by name, scans, breaks, over the control server in a thread of its own.

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "canopus/can/timeline.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/options/parser.hpp"
#include "canopus/serve/control_server.hpp"
#include "canopus/serve/device_control.hpp"

#include "support/plant_folder.hpp"

namespace canopus::cli::plc_program_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using namespace std::chrono_literals;
using ::testing::internal::CaptureStderr;
using ::testing::internal::CaptureStdout;
using ::testing::internal::GetCapturedStderr;
using ::testing::internal::GetCapturedStdout;

class StandingClock final : public link::LoopClock {
 public:
  explicit StandingClock(plant::Plant& plant) : plant_(plant) {}
  can::Time now() override { return plant_.timeline().now(); }
  void touched() override {}

 private:
  plant::Plant& plant_;
};

/// A plant with a program whose time the test moves, between two commands.
class PlcProgramCommand : public support::PlantFolder, public plant::PlantObserver {
 protected:
  PlcProgramCommand() {
    write("main.st",
          "PROGRAM Main\nVAR n : INT; t : TIME; list : ARRAY[1..2] OF REAL; END_VAR\nn := n + 1;\nD5 := n;\n"
          "END_PROGRAM\n");
    plant_ = load(
        "[[bus]]\nname = \"line1\"\nbit_rate = 250000\n[[plc]]\nname = \"plc1\"\nlisten = \"off\"\n"
        "program = [\"main.st\"]\nscan = \"10ms\"\n",
        *this);
    plant_->power_on();
    clock_.emplace(*plant_);
    server_.emplace(context_, *clock_, [this](std::string_view line, serve::ControlServer::Reply reply) {
      reply(serve::DeviceControl(*plant_).answer(line));
      return serve::ControlServer::CallOff();
    });
    EXPECT_TRUE(server_->listen("127.0.0.1", 0));
    place_ = "127.0.0.1:" + std::to_string(server_->port());
    thread_ = std::thread([this] { context_.run(); });
  }
  ~PlcProgramCommand() override {
    boost::asio::post(context_, [this] { server_->stop(); });
    thread_.join();
  }

  void move(can::Duration time) {
    std::promise<void> moved;
    boost::asio::post(context_, [&] {
      plant_->timeline().run_until(plant_->timeline().now() + time);
      moved.set_value();
    });
    moved.get_future().wait();
  }
  struct Outcome {
    int exit_code = -1;
    std::string out;
    std::string err;
  };
  Outcome run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "plc");
    arguments.insert(arguments.end(), {"--at", place_});
    Command app;
    Outcome outcome;
    add_plc_command(app, outcome.exit_code);
    CaptureStdout();
    CaptureStderr();
    if (parse_words(app, arguments).result != Parsing::Result::ran) outcome.exit_code = 100;
    outcome.out = GetCapturedStdout();
    outcome.err = GetCapturedStderr();
    return outcome;
  }

  std::unique_ptr<plant::Plant> plant_;
  std::optional<StandingClock> clock_;
  boost::asio::io_context context_;
  std::optional<serve::ControlServer> server_;
  std::string place_;
  std::thread thread_;
};

TEST_F(PlcProgramCommand, ReadAndWrite_TakeVariablesByName) {
  EXPECT_EQ(run({"read", "main.n"}).out, "main.n  1  INT\n");
  EXPECT_EQ(run({"write", "Main.t", "T#1s500ms"}).out, "Main.t  T#1s500ms  TIME\n");
  EXPECT_EQ(run({"write", "Main.list[2]", "1.5"}).out, "Main.list[2]  1.5  REAL\n");
  EXPECT_EQ(run({"force", "Main.list[2]", "2.5", "--json"}).out,
            "{\"ok\":true,\"t\":0.0,\"name\":\"Main.list[2]\",\"type\":\"REAL\",\"value\":\"2.5\",\"forced\":"
            "true}\n");
  const Outcome wrong = run({"write", "Main.n", "x"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_EQ(wrong.err, "canopus plc: value: expected INT\n");
  EXPECT_EQ(run({"read", "Main.m"}).err, "canopus plc: name: 'Main.m': there is no 'm' in it\n");
  EXPECT_EQ(run({"write", "Main.n", "1", "2"}).exit_code, 2);
}

TEST_F(PlcProgramCommand, Watch_ShowsTheFirstValue) {
  EXPECT_EQ(run({"watch", "Main.n", "--interval", "1ms", "--for", "3ms"}).out,
            "    0.000 s  Main.n  1  INT\n");
  EXPECT_EQ(run({"watch", "Main.n", "--interval", "5"}).exit_code, 2);
}

TEST_F(PlcProgramCommand, ForceAndUnforce) {
  EXPECT_EQ(run({"force", "Main.n", "100"}).out, "Main.n  100  INT  [forced]\n");
  move(20ms);
  EXPECT_EQ(run({"read", "Main.n"}).out, "Main.n  100  INT  [forced]\n");
  EXPECT_EQ(run({"unforce", "Main.n"}).out, "Main.n  100  INT\n");
  EXPECT_EQ(run({"unforce", "Main.n"}).exit_code, 1);
  EXPECT_EQ(run({"force", "Main.n", "100"}).exit_code, 0);
  EXPECT_EQ(run({"unforce"}).out, "1 released\n");
}

TEST_F(PlcProgramCommand, HaltScanBreakContinue) {
  EXPECT_EQ(run({"halt"}).out, "halted\n");
  move(30ms);
  EXPECT_EQ(run({"scan"}).out, "the next scan is executed\n");
  move(30ms);
  EXPECT_EQ(run({"read", "Main.n"}).out, "Main.n  2  INT\n");
  EXPECT_EQ(run({"break", "main.st:2"}).out, "main.st:3\n");
  EXPECT_EQ(run({"continue"}).out, "run\n");
  move(30ms);
  EXPECT_THAT(run({"program"}).out, StartsWith("PLC       plc1 (R04CPU)\nState     halted at main.st:3\nScan "
                                               "     every 10.000 ms, 9 since RUN; "));
  EXPECT_THAT(run({"program"}).out,
              HasSubstr("Task      all other programs (scan): Main; 3 times\nBreak     main.st:3\n"));
  EXPECT_EQ(run({"clear-break", "main.st:3"}).out, "0 breaks left\n");
  for (const std::string wrong : {"main.st", "main.st:0", ":5", "main.st:x"}) {
    EXPECT_EQ(run({"break", wrong}).exit_code, 2);
    EXPECT_EQ(
        run({"break", wrong}).err,
        "canopus plc: \"" + wrong + "\": expected a file of the program and a line, such as main.st:12\n");
  }
  EXPECT_EQ(run({"clear-break"}).out, "0 breaks left\n");
}

TEST_F(PlcProgramCommand, Change_KeepsValuesOrChangesNothing) {
  write("main.st", "PROGRAM Main\nVAR n : INT; END_VAR\nn := n + 100;\nEND_PROGRAM\n");
  EXPECT_EQ(run({"change"}).out, "changed; 1 global variables and programs\n");
  move(10ms);
  EXPECT_EQ(run({"read", "Main.n"}).out, "Main.n  101  INT\n");
  write("main.st", "PROGRAM Main\nx := 1;\nEND_PROGRAM\n");
  const Outcome wrong = run({"change"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("main.st:2:1: there is no variable x"));
}

}  // namespace
}  // namespace canopus::cli::plc_program_test
