// The web server on real sockets of the loopback interface, one thread: the test turns the event loop itself. The bytes of
// HTTP and WebSocket (RFC 6455) are written out.

#include "canopus/web/server/server.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/web/access/password.hpp"
#include "canopus/web/server/client_message.hpp"

namespace canopus::web::server_test {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;
using namespace std::chrono_literals;

class WebClock final : public link::LoopClock {
 public:
  can::Time now() override {
    if (stop_when_asked != nullptr) stop_when_asked->stop();
    if (when_asked) when_asked();
    return can::Time{10s};
  }
  void touched() override {}
  WebServer* stop_when_asked = nullptr;
  std::function<void()> when_asked;
};

class WebServerTest : public ::testing::Test {
 protected:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds patience{60};

  WebServer& start(WebServerOptions options = {}) {
    PageFiles files;
    files.add("index.html", "<!doctype html>\n<html><head></head></html>\n");
    files.add("login.html", "<form><p id=\"said\" role=\"alert\"></p></form>\n");
    files.add("page.css", ":root { color-scheme: light dark; }" + std::string(10000, ' '));
    options.files = std::make_shared<const PageFiles>(std::move(files));
    server_ = std::make_unique<WebServer>(
        context_, clock_,
        WebServer::Use{
            .state =
                [this] {
                  if (when_a_state_is_made_) when_a_state_is_made_();
                  return "{\"state\":" + std::to_string(++states_) + filler_ + "}";
                },
            .lost = [](std::uint64_t events) { return "{\"lost\":" + std::to_string(events) + "}"; },
            .messages =
                [this](bool wanted) {
                  wanted_.push_back(wanted);
                  return wanted ? std::string("{\"m\":1}") : std::string();
                },
            .view =
                [this](std::string_view view) {
                  views_.emplace_back(view);
                  const bool is_one = !view.empty() && view != "{\"none\":0}";
                  return is_one ? "{\"v\":" + std::string(view) + "}" : std::string();
                },
            .command =
                [this](const WebUser& user, std::string_view command, std::uint32_t id, WebReply reply) {
                  commands_.push_back(std::to_string(id) + " " + std::string(name_of(user.role)) + " " +
                                      std::string(command));
                  who_.push_back(user.name + ' ' + std::string(name_of(user.role)));
                  reply("{\"first\":" + std::to_string(id) + "}");
                  reply_ = std::move(reply);
                },
            .note = [this](
                        const WebUser& user, const std::string& what,
                        int code) { notes_.push_back(user.name + ' ' + what + ' ' + std::to_string(code)); }},
        options, [this](std::string_view sentence) { reports_.emplace_back(sentence); });
    EXPECT_TRUE(server_->listen("127.0.0.1", 0));
    return *server_;
  }
  tcp::socket connect() {
    tcp::socket socket(client_context_);
    socket.connect({boost::asio::ip::address_v4::loopback(), server_->port()});
    socket.non_blocking(true);
    context_.poll();
    return socket;
  }
  static void send(tcp::socket& socket, const std::string& data) {
    boost::asio::write(socket, boost::asio::buffer(data));
  }
  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(server_->port()); }
  /// What came until `wanted` was in it; "... closed" at the end of the stream, "... nothing" when it does not come: the server may have
  /// a thread of its own to wait for, and a busy machine.
  std::string receive(tcp::socket& socket, const std::string& wanted = "\x01never") {
    std::string all;
    std::vector<char> memory(100000);
    const auto end = Clock::now() + patience;
    while (all.find(wanted) == std::string::npos && Clock::now() < end) {
      context_.run_one_for(10ms);
      context_.poll();
      error_code error;
      const std::size_t count = socket.read_some(boost::asio::buffer(memory), error);
      if (error == boost::asio::error::would_block) continue;
      if (error) return all + "closed";
      all.append(memory.data(), count);
    }
    return all.find(wanted) != std::string::npos ? all : all + "nothing";
  }
  template <typename Condition>
  [[nodiscard]] bool becomes(const Condition& condition) {
    for (const auto end = Clock::now() + patience; !condition() && Clock::now() < end;)
      context_.run_one_for(10ms);
    return condition();
  }
  tcp::socket watch(const std::string& query = {}) {
    auto client = connect();
    send(client, "GET /events" + query + " HTTP/1.1\r\nHost: " + host() + "\r\nOrigin: http://" + host() +
                     "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    return client;
  }
  /// A text message of a client, masked with zeros.
  static std::string message(const std::string& text) {
    return std::string("\x81") + static_cast<char>(0x80 | text.size()) + std::string(4, '\0') + text;
  }

  boost::asio::io_context context_;
  boost::asio::io_context client_context_;
  WebClock clock_;
  int states_ = 0;
  std::function<void()> when_a_state_is_made_;
  std::vector<bool> wanted_;
  std::vector<std::string> commands_;
  WebReply reply_;
  std::vector<std::string> views_;
  std::string filler_;
  std::vector<std::string> who_;
  std::vector<std::string> notes_;
  std::vector<std::string> reports_;
  std::unique_ptr<WebServer> server_;
};

TEST_F(WebServerTest, AnAnswerEndsTheConnection) {
  start();
  auto client = connect();
  send(client, "GET / HTTP/1.1\r\nHost: " + host() + "\r\n\r\n");
  const std::string answer = receive(client);
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, EndsWith("</html>\nclosed"));
  client.close();
  EXPECT_TRUE(becomes([&] { return server_->clients() == 0; }));
  EXPECT_THAT(reports_, IsEmpty());
}

