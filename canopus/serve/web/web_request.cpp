#include "canopus/serve/web/web_request.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <fmt/format.h>

#include "canopus/serve/web/web_files.hpp"

namespace canopus::serve {
namespace {

namespace http = boost::beast::http;

std::string_view view_of(boost::beast::string_view text) { return {text.data(), text.size()}; }

WebAnswer refusal(unsigned status, std::string_view sentence) {
  return {.status = status, .body = std::string(sentence) + '\n'};
}

/// "127.0.0.1:8080" and the names of the same place.
bool is_own_host(std::string_view host, std::string_view address, std::uint16_t port) {
  const std::array<std::string, 3> names{
      address.find(':') == std::string_view::npos ? std::string(address) : fmt::format("[{}]", address),
      "localhost", address == "::1" ? "localhost" : "127.0.0.1"};
  return std::ranges::any_of(names, [&](const std::string& name) {
    if (boost::beast::iequals({host.data(), host.size()}, fmt::format("{}:{}", name, port))) return true;
    return port == 80 && boost::beast::iequals({host.data(), host.size()}, name);
  });
}

/// The one value of a field; nothing when it is missing or there more than once.
std::optional<std::string_view> only_value(const WebRequest& request, http::field field) {
  if (request.count(field) != 1) return std::nullopt;
  return view_of(request[field]);
}

WebAnswer answer_to_socket(const WebRequest& request, std::string_view host) {
  if (!boost::beast::websocket::is_upgrade(request)) {
    return refusal(426, "this address is for WebSocket");
  }
  const auto origin = only_value(request, http::field::origin);
  if (!origin || !boost::beast::iequals({origin->data(), origin->size()}, fmt::format("http://{}", host))) {
    return refusal(403, "a WebSocket is for this server's own page: Origin is of another place, or missing");
  }
  return {.status = 101};
}

std::string_view reason_of(unsigned status) {
  return view_of(http::obsolete_reason(static_cast<http::status>(status)));
}

}  // namespace

std::size_t end_of_head(std::string_view bytes) noexcept {
  const std::size_t end = bytes.find("\r\n\r\n");
  return end == std::string_view::npos ? 0 : end + 4;
}

std::expected<WebRequest, WebAnswer> read_head(std::string_view head) {
  if (head.size() > longest_web_head)
    return std::unexpected(refusal(431, "the head of the request is too long"));
  http::request_parser<http::empty_body> parser;
  parser.header_limit(static_cast<std::uint32_t>(longest_web_head));
  parser.body_limit(0);
  boost::beast::error_code error;
  parser.put(boost::asio::buffer(head.data(), head.size()), error);
  if (error == http::error::body_limit) return std::unexpected(refusal(413, "a request has no body here"));
  if (error || !parser.is_header_done()) return std::unexpected(refusal(400, "this is no HTTP request"));
  if (!parser.is_done() || parser.chunked() || parser.content_length().value_or(0) != 0) {
    return std::unexpected(refusal(413, "a request has no body here"));
  }
  return parser.release();
}

WebAnswer answer_to(const WebRequest& request, std::string_view address, std::uint16_t port) {
  if (request.version() != 11) return refusal(505, "expected HTTP/1.1");
  const auto host = only_value(request, http::field::host);
  if (!host) return refusal(400, "a request names one Host");
  if (!is_own_host(*host, address, port)) {
    return refusal(421, fmt::format("this server is {}:{}; Host names another place", address, port));
  }
  const std::string_view target = view_of(request.target());
  const std::string_view path = target.substr(0, target.find('?'));
  if (path == "/events" && request.method() == http::verb::get) return answer_to_socket(request, *host);
  const WebFile* file = find_web_file(path == "/" ? "/index.html" : path);
  if (file == nullptr) return refusal(404, "there is no such page");
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    return refusal(405, "expected GET or HEAD");
  }
  return {.content_type = file->content_type,
          .body = std::string(file->content),
          .has_body = request.method() == http::verb::get};
}

std::string written(const WebAnswer& answer) {
  return fmt::format(
      "HTTP/1.1 {} {}\r\n"
      "Server: canopus\r\n"
      "Content-Type: {}\r\n"
      "Content-Length: {}\r\n"
      "Connection: close\r\n"
      "{}"
      "Cache-Control: no-store\r\n"
      "X-Content-Type-Options: nosniff\r\n"
      "X-Frame-Options: DENY\r\n"
      "Referrer-Policy: no-referrer\r\n"
      "Cross-Origin-Opener-Policy: same-origin\r\n"
      "Cross-Origin-Resource-Policy: same-origin\r\n"
      "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
      "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n"
      "\r\n{}",
      answer.status, reason_of(answer.status), answer.content_type, answer.body.size(),
      answer.status == 405 ? "Allow: GET, HEAD\r\n" : "", answer.has_body ? answer.body : std::string());
}

}  // namespace canopus::serve
