#include "canopus/cli/options/parser.hpp"

#include <algorithm>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
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
    const auto parse_value = [&option = data, function](const std::string& value) {
      if (const std::string wrong = function(value); !wrong.empty()) {
        throw CLI::ValidationError(option.names.back(), wrong);
      }
    };
    if (data.most.value_or(1) == 1)
      return app.add_option_function<std::string>(names, parse_value, data.description);
    const auto parse_values = [parse_value](const std::vector<std::string>& values) {
      for (const std::string& value : values) parse_value(value);
    };
    return app.add_option_function<std::vector<std::string>>(names, parse_values, data.description);
  }
};

/// The command that the words name.
Command& named_command(Command& program, std::span<const std::string> words) {
  Command* command = &program;
  command->build();
  for (const std::string& word : words) {
    if (word.starts_with('-')) continue;
    const auto inner = std::ranges::find(command->commands(), word, &Command::name);
    if (inner == command->commands().end()) break;
    command = &*inner;
    command->build();
  }
  return *command;
}

/// Whether the next word is a value of it.
bool takes_next_word(Command& command, const std::string& word) {
  const Option* const option = word.starts_with('-') ? command.get_option(word) : nullptr;
  return option != nullptr && !option->value().empty();
}

/// The words with the options as they are called today.
class PresentSpellings {
 public:
  PresentSpellings(Command& program, std::span<const std::string> words)
      : command_(named_command(program, words)), words_(words) {}

  std::vector<std::string> words(const std::function<void(std::string_view)>& hint) {
    std::vector<std::string> present;
    for (std::size_t i = 0; i < words_.size(); ++i) {
      if (words_[i] == "--") {
        present.insert(present.end(), words_.begin() + static_cast<std::ptrdiff_t>(i), words_.end());
        break;
      }
      const auto meant = meaning(i);
      present.push_back(meant ? meant->word : words_[i]);
      if (!meant) continue;
      if (hint) {
        hint(command_.full_name() + ": " + words_[i] +
             " is an old spelling, which the next release does not know; expected \"" + meant->word + '"');
      }
      i += meant->values;
    }
    return present;
  }

 private:
  struct Meaning {
    std::string word;
    std::size_t values = 0;  ///< words behind the old one that are in it
  };

  [[nodiscard]] std::optional<Meaning> meaning(std::size_t at) const {
    const std::string& word = words_[at];
    const bool is_argument = !word.starts_with('-');
    if (is_argument && at > 0 && takes_next_word(command_, words_[at - 1])) return std::nullopt;
    const std::size_t equals = is_argument ? std::string::npos : word.find('=');
    const std::string name = is_argument ? std::string() : word.substr(0, equals);
    const bool is_next = !is_argument && equals == std::string::npos;
    if (is_next && at + 1 == words_.size()) return std::nullopt;
    const std::string value = is_argument ? word : is_next ? words_[at + 1] : word.substr(equals + 1);
    for (const OldSpelling& spelling : command_.old_spellings()) {
      if (spelling.old != name) continue;
      const auto meant = spelling.value ? spelling.value(value) : std::optional(value);
      if (!meant) continue;
      return Meaning{.word = spelling.now.empty() ? *meant : spelling.now + '=' + *meant,
                     .values = is_next ? 1U : 0U};
    }
    return std::nullopt;
  }

  Command& command_;
  std::span<const std::string> words_;
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
    std::string text = with_shown_names(error.what());
    constexpr std::string_view excludes = " excludes ";  // CLI11's word
    if (const auto at = text.find(excludes); code == ExcludesError && at != std::string::npos)
      text.replace(at, excludes.size(), " cannot be combined with ");
    return {.result = misfit ? Parsing::Result::misfit : Parsing::Result::wrong, .text = std::move(text)};
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

Parsing parse_words(Command& program, std::span<const std::string> words,
                    const std::function<void(std::string_view)>& hint) {
  return Parser(program).parse(PresentSpellings(program, words).words(hint));
}

std::string help_of(Command& program) { return Parser(program).help(); }

}  // namespace canopus::cli
