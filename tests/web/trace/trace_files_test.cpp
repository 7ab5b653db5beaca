// Recorded traces that the page opens: which there are, what is read of them, and nothing outside of their folder.

#include "canopus/web/trace/trace_files.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/text/base64.hpp"

namespace canopus::web::trace_files_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using text::Json;

const std::string two_frames = "(1700000012.000000) can0 703#05\n(1700000012.500000) can1 703#7F\n";

class TraceFilesTest : public ::testing::Test {
 protected:
  TraceFilesTest() {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "traces");
    write("plant.log", two_frames);
    files_.emplace(io_, folder_, trace::Names{}, 3);
  }
  ~TraceFilesTest() override {
    files_.reset();
    fs::remove_all(folder_);
  }

  void write(const std::string& name, const std::string& content) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << content;
  }
  std::vector<std::string> listed() {
    std::vector<std::string> paths;
    const Json row = files_->list();
    for (const Json& one : row["files"]) paths.push_back(one["path"].get<std::string>());
    return paths;
  }
  /// What comes back of it; the thread takes as long as it takes.
  template <typename Ask>
  TraceFiles::Answer answer_of(const Ask& ask) {
    std::optional<TraceFiles::Answer> answer;
    ask([&](TraceFiles::Answer row) { answer = std::move(row); });
    auto work = boost::asio::make_work_guard(io_);
    io_.restart();
    while (!answer && io_.run_one_for(std::chrono::seconds(20)) != 0) {
    }
    return answer ? *answer : std::unexpected("nothing came");
  }
  TraceFiles::Answer open(const std::string& path) {
    return answer_of([&](TraceFiles::Done done) { files_->open({{"path", path}}, std::move(done)); });
  }
  TraceFiles::Answer look(const Json& wish) {
    return answer_of([&](TraceFiles::Done done) { files_->query(wish, std::move(done)); });
  }

  /// Of a file with these bytes, in parts of this length.
  TraceFiles::Answer upload(const std::string& name, const std::string& content, std::size_t part = 20) {
    const auto begun = files_->begin_upload({{"name", name}, {"size", content.size()}});
    if (!begun) return begun;
    const Json number = (*begun)["upload"];
    for (std::size_t at = 0; at < content.size(); at += part) {
      const auto taken = add(number, content.substr(at, part));
      if (!taken) return taken;
      EXPECT_EQ((*taken)["received"], std::min(at + part, content.size()));
    }
    return open_upload(number);
  }
  TraceFiles::Answer add(const Json& number, const std::string& bytes) {
    const std::vector<std::uint8_t> octets(bytes.begin(), bytes.end());
    return answer_of([&](TraceFiles::Done done) {
      files_->add_part({{"upload", number}, {"data", text::to_base64(octets)}}, std::move(done));
    });
  }
  TraceFiles::Answer open_upload(const Json& number) {
    return answer_of([&](TraceFiles::Done done) { files_->open({{"upload", number}}, std::move(done)); });
  }

  fs::path folder_ = fs::path(::testing::TempDir()) / "trace_files_test";
  boost::asio::io_context io_{1};
  std::optional<TraceFiles> files_;
};

TEST_F(TraceFilesTest, List_HasTheTracesOfTheFolder_AndNothingElse) {
  write("traces/a.pcapng", "x");
  write("traces/deep/b.csv", "x");
  write("traces/deep/deeper/c.log", "x");
  write("plant.toml", "x");
  write(".hidden.log", "x");
  fs::create_symlink("/etc/hostname", folder_ / "elsewhere.log");
  fs::create_symlink("plant.log", folder_ / "link.log");
  EXPECT_THAT(listed(), ElementsAre("link.log", "plant.log", "traces/a.pcapng", "traces/deep/b.csv"));
  EXPECT_EQ(files_->list()["files"][1]["size"].get<std::size_t>(), two_frames.size());
}

TEST_F(TraceFilesTest, AnOpenedFile_IsLookedAtAsTheTraceOfTheRun) {
  const auto opened = open("plant.log");
  ASSERT_TRUE(opened) << opened.error();
  EXPECT_EQ((*opened)["records"], 2);
  EXPECT_EQ((*opened)["format"], "candump");
  EXPECT_EQ((*opened)["buses"][1], "can1");
  EXPECT_EQ((*opened)["begin"], 1700000012.0);
  EXPECT_FALSE(opened->contains("message"));
  const Json file = (*opened)["file"];
  const auto rows = look({{"file", file}, {"filter", "node=3"}});
  ASSERT_TRUE(rows) << rows.error();
  ASSERT_EQ((*rows)["rows"].size(), 2U);
  EXPECT_EQ((*rows)["rows"][0]["t"], 0.0) << "since the first frame";
  EXPECT_EQ((*rows)["rows"][1]["t"], 0.5);
  EXPECT_EQ((*rows)["rows"][1]["bus"], "can1");
  ASSERT_TRUE(files_->close({{"file", file}}));
  EXPECT_EQ(look({{"file", file}}).error(), "this trace file is not open any more; open it again");
  EXPECT_EQ(files_->close({{"file", file}}).error(), "this trace file is not open");
}

TEST_F(TraceFilesTest, NoPathLeadsOutOfTheFolder) {
  for (const char* path :
       {"", "/etc/hostname", "../trace_files_test/plant.log", "./plant.log", "plant.toml", "none.log"}) {
    const auto answer = open(path);
    ASSERT_FALSE(answer) << path;
    EXPECT_THAT(answer.error(), HasSubstr("there is no trace file ")) << path;
  }
  const auto answer = answer_of([&](TraceFiles::Done done) { files_->open({{"path", 5}}, std::move(done)); });
  EXPECT_FALSE(answer);
}