TEST_F(WebServerTest, AHeadInPieces) {
  start();
  auto client = connect();
  const std::string head = "GET /page.css HTTP/1.1\r\nHost: " + host() + "\r\n\r\n";
  for (const char byte : head) {
    send(client, std::string(1, byte));
    context_.run_one_for(10ms);
  }
  EXPECT_THAT(receive(client, "color-scheme"), StartsWith("HTTP/1.1 200 OK\r\n"));
}

TEST_F(WebServerTest, AWatcherGetsTheEventsUpToNow_AndTheState) {
  start();
  server_->event("{\"early\":1}");
  auto client = watch();
  const std::string all = receive(client, "}]");
  EXPECT_THAT(all, StartsWith("HTTP/1.1 101 "));
  EXPECT_THAT(all, HasSubstr("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n")) << "RFC 6455 1.3";
  EXPECT_THAT(all, EndsWith("\r\n\r\n\x81\x1A[{\"early\":1},\n{\"state\":1}]"));
}

TEST_F(WebServerTest, EventsAndStatesGoOn_AsLongAsSomebodyWatches) {
  start({.state_interval = 1ms});
  auto client = watch();
  receive(client, "}]");
  server_->event("{\"late\":1}");
  EXPECT_THAT(receive(client, "late"), HasSubstr("[{\"late\":1},\n{\"state\":"));
  client.close();
  EXPECT_TRUE(becomes([&] { return server_->clients() == 0; }));
  const int made = states_;
  context_.run_for(50ms);
  EXPECT_EQ(states_, made);
}

TEST_F(WebServerTest, AWatcherThatReadsNothing_DelaysNobody_AndIsClosed) {
  filler_ = ",\"x\":\"" + std::string(1000000, 'x') + "\"";
  // A state takes longer than 1 ms to make under sanitizers: made every 1 ms, nothing else would get its turn.
  // The 5 s are of the machine's clock: `quick` is closed, too, where it gets no processor for so long.
  start({.send_timeout = 5s, .state_interval = 20ms, .most_events = 10});
  auto slow = watch();
  auto quick = watch();
  for (int i = 0; i < 20; ++i) EXPECT_THAT(receive(quick, "}]"), Not(HasSubstr("closed")));
  for (int i = 0; i < 10'000 && server_->clients() == 2; ++i) {
    server_->event("{}");
    receive(quick, "}]");
  }
  EXPECT_EQ(server_->clients(), 1U);
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("does not take what it is sent: its connection is closed")));
}

TEST_F(WebServerTest, ANewcomer_GetsTheState_AndTheOthersWaitForTheirNextOne) {
  start({.state_interval = 1h});
  auto first = watch();
  EXPECT_THAT(receive(first, "}]"), EndsWith("[{\"state\":1}]"));
  send(first, message("{\"do\":{},\"id\":6}"));
  EXPECT_THAT(receive(first, "}]"), EndsWith("[{\"first\":6}]"));
  auto second = watch();
  EXPECT_THAT(receive(second, "}]"), EndsWith("[{\"state\":2}]")) << "a command may have changed it";
  send(first, message("{\"do\":{},\"id\":7}"));
  EXPECT_THAT(receive(first, "}]"), EndsWith("[{\"first\":7}]")) << "no second state";
}

TEST_F(WebServerTest, WhatHappensUpToTheMomentOfANewcomer_IsOneOfTheLatestEvents_AndNoneIsLost) {
  start({.state_interval = 1h, .most_events = 2});
  server_->event("{\"a\":1}");
  server_->event("{\"b\":2}");
  clock_.when_asked = [&] {
    clock_.when_asked = nullptr;
    server_->event("{\"c\":3}");
  };
  auto client = watch();
  EXPECT_THAT(receive(client, "}]"), EndsWith("[{\"b\":2},\n{\"c\":3},\n{\"state\":1}]"));
}

TEST_F(WebServerTest, PagesThatAreOpenedAtOnce_GetAStateThatWasMadeOnce) {
  start({.state_interval = 1h, .state_is_new_for = 1h});
  std::vector<tcp::socket> clients;
  for (int i = 0; i < 20; ++i) clients.push_back(watch());
  for (auto& client : clients) EXPECT_THAT(receive(client, "}]"), HasSubstr("{\"state\":1}]"));
  server_->event("{\"late\":1}");
  auto newcomer = watch();
  EXPECT_THAT(receive(newcomer, "}]"), EndsWith("[{\"late\":1},\n{\"state\":2}]"));
}

