#pragma once
// What a browser may ask the web server, decided from the bytes of a request's head alone: no socket, no clock. A head
// that is not whole, too long, ambiguous, of another site or of no page gets a refusal; the rest a file of the page, or
// the way to WebSocket.
//
// A page of another site can make a browser send requests here, and point a name of its own at 127.0.0.1 (DNS
// rebinding). So the name in Host must be one of this server's own, and a WebSocket wants an Origin of the same host.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "canopus/web/http/page_files.hpp"

namespace canopus::web {

using WebRequest = boost::beast::http::request<boost::beast::http::empty_body>;

/// The longest head of a request, in bytes, with its empty line.
inline constexpr std::size_t longest_web_head = 8192;

/// The longest body of a request, in bytes: a form.
inline constexpr std::size_t longest_web_body = 4096;

/// What a server with users has to do before it answers.
enum class WebNext : std::uint8_t {
  send,
  page,     ///< the answer is for who has logged in; others are shown the way
  session,  ///< who has logged in asks who he is
  log_in,   ///< wants the body, a form
  log_out,  ///< likewise
};

/// What is sent back. `status` 101: nothing yet, the connection becomes a WebSocket.
struct WebAnswer {
  unsigned status = 200;  ///< of HTTP
  std::string_view content_type = "text/plain; charset=utf-8";
  std::string body{};
  std::shared_ptr<const std::string>
      file{};                ///< the body, if it is not empty: a file of the page, which is not copied
  bool has_body = true;      ///< false for HEAD: the fields are those of the body, which is left out
  bool may_be_kept = false;  ///< by the browser, which asks each time whether it is still the same
  std::string fields{};      ///< further ones of the head, each with its end of line
  bool has_form = false;     ///< the page may send a form
  WebNext next = WebNext::send;
};

/// Where the server is, and whose requests it takes.
struct WebPlace {
  std::string address{};  ///< that it listens on, in numbers; 0.0.0.0 and :: are all of the machine
  std::uint16_t port = 0;
  std::string origin{};  ///< "https://plant.example": what browsers see in front of it; empty: nothing is
  bool has_users = false;
  std::shared_ptr<const PageFiles> files{};  ///< of the page; nullptr: they are missing
};

/// Where the end of the head is: the number of its bytes with the empty line; 0 = not there yet.
[[nodiscard]] std::size_t end_of_head(std::string_view bytes) noexcept;

/// Reads a whole head (up to its end_of_head()); a body may come, no longer than the limit. The error is the refusal.
[[nodiscard]] std::expected<WebRequest, WebAnswer> read_head(std::string_view head);

/// How many bytes of a body come behind the head.
[[nodiscard]] std::size_t body_length(const WebRequest& request) noexcept;

/// "https://plant.example", "http://10.0.0.1:8080": what a browser sends as Origin; the error is a sentence.
[[nodiscard]] std::expected<std::string, std::string> parse_web_origin(std::string_view text);

/// What the request gets from a server at this place. Unless `next` is log_in or log_out, it has no body.
[[nodiscard]] WebAnswer answer_to(const WebRequest& request, const WebPlace& place);

/// The page to log in, with a sentence on it.
[[nodiscard]] WebAnswer log_in_page(const WebPlace& place, unsigned status, std::string_view sentence);

/// The bytes of an answer, head and body, but for `file`, which follows them. The connection ends behind it.
[[nodiscard]] std::string written(const WebAnswer& answer);

}  // namespace canopus::web
