// The trace commands on files: what they keep, and what they must not write over.

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canopus/cli/app/command_line.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/trace/trace_options.hpp"

#include "paths.hpp"

namespace canopus::cli::trace_commands_test {
namespace {

using testing::HasSubstr;

struct Said {
  int code;
  std::string out, error;
};

Said said(std::vector<std::string> words) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(words);
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

class TraceCommands : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "trace_commands_" +
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
    std::ofstream(path("a.log")) << text_;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ostringstream all;
    all << std::ifstream(path(name)).rdbuf();
    return all.str();
  }
  const std::string text_ =
      "(100.000000) can0 181#01\n(101.000000) can0 182#02\n(50.000000) can0 183#03\n(102.000000) can0 "
      "184#04\n";

 private:
  std::string folder_;
};

TEST_F(TraceCommands, Convert_KeepsWhatIsDatedBeforeTheFirstFrame) {
  EXPECT_EQ(said({"trace", "convert", path("a.log"), path("b.log")}).code, 0);
  EXPECT_THAT(content("b.log"), HasSubstr("183#03"));
  EXPECT_EQ(said({"trace", "convert", path("a.log"), path("c.log"), "--from", "0s"}).code, 0);
  EXPECT_THAT(content("c.log"), testing::Not(HasSubstr("183#03")));
}

TEST_F(TraceCommands, ReversedRanges_AreWrongUsage) {
  EXPECT_EQ(said({"trace", "convert", path("a.log"), path("b.log"), "--from", "5s", "--to", "1s"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(path("b.log")));
  EXPECT_THAT(said({"replay", path("a.log"), "--from", "5s", "--to", "1s"}).error,
              HasSubstr("--from is later than --to"));
  EXPECT_THAT(said({"replay", path("a.log"), "--can-id", "5-1"}).error, HasSubstr("\"5-1\" is no CAN-ID"));
}

TEST_F(TraceCommands, Plot_DoesNotWriteOverItsTrace) {
  EXPECT_EQ(said({"trace", "plot", path("a.log"), "--output", path("a.log")}).code, 2);
  EXPECT_EQ(content("a.log"), text_);
}

TEST_F(TraceCommands, AMissingFile_IsExitCodeTwoAndNoReport) {
  for (const std::string& file : {path("missing.log"), path("")}) {
    EXPECT_EQ(said({"trace", "show", file}).code, 2) << file;
    const Said stats = said({"trace", "stats", file});
    EXPECT_EQ(stats.code, 2) << file;
    EXPECT_EQ(stats.out, "") << file;
    EXPECT_EQ(said({"trace", "plot", file, "--output", path("p.svg")}).code, 2) << file;
    EXPECT_FALSE(std::filesystem::exists(path("p.svg"))) << file;
  }
}

TEST_F(TraceCommands, SameFile_IsKnownByOtherNames) {
  std::filesystem::create_hard_link(path("a.log"), path("link.log"));
  EXPECT_TRUE(is_same_file(path("a.log"), path("link.log")));
  EXPECT_FALSE(is_same_file(path("a.log"), path("other.log")));
  EXPECT_FALSE(is_same_file("-", "-"));
}

TEST_F(TraceCommands, AChannelThatTheTraceHasNot_IsSaid) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"trace", "convert", path("a.log"), path("b.csv"), "--relative", "-q"},
        {"trace", "show", path("a.log")},
        {"trace", "stats", path("a.log")},
        {"trace", "plot", path("a.log"), "--output", path("a.svg")}}) {
    std::vector<std::string> missing = words;
    missing.insert(missing.end(), {"--channel", "can7"});
    const Said wrong = said(missing);
    EXPECT_EQ(wrong.code, 1) << words[1];
    EXPECT_THAT(wrong.error,
                HasSubstr("--channel can7: no frame that was read is of this channel; there are: can0"));
    std::vector<std::string> there = words;
    there.insert(there.end(), {"--channel", "can0"});
    EXPECT_EQ(said(there).code, 0) << words[1];
  }
}

constexpr char two_kinds[] =
    "(1.0) can0 705#05\n(1.1) can0 181##1112233\n# note\n(1.2) can0 705#05\n"
    "DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)\n";