TEST_F(WebServerTest, OfManyWatchers_OneIsSentItsMessageInATurnOfTheLoop_SoThatThePlantHasItsOwn) {
  start({.state_interval = 20ms});
  std::vector<tcp::socket> clients;
  for (int i = 0; i < 5; ++i) clients.push_back(watch());
  for (auto& client : clients) receive(client, "}]");
  std::size_t served = clients.size();
  when_a_state_is_made_ = [&] {
    for (auto& client : clients) {
      std::vector<char> memory(client.available());
      (void)client.read_some(boost::asio::buffer(memory));
    }
    // What the plant has to do then comes behind one client, not behind all.
    boost::asio::post(context_, [&] {
      served = static_cast<std::size_t>(
          std::ranges::count_if(clients, [](const tcp::socket& one) { return one.available() > 0; }));
      when_a_state_is_made_ = nullptr;
    });
  };
  while (when_a_state_is_made_) context_.run_one_for(1s);
  EXPECT_LE(served, 1U);
  for (auto& client : clients)
    EXPECT_THAT(receive(client, "}]"), HasSubstr("{\"state\":")) << "each gets its own";
}

TEST_F(WebServerTest, WhatAWatcherSendsChangesNothing) {
  start();
  auto client = watch();
  receive(client, "}]");
  send(client, message("{\"request\":\"set\"}") + message("\x1B[2J"));
  context_.run_for(50ms);
  EXPECT_EQ(server_->clients(), 1U);
}

TEST_F(WebServerTest, MessagesAreMadeForWhoWantsThem) {
  start({.state_interval = 1ms});
  auto client = watch();
  auto other = watch();
  receive(client, "}]");
  EXPECT_THAT(wanted_, Each(false));
  send(client, message("{\"messages\": true}"));
  EXPECT_THAT(receive(client, "{\"m\":1}"), HasSubstr("{\"m\":1}"));
  EXPECT_TRUE(wanted_.back());
  EXPECT_THAT(receive(other, "\"state\":9"), Not(HasSubstr("\"m\"")));
  client.close();
  other.close();
  EXPECT_TRUE(becomes([&] { return !wanted_.back(); })) << "nobody watches";
}

TEST_F(WebServerTest, Views_AreMadeOnceForAllThatLookAtTheSame) {
  start();
  auto client = watch();
  receive(client, "}]");
  auto other = watch();
  receive(other, "}]");
  EXPECT_THAT(views_, IsEmpty()) << "nobody looks";
  send(client, message("{\"views\":[{\"a\":1},{\"b\":2}]}"));
  send(other, message("{\"views\":[{\"a\":1},{\"none\":0}]}"));
  receive(other, "{\"v\":{\"a\":1}}");
  receive(client, "{\"v\":{\"b\":2}}");
  views_.clear();
  EXPECT_THAT(receive(client, "}]"), HasSubstr("{\"v\":{\"a\":1}},\n{\"v\":{\"b\":2}}"));
  receive(other, "}]");
  EXPECT_EQ(std::ranges::count(views_, "{\"a\":1}"), std::ranges::count(views_, "{\"b\":2}"));
  send(client, message("{\"views\":[]}"));
  send(other, message("{\"views\":[]}"));
  receive(client, "}]");
  EXPECT_THAT(receive(client, "}]"), Not(HasSubstr("\"v\"")));
  receive(other, "}]");
  EXPECT_EQ(views_.back(), "") << "said once that nobody looks any more";
}

TEST_F(WebServerTest, Views_OfManyClientsComeInTurn) {
  start({.state_interval = 5ms, .most_views = 2});
  std::vector<tcp::socket> clients;
  for (const char* view : {"a", "b", "c", "d", "e"}) {
    clients.push_back(watch());
    receive(clients.back(), "}]");
    send(clients.back(), message("{\"views\":[{\"" + std::string(view) + "\":1}]}"));
  }
  int before = states_;
  ASSERT_TRUE(becomes([&] { return states_ >= before + 10; }));
  views_.clear();
  before = states_;
  ASSERT_TRUE(becomes([&] { return states_ >= before + 10; }));
  EXPECT_LE(views_.size(), 2U * static_cast<unsigned>(states_ - before));
  for (const char* view : {"a", "b", "c", "d", "e"}) {
    EXPECT_THAT(views_, ::testing::Contains("{\"" + std::string(view) + "\":1}")) << "everybody has a turn";
  }
}

TEST_F(WebServerTest, Views_EndWithTheirClient) {
  start();
  auto client = watch();
  receive(client, "}]");
  send(client, message("{\"views\":[{\"a\":1}]}"));
  receive(client, "{\"v\":{\"a\":1}}");
  client.close();
  EXPECT_TRUE(becomes([&] { return views_.back().empty(); }));
}

