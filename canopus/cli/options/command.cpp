#include "canopus/cli/options/command.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {
namespace {

std::vector<std::string> names_in(std::string_view list) {
  std::vector<std::string> names;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    names.emplace_back(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  std::ranges::stable_partition(names, [](const std::string& name) { return !name.starts_with("--"); });
  return names;
}

/// The word for a value of this type.
struct TypeName {
  std::string operator()(int*) const { return "INT"; }
  std::string operator()(unsigned*) const { return "UINT"; }
  std::string operator()(std::uint64_t*) const { return "UINT"; }
  std::string operator()(std::optional<std::uint16_t>*) const { return "UINT"; }
  std::string operator()(std::optional<unsigned>*) const { return "UINT"; }
  std::string operator()(std::optional<std::uint64_t>*) const { return "UINT"; }
  template <typename Text>
  std::string operator()(const Text&) const {
    return "TEXT";
  }
};

struct ValueText {
  std::string operator()(int* value) const { return std::to_string(*value); }
  std::string operator()(unsigned* value) const { return std::to_string(*value); }
  std::string operator()(std::uint64_t* value) const { return std::to_string(*value); }
  std::string operator()(std::string* value) const { return *value; }
  template <typename Other>
  std::string operator()(const Other&) const {
    return {};
  }
};

bool is_help(const Option& option) { return std::holds_alternative<HelpFlag>(option.data().target); }

}  // namespace

Option::Option(Data data) : data_(std::move(data)) {
  if (!data_.flag) data_.type_name = std::visit(TypeName(), data_.target);
}

Option* Option::type_name(std::string name) {
  data_.type_name = std::move(name);
  return this;
}

Option* Option::required(bool is_required) {
  data_.required = is_required;
  return this;
}

Option* Option::check(OptionCheck check) {
  data_.checks.push_back(std::move(check));
  return this;
}

Option* Option::check(Choices choices) {
  data_.choices = choices.words;
  return check(check_of(std::move(choices)));
}

Option* Option::needs(const Option* other) {
  data_.needs.push_back(other);
  return this;
}

Option* Option::excludes(const Option* other) {
  data_.excludes.push_back(other);
  return this;
}

Option* Option::expected(int number) { return expected(number, number); }

Option* Option::expected(int least, int most) {
  data_.least = least;
  data_.most = most;
  return this;
}

Option* Option::allow_extra_args(bool allowed) {
  data_.extra_arguments = allowed;
  return this;
}

Option* Option::capture_default_str() {
  data_.default_text = std::visit(ValueText(), data_.target);
  return this;
}

Option* Option::envname(std::string variable) {
  data_.variable = std::move(variable);
  return this;
}

void Option::forget(const Option* other) {
  std::erase(data_.needs, other);
  std::erase(data_.excludes, other);
}

bool Option::is_argument() const noexcept { return !data_.names.front().starts_with('-'); }

std::string Option::value() const {
  if (data_.flag || data_.least == 0) return {};
  return data_.type_name;
}

bool Option::is_several() const noexcept {
  if (data_.flag) return false;
  if (data_.most) return *data_.most > 1;
  return std::holds_alternative<std::vector<std::string>*>(data_.target);
}

Command::Command(std::string description, std::string name)
    : name_(std::move(name)), description_(std::move(description)) {
  set_help_flag("-h,--help", "Print this help message and exit");
}

Command* Command::add_subcommand(std::string name, std::string description) {
  Command& added = commands_.emplace_back(std::move(description), std::move(name));
  added.outer_ = this;
  added.footer_ = footer_;
  added.options_.clear();
  const auto help = std::ranges::find_if(options_, is_help);
  if (help != options_.end()) added.options_.push_back(*help);
  return &added;
}

Command* Command::add_subcommand(std::string name, std::string description, Builder builder) {
  Command* const added = add_subcommand(std::move(name), std::move(description));
  added->builder_ = std::move(builder);
  return added;
}

void Command::set_help_flag(const std::string& names, std::string description) {
  std::erase_if(options_, is_help);
  add(names, HelpFlag(), std::move(description), true);
}

void Command::set_version_flag(const std::string& names, std::string text) {
  add(names, VersionFlag(std::move(text)), "Display program version information and exit", true);
}

Option* Command::add(const std::string& names, OptionTarget target, std::string description, bool flag) {
  Option::Data data;
  data.names = names_in(names);
  data.description = std::move(description);
  data.target = std::move(target);
  data.flag = flag;
  data.group = group_;
  return &options_.emplace_back(std::move(data));
}

Option* Command::get_option(std::string_view name) {
  const auto found = std::ranges::find_if(options_, [&](const Option& option) {
    return std::ranges::find(option.names(), name) != option.names().end();
  });
  return found == options_.end() ? nullptr : &*found;
}

void Command::remove_option(const Option* option) {
  for (Option& other : options_) other.forget(option);
  std::erase_if(options_, [&](const Option& one) { return &one == option; });
}

void Command::build() {
  if (const Builder builder = std::exchange(builder_, nullptr)) builder(*this);
}

void Command::build_all() {
  build();
  for (Command& command : commands_) command.build_all();
}

std::string Command::full_name() const {
  return outer_ == nullptr || outer_->name_.empty() ? name_ : outer_->full_name() + ' ' + name_;
}

std::string Command::usage() const {
  std::string line = full_name();
  if (!options().empty()) line += " [OPTIONS]";
  for (const Option& argument : arguments()) {
    const std::string word = argument.names().front() + (argument.is_several() ? "..." : "");
    line += argument.data().required ? " " + word : " [" + word + "]";
  }
  if (!commands_.empty()) line += " COMMAND";
  return line;
}

Command::Options Command::options_that(bool are_arguments) const {
  Options found;
  for (const Option& option : options_) {
    if (option.is_argument() == are_arguments) found.emplace_back(option);
  }
  return found;
}

const Command* Command::find(std::string_view name) const {
  const auto found = std::ranges::find(commands_, name, &Command::name);
  return found == commands_.end() ? nullptr : &*found;
}

Choices one_of_words(const std::vector<std::string_view>& known) {
  return {.words = {known.begin(), known.end()}};
}

OptionCheck check_of(Choices choices) {
  return [words = std::move(choices.words)](const std::string& word) {
    if (std::ranges::find(words, word) != words.end()) return std::string();
    const std::vector<std::string_view> known(words.begin(), words.end());
    return fmt::format("\"{}\" is unknown{}", word, text::suggestion(word, known));
  };
}

OptionCheck number_from(std::uint64_t least, std::uint64_t most) {
  return [least, most](const std::string& text) {
    const auto value = ascii::parse_number<std::uint64_t>(text);
    const bool good = value && *value >= least && *value <= most;
    return good ? std::string() : fmt::format("\"{}\" is not a number from {} to {}", text, least, most);
  };
}

}  // namespace canopus::cli