TEST_F(TraceCommands, WhatATraceLeavesOut_IsSaidByEveryCommandThatReadsIt) {
  std::ofstream(path("two.log")) << two_kinds;
  const std::string left_out = "canopus: " + path("two.log") + ": left out: 1 CAN FD frame, 1 comment\n";
  const std::string lost =
      "canopus: " + path("two.log") + ": the recorder lost 3 frames, which are not in the trace\n";
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"trace", "info", path("two.log")},
        {"trace", "show", path("two.log")},
        {"trace", "stats", path("two.log")},
        {"trace", "plot", path("two.log"), "--output", path("two.svg")},
        {"trace", "convert", path("two.log"), path("two.csv"), "-q"},
        {"trace", "diff", path("two.log"), path("two.log"), "-q"}}) {
    const Said all = said(words);
    EXPECT_EQ(all.code, 0) << words[1] << all.error;
    EXPECT_THAT(all.error, HasSubstr(left_out + lost)) << words[1];
  }
}

TEST_F(TraceCommands, Info_ListsWhatIsLeftOutByKind) {
  std::ofstream(path("two.log")) << two_kinds;
  EXPECT_THAT(said({"trace", "info", path("two.log")}).out,
              HasSubstr("  left out     1 CAN FD frame, 1 comment\n  lost         3 by the recorder\n"));
  EXPECT_THAT(said({"trace", "info", path("a.log")}).out, HasSubstr("  left out     0\n"));
  const std::string json = said({"trace", "info", path("two.log"), "--json"}).out;
  for (const char* part : {R"("left_out":2)", R"("lost":3)", R"("can_fd":1)", R"("comment":1)"})
    EXPECT_THAT(json, HasSubstr(part));
}

TEST_F(TraceCommands, FileOfWhichNothingWasRead_IsAnErrorThatChangesNothing) {
  std::ofstream(path("fd.log")) << "(1.0) can0 181##1112233\n(1.1) can0 182##1112233\n";
  std::ofstream(path("out.csv")) << "before";
  const std::string nothing =
      path("fd.log") +
      ": nothing of it was read: expected classical CAN frames in a trace of the format "
      "candump\n";
  for (const std::vector<std::string>& words : {std::vector<std::string>{"trace", "info", path("fd.log")},
                                                {"trace", "show", path("fd.log")},
                                                {"trace", "stats", path("fd.log")},
                                                {"trace", "convert", path("fd.log"), path("out.csv")}}) {
    const Said all = said(words);
    EXPECT_EQ(all.code, 1) << words[1];
    EXPECT_THAT(all.error, HasSubstr("left out: 2 CAN FD frames\n")) << words[1];
    EXPECT_THAT(all.error, HasSubstr(nothing)) << words[1];
  }
  EXPECT_EQ(said({"trace", "diff", path("fd.log"), path("a.log"), "-q"}).code, 2);
  EXPECT_EQ(content("out.csv"), "before");
}

TEST_F(TraceCommands, TraceInWhichNothingHappened_IsNoError) {
  std::ofstream(path("empty.log")) << "";
  std::ofstream(path("notes.log")) << "# a note\n(1.0) can0 705#05\n";
  std::ofstream(path("head.asc"))
      << "base hex  timestamps absolute\n// version 9.0.0\n0.0 Start of measurement\n";
  for (const char* name : {"empty.log", "notes.log", "head.asc"})
    EXPECT_EQ(said({"trace", "info", path(name)}).code, 0) << name;
}

TEST_F(TraceCommands, ShortSdoFrames_AreShownAndCounted) {
  std::ofstream(path("short.log")) << "(1.0) can0 605#4000100000000000\n(1.001) can0 585#43001000920102\n"
                                      "(1.1) can0 605#2F00620105\n(1.2) can0 705#05\n";
  const std::string shown = said({"trace", "show", path("short.log")}).out;
  EXPECT_THAT(shown, HasSubstr("malformed: 7 bytes, expected 8: 43 00 10 00 92 01 02\n"));
  EXPECT_THAT(shown, HasSubstr("malformed: 5 bytes, expected 8: 2F 00 62 01 05\n"));
  EXPECT_THAT(shown, HasSubstr("1000:00 'Device type' read: no valid answer: one of 7 bytes, expected 8\n"));
  EXPECT_THAT(shown, testing::Not(HasSubstr("no answer")));
  EXPECT_THAT(shown, testing::Not(HasSubstr("\x1B")));
  const std::string figures = said({"trace", "stats", path("short.log")}).out;
  EXPECT_TRUE(
      figures.starts_with("malformed messages (sdo 2):\n"
                          "     0.001000  node 5  585 sdo: 7 bytes, expected 8: 43 00 10 00 92 01 02\n"
                          "     0.100000  node 5  605 sdo: 5 bytes, expected 8: 2F 00 62 01 05\n"
                          "duration: 0.200000 s\n"))
      << figures;
  EXPECT_THAT(figures, HasSubstr("2 malformed"));
  const std::string json = said({"trace", "stats", path("short.log"), "--json"}).out;
  EXPECT_THAT(json, HasSubstr(R"("malformed_services":{"sdo":2})"));
  EXPECT_THAT(said({"trace", "show", path("short.log"), "--filter", "errors"}).out,
              HasSubstr("malformed: 5 bytes, expected 8"));
}

