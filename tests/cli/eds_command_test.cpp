// `canopus eds check`

#include "canopus/cli/files/eds_command.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/parser.hpp"

namespace canopus::cli::eds_command_test {
namespace {

using canopus::cli::EdsCheckOptions;
using testing::EndsWith;
using testing::HasSubstr;

class EdsCheck : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    const auto path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
  }
  int check(EdsCheckOptions options) { return canopus::cli::eds_check(options, out_, err_); }

  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("eds_check_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  canopus::cli::TextOutput out_;
  canopus::cli::TextOutput err_;
};

const std::string small =
    "[DeviceInfo]\nVendorNumber=1\nBaudRate_250=1\n[1000]\nParameterName=T\nDataType=7\nAccessType=ro\n"
    "DefaultValue=0x20192\n";

TEST_F(EdsCheck, AcceptedFile_GetsItsProblemsAndOneSummaryLine) {
  const std::string file = write("a.eds", small);
  EXPECT_EQ(check({.files = {file}}), 0);
  EXPECT_THAT(
      out_.text(),
      HasSubstr(file + ":4: warning: there are no object lists: every object described is taken in\n"));
  EXPECT_THAT(out_.text(),
              EndsWith(file + ": accepted, 3 warnings, 1 note: 3 objects, 0 RPDOs, 0 TPDOs, device type "
                              "00020192H\n"));
}

const std::string lossy = small + "[2000]\nParameterName=X\nDataType=0x99\nAccessType=rw\nDefaultValue=\n";

TEST_F(EdsCheck, Losses_AreNamedAndMakeTheExitCodeThree) {
  const std::string file = write("a.eds", lossy);
  EXPECT_EQ(check({.files = {write("b.eds", small), file}}), 3);
  EXPECT_THAT(
      out_.text(),
      HasSubstr(file +
                ":11:10: loss: DataType=0x99 in [2000] is no data type known here: taken as DOMAIN\n"));
  EXPECT_THAT(out_.text(),
              EndsWith(file + ": accepted with losses, 1 loss, 3 warnings, 1 note: 4 objects, 0 RPDOs, 0 "
                              "TPDOs, device type 00020192H\n"));
}

TEST_F(EdsCheck, LossesBesideARefusedOrMissingFile_LeaveTheirExitCodes) {
  EXPECT_EQ(check({.files = {write("a.eds", lossy), write("b.eds", "hello")}}), 1);
  EXPECT_EQ(check({.files = {"/nowhere/a.eds", write("a.eds", lossy)}}), 2);
}

TEST_F(EdsCheck, LossesInJsonAndQuiet) {
  const std::string file = write("a.eds", lossy);
  EXPECT_EQ(check({.files = {file}, .json = true}), 3);
  const auto line = nlohmann::json::parse(out_.text());
  EXPECT_EQ(line["accepted"], true);
  EXPECT_EQ(line["losses"], 1);
  EXPECT_EQ(line["problems"][0]["severity"], "loss");
  out_.clear();
  EXPECT_EQ(check({.files = {write("b.eds", small), file}, .quiet = true}), 3);
  EXPECT_THAT(out_.text(), testing::StartsWith(file + ":11:10: loss: "));
  EXPECT_THAT(out_.text(), testing::Not(HasSubstr("b.eds")));
}

TEST_F(EdsCheck, RefusedFile_MakesTheExitCodeOne) {
  const std::string file = write("b.eds", "\nhello\n");
  EXPECT_EQ(check({.files = {file, write("a.eds", small)}}), 1);
  EXPECT_THAT(out_.text(),
              HasSubstr(file + ":2: error: this is not an EDS or DCF: there is not one [section]\n"));
  EXPECT_THAT(out_.text(), HasSubstr(file + ": refused\n"));
}

TEST_F(EdsCheck, FileThatIsNotThere_MakesTheExitCodeTwo) {
  EXPECT_EQ(check({.files = {"/nowhere/a.eds", write("b.eds", "x")}}), 2);
  EXPECT_EQ(err_.text(), "canopus: /nowhere/a.eds: No such file or directory\n");
}

TEST_F(EdsCheck, Folder_IsNotReadAsAFile) {
  EXPECT_EQ(check({.files = {folder_.string()}}), 2);
  EXPECT_EQ(err_.text(), "canopus: " + folder_.string() + ": Is a directory\n");
}

TEST_F(EdsCheck, Quiet_PrintsRefusedFilesOnly) {
  EXPECT_EQ(check({.files = {write("a.eds", small)}, .quiet = true}), 0);
  EXPECT_EQ(out_.text(), "");
}

TEST_F(EdsCheck, Colour_IsOnlyWhereAskedFor) {
  const std::string file = write("a.eds", small);
  check({.files = {file}});
  EXPECT_EQ(out_.text().find('\x1b'), std::string::npos);
  check({.files = {file}, .colour = true});
  EXPECT_THAT(out_.text(), HasSubstr("\x1b[1;35mwarning:\x1b[0m"));
}

TEST_F(EdsCheck, Json_IsOneObjectPerFile) {
  const std::string file = write("a.eds", small);
  EXPECT_EQ(check({.files = {file}, .json = true}), 0);
  const auto line = nlohmann::json::parse(out_.text());
  EXPECT_EQ(line["file"], file);
  EXPECT_EQ(line["accepted"], true);
  EXPECT_EQ(line["device_type"], 0x20192);
  EXPECT_EQ(line["problems"][0]["severity"], "warning");
}

TEST_F(EdsCheck, CommandLine_RunsTheCheck) {
  canopus::cli::Command app("canopus");
  int exit_code = 0;
  canopus::cli::add_eds_command(app, exit_code);
  const std::vector<std::string> words{"eds", "check", "--quiet", write("a.eds", "nothing")};
  EXPECT_EQ(canopus::cli::parse_words(app, words).result, canopus::cli::Parsing::Result::ran);
  EXPECT_EQ(exit_code, 1);
}

TEST_F(EdsCheck, CommandLineWithoutFiles_IsAUsageError) {
  canopus::cli::Command app("canopus");
  int exit_code = 0;
  canopus::cli::add_eds_command(app, exit_code);
  const std::vector<std::string> words{"eds", "check"};
  EXPECT_EQ(canopus::cli::parse_words(app, words).result, canopus::cli::Parsing::Result::misfit);
}

class EdsConvert : public EdsCheck {
 protected:
  int convert(const std::string& from, const std::string& to, const std::string& kind = {}) {
    return canopus::cli::eds_convert({from, to, kind}, out_, err_);
  }
  std::string path(const std::string& name) { return (folder_ / name).string(); }
  static std::string content(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
};

TEST_F(EdsConvert, EdsToXddAndBack_KeepsTheDevice) {
  const std::string eds = write("a.eds", small);
  EXPECT_EQ(convert(eds, path("a.xdd")), 0);
  EXPECT_THAT(content(path("a.xdd")),
              HasSubstr("<CANopenObject index=\"1000\" name=\"T\" objectType=\"7\" "
                        "dataType=\"0007\" accessType=\"ro\" defaultValue=\"0x00020192\""));
  EXPECT_THAT(err_.text(), HasSubstr(eds + ": warning: the file has no date of its creation"));
  EXPECT_EQ(convert(path("a.xdd"), path("b.eds")), 0);
  EXPECT_THAT(content(path("b.eds")), HasSubstr("DefaultValue=0x00020192\r\n"));
  EXPECT_EQ(out_.text(), "");
}

TEST_F(EdsConvert, StandardOutput_GetsTheFileAlone) {
  EXPECT_EQ(convert(write("a.eds", small), "-", "xdd"), 0);
  EXPECT_THAT(out_.text(), testing::StartsWith("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<ISO15745"));
  EXPECT_THAT(out_.text(), EndsWith("</ISO15745ProfileContainer>\n"));
}

TEST_F(EdsConvert, WhatTheReaderRepaired_IsSaidWithItsLine) {
  const std::string file = write("a.eds", small);
  EXPECT_EQ(convert(file, path("a.xdd")), 0);
  EXPECT_THAT(err_.text(), HasSubstr(file + ":4: warning: there are no object lists"));
}

TEST_F(EdsConvert, ConfigurationWithoutANode_IsSaid) {
  const std::string file = write("a.eds", small);
  EXPECT_EQ(convert(file, path("a.xdc")), 0);
  EXPECT_THAT(err_.text(), HasSubstr(file + ": warning: the file is for no node: what is written is an XDD"));
  err_.clear();
  const std::string dcf = write("a.dcf", small + "[DeviceComissioning]\nNodeID=3\n");
  EXPECT_EQ(convert(dcf, path("b.xdd")), 0);
  EXPECT_THAT(err_.text(), HasSubstr(dcf + ": warning: the file is for a node: what is written is an XDC"));
}

TEST_F(EdsConvert, UnknownExtensionOrFile_IsRefusedAndNothingIsWritten) {
  const std::string file = write("a.eds", small);
  EXPECT_EQ(convert(file, path("a.txt")), 2);
  EXPECT_THAT(err_.text(),
              HasSubstr("expected a name that ends in .eds, .dcf, .xdd or .xdc, or --out-format"));
  EXPECT_EQ(convert(file, "-"), 2);
  EXPECT_EQ(convert(path("none.eds"), path("b.xdd")), 2);
  EXPECT_EQ(convert(write("c.eds", "<a>"), path("b.xdd")), 1);
  EXPECT_EQ(convert(file, path("no/folder/b.xdd")), 1);
  EXPECT_FALSE(std::filesystem::exists(path("b.xdd")));
}

}  // namespace
}  // namespace canopus::cli::eds_command_test
