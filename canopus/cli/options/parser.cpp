#include "canopus/cli/options/parser.hpp"

#include <algorithm>
#include <memory>
#include <sstream>
#include <utility>

#include <CLI/CLI.hpp>

namespace canopus::cli {
namespace {

/// CLI11 has the options that one needs and excludes in the order of their addresses: the help has them in the table's.
class TableFormatter final : public CLI::Formatter {
 public:
  void add(const CLI::Option* option) { order_.push_back(option); }

  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    if (option->get_needs().size() < 2 && option->get_excludes().size() < 2) return text;
    text.erase(std::min({text.find(" Needs:"), text.find(" Excludes:"), text.size()}));
    return text + list(" Needs:", option->get_needs()) + list(" Excludes:", option->get_excludes());
  }

 private:
  template <typename Options>
  std::string list(const char* title, const Options& options) const {
    std::string text;
    for (const CLI::Option* option : order_) {
      if (std::ranges::find(options, option) == options.end()) continue;
      text += (text.empty() ? title : "") + (' ' + option->get_name());
    }
    return text;
  }

  std::vector<const CLI::Option*> order_;
};

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ",") + name;
  return list;
}

/// Adds an option to CLI11's command by the type of its target.
struct OptionAdder {
  CLI::App& app;
  const Option::Data& data;
  const std::string& names;

  CLI::Option* operator()(HelpFlag /*target*/) const {
    CLI::Option* const inherited = app.get_help_ptr();
    const bool same = inherited != nullptr && inherited->get_name(false, true) == names &&
                      inherited->get_description() == data.description;
    return same ? inherited : app.set_help_flag(names, data.description);
  }
  CLI::Option* operator()(const VersionFlag& version) const {
    return app.set_version_flag(names, version.text, data.description);
  }
  CLI::Option* operator()(bool* target) const { return app.add_flag(names, *target, data.description); }
  CLI::Option* operator()(std::string* target) const {
    return data.flag ? app.add_flag(names, *target, data.description)
                     : app.add_option(names, *target, data.description);
  }
  template <typename Value>
  CLI::Option* operator()(Value* target) const {
    return app.add_option(names, *target, data.description);
  }
  CLI::Option* operator()(const std::function<void()>& function) const {
    return app.add_flag_callback(names, function, data.description);
  }
  CLI::Option* operator()(const OptionCheck& function) const {
    const auto take = [&option = data, function](const std::string& value) {
      if (const std::string wrong = function(value); !wrong.empty()) {
        throw CLI::ValidationError(option.names.back(), wrong);
      }
    };
    return app.add_option_function<std::string>(names, take, data.description);
  }
};

class Parser {
 public:
  explicit Parser(Command& program) : program_(program), app_(program.description(), program.name()) {
    app_.formatter(formatter_);
    add(app_, program);
  }

  Parsing parse(std::span<const std::string> words) {
    Parsing parsing;
    try {
      app_.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const CLI::ParseError& error) {
      parsing = result_of(error);
    }
    name_commands(parsing);
    return parsing;
  }
  std::string help() { return with_shown_names(app_.help()); }

 private:
  using Added = std::vector<std::pair<const Option*, CLI::Option*>>;

  void add(CLI::App& app, Command& command) {
    command.build();
    app.footer(command.footer());
    const int required = command.required_subcommands();
    if (required != 0) app.require_subcommand(required);
    Added options;
    for (const Option& option : command.all_options()) {
      options.emplace_back(&option, add_option(app, option));
      formatter_->add(options.back().second);
    }
    connect(options);
    for (Command& inner : command.commands()) {
      CLI::App* const inner_app = app.add_subcommand(inner.name(), inner.description());
      // Its own options and commands when the words come to it.
      inner_app->preparse_callback(
          [this, inner_app, &inner](std::size_t /*words*/) { add(*inner_app, inner); });
    }
    if (!command.action()) return;
    app.callback([&command, options] {
      for (Option& option : command.all_options()) {
        const auto added = std::ranges::find(options, &option, &Added::value_type::first);
        option.set_count(added->second->count());
      }
      command.action()();
    });
  }

  CLI::Option* add_option(CLI::App& app, const Option& option) {
    const Option::Data& data = option.data();
    const std::string names = option.is_argument() ? inner_name(data.names.front()) : joined(data.names);
    CLI::Option* const added = std::visit(OptionAdder{app, data, names}, data.target);
    if (!data.type_name.empty()) added->type_name(data.type_name);
    if (!data.default_text.empty()) added->default_str(data.default_text);
    if (!data.group.empty()) added->group(data.group);
    if (!data.variable.empty()) added->envname(data.variable);
    if (data.required) added->required();
    if (data.least) {
      if (data.least == data.most) {
        added->expected(*data.least);
      } else {
        added->expected(*data.least, *data.most);
      }
    }
    if (!data.extra_arguments) added->allow_extra_args(false);
    for (const OptionCheck& check : data.checks) added->check(check);
    return added;
  }

  static void connect(const Added& options) {
    const auto added = [&](const Option* option) {
      return std::ranges::find(options, option, &Added::value_type::first)->second;
    };
    for (const auto& [option, one] : options) {
      for (const Option* other : option->data().needs) one->needs(added(other));
      for (const Option* other : option->data().excludes) one->excludes(added(other));
    }
  }

  /// Since 2.4 the name of an argument has no '=' and no ' ' in CLI11. These bytes are in no text (UTF-8).
  std::string inner_name(const std::string& shown) {
    std::string name = shown;
    std::ranges::replace(name, '=', '\xFE');
    std::ranges::replace(name, ' ', '\xFF');
    if (name != shown) inner_names_.emplace_back(name, shown);
    return name;
  }

  [[nodiscard]] std::string with_shown_names(std::string text) const {
    for (const auto& [inner, shown] : inner_names_) {
      for (std::size_t at = 0; (at = text.find(inner, at)) != std::string::npos; at += shown.size()) {
        text.replace(at, inner.size(), shown);
      }
    }
    return text;
  }

  [[nodiscard]] Parsing result_of(const CLI::ParseError& error) const {
    using enum CLI::ExitCodes;
    const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
    if (code == Success) {
      std::ostringstream answer, nothing;
      (void)app_.exit(error, answer, nothing);
      return {.result = Parsing::Result::answered, .text = with_shown_names(answer.str())};
    }
    const bool misfit = code == ExtrasError || code == RequiredError;
    return {.result = misfit ? Parsing::Result::misfit : Parsing::Result::wrong,
            .text = with_shown_names(error.what())};
  }

  void name_commands(Parsing& parsing) const {
    const CLI::App* app = &app_;
    const Command* command = &program_;
    parsing.commands.push_back({command, app->remaining()});
    while (!app->get_subcommands().empty()) {
      app = app->get_subcommands().back();
      command = command->find(app->get_name());
      parsing.commands.push_back({command, app->remaining()});
    }
  }

  Command& program_;
  std::shared_ptr<TableFormatter> formatter_ = std::make_shared<TableFormatter>();
  std::vector<std::pair<std::string, std::string>> inner_names_;  ///< and what is shown for them
  CLI::App app_;
};

}  // namespace

Parsing parse_words(Command& program, std::span<const std::string> words) {
  return Parser(program).parse(words);
}

std::string help_of(Command& program) { return Parser(program).help(); }

}  // namespace canopus::cli