TEST_F(TraceCommands, StatsAndShow_LeaveOutOtherChannels) {
  std::ofstream(path("two.log")) << "(1.000000) can0 181#01\n(2.000000) can1 182#02\n";
  EXPECT_THAT(said({"trace", "stats", path("two.log"), "--channel", "can1"}).out,
              testing::AllOf(HasSubstr("channel can1"), testing::Not(HasSubstr("channel can0"))));
  EXPECT_THAT(said({"trace", "show", path("two.log"), "--channel", "can1"}).out,
              testing::AllOf(HasSubstr("182"), testing::Not(HasSubstr("181"))));
}

TEST(ChannelChoice, ManyChannels_AreNotAllListed) {
  ChannelChoice choice({"x", "can3"});
  for (int i = 0; i < 100; ++i) EXPECT_EQ(choice.wants("can" + std::to_string(i)), i == 3);
  EXPECT_TRUE(choice.wants("can3"));
  TextOutput err;
  EXPECT_FALSE(choice.report_missing(err));
  EXPECT_EQ(
      err.text(),
      "canopus: --channel x: no frame that was read is of this channel; there are: can0, can1, can10, can11, "
      "can12, can13, can14, can15, ...\n");
}

TEST_F(TraceCommands, ShowWithReversedTimes_IsWrongUsage) {
  const Said show = said({"trace", "show", path("a.log"), "--from", "2s", "--to", "1s"});
  EXPECT_EQ(show.code, 2);
  EXPECT_THAT(show.error, HasSubstr("--from is later than --to"));
}

TEST_F(TraceCommands, ConvertRelative_SaysWhichTimesTheFormatCannotHave) {
  const Said candump = said({"trace", "convert", path("a.log"), path("b.log"), "--relative"});
  EXPECT_EQ(candump.code, 1);
  EXPECT_THAT(candump.error,
              HasSubstr("1 frame earlier than time 0, which candump cannot say, written at time 0"));
  EXPECT_EQ(said({"trace", "convert", path("a.log"), path("b.csv"), "--relative"}).code, 0);
  EXPECT_THAT(content("b.csv"), HasSubstr("-50.000000000"));
}

TEST_F(TraceCommands, Convert_ReplacesItsTargetAndKeepsModeAndLink) {
  std::ofstream(path("b.csv")) << "old";
  ASSERT_EQ(::chmod(path("b.csv").c_str(), 0600), 0);
  std::filesystem::create_symlink(path("b.csv"), path("link.csv"));
  EXPECT_EQ(said({"trace", "convert", path("a.log"), path("link.csv"), "-q"}).code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(path("link.csv")));
  EXPECT_THAT(content("b.csv"), HasSubstr("0x181"));
  struct stat found {};
  ASSERT_EQ(::stat(path("b.csv").c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 07777U, 0600U);
}

TEST_F(TraceCommands, Convert_WritesIntoADeviceAsItIs) {
  const Said device = said({"trace", "convert", path("a.log"), "/dev/null", "--out-format", "csv"});
  EXPECT_EQ(device.code, 0) << device.error;
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(TraceCommands, Convert_WritesTheTrcOfOlderPrograms) {
  std::ofstream(path("b.log"))
      << "(1700000000.123400) can0 181#0102 R\n(1700000001.200000) can0 00000181#R3 T\n"
         "(1700000001.300000) can0 20000008#0000010000000000 R\n";
  EXPECT_EQ(said({"trace", "convert", path("b.log"), path("b.trc"), "--trc-version", "1.1"}).code, 0);
  const std::string text = content("b.trc");
  EXPECT_THAT(text, testing::StartsWith(";$FILEVERSION=1.1\r\n;$STARTTIME=45244.925"));
  EXPECT_THAT(text, testing::Not(HasSubstr("$COLUMNS")));
  EXPECT_THAT(text, HasSubstr("\r\n     1)         0.4  Rx         0181  2  01 02\r\n"));
  EXPECT_THAT(text, HasSubstr("\r\n     2)      1077.0  Tx     00000181  3  RTR\r\n"));
  // found while receiving (01): the frame has not the flag of a transmission
  EXPECT_THAT(text, HasSubstr("\r\n     3)      1177.0  Error      0001  4  01 00 00 00\r\n"));
  EXPECT_EQ(said({"trace", "convert", path("b.log"), path("c.trc"), "--trc-version", "3"}).code, 2);
}

TEST_F(TraceCommands, NameOfADescriptor_IsWrittenAsItIs) {
  for (const std::string name : {"/dev/stdout", "/dev/../dev/stderr", "/dev/fd/1", "/proc/self/fd/1"}) {
    EXPECT_EQ(NewFile(name).path(), name);
  }
}

TEST_F(TraceCommands, UnfinishedFile_LeavesWhatWasThere) {
  std::ofstream(path("b.csv")) << "old";
  {
    const NewFile file(path("b.csv"));
    std::ofstream(file.path()) << "half";
    EXPECT_EQ(content("b.csv"), "old");
  }
  EXPECT_EQ(content("b.csv"), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("")), {}), 2);
}

