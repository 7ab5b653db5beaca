// The page's commands are commands of the program: each has the words, options and arguments that the page sends.

#include <algorithm>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "canopus/cli/app/command_line.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/web/commands/arguments.hpp"
#include "canopus/web/commands/command_table.hpp"

namespace canopus::cli::web_command_table_test {
namespace {

using Settings = web::WebCommand::Settings;

struct Program {
  Program() {
    add_commands(app, code);
    app.build_all();
  }
  Command app{"", "canopus"};
  int code = 0;
};

class WebCommandTable : public testing::TestWithParam<web::WebCommand> {
 protected:
  static const Option* option_of(const Command& command, const std::string& name) {
    for (const Option& one : command.options()) {
      if (std::ranges::find(one.names(), "--" + name) != one.names().end()) return &one;
    }
    return nullptr;
  }
  /// "--wait" is a flag, "--timeout=5s" an option.
  static void expect_option(const Command& command, const std::string& word) {
    const std::size_t equals = word.find('=');
    const Option* option =
        option_of(command, word.substr(2, equals == std::string::npos ? equals : equals - 2));
    ASSERT_NE(option, nullptr) << word;
    EXPECT_EQ(option->value().empty(), equals == std::string::npos) << word;
  }

  /// What the command takes behind its options, word by word; the last one may be a list.
  struct Argument {
    bool is_list = false;
    bool required = false;
  };
  static std::vector<Argument> arguments_of(const Command& command) {
    std::vector<Argument> all;
    for (const Option& one : command.arguments()) {
      const auto& data = one.data();
      const bool is_fixed = data.least && data.least == data.most;
      all.insert(all.end(), is_fixed ? static_cast<std::size_t>(*data.most) : 1,
                 {.is_list = one.is_several() && !is_fixed, .required = data.required});
    }
    return all;
  }
  static void expect_fields(const web::WebCommand& web, const Command& command) {
    auto arguments = arguments_of(command);
    const bool has_place =
        web::is_web_settings_command(web.title) ? web.settings == Settings::file : web.has_project;
    if (has_place) arguments.erase(arguments.begin());
    if (!web.makes_file.empty()) arguments.pop_back();
    std::size_t place = 0;
    for (const web::WebCommandField& field : web.fields) {
      if (field.name.empty()) break;
      SCOPED_TRACE(field.name);
      std::string name(field.name);
      std::ranges::replace(name, '_', '-');
      using enum web::WebCommandField::Kind;
      if (field.kind == option || field.kind == flag) {
        expect_option(command, "--" + name + (field.kind == option ? "=VALUE" : ""));
        continue;
      }
      ASSERT_LT(place, arguments.size()) << "the command takes fewer arguments";
      EXPECT_EQ(field.kind == words, arguments[place].is_list);
      EXPECT_LE(arguments[place].required, field.required) << "the command does not work without it";
      ++place;
    }
    for (; place < arguments.size(); ++place) EXPECT_FALSE(arguments[place].required) << "argument " << place;
  }
};

TEST_P(WebCommandTable, EachCommandAndField_IsOneOfTheProgram) {
  const Program program;
  const web::WebCommand& web = GetParam();
  const Command* command = &program.app;
  std::istringstream words(std::string(web.words.empty() ? web.title : web.words));
  std::vector<std::string> sent;
  for (std::string word; words >> word;) {
    if (word.starts_with("--")) {
      sent.push_back(word);
      continue;
    }
    command = command->find(word);
    ASSERT_NE(command, nullptr) << word;
  }
  ASSERT_TRUE(command->action()) << "is no command that does something";
  if (web.has_json) sent.emplace_back("--json");
  const bool is_of_a_bus = !web::is_web_settings_command(web.title);
  if (web.joins_bus) sent.emplace_back(is_of_a_bus ? "--bus=BUS" : "--plc=ADDRESS");
  if (web.takes_device_files) sent.emplace_back("--eds=FILE");
  if (web.settings == Settings::option) sent.emplace_back("--project=FILE");
  if (web.settings == Settings::model) sent.emplace_back("--module=MODEL");
  for (const std::string& word : sent) expect_option(*command, word);
  expect_fields(web, *command);
}

std::string name_of(const testing::TestParamInfo<web::WebCommand>& info) {
  std::string name(info.param.title);
  std::ranges::replace_if(
      name, [](char c) { return c == ' ' || c == '-'; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Bus, WebCommandTable, testing::ValuesIn(web::web_bus_commands()), name_of);
INSTANTIATE_TEST_SUITE_P(Settings, WebCommandTable, testing::ValuesIn(web::web_settings_commands()), name_of);

}  // namespace
}  // namespace canopus::cli::web_command_table_test