/// A server with users, on loopback; the passwords' hashes are of the usual cost.
class WebServerWithUsers : public WebServerTest {
 protected:
  void start_with_users(WebServerOptions options = {}) {
    options.gate.read_users = [] {
      static const std::string hash = *hash_of("correct horse");
      return std::vector<WebAccount>{{.name = "anna", .role = WebRole::operate, .hash = hash},
                                     {.name = "bert", .role = WebRole::look, .hash = hash}};
    };
    start(options);
  }
  std::string ask(const std::string& head, const std::string& body = {}) {
    auto client = connect();
    const std::string origin = "Host: " + host() + "\r\nOrigin: http://" + host() + "\r\n";
    send(client, head + " HTTP/1.1\r\n" + origin + cookie_ + length_of(body) + "\r\n" + body);
    return receive(client);
  }
  static std::string length_of(const std::string& body) {
    if (body.empty()) return {};
    return "Content-Type: application/x-www-form-urlencoded\r\nContent-Length: " +
           std::to_string(body.size()) + "\r\n";
  }
  std::string log_in(const std::string& password, const std::string& name = "anna") {
    const std::string answer = ask("POST /login", "name=" + name + "&password=" + password);
    const std::size_t begin = answer.find("Set-Cookie: ");
    if (begin != std::string::npos)
      cookie_ = "Cookie: " + answer.substr(begin + 12, answer.find(';', begin) - begin - 12) + "\r\n";
    return answer;
  }
  std::string key() {
    const std::string answer = ask("GET /session");
    return answer.substr(answer.find("\"key\":\"") + 7, 32);
  }
  tcp::socket watch_with(const std::string& target) {
    auto client = connect();
    send(client, "GET " + target + " HTTP/1.1\r\nHost: " + host() + "\r\nOrigin: http://" + host() + "\r\n" +
                     cookie_ +
                     "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    return client;
  }
  std::string cookie_;
};

TEST_F(WebServerWithUsers, NobodySeesThePlant_BeforeHeHasLoggedIn) {
  start_with_users();
  EXPECT_THAT(ask("GET /"), AllOf(StartsWith("HTTP/1.1 303 "), HasSubstr("\r\nLocation: /login\r\n")));
  EXPECT_THAT(ask("GET /session"), StartsWith("HTTP/1.1 401 "));
  auto client = watch_with("/events");
  EXPECT_THAT(receive(client), StartsWith("HTTP/1.1 401 "));
  EXPECT_EQ(states_, 0);
  EXPECT_THAT(log_in("wrong"), StartsWith("HTTP/1.1 401 "));
  EXPECT_THAT(cookie_, IsEmpty());
  EXPECT_THAT(log_in("correct+horse"), AllOf(StartsWith("HTTP/1.1 303 "), HasSubstr("\r\nLocation: /\r\n")));
  EXPECT_THAT(ask("GET /"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(notes_, ElementsAre("anna log in 1", "anna log in 0"));
}

TEST_F(WebServerWithUsers, ACommandIsThatOfTheUser_ForWhoHasTheKeyOfTheSession) {
  start_with_users({.role = WebRole::configure});
  log_in("correct+horse");
  for (const auto& [target, role] : {std::pair<std::string, std::string>{"/events?key=" + key(), "operate"},
                                     {"/events", "look"},
                                     {"/events?key=", "look"},
                                     {"/events?key=" + std::string(32, '0'), "look"}}) {
    auto client = watch_with(target);
    receive(client, "}]");
    who_.clear();
    send(client, message("{\"do\":{},\"id\":1}"));
    EXPECT_TRUE(becomes([&] { return !who_.empty(); }));
    EXPECT_THAT(who_, ElementsAre("anna " + role)) << target;
  }
}

TEST_F(WebServerWithUsers, AUserWithManyPages_LeavesPlacesToOthers) {
  start_with_users({.maximum_clients = 3, .most_watchers_of_user = 2});
  log_in("correct+horse");
  std::vector<tcp::socket> pages;
  for (int i = 0; i < 2; ++i) {
    pages.push_back(watch_with("/events?key=" + key()));
    EXPECT_THAT(receive(pages.back(), "}]"), StartsWith("HTTP/1.1 101 "));
  }
  auto third = watch_with("/events?key=" + key());
  EXPECT_THAT(receive(third, "pages"),
              AllOf(StartsWith("HTTP/1.1 503 "), HasSubstr("this user watches too many pages")));
  third.close();
  cookie_.clear();
  log_in("correct+horse", "bert");
  auto other = watch_with("/events");
  EXPECT_THAT(receive(other, "}]"), StartsWith("HTTP/1.1 101 "));
  for (tcp::socket& page : pages) EXPECT_THAT(receive(page, "}]"), Not(HasSubstr("closed")));
}

TEST_F(WebServerWithUsers, AWebSocketEndsWithItsSession) {
  start_with_users();
  log_in("correct+horse");
  const std::string secret = key();
  auto client = watch_with("/events?key=" + secret);
  receive(client, "}]");
  EXPECT_THAT(ask("POST /logout", "key=x"), StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(receive(client, "}]"), Not(HasSubstr("closed")));
  EXPECT_THAT(ask("POST /logout", "key=" + secret), StartsWith("HTTP/1.1 303 "));
  EXPECT_THAT(receive(client), EndsWith("closed"));
  EXPECT_THAT(ask("GET /session"), StartsWith("HTTP/1.1 401 "));
}

TEST_F(WebServerWithUsers, WhatIsSaidOnAWebSocketKeepsItsSession) {
  start_with_users({.gate = {.sessions = {.longest_idle = 1s}}});
  // On a machine that stands still for longer than the session may be idle, again.
  Clock::duration longest = 1h;
  while (longest > 800ms) {
    cookie_.clear();
    log_in("correct+horse");
    auto client = watch_with("/events");
    receive(client, "}]");
    longest = {};
    for (int i = 0; i < 7; ++i) {
      const auto begin = Clock::now();
      context_.run_for(200ms);
      send(client, message("{\"messages\":false}"));
      context_.poll();
      longest = std::max(longest, Clock::now() - begin);
    }
    const std::size_t clients = server_->clients();
    if (longest <= 800ms) {
      EXPECT_EQ(clients, 1U);
    }
    EXPECT_TRUE(becomes([&] { return server_->clients() == 0; })) << "looking alone does not";
  }
}

TEST_F(WebServerWithUsers, AFormInPieces_AndOneThatGoesOn) {
  start_with_users();
  const std::string body = "name=anna&password=correct+horse";
  const std::string head = "POST /login HTTP/1.1\r\nHost: " + host() + "\r\nOrigin: http://" + host() +
                           "\r\n" + length_of(body) + "\r\n";
  auto client = connect();
  for (const char byte : head + body) {
    send(client, std::string(1, byte));
    context_.run_one_for(10ms);
  }
  EXPECT_THAT(receive(client), StartsWith("HTTP/1.1 303 "));
  auto other = connect();
  send(other, head + body + "GET / HTTP/1.1\r\n\r\n");
  EXPECT_THAT(receive(other), StartsWith("HTTP/1.1 400 "));
}

TEST_F(WebServerWithUsers, AHalfForm_IsWaitedForOnlyForAWhile) {
  start_with_users({.head_timeout = 50ms});
  auto client = connect();
  send(client, "POST /login HTTP/1.1\r\nHost: " + host() + "\r\nOrigin: http://" + host() + "\r\n" +
                   length_of("12345") + "\r\nname");
  EXPECT_EQ(receive(client), "closed");
}

TEST_F(WebServerWithUsers, TheAddressHasNoKey) {
  start_with_users({.key = "0123"});
  EXPECT_EQ(server_->url(), "http://" + host() + "/");
}

TEST_F(WebServerWithUsers, AtAnyAddress) {
  start_with_users();
  server_->stop();
  EXPECT_TRUE(server_->listen("0.0.0.0", 0));
}

TEST_F(WebServerTest, TooManyRequestsOfOneAddress_AreRefused) {
  start({.gate = {.rate = {.of_address_at_once = 3, .of_address = 0.001}}});
  for (int i = 0; i < 5; ++i) {
    auto client = connect();
    send(client, "GET /page.css HTTP/1.1\r\nHost: " + host() + "\r\n\r\n");
    EXPECT_THAT(receive(client), StartsWith(i < 3 ? "HTTP/1.1 200 " : "HTTP/1.1 429 "));
  }
}

TEST(ClientMessage, OnlyWhatAWatcherMaySay) {
  EXPECT_EQ(parse_client_message("{\"messages\": true}")->messages, true);
  EXPECT_EQ(parse_client_message("{\"messages\":false}")->messages, false);
  EXPECT_THAT(*parse_client_message("{\"views\": []}")->views, IsEmpty());
  EXPECT_THAT(*parse_client_message("{\"views\": [{\"words\": 0, \"from\": 7}, {}]}")->views,
              ElementsAre("{\"from\":7,\"words\":0}", "{}"));
  for (const std::string& text : std::vector<std::string>{
           "",
           "true",
           "[]",
           "{}",
           "{\"messages\":1}",
           "{\"messages\":true,\"x\":1}",
           "{\"message\":true}",
           "{\"messages\":true",
           "[[[[[[[[[[[[[[[[[[",
           "\xFF",
           "{\"request\":\"set\"}",
           "{\"views\":{}}",
           "{\"views\":[1]}",
           "{\"views\":[{},{},{},{},{},{},{},{},{}]}",
           R"({"views":[{"a":")" + std::string(ClientMessage::longest_view, 'x') + "\"}]}",
           "{\"views\":[],\"messages\":true}",
           "{\"messages\":[]}",
           "{\"views\":true}",
           "{\"do\":{}}",
           "{\"do\":[],\"id\":1}",
           "{\"do\":{},\"id\":-1}",
           "{\"do\":{},\"id\":4294967296}",
           "{\"do\":{},\"id\":1.5}",
           "{\"do\":{},\"id\":1,\"x\":1}"}) {
    EXPECT_FALSE(parse_client_message(text)) << text;
  }
  // Whoever carries it out walks through it.
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_TRUE(parse_client_message("{\"do\":{\"a\":" + nested(62) + "},\"id\":1}"));
  EXPECT_FALSE(parse_client_message("{\"do\":{\"a\":" + nested(63) + "},\"id\":1}"));
  EXPECT_FALSE(parse_client_message("{\"do\":{\"a\":" + nested(100'000) + "},\"id\":1}"));
  EXPECT_FALSE(parse_client_message("{\"views\":[{\"a\":" + nested(62) + "}]}"));
  const auto wish = parse_client_message("{\"id\": 4294967295, \"do\": {\"command\": \"hello\"}}");
  EXPECT_EQ(wish->command->text, "{\"command\":\"hello\"}");
  EXPECT_EQ(wish->command->id, 4294967295U);
}

TEST_F(WebServerTest, Command_IsHandedOnWithTheRole_AndItsRepliesGoToItsClientAlone) {
  start({.role = WebRole::configure, .key = "0123456789abcdef"});
  EXPECT_THAT(server_->url(), EndsWith("/#key=0123456789abcdef"));
  auto other = watch("?key=0123456789abcdee");
  receive(other, "}]");
  auto client = watch("?key=0123456789abcdef");
  receive(client, "}]");
  send(client, message("{\"do\":{\"command\":\"x\"},\"id\":7}"));
  EXPECT_THAT(receive(client, "first"), HasSubstr("[{\"first\":7}]"));
  reply_("{\"later\":7}");
  EXPECT_THAT(receive(client, "later"), HasSubstr("{\"later\":7}"));
  send(other, message("{\"do\":{},\"id\":8}"));
  EXPECT_THAT(receive(other, "first"), AllOf(HasSubstr("{\"first\":8}"), Not(HasSubstr(":7"))));
  EXPECT_THAT(commands_, ElementsAre("7 configure {\"command\":\"x\"}", "8 look {}"));
  other.close();
  EXPECT_TRUE(becomes([&] { return server_->clients() == 1; }));
  reply_("{}");  // nobody is there any more
  EXPECT_EQ(server_->clients(), 1U);
}

TEST_F(WebServerTest, KeyIsWhole_OrNone) {
  start({.role = WebRole::operate, .key = "01"});
  for (const char* query : {"?key=0", "?key=", "", "?key=011", "?k=01", "?key=01&key=01"}) {
    auto client = watch(query);
    receive(client, "}]");
    send(client, message("{\"do\":{},\"id\":1}"));
    receive(client, "first");
  }
  EXPECT_THAT(commands_, Each(std::string("1 look {}")));
  EXPECT_EQ(commands_.size(), 6U);
}

TEST_F(WebServerTest, WhoMayChangeSomething_MaySendMore) {
  start({.role = WebRole::operate, .key = "01", .longest_message = 100, .longest_command = 120});
  auto looker = watch();
  receive(looker, "}]");
  send(looker, message(std::string(101, ' ')));
  EXPECT_THAT(receive(looker, "\x88"), HasSubstr("\x88\x02\x03\xF1"));
  auto client = watch("?key=01");
  receive(client, "}]");
  send(client, message("{\"do\":{},\"id\":1}" + std::string(90, ' ')));
  EXPECT_THAT(receive(client, "first"), HasSubstr("first"));
  send(client, message(std::string(121, ' ')));
  EXPECT_THAT(receive(client, "\x88"), HasSubstr("\x88\x02\x03\xF1"));
}

TEST_F(WebServerTest, AMessageThatIsTooLong_OrTooManyOfThem) {
  start({.longest_message = 100, .most_messages = 5});
  auto client = watch();
  receive(client, "}]");
  send(client, message(std::string(101, 'x')));
  EXPECT_THAT(receive(client, "\x88"), HasSubstr("\x88\x02\x03\xF1")) << "close, 1009: message too big";
  client.close();
  EXPECT_TRUE(becomes([&] { return server_->clients() == 0; }));
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("sent a message that is too long")));
  auto other = watch();
  receive(other, "}]");
  for (int i = 0; i < 6; ++i) send(other, message("x"));
  EXPECT_THAT(receive(other), EndsWith("closed"));
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("too long"), HasSubstr("sends too much")));
  EXPECT_EQ(server_->clients(), 0U);
}

TEST_F(WebServerTest, AClientThatWaitsForEachReply_MaySendAsFastAsTheReplies_IfItMayChangeSomething) {
  start({.role = WebRole::operate, .key = "01", .most_messages = 5});
  auto owner = watch("?key=01");
  receive(owner, "}]");
  for (int i = 1; i <= 30; ++i) {
    send(owner, message("{\"do\":{},\"id\":" + std::to_string(i) + "}"));
    EXPECT_THAT(receive(owner, "first"), HasSubstr("{\"first\":" + std::to_string(i) + "}"));
  }
  for (int i = 0; i < 6; ++i) send(owner, message("x"));  // nothing replies to these
  EXPECT_THAT(receive(owner), EndsWith("closed"));
  // Who only looks is closed for six within a second, replied to or not; a machine that takes longer for them tries again.
  for (bool was_within_a_second = false; !was_within_a_second;) {
    const auto begin = Clock::now();
    auto other = watch();
    receive(other, "}]");
    std::string last;
    for (int i = 0; i < 6; ++i) {
      if (i > 0) {
        EXPECT_THAT(last, HasSubstr("first")) << i;
      }
      send(other, message("{\"do\":{},\"id\":1}"));
      last = receive(other, "first");
    }
    was_within_a_second = last.ends_with("closed") || Clock::now() - begin < 1s;
    if (was_within_a_second) {
      EXPECT_THAT(last, EndsWith("closed"));
    }
  }
  EXPECT_THAT(reports_, Each(HasSubstr("sends too much")));
}

TEST_F(WebServerTest, BytesThatAreNoWebSocketEndTheConnection_AlsoOfOneThatStays) {
  start({.silent_timeout = 3s, .state_interval = 10ms});
  auto client = watch();
  receive(client, "}]");
  send(client, std::string("\x83\x80\0\0\0\0", 6));  // opcode 3 is reserved
  EXPECT_THAT(receive(client), AllOf(HasSubstr("\x88\x02\x03\xEA"), EndsWith("closed")))
      << "1002: protocol error";
  EXPECT_TRUE(becomes([&] { return server_->clients() == 0; }));
}

TEST_F(WebServerTest, AConnectionThatNothingComesOn_IsClosed_AndThatIsNoError) {
  start({.head_timeout = 50ms});
  auto client = connect();
  EXPECT_EQ(receive(client), "closed");
  EXPECT_THAT(reports_, IsEmpty()) << "browsers open connections in reserve";
}

TEST_F(WebServerTest, AHalfRequest_IsWaitedForOnlyForAWhile) {
  start({.head_timeout = 50ms});
  auto client = connect();
  send(client, "GET / HT");
  EXPECT_EQ(receive(client), "closed");
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("left a request incomplete: its connection is closed")));
}

