// What the web server makes of the head of a request: refusals by the list of docs/web.md, and what pages get.

#include "canopus/web/http/request.hpp"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::web::request_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr std::uint16_t port = 8080;

std::shared_ptr<const PageFiles> page_files() {
  static const auto files = [] {
    PageFiles all;
    all.add("index.html", "<!doctype html>\n<html><head>\n<title>x</title></head></html>\n");
    all.add("login.html", "<!doctype html>\n<form><p id=\"said\" role=\"alert\"></p></form>\n");
    all.add("page.css", "body { margin: 0; }\n");
    all.add("page.js", "export {};\n");
    all.add("icon.svg", "<svg/>\n");
    return std::make_shared<const PageFiles>(all);
  }();
  return files;
}

WebAnswer ask(const std::string& head, std::string_view address = "127.0.0.1", std::uint16_t at = port) {
  const auto request = read_head(head);
  return request ? answer_to(*request, {.address = std::string(address), .port = at, .files = page_files()})
                 : request.error();
}

std::string get(const std::string& target, const std::string& fields = "Host: 127.0.0.1:8080\r\n") {
  return "GET " + target + " HTTP/1.1\r\n" + fields + "\r\n";
}

std::string socket(const std::string& fields) {
  return get("/events",
             "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                 fields);
}

TEST(WebRequest, TheFilesOfThePage_HaveTheirTypes) {
  const WebAnswer page = ask(get("/"));
  EXPECT_EQ(page.status, 200U);
  EXPECT_EQ(page.content_type, "text/html; charset=utf-8");
  EXPECT_THAT(page.body, StartsWith("<!doctype html>"));
  EXPECT_EQ(ask(get("/index.html?a=b")).body, page.body);
  EXPECT_EQ(ask(get("/page.css")).content_type, "text/css; charset=utf-8");
  EXPECT_EQ(ask(get("/page.js")).content_type, "text/javascript; charset=utf-8");
  EXPECT_EQ(ask(get("/icon.svg")).content_type, "image/svg+xml");
}

TEST(WebRequest, AFileIsSentOnce_AsLongAsItStaysTheSame) {
  const WebAnswer first = ask(get("/page.css"));
  EXPECT_EQ(first.status, 200U);
  ASSERT_TRUE(first.file);
  EXPECT_EQ(*first.file, "body { margin: 0; }\n");
  const std::string head = written(first);
  EXPECT_THAT(head, HasSubstr("\r\nCache-Control: no-cache\r\n"));
  EXPECT_THAT(head, HasSubstr("\r\nContent-Length: 20\r\n"));
  EXPECT_TRUE(head.ends_with("\r\n\r\n")) << "the file follows";
  const std::size_t begin = head.find("\r\nETag: \"") + 8;
  const std::string tag = head.substr(begin, 18);
  const std::string host = "Host: 127.0.0.1:8080\r\n";
  const WebAnswer again = ask(get("/page.css", host + "If-None-Match: " + tag + "\r\n"));
  EXPECT_EQ(again.status, 304U);
  EXPECT_FALSE(again.file);
  EXPECT_EQ(ask(get("/page.js", host + "If-None-Match: " + tag + "\r\n")).status, 200U);
  EXPECT_THAT(written(ask(get("/"))), HasSubstr("\r\nCache-Control: no-store\r\n"))
      << "with users it is another page";
}

TEST(WebRequest, WithoutTheFilesOfThePage_ASentenceSaysHowToGetThem) {
  const auto ask_without = [](const std::string& target, bool has_users) {
    return answer_to(*read_head(get(target)), {.address = "127.0.0.1", .port = port, .has_users = has_users});
  };
  for (const char* target : {"/", "/index.html"}) {
    EXPECT_EQ(ask_without(target, false).status, 503U);
    EXPECT_THAT(ask_without(target, false).body, HasSubstr("`tools/page build/page` builds them"));
  }
  EXPECT_EQ(ask_without("/login", true).status, 503U);
  EXPECT_EQ(ask_without("/page.js", false).status, 404U);
  const WebPlace place{.address = "127.0.0.1", .port = port, .has_users = true};
  EXPECT_EQ(log_in_page(place, 401, "The name or the password is wrong.").status, 401U);
}

TEST(WebRequest, NoFileButThoseOfThePage) {
  for (const char* target : {"/plant.toml", "/../etc/passwd", "/%2e%2e/etc/passwd", "//etc/passwd", "/page",
                             "/page.js/", "*", "/page.js%00"}) {
    EXPECT_EQ(ask(get(target)).status, 404U) << target;
  }
}

TEST(WebRequest, HeadIsThePageWithoutItsBody) {
  const WebAnswer answer = ask("HEAD / HTTP/1.1\r\nHost: localhost:8080\r\n\r\n");
  const std::string text = written(answer);
  EXPECT_TRUE(text.ends_with("\r\n\r\n"));
  EXPECT_THAT(text, HasSubstr("Content-Length: " + std::to_string(ask(get("/")).body.size()) + "\r\n"));
}

TEST(WebRequest, NothingIsChangedByAnyMethod) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "CONNECT"}) {
    const WebAnswer answer = ask(std::string(method) + " / HTTP/1.1\r\nHost: localhost:8080\r\n\r\n");
    EXPECT_EQ(answer.status, 405U) << method;
    EXPECT_THAT(written(answer), HasSubstr("Allow: GET, HEAD\r\n"));
  }
}

