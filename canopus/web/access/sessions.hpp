#pragma once
// Who has logged in on the page, until he logs out or does nothing for long. Moments are given: no clock.

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/web/access/user.hpp"
#include "canopus/web/access/users.hpp"
#include "canopus/web/http/limits.hpp"

namespace canopus::web {

struct WebSession {
  std::string secret{};  ///< the value of the cookie
  std::string
      key{};  ///< what a page of this server alone can read, and sends with what it changes (CSRF token)
  WebUser user{};
  std::string hash{};  ///< of the password that it began with
  WebMoment began{};
  WebMoment used{};  ///< the user did something then
  bool is_over = false;
};

struct WebSessionOptions {
  std::chrono::seconds longest_idle{30 * 60};  ///< not for those who only look: a display on the wall
  std::chrono::seconds longest{12 * 60 * 60};
  std::size_t most = 64;
  std::size_t most_of_user = 8;  ///< the oldest gives way
};

class WebSessions {
 public:
  explicit WebSessions(WebSessionOptions options = {}) : options_(options) {}

  /// nullptr: there are too many.
  [[nodiscard]] std::shared_ptr<WebSession> begin(WebUser user, std::string hash, WebMoment now);
  /// That of this cookie; nullptr when there is none. It counts as used.
  [[nodiscard]] std::shared_ptr<WebSession> find(std::string_view secret, WebMoment now);
  void end(WebSession& session);
  /// Ends those whose time is over; whoever holds one asks `is_over`.
  void end_expired(WebMoment now);
  /// Ends those of users who are not there any more, or have another role or password.
  void update_users(const std::vector<WebAccount>& accounts);
  [[nodiscard]] std::size_t size() const noexcept { return sessions_.size(); }

 private:
  WebSessionOptions options_;
  std::vector<std::shared_ptr<WebSession>> sessions_;  // the oldest first
};

}  // namespace canopus::web