TEST_F(WebServerTest, DribbledBytesDoNotKeepAConnection) {
  start({.head_timeout = 100ms});
  auto client = connect();
  error_code error;
  for (int i = 0; i < 1000 && !error; ++i) {
    boost::asio::write(client, boost::asio::buffer("x", 1), error);
    context_.run_for(2ms);
    if (server_->clients() == 0) break;
  }
  EXPECT_EQ(server_->clients(), 0U);
}

TEST_F(WebServerTest, AHeadThatDoesNotEnd_IsRefused) {
  start();
  auto client = connect();
  send(client, "GET / HTTP/1.1\r\n" + std::string(20000, 'x'));
  EXPECT_THAT(receive(client, "too long"), StartsWith("HTTP/1.1 431 "));
}

TEST_F(WebServerTest, BytesBehindTheHeadAreRefused) {
  start();
  auto client = connect();
  send(client, "GET / HTTP/1.1\r\nHost: " + host() + "\r\n\r\nGET / HTTP/1.1\r\n\r\n");
  EXPECT_THAT(receive(client, "no body here"), StartsWith("HTTP/1.1 400 "));
}

TEST_F(WebServerTest, FurtherClientsAreRefused_AndTheOthersStay) {
  start({.maximum_clients = 2});
  auto first = watch();
  receive(first, "}]");
  auto second = watch();
  receive(second, "}]");
  auto third = connect();
  EXPECT_EQ(receive(third), "closed");
  EXPECT_EQ(server_->clients(), 2U);
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("was refused: all 2 connections are in use")));
}

