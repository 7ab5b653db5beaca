// The page's commands are commands of the program: each has the words, options and arguments that the page sends.

#include "canopus/cli/web/web_command_table.hpp"

#include <algorithm>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "canopus/cli/command_line.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/web/web_arguments.hpp"

namespace canopus::cli::web_command_table_test {
namespace {

using Settings = WebCommand::Settings;

struct Program {
  Program() {
    add_commands(app, code);
    app.build_all();
  }
  Command app{"", "canopus"};
  int code = 0;
};

class WebCommandTable : public testing::TestWithParam<WebCommand> {
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
};

TEST_P(WebCommandTable, EachCommandAndField_IsOneOfTheProgram) {
  const Program program;
  const WebCommand& web = GetParam();
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
  const bool is_of_a_bus = !is_web_settings_command(web.title);
  if (web.joins_bus) sent.emplace_back(is_of_a_bus ? "--bus=BUS" : "--host=ADDRESS");
  if (web.takes_device_files) sent.emplace_back("--eds=FILE");
  if (web.settings == Settings::option) sent.emplace_back("--project=FILE");
  if (web.settings == Settings::model) sent.emplace_back("--model=MODEL");
  std::size_t arguments = web.makes_file.empty() ? 0 : 1;
  if (web.settings == Settings::file || (is_of_a_bus && web.has_project)) ++arguments;
  bool has_list = false;
  for (const WebCommandField& field : web.fields) {
    if (field.name.empty()) break;
    const std::string name(field.option.empty() ? field.name : field.option);
    switch (field.kind) {
      case WebCommandField::Kind::option: sent.push_back("--" + name + "=VALUE"); break;
      case WebCommandField::Kind::flag: sent.push_back("--" + name); break;
      case WebCommandField::Kind::words: has_list = true; [[fallthrough]];
      case WebCommandField::Kind::word:
      case WebCommandField::Kind::file: ++arguments; break;
    }
  }
  for (const std::string& word : sent) expect_option(*command, word);
  const auto taken = command->arguments();
  const bool takes_list = std::ranges::any_of(taken, [](const Option& one) { return one.is_several(); });
  EXPECT_TRUE(takes_list || (arguments <= taken.size() && !has_list)) << arguments << " arguments are sent";
}

std::string name_of(const testing::TestParamInfo<WebCommand>& info) {
  std::string name(info.param.title);
  std::ranges::replace_if(
      name, [](char c) { return c == ' ' || c == '-'; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Bus, WebCommandTable, testing::ValuesIn(web_bus_commands()), name_of);
INSTANTIATE_TEST_SUITE_P(Settings, WebCommandTable, testing::ValuesIn(web_settings_commands()), name_of);

}  // namespace
}  // namespace canopus::cli::web_command_table_test
