#include "canopus/web/access/authenticator.hpp"

#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "canopus/text/json.hpp"
#include "canopus/web/access/password.hpp"
#include "canopus/web/access/secret.hpp"

namespace canopus::web {
namespace {

namespace http = boost::beast::http;

/// Codes of refused log-ins (docs/web.md).
constexpr int wrong_password = 1;
constexpr int too_many_attempts = 9;

bool is_tls(const WebPlace& place) { return place.origin.starts_with("https://"); }

std::string cookie_field(const WebPlace& place, std::string_view value, std::string_view more) {
  return fmt::format("Set-Cookie: {}={}; Path=/; HttpOnly; SameSite=Strict{}{}\r\n", cookie_name(place),
                     value, is_tls(place) ? "; Secure" : "", more);
}

WebAnswer way_to(std::string_view path) {
  return {.status = 303, .body = "elsewhere\n", .fields = fmt::format("Location: {}\r\n", path)};
}

std::string_view value_of(const WebForm& form, std::string_view name) {
  const auto found = form.find(name);
  return found == form.end() ? std::string_view() : std::string_view(found->second);
}

}  // namespace

std::string cookie_name(const WebPlace& place) {
  return fmt::format("{}canopus_{}", is_tls(place) ? "__Host-" : "", place.port);
}

Authenticator::Authenticator(boost::asio::io_context& context, WebGateOptions options, Use use)
    : context_(context),
      options_(std::move(options)),
      use_(std::move(use)),
      rate_(options_.rate),
      attempts_(options_.attempts),
      sessions_(options_.sessions),
      salt_(std::hash<std::string>()(new_secret())) {
  if (has_users())
    worker_ = std::make_unique<serve::Worker>(options_.most_log_ins, false, std::chrono::seconds(30));
}

void Authenticator::note(const WebUser& user, const std::string& what, int code) const {
  if (use_.note) use_.note(user, what, code);
}

std::optional<WebAnswer> Authenticator::refusal(const link::InternetAddress& address, WebMoment now) {
  if (rate_.admits(address, now)) return std::nullopt;
  return WebAnswer{
      .status = 429, .body = "too many requests; wait a second\n", .fields = "Retry-After: 1\r\n"};
}

std::shared_ptr<WebSession> Authenticator::session_of(const WebRequest& request, const WebPlace& place,
                                                      WebMoment now) {
  if (!has_users() || request.count(http::field::cookie) != 1) return nullptr;
  const auto field = request[http::field::cookie];
  const auto secret = cookie_of({field.data(), field.size()}, cookie_name(place));
  return secret ? sessions_.find(*secret, now) : nullptr;
}

/// An unknown user is compared with somebody's password, always the same: it takes as long.
Authenticator::Found Authenticator::look_up(const WebGateOptions& options, const std::string& name,
                                            const std::string& password, std::size_t decoy) {
  Found found{.accounts = options.read_users()};
  if (!found.accounts || found.accounts->empty()) return found;
  const auto account = std::ranges::find(*found.accounts, name, &WebAccount::name);
  const bool is_known = account != found.accounts->end();
  if (is_known) found.account = *account;
  const WebAccount& compared = is_known ? *account : (*found.accounts)[decoy % found.accounts->size()];
  found.fits = fits_hash(password, compared.hash) && is_known;
  return found;
}

void Authenticator::log_in(std::string_view form, const Client& client, const WebPlace& place, WebMoment now,
                           Answer answer) {
  const auto fields = read_form(form);
  const std::string name(fields ? value_of(*fields, "name") : "");
  const std::string password(fields ? value_of(*fields, "password") : "");
  if (name.empty() || name.size() > 64 || password.empty() || password.size() > longest_password) {
    return answer(log_in_page(place, 400, "A name and a password are needed."));
  }
  WebUser user{.name = name, .address = client.name};
  if (const auto wait = attempts_.wait(client.address, name, now); wait.count() != 0) {
    if (now - refused_ > std::chrono::seconds(10))
      note({.name = "?", .address = client.name}, "log in", too_many_attempts);
    refused_ = now;
    WebAnswer refused = log_in_page(place, 429, fmt::format("Too many attempts. Wait {} s.", wait.count()));
    refused.fields = fmt::format("Retry-After: {}\r\n", wait.count());
    return answer(refused);
  }
  const std::size_t decoy = std::hash<std::string>()(name) ^ salt_;
  const bool is_taken = worker_->add([gate = weak_from_this(), &context = context_, options = options_, user,
                                      password, client, place, now, decoy, answer] {
    auto found = look_up(options, user.name, password, decoy);
    boost::asio::post(context, [gate, found = std::move(found), user, client, place, now, answer] {
      if (const auto self = gate.lock()) self->finish_log_in(found, user, client, place, now, answer);
    });
  });
  if (!is_taken) answer(log_in_page(place, 503, "Too many log in at the same time. Try again."));
}

/// The one answer for a wrong name and for a wrong password. What was typed as an unknown name may be a password: it is not noted.
void Authenticator::finish_log_in(const Found& found, WebUser user, const Client& client,
                                  const WebPlace& place, WebMoment now, const Answer& answer) {
  update_users(found);
  if (!found.fits) {
    note({.name = found.account ? user.name : "?", .address = client.name}, "log in", wrong_password);
    return answer(log_in_page(place, 401, "The name or the password is wrong."));
  }
  user.role = found.account->role;
  attempts_.succeeded(client.address, user.name);
  const auto session = sessions_.begin(user, found.account->hash, now);
  if (session == nullptr) return answer(log_in_page(place, 503, "Too many are logged in."));
  note(user, "log in", 0);
  WebAnswer way = way_to("/");
  way.fields += cookie_field(place, session->secret, "");
  answer(way);
}

/// A file that has become wrong changes nothing.
void Authenticator::update_users(const Found& found) {
  const std::string trouble = found.accounts ? std::string() : found.accounts.error();
  if (trouble != trouble_ && !trouble.empty() && use_.report)
    use_.report(trouble + "; the users stay as they are");
  trouble_ = trouble;
  if (found.accounts) sessions_.update_users(*found.accounts);
}

WebAnswer Authenticator::log_out(std::string_view form, WebSession* session, const Client& client,
                                 const WebPlace& place) {
  const auto fields = read_form(form);
  if (session == nullptr) return {.status = 401, .body = "no user is logged in\n"};
  if (!fields || !is_same_secret(value_of(*fields, "key"), session->key)) {
    return {.status = 403, .body = "the form has not the key of the session\n"};
  }
  note({.name = session->user.name, .address = client.name, .role = session->user.role}, "log out", 0);
  sessions_.end(*session);
  WebAnswer way = way_to("/login");
  way.fields += cookie_field(place, "", "; Max-Age=0");
  return way;
}

WebAnswer Authenticator::described(const WebSession* session) {
  if (session == nullptr) return {.status = 401, .body = "log in first\n"};
  const text::Json text{
      {"user", session->user.name}, {"role", name_of(session->user.role)}, {"key", session->key}};
  return {.content_type = "application/json", .body = text.dump()};
}

void Authenticator::refresh(WebMoment now) {
  if (!has_users()) return;
  sessions_.end_expired(now);
  if (is_looking_ || sessions_.size() == 0 || now - looked_ < options_.users_again) return;
  looked_ = now;
  is_looking_ =
      worker_->add([gate = weak_from_this(), &context = context_, read_users = options_.read_users] {
        Found found{.accounts = read_users()};
        boost::asio::post(context, [gate, found = std::move(found)] {
          const auto self = gate.lock();
          if (!self) return;
          self->is_looking_ = false;
          self->update_users(found);
        });
      });
}

}  // namespace canopus::web