TEST(WebRequest, HostMustNameThisServer_AgainstNamesThatArePointedHere) {
  for (const char* host : {"127.0.0.1:8080", "localhost:8080", "LOCALHOST:8080"}) {
    EXPECT_EQ(ask(get("/", std::string("Host: ") + host + "\r\n")).status, 200U) << host;
  }
  for (const char* host :
       {"evil.example:8080", "evil.example", "127.0.0.1", "127.0.0.1:80", "localhost:8081", "", "[::1]:8080",
        "localhost.evil.example:8080", "127.0.0.1:8080.evil.example", "user@127.0.0.1:8080"}) {
    EXPECT_EQ(ask(get("/", std::string("Host: ") + host + "\r\n")).status, 421U) << host;
  }
  EXPECT_EQ(ask(get("/", "Host: [::1]:8080\r\n"), "::1").status, 200U);
  EXPECT_EQ(ask(get("/", "Host: 127.0.0.1:8080\r\n"), "::1").status, 421U);
  EXPECT_EQ(ask(get("/", "Host: localhost\r\n"), "127.0.0.1", 80).status, 200U);
}

TEST(WebRequest, OneHostAlone) {
  EXPECT_EQ(ask(get("/", "")).status, 400U);
  EXPECT_EQ(ask(get("/", "Host: 127.0.0.1:8080\r\nHost: evil.example\r\n")).status, 400U);
}

TEST(WebRequest, AWebSocketIsForThisServersPage) {
  const std::string host = "Host: 127.0.0.1:8080\r\n";
  EXPECT_EQ(ask(socket(host + "Origin: http://127.0.0.1:8080\r\n")).status, 101U);
  EXPECT_EQ(ask(socket("Host: localhost:8080\r\nOrigin: http://localhost:8080\r\n")).status, 101U);
  EXPECT_EQ(ask(socket(host)).status, 403U) << "no Origin";
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1:8080", "http://127.0.0.1:8081",
                             "http://localhost:8080", "http://127.0.0.1:8080.evil.example", "file://"}) {
    EXPECT_EQ(ask(socket(host + "Origin: " + origin + "\r\n")).status, 403U) << origin;
  }
  EXPECT_EQ(ask(socket(host + "Origin: http://127.0.0.1:8080\r\nOrigin: http://evil.example\r\n")).status,
            403U);
  EXPECT_EQ(ask(socket("Host: evil.example:8080\r\nOrigin: http://evil.example:8080\r\n")).status, 421U);
  EXPECT_EQ(ask(get("/events")).status, 426U);
}

TEST(WebRequest, WhatIsNoRequest) {
  for (const char* head :
       {"\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\nHost: localhost:8080\r\n\r\n",
        "GET / HTTP/1.1\r\n: x\r\n\r\n", "GET / HTTP/1.1\r\nHost : localhost:8080\r\n\r\n",
        "GET /\x01 HTTP/1.1\r\nHost: localhost:8080\r\n\r\n", "\x16\x03\x01\x02\r\n\r\n"}) {
    EXPECT_EQ(ask(head).status, 400U) << head;
  }
  EXPECT_EQ(ask("GET / HTTP/1.0\r\nHost: localhost:8080\r\n\r\n").status, 505U);
}