TEST_F(TraceFilesTest, AFileThatIsWrongOrLong_SaysSo) {
  write("none.log", "nothing of a trace\n");
  EXPECT_FALSE(open("none.log"));
  write("half.log", two_frames + "(1700000013.0) can0 7GG#05\n");
  const auto half = open("half.log");
  ASSERT_TRUE(half) << half.error();
  EXPECT_EQ((*half)["records"], 2);
  EXPECT_THAT((*half)["message"].get<std::string>(), HasSubstr("half.log:3:"));
  write("long.log", two_frames + two_frames);
  const auto cut = open("long.log");
  ASSERT_TRUE(cut) << cut.error();
  EXPECT_EQ((*cut)["records"], 3);
  EXPECT_EQ((*cut)["message"], "the first 3 frames; the file has more");
}

TEST_F(TraceFilesTest, AThirdFile_ClosesTheOldest) {
  write("b.log", two_frames);
  write("c.log", two_frames);
  const Json first = (*open("plant.log"))["file"];
  const Json second = (*open("b.log"))["file"];
  ASSERT_TRUE(look({{"file", first}}));
  ASSERT_TRUE(open("c.log"));
  EXPECT_FALSE(look({{"file", first}}));
  EXPECT_TRUE(look({{"file", second}}));
}

TEST_F(TraceFilesTest, AFileOfTheBrowsersMachine_ComesInParts_AndIsLookedAtAsOneOfTheFolder) {
  const auto opened = upload("C:\\traces\\line.log", two_frames);
  ASSERT_TRUE(opened) << opened.error();
  EXPECT_EQ((*opened)["path"], "C:\\traces\\line.log");
  EXPECT_EQ((*opened)["records"], 2);
  const auto rows = look({{"file", (*opened)["file"]}});
  ASSERT_TRUE(rows) << rows.error();
  EXPECT_EQ((*rows)["rows"].size(), 2U);
}

TEST_F(TraceFilesTest, TheNameOfAnUpload_IsNoPath_AndItsErrorsNameTheLine) {
  for (const char* name : {"../../etc/passwd", "/etc/hostname", "plant.log", "a\x1B[31m.log"}) {
    const auto half = upload(name, two_frames + "(1700000013.0) can0 7GG#05\n");
    ASSERT_TRUE(half) << half.error();
    EXPECT_EQ((*half)["records"], 2) << name << ": what came, not what is there under this name";
    const auto message = (*half)["message"].get<std::string>();
    EXPECT_THAT(message, HasSubstr((*half)["path"].get<std::string>() + ":3:"));
    EXPECT_THAT(message, Not(HasSubstr("/proc/")));
    EXPECT_THAT(message, Not(HasSubstr("\x1B")));
  }
  EXPECT_THAT(upload("line.zip", "PK\x03\x04 and so on").error(), StartsWith("line.zip: "));
  EXPECT_THAT(listed(), ElementsAre("plant.log")) << "it is in no folder";
}

TEST_F(TraceFilesTest, AnUpload_HasASize_AndPartsOfALimitedLength) {
  const auto begin = [&](const Json& wish) { return files_->begin_upload(wish); };
  EXPECT_EQ(begin({{"name", "a.log"}, {"size", 0U}}).error(), "a.log: the file is empty");
  EXPECT_EQ(begin({{"name", "a.log"}, {"size", TraceFiles::longest_upload + 1}}).error(),
            "a.log: 129 MiB; a trace file from elsewhere has at most 128 MiB");
  EXPECT_EQ(begin({{"name", "a.log"}, {"size", "5"}}).error(), "size: expected a number of bytes");
  EXPECT_EQ(begin({{"name", ""}, {"size", 5U}}).error(), "name: expected 1 to 255 bytes");
  EXPECT_EQ(begin({{"name", std::string(256, 'a')}, {"size", 5U}}).error(), "name: expected 1 to 255 bytes");

  const Json number = (*begin({{"name", "a.log"}, {"size", 5U}}))["upload"];
  EXPECT_EQ(add(number, std::string(TraceFiles::longest_part + 3, 'x')).error(),
            "data: expected at most 262144 bytes");
  EXPECT_TRUE(add(number, "four"));
  EXPECT_EQ(add(number, "ty").error(), "a.log: more than its 5 bytes came");
  EXPECT_EQ(add(number, "y").error(), "this upload is over; begin again") << "it has failed";
  EXPECT_EQ(open_upload(number).error(), "this upload is over; begin again");
}

TEST_F(TraceFilesTest, AnUploadThatIsNotWhole_IsNotOpened_AndAThirdOneEndsTheOldest) {
  const auto begin = [&] { return (*files_->begin_upload({{"name", "a.log"}, {"size", 5U}}))["upload"]; };
  const Json half = begin();
  ASSERT_TRUE(add(half, "(1"));
  EXPECT_EQ(open_upload(half).error(), "a.log: not all of it has come");
  const Json first = begin();
  const Json second = begin();
  ASSERT_TRUE(add(first, "1"));
  const Json third = begin();
  EXPECT_FALSE(add(first, "2"));
  EXPECT_TRUE(add(second, "2"));
  EXPECT_TRUE(add(third, "2"));
  const auto answer = answer_of([&](TraceFiles::Done done) {
    files_->add_part({{"upload", third}, {"data", "no base64!"}}, std::move(done));
  });
  EXPECT_EQ(answer.error(), "data: expected base64");
}

}  // namespace
}  // namespace canopus::web::trace_files_test
