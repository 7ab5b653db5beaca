#include "canopus/web/access/sessions.hpp"

#include <algorithm>
#include <utility>

#include "canopus/web/access/secret.hpp"

namespace canopus::web {

std::shared_ptr<WebSession> WebSessions::begin(WebUser user, std::string hash, WebMoment now) {
  end_expired(now);
  const auto is_his = [&](const auto& session) { return session->user.name == user.name; };
  if (std::cmp_greater_equal(std::ranges::count_if(sessions_, is_his), options_.most_of_user)) {
    end(**std::ranges::find_if(sessions_, is_his));
  }
  if (sessions_.size() >= options_.most) return nullptr;
  sessions_.push_back(std::make_shared<WebSession>(WebSession{.secret = new_secret(),
                                                              .key = new_secret(),
                                                              .user = std::move(user),
                                                              .hash = std::move(hash),
                                                              .began = now,
                                                              .used = now}));
  return sessions_.back();
}

std::shared_ptr<WebSession> WebSessions::find(std::string_view secret, WebMoment now) {
  end_expired(now);
  std::shared_ptr<WebSession> found;
  for (const auto& session : sessions_) {
    if (is_same_secret(session->secret, secret)) found = session;
  }
  if (found) found->used = now;
  return found;
}

void WebSessions::end(WebSession& session) {
  session.is_over = true;
  std::erase_if(sessions_, [](const auto& one) { return one->is_over; });
}

void WebSessions::update_users(const std::vector<WebAccount>& accounts) {
  for (const auto& session : std::vector(sessions_)) {
    const auto account = std::ranges::find(accounts, session->user.name, &WebAccount::name);
    const bool stays =
        account != accounts.end() && account->role == session->user.role && account->hash == session->hash;
    if (!stays) end(*session);
  }
}

void WebSessions::end_expired(WebMoment now) {
  for (const auto& session : std::vector(sessions_)) {
    const bool is_idle = session->user.role != WebRole::look && now - session->used > options_.longest_idle;
    if (is_idle || now - session->began > options_.longest) end(*session);
  }
}

}  // namespace canopus::web