TEST(WebRequest, ABodyIsRefused) {
  const std::string host = "POST / HTTP/1.1\r\nHost: localhost:8080\r\n";
  EXPECT_EQ(ask(host + "Content-Length: 5\r\n\r\n").status, 413U);
  EXPECT_EQ(ask(host + "Content-Length: 99999999999999999999\r\n\r\n").status, 400U);
  EXPECT_EQ(ask(host + "Transfer-Encoding: chunked\r\n\r\n").status, 413U);
  EXPECT_EQ(ask(host + "Transfer-Encoding: chunked\r\nContent-Length: 0\r\n\r\n").status, 400U)
      << "two lengths";
}

TEST(WebRequest, AHeadHasAnEnd_AndALimit) {
  EXPECT_EQ(end_of_head("GET / HTTP/1.1\r\n"), 0U);
  EXPECT_EQ(end_of_head("GET / HTTP/1.1\r\n\r\nrest"), 18U);
  EXPECT_EQ(end_of_head("a\n\n"), 0U);
  const std::string fields = "Host: localhost:8080\r\nX: ";
  const std::string most =
      get("/", fields + std::string(longest_web_head - get("/", fields + "\r\n").size(), 'x') + "\r\n");
  ASSERT_EQ(most.size(), longest_web_head);
  EXPECT_EQ(ask(most).status, 200U);
  EXPECT_EQ(ask(get("/", fields + std::string(longest_web_head, 'x') + "\r\n")).status, 431U);
}

TEST(WebRequest, EveryAnswerKeepsOtherSitesOut) {
  for (const WebAnswer& answer : {ask(get("/")), ask(get("/nothing")), ask("?\r\n\r\n")}) {
    const std::string text = written(answer);
    EXPECT_THAT(text, HasSubstr("\r\nContent-Security-Policy: default-src 'none'; script-src 'self';"));
    EXPECT_THAT(text, HasSubstr("; style-src 'self'; img-src 'self' data:; connect-src 'self';"));
    EXPECT_THAT(text, Not(HasSubstr("unsafe")));
    EXPECT_THAT(text, HasSubstr("frame-ancestors 'none'"));
    EXPECT_THAT(text, HasSubstr("\r\nX-Content-Type-Options: nosniff\r\n"));
    EXPECT_THAT(text, HasSubstr("\r\nCross-Origin-Resource-Policy: same-origin\r\n"));
    EXPECT_THAT(text, HasSubstr("\r\nReferrer-Policy: no-referrer\r\n"));
    EXPECT_THAT(text, HasSubstr("\r\nConnection: close\r\n"));
  }
}

TEST(WebRequest, ARefusalRepeatsNothingOfTheRequest) {
  EXPECT_THAT(written(ask(get("/<script>alert(1)</script>"))), Not(HasSubstr("<script>")));
  EXPECT_THAT(written(ask(get("/", "Host: <script>\r\n"))), Not(HasSubstr("<script>")));
}

WebAnswer ask_at(const WebPlace& place, const std::string& head) {
  const auto request = read_head(head);
  return request ? answer_to(*request, place) : request.error();
}

const WebPlace with_users{.address = "10.0.0.9", .port = 8080, .has_users = true, .files = page_files()};

std::string post(const std::string& target, const std::string& fields = "Origin: http://10.0.0.9:8080\r\n") {
  return "POST " + target +
         " HTTP/1.1\r\nHost: 10.0.0.9:8080\r\nContent-Type: application/x-www-form-urlencoded\r\n"
         "Content-Length: 5\r\n" +
         fields + "\r\n";
}

TEST(WebRequest, FormsAreForServersWithUsers) {
  EXPECT_EQ(ask_at(with_users, post("/login")).next, WebNext::log_in);
  EXPECT_EQ(ask_at(with_users, post("/logout")).next, WebNext::log_out);
  WebPlace without = with_users;
  without.has_users = false;
  EXPECT_EQ(ask_at(without, post("/login")).status, 413U);
  EXPECT_EQ(ask_at(without, "GET /login HTTP/1.1\r\nHost: 10.0.0.9:8080\r\n\r\n").status, 404U);
  EXPECT_EQ(ask_at(without, "GET /session HTTP/1.1\r\nHost: 10.0.0.9:8080\r\n\r\n").status, 404U);
  EXPECT_EQ(ask_at(with_users, post("/")).status, 413U);
  EXPECT_EQ(ask_at(with_users, post("/session")).status, 413U);
}