TEST_F(WebServerTest, HalfRequests_GiveWay_TheOldestFirst) {
  start({.maximum_clients = 8, .most_requests_of_address = 4, .role = WebRole::configure, .key = "01"});
  std::vector<tcp::socket> half;
  for (int i = 0; i < 80; ++i) {
    half.push_back(connect());
    send(half.back(), "GET / HT");
  }
  EXPECT_TRUE(becomes([&] { return server_->clients() <= 4; }));
  EXPECT_EQ(server_->clients(), 4U) << "of one address";
  auto owner = watch("?key=01");
  EXPECT_THAT(receive(owner, "}]"), StartsWith("HTTP/1.1 101 "));
  auto page = connect();
  send(page, "GET / HTTP/1.1\r\nHost: " + host() + "\r\n\r\n");
  EXPECT_THAT(receive(page, "</html>"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(reports_[0], HasSubstr(": its connection is closed"));
}

TEST_F(WebServerTest, WatchersWithoutKey_AreSoManyOfAnAddress_AndGiveWayToThoseWithIt) {
  start({.maximum_clients = 4, .most_watchers_of_address = 3, .role = WebRole::configure, .key = "01"});
  std::vector<tcp::socket> watchers;
  for (int i = 0; i < 3; ++i) {
    watchers.push_back(watch());
    receive(watchers.back(), "}]");
  }
  auto further = watch();
  EXPECT_THAT(receive(further, "key of the page"), StartsWith("HTTP/1.1 503 "));
  std::vector<tcp::socket> owners;
  for (int i = 0; i < 4; ++i) {
    owners.push_back(watch("?key=01"));
    EXPECT_THAT(receive(owners.back(), "}]"), StartsWith("HTTP/1.1 101 ")) << i;
  }
  for (tcp::socket& watcher : watchers) EXPECT_THAT(receive(watcher), EndsWith("closed"));
  EXPECT_EQ(server_->clients(), 4U);
  auto fifth = watch("?key=01");
  EXPECT_THAT(receive(fifth), EndsWith("closed")) << "none of them gives way";
  for (tcp::socket& owner : owners) EXPECT_THAT(receive(owner, "}]"), Not(HasSubstr("closed")));
}

TEST_F(WebServerTest, PingsAndPartsOfMessagesCountAsMessages) {
  const std::string ping("\x89\x80\0\0\0\0", 6);
  const std::string empty_part("\0\x80\0\0\0\0", 6);
  const std::string begin("\x01\x80\0\0\0\0", 6);
  for (const auto& [first, repeated] : {std::pair(std::string(), ping), std::pair(begin, empty_part)}) {
    start({.most_messages = 20});
    auto client = watch();
    receive(client, "}]");
    std::string frames = first;
    for (int i = 0; i < 19; ++i) frames += repeated;
    send(client, frames);
    EXPECT_THAT(receive(client, "}]"), Not(HasSubstr("closed")));
    std::string more;  // at once: a new second may have begun
    for (int i = 0; i < 21; ++i) more += repeated;
    send(client, more);
    EXPECT_THAT(receive(client), EndsWith("closed"));
    EXPECT_THAT(reports_, ElementsAre(HasSubstr("sends too much")));
    reports_.clear();
  }
}

TEST_F(WebServerTest, SoManyBytesWaitForAllClients) {
  start({.most_waiting_bytes = 30U << 20});
  std::vector<tcp::socket> clients;
  for (std::uint32_t id = 0; id < 4; ++id) {
    clients.push_back(watch());
    receive(clients.back(), "}]");
    send(clients.back(), message("{\"do\":{},\"id\":" + std::to_string(id) + "}"));
    receive(clients.back(), "first");
    reply_(std::string(12U << 20, 'x'));  // more than the system takes
  }
  EXPECT_LT(server_->clients(), 4U);
  EXPECT_GE(server_->clients(), 2U);
  EXPECT_THAT(reports_, ::testing::Contains(HasSubstr("does not take the replies to its commands")));
}

TEST_F(WebServerTest, ThousandsOfConnects_LeaveNothingBehind) {
  start({.maximum_clients = 8});
  for (int i = 0; i < 2000; ++i) (void)connect();
  EXPECT_TRUE(becomes([&] { return server_->clients() == 0; }));
  auto client = watch();
  EXPECT_THAT(receive(client, "}]"), StartsWith("HTTP/1.1 101 "));
}

TEST_F(WebServerTest, ThisMachineAlone) {
  start();
  for (const char* host : {"0.0.0.0", "192.168.1.7", "::"}) {
    const auto result = server_->listen(host, 0);
    ASSERT_FALSE(result) << host;
    EXPECT_THAT(result.error(), HasSubstr("the page is for this machine alone unless it has users"));
  }
  EXPECT_FALSE(server_->listen("example.org", 0)) << "no address in numbers";
}

TEST_F(WebServerTest, ItMayBeStoppedWithinThePresentMoment) {
  start();
  clock_.stop_when_asked = server_.get();
  auto client = watch();
  EXPECT_THAT(receive(client), EndsWith("closed"));
  EXPECT_EQ(states_, 0);
}

TEST_F(WebServerTest, ItMayBeStoppedWithWatchers) {
  start({.state_interval = 1ms});
  auto client = watch();
  receive(client, "}]");
  server_.reset();
  context_.run_for(20ms);
  SUCCEED();
}

}  // namespace
}  // namespace canopus::web::server_test
