#include "canopus/cli/app/users_command.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <expected>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/text/json.hpp"
#include "canopus/web/access/password.hpp"

namespace canopus::cli {
namespace {

constexpr char interrupted = '\x03';  // Ctrl-C

/// Disables the terminal's echo for its lifetime. Ctrl-C is a character that ends the line: as a signal it
/// would leave the echo off.
class Silence {
 public:
  Silence() {
    ::tcgetattr(STDIN_FILENO, &before_);
    termios silent = before_;
    silent.c_lflag &= ~static_cast<tcflag_t>(ECHO | ISIG);
    silent.c_lflag |= ECHONL;
    silent.c_cc[VEOL] = interrupted;
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
  }
  ~Silence() { ::tcsetattr(STDIN_FILENO, TCSADRAIN, &before_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  termios before_{};
};

/// Up to the end of the line, byte by byte: the input behind it belongs to other readers. Nothing at the end
/// of the input.
std::expected<std::optional<std::string>, std::string> read_line() {
  constexpr std::size_t most = 4096;
  std::string line;
  while (line.size() < most) {
    char letter = 0;
    const ssize_t count = ::read(STDIN_FILENO, &letter, 1);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::unexpected(std::generic_category().message(errno));
    if (count == 0) return line.empty() ? std::optional<std::string>() : line;
    if (letter == interrupted) return std::unexpected(std::string("interrupted"));
    if (letter == '\n') break;
    line += letter;
  }
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

std::expected<std::string, std::string> prompt(const std::string& sentence) {
  if (!sentence.empty()) print_error("{}", sentence);
  auto line = read_line();
  if (!line) return std::unexpected("the password cannot be read: " + line.error());
  if (!*line) return std::unexpected(std::string("expected a password on the standard input"));
  return std::move(**line);
}

/// A password from the terminal of the standard input, asked for twice and not shown; without a terminal the first line of the
/// standard input. The error is a sentence.
std::expected<std::string, std::string> read_password(const std::string& user) {
  if (::isatty(STDIN_FILENO) == 0) return prompt({});
  const Silence silence;
  auto first = prompt("Password of " + user + " (it is not shown):");
  if (!first) return first;
  const auto second = prompt("The same again:");
  if (!second) return second;
  if (*first != *second) return std::unexpected(std::string("the two passwords are not the same"));
  return first;
}

constexpr int users_done = 0;
constexpr int users_failed = 1;

struct UsersArguments {
  std::string file;
  std::string name;
  std::string role = "look";
  bool replaces = false;
  bool json = false;
};

int fail(const std::string& sentence) {
  print_error("canopus web-users: {}", sentence);
  return users_failed;
}

/// The begin and end of line `number`, its end of line included.
std::pair<std::size_t, std::size_t> place_of_line(std::string_view text, std::size_t number) {
  std::size_t begin = 0;
  for (std::size_t line = 1; line < number; ++line) begin = text.find('\n', begin) + 1;
  return {begin, std::min(text.find('\n', begin), text.size() - 1) + 1};
}

/// The accounts, and the one of this name.
std::expected<std::optional<web::WebAccount>, std::string> find_user(const std::string& text,
                                                                     const std::string& file,
                                                                     std::string_view name) {
  const auto accounts = web::parse_web_users(text, file);
  if (!accounts) return std::unexpected(accounts.error());
  const auto found = std::ranges::find(*accounts, name, &web::WebAccount::name);
  return found == accounts->end() ? std::optional<web::WebAccount>() : *found;
}

int write(const std::string& file, const std::string& text) {
  // Only the owner may read it, from its creation on.
  const mode_t before = ::umask(077);
  const auto written = write_new_file(file, text);
  ::umask(before);
  return written ? users_done : fail(written.error());
}

/// The present contents of the file; empty for a new one.
std::expected<std::string, std::string> text_before(const std::string& file) {
  std::error_code failure;
  const auto found = std::filesystem::symlink_status(file, failure);
  if (found.type() == std::filesystem::file_type::not_found) return std::string();
  return web::read_web_users_text(file);
}

int add_user(const UsersArguments& arguments) {
  auto text = text_before(arguments.file);
  if (!text) return fail(text.error());
  const auto before = find_user(*text, arguments.file, arguments.name);
  if (!before) return fail(before.error());
  if (*before && !arguments.replaces) {  // before the user types a password
    return fail(fmt::format("{}:{}: {} is a user already; --replace gives a new role and password",
                            arguments.file, (*before)->line, arguments.name));
  }
  const auto password = read_password(arguments.name);
  if (!password) return fail(password.error());
  auto hash = web::hash_of(*password);
  if (!hash) return fail(hash.error());
  const auto role = web::parse_web_role(arguments.role);
  const auto changed =
      with_user(*text, arguments.file, {.name = arguments.name, .role = *role, .hash = std::move(*hash)},
                arguments.replaces);
  if (!changed) return fail(changed.error());
  return write(arguments.file, *changed);
}

int remove_user(const UsersArguments& arguments) {
  const auto text = web::read_web_users_text(arguments.file);
  if (!text) return fail(text.error());
  const auto changed = without_user(*text, arguments.file, arguments.name);
  if (!changed) return fail(changed.error());
  return write(arguments.file, *changed);
}

int list_users(const UsersArguments& arguments) {
  const auto users = web::read_web_users(arguments.file);
  if (!users) return fail(users.error());
  for (const web::WebAccount& user : *users) {
    if (arguments.json) {
      print_json({{"name", user.name}, {"role", name_of(user.role)}, {"line", user.line}});
    } else {
      print_line("{:<32} {}", user.name, name_of(user.role));
    }
  }
  return users_done;
}

std::string check_name(const std::string& name) {
  if (web::is_user_name(name)) return {};
  return fmt::format("\"{}\": expected 1 to 32 letters, digits and . _ - @ that begin with a letter or digit",
                     name);
}

}  // namespace

std::expected<std::string, std::string> with_user(const std::string& text, const std::string& file,
                                                  const web::WebAccount& account, bool replaces) {
  const auto before = find_user(text, file, account.name);
  if (!before) return std::unexpected(before.error());
  if (*before && !replaces) {
    return std::unexpected(fmt::format("{}:{}: {} is a user already", file, (*before)->line, account.name));
  }
  const std::string line = fmt::format("{} {} {}\n", account.name, name_of(account.role), account.hash);
  std::string changed = text;
  if (*before) {
    const auto [begin, end] = place_of_line(text, (*before)->line);
    changed.replace(begin, end - begin, line);
  } else {
    if (!changed.empty() && !changed.ends_with('\n')) changed += '\n';
    changed += line;
  }
  const auto check = web::parse_web_users(changed, file);
  if (!check) return std::unexpected(check.error());
  return changed;
}

std::expected<std::string, std::string> without_user(const std::string& text, const std::string& file,
                                                     std::string_view name) {
  const auto before = find_user(text, file, name);
  if (!before) return std::unexpected(before.error());
  if (!*before) return std::unexpected(fmt::format("{}: {} is no user of it", file, name));
  const auto [begin, end] = place_of_line(text, (*before)->line);
  std::string changed = text;
  changed.erase(begin, end - begin);
  return changed;
}

namespace {

void build_users_command(Command& users, int& exit_code) {
  auto arguments = std::make_shared<UsersArguments>();
  users.require_subcommand(1);
  const auto command = [&](const char* name, const char* help, int (*run)(const UsersArguments&)) {
    Command* one = users.add_subcommand(name, help);
    one->add_option("FILE", arguments->file, "the users, one a line: name, role, hash of the password")
        ->required();
    one->callback([arguments, run, &exit_code] { exit_code = run(*arguments); });
    return one;
  };
  Command* add = command(
      "add", "Add a user; the password is asked for, or is the first line of the standard input", add_user);
  add->add_option("NAME", arguments->name, "letters, digits and . _ - @")->required()->check(check_name);
  add->add_option("--role", arguments->role,
                  "look: sees all; operate: does what ends with the run; configure: changes projects and "
                  "devices, too; "
                  "without it look")
      ->type_name("ROLE")
      ->check(one_of_words({"look", "operate", "configure"}));
  add->add_flag("--replace", arguments->replaces, "The user is there already: give a new password and role");
  add->footer(
      "The file is made for its owner alone; others may not read or write it.\n"
      "Example: canopus web-users add users.txt anna --role operate");
  Command* remove = command("remove", "Remove a user", remove_user);
  remove->add_option("NAME", arguments->name, "the user")->required()->check(check_name);
  Command* list = command("list", "Print the users and their roles", list_users);
  list->add_flag("--json", arguments->json, "One JSON object per line");
}

}  // namespace

void add_users_command(Command& app, int& exit_code) {
  app.add_subcommand("web-users", "Users of the page in the browser: names, passwords and roles",
                     [&exit_code](Command& users) { build_users_command(users, exit_code); });
}

}  // namespace canopus::cli
