// Everything the program prints goes through print.hpp, which lets nothing control the terminal but paint().

#include "canopus/cli/output/print.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "paths.hpp"

namespace canopus::cli::print_test {
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
std::string code_of(std::string_view text) {
  std::string code;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, std::min(text.find('\n'), text.size() - 1) + 1);
    code += line.substr(0, line.find("//"));
    code += '\n';
    text.remove_prefix(line.size());
  }
  return code;
}

/// The name stands there as a name of its own, and is called if it ends with a parenthesis.
bool has_word(const std::string& code, std::string_view word) {
  const auto is_part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  const bool is_call = word.ends_with('(');
  if (is_call) word.remove_suffix(1);
  for (std::size_t at = code.find(word); at != std::string::npos; at = code.find(word, at + 1)) {
    std::size_t end = at + word.size();
    if (at > 0 && (is_part(code[at - 1]) || code[at - 1] == '.')) continue;
    if (end < code.size() && is_part(code[end])) continue;
    end = std::min(code.find_first_not_of(' ', end), code.size());
    if (!is_call || code.substr(end, 1) == "(") return true;
  }
  return false;
}

/// Prints past print.hpp, or writes escape sequences of its own.
bool prints_otherwise(const std::string& code) {
  constexpr std::string_view words[] = {"fmt::print", "fmt::vprint", "cout",     "cerr",    "clog",
                                        "wcout",      "stdout",      "stderr",   "printf(", "vprintf(",
                                        "fprintf(",   "vfprintf(",   "dprintf(", "puts(",   "fputs(",
                                        "putc(",      "fputc(",      "putchar(", "perror(", "STDOUT_FILENO, ",
                                        "\\x1b",      "\\x1B",       "\\033",    "\\e["};
  if (std::ranges::any_of(words, [&](std::string_view word) {
        return word[0] == '\\' || word.ends_with(' ') ? code.contains(word) : has_word(code, word);
      })) {
    return true;
  }
  for (const std::string_view direct : {"write(1,", "write(2,", "write(STD", "dup(1)", "dup(2)"}) {
    if (code.contains(direct)) return true;
  }
  return has_word(code, "dup2(");
}

TEST(PrintRule, SeesWhatPrintsOtherwise) {
  for (const char* code :
       {"fmt::print(\"{}\", a);", "std::cout << a;", "std::fputs(a, file);", "std::printf(\"a\");",
        " puts(a);", "std::fwrite(a, 1, 1, stdout);", "fprintf(stderr, a);", "\"\\x1b[2J\"", "\"\\033[1m\"",
        "perror(a);", "::write(STDOUT_FILENO, a, 1);", "write(2, a, 1);", "::dup2(a, 1);"}) {
    EXPECT_TRUE(prints_otherwise(code)) << code;
  }
  for (const char* code : {"print_line(\"a\");", "std::snprintf(a, 1, b);", "std::vsnprintf(a, 1, b, c);",
                           "isatty(STDOUT_FILENO)", "inputs(a)", "file.write(a, 1);",
                           "::write(socket, a, 1);", "posix_spawn_file_actions_adddup2(&files, a, 1);"}) {
    EXPECT_FALSE(prints_otherwise(code)) << code;
  }
  EXPECT_FALSE(prints_otherwise(code_of("// as std::cout does\n")));
}

TEST(PrintRule, TheProgramPrintsOneWay) {
  const fs::path sources = fs::path(CANOPUS_SOURCE_DIR) / "canopus";
  // These own the streams and the terminal.
  const std::vector<std::string> owners{"print.cpp", "output.cpp", "run_output.cpp", "screen.cpp",
                                        "python_check.cpp"};  // its Python program owns its own
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
}  // namespace canopus::cli::print_test
