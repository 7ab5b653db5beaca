// Everything the program prints goes through print.hpp, which lets nothing control the terminal but paint().

#include "canopus/app/print.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace canopus::app {
namespace {

using testing::IsEmpty;
using testing::Not;
namespace fs = std::filesystem;

TEST(Print, TextInALineCannotControlTheTerminalNorBeginAnotherLine) {
  TextOutput out;
  const std::string name = "x\x1b[2J\ncanopus: forged";
  out.line("{}: {} objects, {:>4}", name, 12, std::string_view("\x07"));
  EXPECT_EQ(out.text(), "x\\x1B[2J\\ncanopus: forged: 12 objects, \\x07\n");
}

TEST(Print, ColoursAreThoseOfPaint) {
  TextOutput out;
  out.line("{}: {}", "drive\x1b[8m", paint("not\x1b[0m booted", "31", true));
  EXPECT_EQ(out.text(), "drive\\x1B[8m: \x1b[31mnot\\x1B[0m booted\x1b[0m\n");
  EXPECT_EQ(paint("booted", "32", false).text(), "booted");
}

TEST(Print, AJsonObjectIsOneLineThatControlsNothing) {
  TextOutput out;
  out.json({{"name", "a\u009B2J\nb\x7f\xE4"}});
  EXPECT_EQ(out.text(), "{\"name\":\"a\\u009b2J\\nb\\u007f\uFFFD\"}\n");
}

// --- the rule itself

/// The code without its comments.
std::string code_of(const std::string& text) {
  static const std::regex comment(R"(//[^\n]*)");
  return std::regex_replace(text, comment, "");
}

/// Prints past print.hpp, or writes escape sequences of its own.
bool prints_otherwise(const std::string& code) {
  static const std::regex others(
      R"(fmt::v?print|\bstd::(cout|cerr|clog|wcout|print|println)\b|\b(stdout|stderr)\b|)"
      R"((^|[^nv_a-z])(v?f?printf|f?puts|f?putc|putchar|perror|dprintf)\s*\(|)"
      R"(\\x1[bB]|\\033|\\e\[|\b(write|dup2?)\s*\(\s*(1|2|STD(OUT|ERR)_FILENO)\b)");
  return std::regex_search(code, others);
}

TEST(PrintRule, SeesWhatPrintsOtherwise) {
  for (const char* code :
       {"fmt::print(\"{}\", a);", "std::cout << a;", "std::fputs(a, file);", "std::printf(\"a\");",
        " puts(a);", "std::fwrite(a, 1, 1, stdout);", "fprintf(stderr, a);", "\"\\x1b[2J\"", "\"\\033[1m\"",
        "perror(a);", "::write(STDOUT_FILENO, a, 1);", "write(2, a, 1);"}) {
    EXPECT_TRUE(prints_otherwise(code)) << code;
  }
  for (const char* code : {"print_line(\"a\");", "std::snprintf(a, 1, b);", "isatty(STDOUT_FILENO)",
                           "inputs(a)", "file.write(a, 1);", "::write(socket, a, 1);"}) {
    EXPECT_FALSE(prints_otherwise(code)) << code;
  }
  EXPECT_FALSE(prints_otherwise(code_of("// as std::cout does\n")));
}

TEST(PrintRule, TheProgramPrintsOneWay) {
  const fs::path sources = fs::path(CANOPUS_SOURCE_DIR) / "canopus";
  // These own the streams and the terminal.
  const std::vector<std::string> owners{"print.cpp", "screen.cpp", "live_table.cpp"};
  std::vector<std::string> others;
  unsigned read = 0;
  for (const auto& entry : fs::recursive_directory_iterator(sources)) {
    const fs::path& path = entry.path();
    if (path.extension() != ".cpp" && path.extension() != ".hpp") continue;
    if (testing::Matches(testing::Contains(path.filename().string()))(owners)) continue;
    std::ifstream file(path);
    ++read;
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (prints_otherwise(code_of(text))) others.push_back(path.string());
  }
  EXPECT_GT(read, 100U);
  EXPECT_THAT(others, IsEmpty());
}

}  // namespace
}  // namespace canopus::app