TEST(WebRequest, AFormIsForThisServersPage) {
  for (const char* target : {"/login", "/logout"}) {
    EXPECT_EQ(ask_at(with_users, post(target, "")).status, 403U) << "no Origin";
    for (const char* origin : {"http://evil.example", "null", "https://10.0.0.9:8080", "http://10.0.0.9",
                               "http://10.0.0.9:8081"}) {
      EXPECT_EQ(ask_at(with_users, post(target, std::string("Origin: ") + origin + "\r\n")).status, 403U)
          << origin;
    }
  }
}

TEST(WebRequest, AFormHasItsType_AndALimit) {
  const std::string head = "POST /login HTTP/1.1\r\nHost: 10.0.0.9:8080\r\nOrigin: http://10.0.0.9:8080\r\n";
  const std::string form = "Content-Type: application/x-www-form-urlencoded; charset=UTF-8\r\n";
  EXPECT_EQ(ask_at(with_users, head + form + "Content-Length: 4096\r\n\r\n").next, WebNext::log_in);
  EXPECT_EQ(ask_at(with_users, head + form + "Content-Length: 4097\r\n\r\n").status, 413U);
  EXPECT_EQ(ask_at(with_users, head + form + "Transfer-Encoding: chunked\r\n\r\n").status, 413U);
  EXPECT_EQ(ask_at(with_users, head + form + "Content-Length: 5\r\nContent-Length: 6\r\n\r\n").status, 400U);
  EXPECT_EQ(ask_at(with_users, head + "Content-Length: 5\r\n\r\n").status, 415U);
  for (const char* type : {"text/plain", "application/json", "multipart/form-data; boundary=x"}) {
    EXPECT_EQ(ask_at(with_users, head + "Content-Type: " + type + "\r\nContent-Length: 5\r\n\r\n").status,
              415U)
        << type;
  }
}

TEST(WebRequest, HowLongABodyIs) {
  EXPECT_EQ(body_length(*read_head(post("/login"))), 5U);
  EXPECT_EQ(body_length(*read_head(get("/"))), 0U);
}

TEST(WebRequest, WithUsers_ThePageIsForWhoHasLoggedIn) {
  const auto next_of = [](const std::string& target) {
    return ask_at(with_users, "GET " + target + " HTTP/1.1\r\nHost: 10.0.0.9:8080\r\n\r\n");
  };
  EXPECT_EQ(next_of("/").next, WebNext::page);
  EXPECT_EQ(next_of("/index.html").next, WebNext::page);
  EXPECT_EQ(next_of("/index.html?x=y").next, WebNext::page);
  EXPECT_THAT(next_of("/").body, HasSubstr("<meta name=\"canopus-users\" content=\"yes\">"));
  EXPECT_THAT(ask(get("/")).body, Not(HasSubstr("canopus-users")));
  EXPECT_EQ(next_of("/session").next, WebNext::session);
  EXPECT_EQ(next_of("/page.js").next, WebNext::send) << "the program's own, of no plant";
}

TEST(WebRequest, ThePageToLogIn_MaySendAForm_AndNoOtherMay) {
  const WebAnswer page = ask_at(with_users, "GET /login HTTP/1.1\r\nHost: 10.0.0.9:8080\r\n\r\n");
  EXPECT_EQ(page.status, 200U);
  EXPECT_EQ(page.next, WebNext::send);
  EXPECT_THAT(page.body, HasSubstr("<p id=\"said\" role=\"alert\"></p>"));
  EXPECT_THAT(written(page), HasSubstr("; form-action 'self'; frame-ancestors 'none'"));
  EXPECT_THAT(written(page), HasSubstr("\r\nReferrer-Policy: same-origin\r\n"))
      << "else Origin would be null";
  EXPECT_THAT(written(ask(get("/"))), HasSubstr("; form-action 'none';"));
}

