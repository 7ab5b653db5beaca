// Log-ins and sessions of the page's users, without a socket: the test turns the event loop; passwords are compared in the gate's
// own thread.

#include "canopus/web/access/authenticator.hpp"

#include <atomic>
#include <future>
#include <mutex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/web/access/password.hpp"

namespace canopus::web::authenticator_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;
using namespace std::chrono_literals;

const WebMoment start{1h};
std::shared_ptr<const PageFiles> page_files() {
  PageFiles files;
  files.add("login.html", "<p id=\"said\" role=\"alert\"></p>\n");
  return std::make_shared<const PageFiles>(std::move(files));
}
const WebPlace place{.address = "10.0.0.9", .port = 8080, .has_users = true, .files = page_files()};

class WebGateTest : public ::testing::Test {
 protected:
  WebGateTest() {
    accounts_ = std::vector<WebAccount>{{.name = "anna", .role = WebRole::operate, .hash = hash()},
                                        {.name = "bob", .role = WebRole::look, .hash = hash()}};
  }
  static const std::string& hash() {
    static const std::string one = *hash_of("correct horse");
    return one;
  }
  void open(WebGateOptions options = {}) {
    options.read_users = [this] {
      ++reads_;
      const std::scoped_lock lock(mutex_);
      return accounts_;
    };
    gate_ = std::make_shared<Authenticator>(
        context_, options,
        Authenticator::Use{.note =
                               [this](const WebUser& user, const std::string& what, int code) {
                                 notes_.push_back(user.name + '/' + std::string(name_of(user.role)) + '@' +
                                                  user.address + ' ' + what + ' ' + std::to_string(code));
                               },
                           .report = [this](const std::string& said) { reports_.push_back(said); }});
  }
  WebAnswer log_in(const std::string& form, WebMoment now = start, const char* from = "10.0.0.1") {
    std::optional<WebAnswer> result;
    gate_->log_in(form, {.address = *link::parse_internet_address(from), .name = std::string(from) + ":5"},
                  at_, now, [&](const WebAnswer& answer) { result = answer; });
    turn([&] { return result.has_value(); });
    return result.value_or(WebAnswer{.status = 0});
  }
  /// The thread posts into the loop: as long as that takes.
  template <typename Done>
  void turn(Done done) {
    const auto work = boost::asio::make_work_guard(context_);
    context_.restart();  // it stops when it has nothing to do
    while (!done()) context_.run_one_for(10s);
  }
  std::shared_ptr<WebSession> session_of(const std::string& cookie, WebMoment now = start) {
    WebRequest request;
    request.set(boost::beast::http::field::cookie, cookie);
    return gate_->session_of(request, at_, now);
  }
  static std::string cookie_in(const WebAnswer& answer) {
    const std::size_t begin = answer.fields.find("Set-Cookie: ") + 12;
    return answer.fields.substr(begin, answer.fields.find(';', begin) - begin);
  }

  boost::asio::io_context context_;
  std::mutex mutex_;
  std::expected<std::vector<WebAccount>, std::string> accounts_;
  std::atomic<int> reads_ = 0;
  WebPlace at_ = place;
  std::vector<std::string> notes_;
  std::vector<std::string> reports_;
  std::shared_ptr<Authenticator> gate_;
};

const std::string right_form = "name=anna&password=correct+horse";

TEST_F(WebGateTest, ARightPassword_BeginsASession_WithACookieThatScriptsAndOtherSitesDoNotGet) {
  open();
  const WebAnswer answer = log_in(right_form);
  EXPECT_EQ(answer.status, 303U);
  EXPECT_THAT(answer.fields, StartsWith("Location: /\r\nSet-Cookie: canopus_8080="));
  EXPECT_THAT(answer.fields, HasSubstr("; Path=/; HttpOnly; SameSite=Strict\r\n"));
  EXPECT_THAT(answer.fields, Not(HasSubstr("Secure")));
  const auto session = session_of(cookie_in(answer));
  ASSERT_NE(session, nullptr);
  EXPECT_EQ(session->user.name, "anna");
  EXPECT_EQ(session->user.role, WebRole::operate);
  EXPECT_THAT(notes_, ElementsAre("anna/operate@10.0.0.1:5 log in 0"));
  EXPECT_EQ(session_of(cookie_in(answer) + "0"), nullptr);
  EXPECT_EQ(session_of("canopus_8081=" + session->secret), nullptr);
}

TEST_F(WebGateTest, BehindTls_TheCookieIsForTlsAlone) {
  open();
  at_.origin = "https://plant.example";
  EXPECT_THAT(log_in(right_form).fields, HasSubstr("Set-Cookie: __Host-canopus_8080="));
  EXPECT_THAT(log_in(right_form).fields, HasSubstr("; Path=/; HttpOnly; SameSite=Strict; Secure\r\n"));
}

