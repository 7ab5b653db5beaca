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
#include <string>
#include <string_view>

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

namespace canopus::serve {

using WebRequest = boost::beast::http::request<boost::beast::http::empty_body>;

/// The longest head of a request, in bytes, with its empty line.
inline constexpr std::size_t longest_web_head = 8192;

/// What is sent back. `status` 101: nothing yet, the connection becomes a WebSocket.
struct WebAnswer {
  unsigned status = 200;  ///< of HTTP
  std::string_view content_type = "text/plain; charset=utf-8";
  std::string body{};
  bool has_body = true;  ///< false for HEAD: the fields are those of the body, which is left out
};

/// Where the end of the head is: the number of its bytes with the empty line; 0 = not there yet.
[[nodiscard]] std::size_t end_of_head(std::string_view bytes) noexcept;

/// Reads a whole head (up to its end_of_head()). The error is the refusal.
[[nodiscard]] std::expected<WebRequest, WebAnswer> read_head(std::string_view head);

/// What the request gets from a server that listens on this loopback address (numbers) and port.
[[nodiscard]] WebAnswer answer_to(const WebRequest& request, std::string_view address, std::uint16_t port);

/// The bytes of an answer, head and body. The connection ends behind it.
[[nodiscard]] std::string written(const WebAnswer& answer);

}  // namespace canopus::serve