TEST(WebRequest, AllAddressesOfTheMachine_ByTheirNumbers_ButByNoName) {
  for (const char* address : {"0.0.0.0", "::"}) {
    const WebPlace all{.address = address, .port = 8080, .has_users = true, .files = page_files()};
    for (const char* host :
         {"10.0.0.9:8080", "127.0.0.1:8080", "[::1]:8080", "[fd00::7]:8080", "localhost:8080"}) {
      EXPECT_EQ(ask_at(all, get("/page.js", std::string("Host: ") + host + "\r\n")).status, 200U) << host;
    }
    for (const char* host :
         {"plant.example:8080", "10.0.0.9", "10.0.0.9:8081", "10.0.0.9.evil.example:8080", "::1:8080",
          "[10.0.0.9]:8080", ":8080", "[]:8080", "0x7f.1:8080", "10.0.0.9:8080:8080"}) {
      EXPECT_EQ(ask_at(all, get("/page.js", std::string("Host: ") + host + "\r\n")).status, 421U) << host;
    }
  }
  const WebPlace at_80{.address = "0.0.0.0", .port = 80, .has_users = true, .files = page_files()};
  EXPECT_EQ(ask_at(at_80, get("/page.js", "Host: 10.0.0.9\r\n")).status, 200U);
}

TEST(WebRequest, OneAddress_IsNotLocalhost_UnlessItIs) {
  for (const char* host : {"localhost:8080", "127.0.0.1:8080", "10.0.0.8:8080"}) {
    EXPECT_EQ(ask_at(with_users, get("/page.js", std::string("Host: ") + host + "\r\n")).status, 421U)
        << host;
  }
}

TEST(WebRequest, AProxyHasAnOriginOfItsOwn) {
  const WebPlace behind{
      .address = "127.0.0.1", .port = 8080, .origin = "https://plant.example", .has_users = true};
  const auto socket_of = [&](const std::string& host, const std::string& origin) {
    return ask_at(behind, socket("Host: " + host + "\r\nOrigin: " + origin + "\r\n")).status;
  };
  EXPECT_EQ(socket_of("plant.example", "https://plant.example"), 101U);
  EXPECT_EQ(socket_of("127.0.0.1:8080", "https://plant.example"), 101U)
      << "a proxy that does not pass Host on";
  EXPECT_EQ(socket_of("127.0.0.1:8080", "http://127.0.0.1:8080"), 101U);
  EXPECT_EQ(socket_of("plant.example", "https://evil.example"), 403U);
  EXPECT_EQ(socket_of("plant.example", "https://plant.example.evil.example"), 403U);
  EXPECT_EQ(socket_of("evil.example", "https://plant.example"), 421U);
  EXPECT_EQ(ask_at(with_users, socket("Host: 10.0.0.9:8080\r\nOrigin: https://plant.example\r\n")).status,
            403U);
}

TEST(WebRequest, AnOriginIsASchemeAndAHost) {
  for (const char* text : {"https://plant.example", "http://10.0.0.1:8080", "https://[fd00::7]:8443"}) {
    EXPECT_EQ(parse_web_origin(text), text);
  }
  for (const char* text :
       {"", "plant.example", "https://", "https://plant.example/", "ftp://plant.example",
        "https://Plant.example", "https://a b", "https://a\r\nX: y", "https://a@b", "https://*"}) {
    EXPECT_FALSE(parse_web_origin(text)) << text;
  }
}

/// Whatever comes, a file goes out only to who names this server, and a WebSocket only to this server's page.
RC_GTEST_PROP(WebRequest, AnyBytes, ()) {
  const auto piece = rc::gen::element<std::string>(
      "GET ", "POST ", "/", "/events", "/page.js", " HTTP/1.1\r\n", "Host: 127.0.0.1:8080\r\n",
      "Host: evil\r\n", "Origin: http://127.0.0.1:8080\r\n", "Origin: http://evil\r\n",
      "Upgrade: websocket\r\n", "Connection: Upgrade\r\n", "Sec-WebSocket-Version: 13\r\n",
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n", "Content-Length: 1\r\n", "\r\n", "\n",
      std::string(1, '\0'), "\xFF");
  std::string head;
  for (const std::string& part : *rc::gen::container<std::vector<std::string>>(piece)) head += part;
  head += *rc::gen::element<std::string>("", "\r\n\r\n");
  const WebAnswer answer = ask(head);
  if (answer.status == 200) RC_ASSERT(head.find("Host: 127.0.0.1:8080\r\n") != std::string::npos);
  if (answer.status == 101) RC_ASSERT(head.find("Origin: http://127.0.0.1:8080\r\n") != std::string::npos);
  if (answer.status == 101 || answer.status == 200) RC_ASSERT(head.find("Host: evil") == std::string::npos);
  RC_ASSERT(written(answer).starts_with("HTTP/1.1 "));
}

}  // namespace
}  // namespace canopus::web::request_test
