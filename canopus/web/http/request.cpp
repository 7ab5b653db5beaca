#include "canopus/web/http/request.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <fmt/format.h>

#include "canopus/link/allow_list.hpp"

namespace canopus::web {
namespace {

namespace http = boost::beast::http;

std::string_view view_of(boost::beast::string_view text) { return {text.data(), text.size()}; }

WebAnswer refusal(unsigned status, std::string_view sentence) {
  return {.status = status, .body = std::string(sentence) + '\n'};
}

bool is_equal(std::string_view one, std::string_view other) {
  return boost::beast::iequals({one.data(), one.size()}, {other.data(), other.size()});
}

/// "https://plant.example" is at "plant.example".
std::string_view host_of(std::string_view origin) { return origin.substr(origin.find("://") + 3); }

/// "192.168.1.7:8080", "[::1]:8080": an address in numbers cannot be a name of another site that is pointed here.
bool is_in_numbers(std::string_view host, std::uint16_t port) {
  const std::string end = fmt::format(":{}", port);
  if (host.ends_with(end)) {
    host.remove_suffix(end.size());
  } else if (port != 80) {
    return false;
  }
  const bool is_ipv6 = host.starts_with('[') && host.ends_with(']');
  if (is_ipv6) host = host.substr(1, host.size() - 2);
  return is_ipv6 == host.contains(':') && host != "localhost" &&
         link::parse_internet_address(host).has_value();
}

/// "127.0.0.1:8080" and the names of the same place.
bool is_own_host(std::string_view host, const WebPlace& place) {
  if (!place.origin.empty() && is_equal(host, host_of(place.origin))) return true;
  if (place.address == "0.0.0.0" || place.address == "::") {
    return is_in_numbers(host, place.port) || is_equal(host, fmt::format("localhost:{}", place.port));
  }
  std::vector<std::string> names{place.address.contains(':') ? fmt::format("[{}]", place.address)
                                                             : place.address};
  const auto address = link::parse_internet_address(place.address);
  if (address && link::is_loopback(*address)) names.insert(names.end(), {"localhost", "127.0.0.1"});
  if (place.address == "::1") names.pop_back();
  return std::ranges::any_of(names, [&](const std::string& name) {
    return is_equal(host, fmt::format("{}:{}", name, place.port)) ||
           (place.port == 80 && is_equal(host, name));
  });
}

/// The one value of a field; nothing when it is missing or there more than once.
std::optional<std::string_view> only_value(const WebRequest& request, http::field field) {
  if (request.count(field) != 1) return std::nullopt;
  return view_of(request[field]);
}

/// A page of another site has another Origin; no page has none.
bool is_of_own_page(const WebRequest& request, std::string_view host, const WebPlace& place) {
  const auto origin = only_value(request, http::field::origin);
  if (!origin) return false;
  return is_equal(*origin, fmt::format("http://{}", host)) ||
         (!place.origin.empty() && is_equal(*origin, place.origin));
}

WebAnswer answer_to_socket(const WebRequest& request, std::string_view host, const WebPlace& place) {
  if (!boost::beast::websocket::is_upgrade(request)) {
    return refusal(426, "this address is for WebSocket");
  }
  if (!is_of_own_page(request, host, place)) {
    return refusal(403, "a WebSocket is for this server's own page: Origin is of another place, or missing");
  }
  return {.status = 101};
}

WebAnswer answer_to_form(const WebRequest& request, std::string_view host, const WebPlace& place,
                         WebNext next) {
  if (!is_of_own_page(request, host, place)) {
    return refusal(403, "a form is for this server's own page: Origin is of another place, or missing");
  }
  const auto type = only_value(request, http::field::content_type);
  if (!type || !is_equal(type->substr(0, type->find(';')), "application/x-www-form-urlencoded")) {
    return refusal(415, "expected a form: application/x-www-form-urlencoded");
  }
  return {.next = next};
}

/// A page of its own, with a text put behind `place` of it. Without the files of the page a sentence.
WebAnswer changed_page(const PageFile* file, std::string_view place, std::string_view text) {
  if (file == nullptr) return refusal(503, PageFiles::missing);
  WebAnswer answer{.content_type = file->content_type, .body = *file->content};
  if (const std::size_t begin = answer.body.find(place); begin != std::string::npos)
    answer.body.insert(begin + place.size(), text);
  return answer;
}

const PageFile* file_of(const WebPlace& place, std::string_view path) {
  return place.files == nullptr ? nullptr : place.files->find(path);
}

/// A file as it is, unless the browser has just this one.
WebAnswer unchanged_file(const WebRequest& request, const PageFile& file) {
  WebAnswer answer{.content_type = file.content_type, .may_be_kept = true};
  answer.fields = fmt::format("ETag: {}\r\n", file.tag);
  const auto kept = only_value(request, http::field::if_none_match);
  if (kept && kept->contains(file.tag)) {
    answer.status = 304;
  } else {
    answer.file = file.content;
  }
  return answer;
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
  parser.body_limit(longest_web_body);
  boost::beast::error_code error;
  parser.put(boost::asio::buffer(head.data(), head.size()), error);
  if (error == http::error::body_limit)
    return std::unexpected(refusal(413, "the body of the request is too long"));
  if (error || !parser.is_header_done()) return std::unexpected(refusal(400, "this is no HTTP request"));
  if (parser.chunked()) return std::unexpected(refusal(413, "a request has no body here"));
  return parser.release();
}

std::size_t body_length(const WebRequest& request) noexcept {
  const auto given = only_value(request, http::field::content_length);
  std::size_t length = 0;
  if (given) std::from_chars(given->data(), given->data() + given->size(), length);
  return length;
}

std::expected<std::string, std::string> parse_web_origin(std::string_view text) {
  const auto is_of_host = [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') ||
           std::string_view("-.:[]").contains(letter);
  };
  const bool has_scheme = text.starts_with("http://") || text.starts_with("https://");
  const std::string_view host = has_scheme ? host_of(text) : std::string_view();
  if (host.empty() || host.size() > 255 || !std::ranges::all_of(host, is_of_host)) {
    return std::unexpected(
        fmt::format("\"{}\" is no origin; expected https://NAME or https://NAME:PORT in small letters, with "
                    "nothing behind",
                    text));
  }
  return std::string(text);
}

WebAnswer log_in_page(const WebPlace& place, unsigned status, std::string_view sentence) {
  const PageFile* const file = file_of(place, "/login.html");
  WebAnswer answer = changed_page(file, "<p id=\"said\" role=\"alert\">", sentence);
  if (file != nullptr || status != 200) answer.status = status;
  answer.has_form = file != nullptr;
  return answer;
}

WebAnswer answer_to(const WebRequest& request, const WebPlace& place) {
  if (request.version() != 11) return refusal(505, "expected HTTP/1.1");
  const auto host = only_value(request, http::field::host);
  if (!host) return refusal(400, "a request names one Host");
  if (!is_own_host(*host, place)) {
    return refusal(421,
                   fmt::format("this server is {}:{}; Host names another place", place.address, place.port));
  }
  const std::string_view target = view_of(request.target());
  const std::string_view path = target.substr(0, target.find('?'));
  const http::verb method = request.method();
  if (place.has_users && method == http::verb::post) {
    if (path == "/login") return answer_to_form(request, *host, place, WebNext::log_in);
    if (path == "/logout") return answer_to_form(request, *host, place, WebNext::log_out);
  }
  if (body_length(request) != 0) return refusal(413, "a request has no body here");
  if (path == "/events" && method == http::verb::get) return answer_to_socket(request, *host, place);
  const bool is_log_in = place.has_users && path == "/login";
  const bool is_session = place.has_users && path == "/session";
  const bool is_page = path == "/" || path == "/index.html";
  const PageFile* const file = file_of(place, path);
  if (file == nullptr && !is_page && !is_log_in && !is_session) return refusal(404, "there is no such page");
  if (method != http::verb::get && method != http::verb::head) {
    WebAnswer answer = refusal(405, "expected GET or HEAD");
    answer.fields = "Allow: GET, HEAD\r\n";
    return answer;
  }
  WebAnswer answer;
  if (is_log_in) {
    answer = log_in_page(place, 200, {});
  } else if (is_session) {
    answer.next = WebNext::session;
  } else if (is_page) {
    constexpr std::string_view users = "\n<meta name=\"canopus-users\" content=\"yes\">";
    answer = changed_page(file, "<head>", place.has_users ? users : std::string_view());
    if (place.has_users) answer.next = WebNext::page;
  } else {
    answer = unchanged_file(request, *file);
  }
  answer.has_body = method == http::verb::get;
  return answer;
}

std::string written(const WebAnswer& answer) {
  return fmt::format(
      "HTTP/1.1 {} {}\r\n"
      "Server: canopus\r\n"
      "Content-Type: {}\r\n"
      "Content-Length: {}\r\n"
      "Connection: close\r\n"
      "{}"
      "Cache-Control: {}\r\n"
      "X-Content-Type-Options: nosniff\r\n"
      "X-Frame-Options: DENY\r\n"
      "Referrer-Policy: {}\r\n"
      "Cross-Origin-Opener-Policy: same-origin\r\n"
      "Cross-Origin-Resource-Policy: same-origin\r\n"
      "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' "
      "data:; "
      "connect-src 'self'; base-uri 'none'; form-action {}; frame-ancestors 'none'\r\n"
      "\r\n{}",
      answer.status, reason_of(answer.status), answer.content_type,
      answer.file ? answer.file->size() : answer.body.size(), answer.fields,
      answer.may_be_kept ? "no-cache" : "no-store",
      // Without a referrer browsers say "Origin: null" with a form.
      answer.has_form ? "same-origin" : "no-referrer", answer.has_form ? "'self'" : "'none'",
      answer.has_body ? answer.body : std::string());
}

}  // namespace canopus::web