TEST_F(WebGateTest, AWrongNameAndAWrongPassword_GetTheSameAnswer) {
  open();
  const WebAnswer wrong_password = log_in("name=anna&password=correct+horsf");
  const WebAnswer wrong_name = log_in("name=nobody&password=correct+horse");
  EXPECT_EQ(wrong_password.status, 401U);
  EXPECT_EQ(written(wrong_password), written(wrong_name));
  EXPECT_THAT(wrong_password.body,
              HasSubstr("<p id=\"said\" role=\"alert\">The name or the password is wrong.</p>"));
  EXPECT_THAT(notes_, ElementsAre("anna/look@10.0.0.1:5 log in 1", "?/look@10.0.0.1:5 log in 1"))
      << "what was typed as a name may be a password";
}

TEST_F(WebGateTest, AnUnknownName_TakesAsLong_AsAKnownOne) {
  open({.attempts = {.at_once = 1000}});
  using Clock = std::chrono::steady_clock;
  const auto time_of = [&](const std::string& name) {
    const auto begin = Clock::now();
    (void)log_in("name=" + name + "&password=wrong+one");
    return Clock::now() - begin;
  };
  Clock::duration known = 1h, unknown = 1h;  // the shortest of some: what else runs here makes others longer
  for (int i = 0; i < 5; ++i) {
    known = std::min(known, time_of("anna"));
    unknown = std::min(unknown, time_of("nobody" + std::to_string(i)));
  }
  EXPECT_GT(unknown, known / 3);
}

TEST_F(WebGateTest, WhatIsNoForm_IsNotCompared) {
  open();
  for (const std::string form : {"", "name=anna", "password=x", "name=&password=x", "name=anna&password=",
                                 "name=%&password=x", "name=anna&name=bob&password=x"}) {
    EXPECT_EQ(log_in(form).status, 400U) << form;
  }
  EXPECT_EQ(log_in("name=anna&password=" + std::string(257, 'x')).status, 400U);
  EXPECT_EQ(log_in("name=" + std::string(65, 'x') + "&password=x").status, 400U);
  EXPECT_EQ(reads_, 0);
}

TEST_F(WebGateTest, AttemptsAreLimited_AlsoTheRightOne) {
  open({.attempts = {.at_once = 2, .first_wait = 5s}});
  EXPECT_EQ(log_in("name=anna&password=wrong+one").status, 401U);
  EXPECT_EQ(log_in("name=anna&password=wrong+one").status, 401U);
  const WebAnswer answer = log_in(right_form);
  EXPECT_EQ(answer.status, 429U);
  EXPECT_EQ(answer.fields, "Retry-After: 5\r\n");
  EXPECT_THAT(answer.body, HasSubstr("Too many attempts. Wait 5 s."));
  EXPECT_EQ(log_in(right_form).status, 429U);
  EXPECT_THAT(notes_, ElementsAre("anna/look@10.0.0.1:5 log in 1", "anna/look@10.0.0.1:5 log in 1",
                                  "?/look@10.0.0.1:5 log in 9"))
      << "of a flood the first";
  EXPECT_EQ(log_in(right_form, start + 5s).status, 303U);
  EXPECT_EQ(log_in("name=anna&password=wrong+one", start + 5s).status, 401U) << "a fresh beginning";
}

TEST_F(WebGateTest, SoManyMayWaitForTheThread) {
  open({.attempts = {.at_once = 1000}, .most_log_ins = 2});
  std::vector<unsigned> answers;
  for (int i = 0; i < 20; ++i) {
    gate_->log_in(right_form, {}, place, start,
                  [&](const WebAnswer& answer) { answers.push_back(answer.status); });
  }
  EXPECT_THAT(answers, ::testing::Each(503U)) << "answered at once";
  EXPECT_GE(answers.size(), 16U);
  turn([&] { return answers.size() == 20; });
  EXPECT_GE(std::ranges::count(answers, 303U), 2);
}

TEST_F(WebGateTest, TheLoopGoesOn_WhileAPasswordIsCompared) {
  open();
  std::promise<void> go_on;
  auto waits = go_on.get_future().share();
  gate_ = std::make_shared<Authenticator>(context_,
                                          WebGateOptions{.read_users =
                                                             [this, waits] {
                                                               waits.wait();
                                                               return accounts_;
                                                             }},
                                          Authenticator::Use{});
  unsigned status = 0;
  gate_->log_in(right_form, {}, place, start, [&](const WebAnswer& answer) { status = answer.status; });
  context_.poll();
  EXPECT_EQ(status, 0U) << "log_in() has come back, and the thread has not";
  go_on.set_value();
  turn([&] { return status != 0; });
  EXPECT_EQ(status, 303U);
}

TEST_F(WebGateTest, ItMayEnd_WhileAPasswordIsCompared) {
  open();
  gate_->log_in(right_form, {}, place, start, [](const WebAnswer&) { FAIL(); });
  gate_.reset();
  context_.poll();
}