TEST_F(TraceCommands, SignalWhileAFileIsWritten_LeavesNothingOfIt) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(
        {
          const NewFile file(path("b.csv"));
          std::ofstream(file.path()) << "half";
          (void)::raise(signal);
        },
        testing::KilledBySignal(signal), "");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("")), {}), 1) << signal;
  }
}

TEST_F(TraceCommands, IgnoredSignal_StaysIgnored) {
  EXPECT_EXIT(
      {
        (void)std::signal(SIGHUP, SIG_IGN);
        NewFile file(path("b.csv"));
        (void)::raise(SIGHUP);
        std::ofstream(file.path()) << "whole";
        const bool kept = file.commit().has_value();
        ::_exit(kept ? 7 : 8);
      },
      testing::ExitedWithCode(7), "");
  EXPECT_EQ(content("b.csv"), "whole");
}

TEST_F(TraceCommands, Monitor_DoesNotWriteOverWhatItReads) {
  std::filesystem::copy_file(std::string(CANOPUS_SOURCE_DIR) + "/examples/lift/devices/load-unit.eds",
                             path("eds.log"));
  const std::string before = content("eds.log");
  const Said monitor = said({"monitor", "--bus", "cannelloni:127.0.0.1:9", "--eds", "3=" + path("eds.log"),
                             "--trace", path("eds.log")});
  EXPECT_THAT(monitor.error, HasSubstr("this file is read"));
  EXPECT_EQ(monitor.code, 2);
  EXPECT_EQ(content("eds.log"), before);
}

/// The other end of a cannelloni over UDP: what was sent waits in its socket.
class ReplayTest : public TraceCommands {
 protected:
  std::string bus() { return "cannelloni:127.0.0.1:" + std::to_string(peer_.local_endpoint().port()); }
  /// The identifiers of all frames that came, all of them with one byte.
  std::vector<unsigned> heard() {
    std::vector<unsigned> identifiers;
    peer_.non_blocking(true);
    std::array<unsigned char, 2048> input{};
    boost::system::error_code nothing;
    while (true) {
      const std::size_t size = peer_.receive(boost::asio::buffer(input), 0, nothing);
      if (nothing) return identifiers;
      for (std::size_t at = 5; at + 6 <= size; at += 6)
        identifiers.push_back(input[at + 2] * 256U + input[at + 3]);
    }
  }

 private:
  using udp = boost::asio::ip::udp;
  boost::asio::io_context io_;
  udp::socket peer_{io_, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0)};
};

TEST_F(ReplayTest, FramesDatedBeforeTheFirstOne_AreSentInTheirPlace) {
  const Said replay = said({"replay", path("a.log"), "--bus", bus(), "--speed", "1000"});
  EXPECT_EQ(replay.code, 0) << replay.error;
  EXPECT_EQ(heard(), (std::vector<unsigned>{0x181, 0x182, 0x183, 0x184}));
}

TEST_F(ReplayTest, From_LeavesOutWhatIsDatedBeforeTheFirstOne) {
  EXPECT_EQ(said({"replay", path("a.log"), "--bus", bus(), "--speed", "max", "--from", "0s"}).code, 0);
  EXPECT_EQ(heard(), (std::vector<unsigned>{0x181, 0x182, 0x184}));
}

TEST_F(ReplayTest, SentFrames_AreOutWhenTheirNumberIsSaid) {
  const Said replay = said({"replay", path("a.log"), "--bus", bus(), "--speed", "max"});
  EXPECT_THAT(replay.out, testing::StartsWith("4 frames sent in "));
  EXPECT_EQ(heard().size(), 4U);
}

TEST_F(ReplayTest, AChannelThatTheTraceHasNot_IsSaid) {
  const Said replay = said({"replay", path("a.log"), "--bus", bus(), "--speed", "max", "--channel", "can7"});
  EXPECT_EQ(replay.code, 1);
  EXPECT_THAT(replay.error, HasSubstr("--channel can7"));
}

}  // namespace
}  // namespace canopus::cli::trace_commands_test
