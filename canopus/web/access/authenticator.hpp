#pragma once
// Who comes in to the page of a run: limits of requests, and with users their log-ins and sessions. It runs on the event loop;
// hashes are computed, and the users' file is read, by a thread of its own.

#include <chrono>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "canopus/link/allow_list.hpp"
#include "canopus/serve/worker.hpp"
#include "canopus/web/access/sessions.hpp"
#include "canopus/web/access/users.hpp"
#include "canopus/web/http/form.hpp"
#include "canopus/web/http/limits.hpp"
#include "canopus/web/http/request.hpp"

namespace canopus::web {

struct WebGateOptions {
  /// Reads the users, in a thread of its own, at each log-in and every few seconds: who is not among them any more is out. Empty:
  /// there are no users.
  std::function<std::expected<std::vector<WebAccount>, std::string>()> read_users{};
  WebRateOptions rate{};
  WebAttemptOptions attempts{};
  WebSessionOptions sessions{};
  std::size_t most_log_ins = 8;                  ///< that wait for the thread
  std::chrono::milliseconds users_again{10000};  ///< from one look at the users to the next
};

class Authenticator : public std::enable_shared_from_this<Authenticator> {
 public:
  struct Use {
    /// Somebody logged in or out, or failed to: code 0, else why not.
    std::function<void(const WebUser& user, const std::string& what, int code)> note{};
    /// Something that a person should know.
    std::function<void(const std::string& sentence)> report{};
  };
  struct Client {
    link::InternetAddress address{};
    std::string name{};  ///< "192.168.1.7:50123"
  };
  using Answer = std::function<void(const WebAnswer&)>;

  /// `context` must outlive it; to be held by a shared_ptr.
  Authenticator(boost::asio::io_context& context, WebGateOptions options, Use use);

  [[nodiscard]] bool has_users() const noexcept { return static_cast<bool>(options_.read_users); }
  /// 429, or nothing: the request is answered.
  [[nodiscard]] std::optional<WebAnswer> refusal(const link::InternetAddress& address, WebMoment now);
  /// Of who has logged in; nullptr: nobody.
  [[nodiscard]] std::shared_ptr<WebSession> session_of(const WebRequest& request, const WebPlace& place,
                                                       WebMoment now);
  /// Answers later, in the loop.
  void log_in(std::string_view form, const Client& client, const WebPlace& place, WebMoment now,
              Answer answer);
  [[nodiscard]] WebAnswer log_out(std::string_view form, WebSession* session, const Client& client,
                                  const WebPlace& place);
  /// What GET /session gets: user, role, and the key of the session; 401 for nobody.
  [[nodiscard]] static WebAnswer described(const WebSession* session);
  /// Ends sessions whose time is over, and reads the users again.
  void refresh(WebMoment now);

 private:
  /// What the thread found out.
  struct Found {
    std::expected<std::vector<WebAccount>, std::string> accounts{};
    std::optional<WebAccount> account{};  ///< of that name
    bool fits = false;
  };
  [[nodiscard]] static Found look_up(const WebGateOptions& options, const std::string& name,
                                     const std::string& password, std::size_t decoy);
  void finish_log_in(const Found& found, WebUser user, const Client& client, const WebPlace& place,
                     WebMoment now, const Answer& answer);
  void update_users(const Found& found);
  void note(const WebUser& user, const std::string& what, int code) const;

  boost::asio::io_context& context_;
  WebGateOptions options_;
  Use use_;
  WebRate rate_;
  WebAttempts attempts_;
  WebSessions sessions_;
  std::string trouble_;  // with the users, reported already
  std::size_t salt_;     // what unknown users are compared with
  WebMoment looked_{};
  WebMoment refused_{};  // the last of too many attempts: of a flood the first is noted
  bool is_looking_ = false;
  std::unique_ptr<serve::Worker> worker_;  // with users
};

/// "canopus_8080": browsers send the cookies of a host to each of its ports.
[[nodiscard]] std::string cookie_name(const WebPlace& place);

}  // namespace canopus::web
