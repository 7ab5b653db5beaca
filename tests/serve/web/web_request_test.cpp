// What the web server makes of the head of a request: refusals by the list of docs/web.md, and what pages get.

#include "canopus/serve/web/web_request.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::serve {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr std::uint16_t port = 8080;

WebAnswer ask(const std::string& head, std::string_view address = "127.0.0.1", std::uint16_t at = port) {
  const auto request = read_head(head);
  return request ? answer_to(*request, address, at) : request.error();
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

TEST(WebRequest, ThePageHasNoScriptOrStyleInIt_SoThatThePolicyHolds) {
  const std::string page = ask(get("/")).body;
  EXPECT_THAT(page, Not(HasSubstr("style=")));
  EXPECT_THAT(page, Not(HasSubstr("onclick")));
  EXPECT_THAT(page, Not(HasSubstr("http://"))) << "nothing is fetched from elsewhere";
  EXPECT_THAT(page, Not(HasSubstr("https://")));
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
}  // namespace canopus::serve