TEST_F(WebGateTest, TheSessionSaysItsKey_ToItsOwnCookieAlone) {
  open();
  const auto session = session_of(cookie_in(log_in(right_form)));
  const WebAnswer answer = Authenticator::described(session.get());
  EXPECT_EQ(answer.content_type, "application/json");
  EXPECT_EQ(answer.body, "{\"user\":\"anna\",\"role\":\"operate\",\"key\":\"" + session->key + "\"}");
  EXPECT_EQ(Authenticator::described(nullptr).status, 401U);
}

TEST_F(WebGateTest, TwoCookieFields_AreNoSession) {
  open();
  const std::string cookie = cookie_in(log_in(right_form));
  WebRequest request;
  request.insert(boost::beast::http::field::cookie, cookie);
  EXPECT_NE(gate_->session_of(request, at_, start), nullptr);
  request.insert(boost::beast::http::field::cookie, "other=1");
  EXPECT_EQ(gate_->session_of(request, at_, start), nullptr) << "which one a proxy has seen is not known";
}

TEST_F(WebGateTest, LoggingOutNeedsTheKey) {
  open();
  const std::string cookie = cookie_in(log_in(right_form));
  const auto session = session_of(cookie);
  for (const std::string& form : {std::string(), std::string("key="), "key=" + session->secret,
                                  "k=" + session->key, std::string("%")}) {
    EXPECT_EQ(gate_->log_out(form, session.get(), {}, place).status, 403U) << form;
  }
  EXPECT_EQ(gate_->log_out("key=" + session->key, nullptr, {}, place).status, 401U);
  EXPECT_NE(session_of(cookie), nullptr);
  const WebAnswer answer =
      gate_->log_out("key=" + session->key, session.get(), {.address = {}, .name = "10.0.0.2:7"}, place);
  EXPECT_EQ(answer.status, 303U);
  EXPECT_EQ(
      answer.fields,
      "Location: /login\r\nSet-Cookie: canopus_8080=; Path=/; HttpOnly; SameSite=Strict; Max-Age=0\r\n");
  EXPECT_EQ(session_of(cookie), nullptr);
  EXPECT_TRUE(session->is_over);
  EXPECT_EQ(notes_.back(), "anna/operate@10.0.0.2:7 log out 0");
}

TEST_F(WebGateTest, WhoIsNotInTheFileAnyMore_IsOut) {
  open({.users_again = 10s});
  const auto session = session_of(cookie_in(log_in(right_form)));
  const auto other = session_of(cookie_in(log_in("name=bob&password=correct+horse")));
  {
    const std::scoped_lock lock(mutex_);
    accounts_->erase(accounts_->begin());
  }
  const int reads = reads_;
  gate_->refresh(start + 10s);
  gate_->refresh(start + 15s);
  turn([&] { return session->is_over; });
  EXPECT_EQ(reads_, reads + 1) << "once in 10 s";
  EXPECT_FALSE(other->is_over);
  EXPECT_EQ(log_in(right_form, start + 30s).status, 401U);
}

TEST_F(WebGateTest, AFileThatHasBecomeWrong_ChangesNothing_AndIsSaidOnce) {
  open({.users_again = 10s});
  const auto session = session_of(cookie_in(log_in(right_form)));
  {
    const std::scoped_lock lock(mutex_);
    accounts_ = std::unexpected(std::string("users:3: expected NAME ROLE HASH"));
  }
  gate_->refresh(start + 10s);
  turn([&] { return !reports_.empty(); });
  const int reads = reads_;
  gate_->refresh(start + 20s);
  turn([&] { return reads_ != reads; });
  context_.run_for(20ms);
  EXPECT_THAT(reports_, ElementsAre("users:3: expected NAME ROLE HASH; the users stay as they are"));
  EXPECT_FALSE(session->is_over);
  EXPECT_EQ(log_in(right_form, start + 30s).status, 401U) << "nobody new";
}

TEST_F(WebGateTest, TooManyRequests_GetA429) {
  open({.rate = {.of_address_at_once = 2, .of_address = 1}});
  const auto from = *link::parse_internet_address("10.0.0.1");
  EXPECT_FALSE(gate_->refusal(from, start));
  EXPECT_FALSE(gate_->refusal(from, start));
  const auto answer = gate_->refusal(from, start);
  ASSERT_TRUE(answer);
  EXPECT_THAT(written(*answer), StartsWith("HTTP/1.1 429 Too Many Requests\r\n"));
  EXPECT_THAT(written(*answer), HasSubstr("\r\nRetry-After: 1\r\n"));
  EXPECT_FALSE(gate_->refusal(*link::parse_internet_address("10.0.0.2"), start));
}

TEST_F(WebGateTest, WithoutUsers_NobodyHasASession) {
  gate_ = std::make_shared<Authenticator>(context_, WebGateOptions{}, Authenticator::Use{});
  EXPECT_FALSE(gate_->has_users());
  EXPECT_EQ(session_of("canopus_8080=0123456789abcdef0123456789abcdef"), nullptr);
  gate_->refresh(start);
  EXPECT_THAT(notes_, IsEmpty());
}

}  // namespace
}  // namespace canopus::web::authenticator_test
