#include "canopus/web/access/users.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/web/access/password.hpp"

namespace canopus::web {
namespace {

bool is_letter_or_digit(char letter) { return ascii::is_letter(letter) || ascii::is_digit(letter); }

std::expected<WebAccount, std::string> read_account(const std::vector<std::string_view>& words) {
  if (words.size() != 3) {
    return std::unexpected("expected NAME ROLE HASH, found " + ascii::counted(words.size(), "word"));
  }
  if (!is_user_name(words[0])) {
    return std::unexpected(std::string(
        "expected a name of 1 to 32 letters, digits and . _ - @ that begins with a letter or digit"));
  }
  const auto role = parse_web_role(words[1]);
  if (!role) return std::unexpected(role.error());
  // Never repeated in an error: it may be a password that somebody wrote there.
  if (!is_password_hash(words[2])) {
    return std::unexpected(
        std::string("expected a yescrypt or scrypt hash ($y$ or $7$) of the usual cost, as `canopus "
                    "web-users add` and mkpasswd make it"));
  }
  return WebAccount{.name = std::string(words[0]), .role = *role, .hash = std::string(words[2])};
}

std::string reason(int error) { return std::generic_category().message(error); }

/// Why not.
std::optional<std::string> objection(const struct stat& found) {
  if (!S_ISREG(found.st_mode)) return "expected a file";
  if (found.st_uid != ::geteuid() && found.st_uid != 0)
    return "expected a file owned by the user of this program, or by root";
  constexpr unsigned wrong = S_IWGRP | S_IWOTH | S_IROTH;
  if ((found.st_mode & wrong) != 0) {
    return fmt::format("its mode is {:04o}: others can {} it; expected 0600 or 0640 (chmod 600)",
                       found.st_mode & 07777U, (found.st_mode & (S_IWGRP | S_IWOTH)) != 0 ? "write" : "read");
  }
  if (found.st_size > static_cast<off_t>(longest_users_file)) {
    return fmt::format("expected at most {} bytes", longest_users_file);
  }
  return std::nullopt;
}

/// The rest of an open file; nothing (errno) when it cannot be read, and no more than one byte beyond the limit.
std::optional<std::string> rest_of(int file) {
  std::string text;
  std::array<char, 4096> piece{};
  while (text.size() <= longest_users_file) {
    const ssize_t count = ::read(file, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::nullopt;
    if (count == 0) break;
    text.append(piece.data(), static_cast<std::size_t>(count));
  }
  return text;
}

}  // namespace

bool is_user_name(std::string_view text) noexcept {
  if (text.empty() || text.size() > 32 || !is_letter_or_digit(text.front())) return false;
  return std::ranges::all_of(text, [](char letter) {
    return is_letter_or_digit(letter) || std::string_view("._-@").contains(letter);
  });
}

std::expected<WebRole, std::string> parse_web_role(std::string_view text) {
  for (const WebRole role : {WebRole::look, WebRole::operate, WebRole::configure}) {
    if (text == name_of(role)) return role;
  }
  return std::unexpected(fmt::format("\"{}\" is no role; expected look, operate or configure", text));
}

std::expected<std::vector<WebAccount>, std::string> parse_web_users(std::string_view text,
                                                                    const std::string& file) {
  if (text.size() > longest_users_file) {
    return std::unexpected(fmt::format("{}: expected at most {} bytes", file, longest_users_file));
  }
  std::vector<WebAccount> accounts;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    const auto words = ascii::words(line);
    if (words.empty() || words.front().starts_with('#')) continue;
    auto account = read_account(words);
    if (!account) return std::unexpected(fmt::format("{}:{}: {}", file, number, account.error()));
    const auto other = std::ranges::find(accounts, account->name, &WebAccount::name);
    if (other != accounts.end()) {
      return std::unexpected(fmt::format("{}:{}: {} is in line {} already; expected a user once", file,
                                         number, account->name, other->line));
    }
    if (accounts.size() == most_users)
      return std::unexpected(fmt::format("{}:{}: expected at most {} users", file, number, most_users));
    account->line = number;
    accounts.push_back(std::move(*account));
  }
  return accounts;
}

std::expected<std::string, std::string> read_web_users_text(const std::string& file) {
  // Nobody is waited for: a FIFO opens at once.
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return std::unexpected(fmt::format("{}: {}", file, reason(errno)));
  struct stat found {};
  std::string why;
  std::optional<std::string> text;
  if (::fstat(descriptor, &found) != 0) {
    why = reason(errno);
  } else if (const auto wrong = objection(found)) {
    why = *wrong;
  } else {
    text = rest_of(descriptor);
    if (!text) why = reason(errno);
  }
  ::close(descriptor);
  if (!text) return std::unexpected(fmt::format("{}: {}", file, why));
  return *text;
}

std::expected<std::vector<WebAccount>, std::string> read_web_users(const std::string& file) {
  const auto text = read_web_users_text(file);
  if (!text) return std::unexpected(text.error());
  return parse_web_users(*text, file);
}

}  // namespace canopus::web
