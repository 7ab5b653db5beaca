#pragma once
// The commands of the program as data: what each is called, takes and runs. The parser (parser.hpp) reads the
// command line by this table; help, manual pages and completion are generated from it, so that they match the
// program.
//
//   Command* command = app.add_subcommand("send", "Send a frame");
//   command->add_option("--rate", options->rate, "How often")->type_name("RATE")->check(one_of_words({"slow", "fast"}));
//   command->callback([options] { send(*options); });

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace canopus::cli {

/// Empty when the value is good, else what is wrong with it.
using OptionCheck = std::function<std::string(const std::string&)>;

/// The words that an option takes, and no others.
struct Choices {
  std::vector<std::string> words;
};

struct HelpFlag {};
struct VersionFlag {
  std::string text;  ///< what is printed
};

/// The destination of an option's value. A function gets the value instead, and returns an error like a
/// check; one without a value is called for a flag.
using OptionTarget =
    std::variant<HelpFlag, VersionFlag, bool*, int*, unsigned*, std::uint64_t*, std::string*,
                 std::vector<std::string>*, std::optional<std::string>*, std::optional<std::uint16_t>*,
                 std::optional<unsigned>*, std::optional<std::uint64_t>*, std::function<void()>, OptionCheck>;

/// An option as it was written until now. It works for one more release, with a hint on stderr; help, completion and
/// manual pages do not have it.
struct OldSpelling {
  std::string old;  ///< "--start"; empty: an argument
  std::string now;  ///< "--from"; empty: an argument, as in `canopus master FILE`
  /// The value behind `now` for this value; nothing: the option is meant as it is written today. Empty: the same value.
  std::function<std::optional<std::string>(std::string_view value)> value{};
};

/// An option ("--for TIME"), a flag ("--json") or a positional argument ("PLANT").
class Option {
 public:
  struct Data {
    std::vector<std::string> names;  ///< "-q", "--quiet": short ones first; of an argument its name alone
    std::string description;
    OptionTarget target;
    bool flag = false;         ///< takes no value, or one behind = alone
    std::string type_name;     ///< the word for its value
    std::string group;         ///< heading in the help
    std::string variable;      ///< of the environment: its value, where the option is not given
    std::string default_text;  ///< what the help shows as default
    bool required = false;
    bool extra_arguments = true;     ///< a list takes several words at once
    std::optional<int> least, most;  ///< number of values, where it is not the target's
    std::vector<OptionCheck> checks;
    std::vector<std::string> choices;  ///< the words it takes; empty: others, too
    std::vector<const Option*> needs, excludes;
  };

  explicit Option(Data data);

  Option* type_name(std::string name);
  Option* required(bool is_required = true);
  Option* check(OptionCheck check);
  Option* check(Choices choices);
  Option* needs(const Option* other);
  /// Neither with the other.
  Option* excludes(const Option* other);
  Option* expected(int number);
  Option* expected(int least, int most);
  /// For a list: false permits one value per occurrence of the option.
  Option* allow_extra_args(bool allowed);
  /// The help shows the value that the target has now.
  Option* capture_default_str();
  Option* envname(std::string variable);
  /// Neither needs nor excludes the other one.
  void forget(const Option* other);

  [[nodiscard]] const Data& data() const noexcept { return data_; }
  [[nodiscard]] const std::vector<std::string>& names() const noexcept { return data_.names; }
  [[nodiscard]] const std::string& description() const noexcept { return data_.description; }
  [[nodiscard]] const std::vector<std::string>& choices() const noexcept { return data_.choices; }
  [[nodiscard]] bool is_argument() const noexcept;
  /// The placeholder of the option's value ("TIME"); empty: no value.
  [[nodiscard]] std::string value() const;
  /// Takes several values, or may be given again.
  [[nodiscard]] bool is_several() const noexcept;

  /// The number of its values on the command line, after parsing.
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  void set_count(std::size_t count) noexcept { count_ = count; }

 private:
  Data data_;
  std::size_t count_ = 0;
};

/// A command, or the program. Pointers to it and to its options stay good.
class Command {
 public:
  /// Adds what the command has.
  using Builder = std::function<void(Command&)>;

  explicit Command(std::string description = {}, std::string name = {});
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  /// It has the help flag and, until it gets its own, the footer that this command has now.
  Command* add_subcommand(std::string name, std::string description);
  /// `builder` is called once more of it is needed than name and description.
  Command* add_subcommand(std::string name, std::string description, Builder builder);

  template <typename Value>
  Option* add_option(const std::string& names, Value& target, std::string description) {
    return add(names, &target, std::move(description), false);
  }
  Option* add_option_function(const std::string& names, OptionCheck function, std::string description) {
    return add(names, std::move(function), std::move(description), false);
  }
  /// A string gets "true", or the text behind =.
  template <typename Value>
  Option* add_flag(const std::string& names, Value& target, std::string description) {
    return add(names, &target, std::move(description), true);
  }
  Option* add_flag_callback(const std::string& names, std::function<void()> function,
                            std::string description) {
    return add(names, std::move(function), std::move(description), true);
  }
  void set_help_flag(const std::string& names, std::string description);
  void set_version_flag(const std::string& names, std::string text);
  /// Options that are added from now on are below this heading.
  void option_group(std::string heading) { group_ = std::move(heading); }
  [[nodiscard]] Option* get_option(std::string_view name);
  void remove_option(const Option* option);
  void add_old_spelling(OldSpelling spelling) { old_spellings_.push_back(std::move(spelling)); }

  void footer(std::string text) { footer_ = std::move(text); }
  void callback(std::function<void()> action) { action_ = std::move(action); }
  /// The number of subcommands that must follow.
  void require_subcommand(int number) { required_subcommands_ = number; }

  /// Has the builder called, if it was not yet.
  void build();
  /// Also of all commands in it.
  void build_all();

  /// Its last word: "convert".
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// "canopus trace convert"
  [[nodiscard]] std::string full_name() const;
  /// "canopus trace convert [OPTIONS] IN OUT"
  [[nodiscard]] std::string usage() const;
  [[nodiscard]] const std::string& description() const noexcept { return description_; }
  /// The last lines of the help.
  [[nodiscard]] const std::string& footer() const noexcept { return footer_; }
  /// In the order in which they were added, arguments among them, --help first.
  [[nodiscard]] std::list<Option>& all_options() noexcept { return options_; }
  using Options = std::vector<std::reference_wrapper<const Option>>;
  [[nodiscard]] Options options() const { return options_that(false); }
  [[nodiscard]] Options arguments() const { return options_that(true); }
  [[nodiscard]] std::list<Command>& commands() noexcept { return commands_; }
  [[nodiscard]] const std::list<Command>& commands() const noexcept { return commands_; }
  /// nullptr: there is none of this name.
  [[nodiscard]] const Command* find(std::string_view name) const;
  [[nodiscard]] const std::function<void()>& action() const noexcept { return action_; }
  [[nodiscard]] int required_subcommands() const noexcept { return required_subcommands_; }
  [[nodiscard]] const std::vector<OldSpelling>& old_spellings() const noexcept { return old_spellings_; }

 private:
  Option* add(const std::string& names, OptionTarget target, std::string description, bool flag);
  [[nodiscard]] Options options_that(bool are_arguments) const;

  std::string name_, description_, footer_, group_;
  const Command* outer_ = nullptr;
  std::list<Option> options_;
  std::list<Command> commands_;
  std::vector<OldSpelling> old_spellings_;
  std::function<void()> action_;
  Builder builder_;
  int required_subcommands_ = 0;
};

// Checks of option values during parsing, for Option::check().

/// One of these words.
[[nodiscard]] Choices one_of_words(const std::vector<std::string_view>& known);

/// The check of one_of_words().
[[nodiscard]] OptionCheck check_of(Choices choices);

/// A decimal number, `least` to `most`.
[[nodiscard]] OptionCheck number_from(std::uint64_t least, std::uint64_t most);

}  // namespace canopus::cli
