// Heads of requests of any bytes to the web server, without and with users: each gets one answer, and a file or a WebSocket only
// when it names this server. The same bytes as a form, as the file of users, and as what a watcher says.

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>

#include "canopus/web/access/password.hpp"
#include "canopus/web/access/users.hpp"
#include "canopus/web/http/form.hpp"
#include "canopus/web/http/request.hpp"
#include "canopus/web/server/client_message.hpp"

#include "input.hpp"

namespace {

using namespace canopus;

bool names(std::string_view head, std::initializer_list<std::string_view> places) {
  std::string lower(head);
  for (char& letter : lower) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return std::ranges::any_of(places,
                             [&](std::string_view place) { return lower.find(place) != std::string::npos; });
}

std::shared_ptr<const web::PageFiles> page_files() {
  web::PageFiles files;
  files.add("index.html", "<head></head>");
  files.add("login.html", "<p id=\"said\" role=\"alert\"></p>");
  files.add("page.js", "export {};");
  return std::make_shared<const web::PageFiles>(files);
}

void check_request(std::string_view bytes, const web::WebPlace& place) {
  const std::size_t length = web::end_of_head(bytes);
  fuzz::expect(length <= bytes.size());
  const std::string_view head = length == 0 ? bytes : bytes.substr(0, length);
  const auto request = web::read_head(head);
  const web::WebAnswer answer = request ? web::answer_to(*request, place) : request.error();
  fuzz::expect(answer.status == 101 || answer.status == 200 || answer.status == 304 ||
               (answer.status >= 400 && answer.status < 600));
  fuzz::expect(web::written(answer).starts_with("HTTP/1.1 "));
  if (answer.status == 101 || answer.status == 200 || answer.status == 304) {
    fuzz::expect(head.size() <= web::longest_web_head);
    fuzz::expect(place.has_users ? names(head, {":8080", "plant.example"})
                                 : names(head, {"127.0.0.1:8080", "localhost:8080"}));
  }
  const bool is_form = answer.next == web::WebNext::log_in || answer.next == web::WebNext::log_out;
  if (is_form) {
    fuzz::expect(place.has_users && names(head, {"http://", "https://plant.example"}) &&
                 names(head, {"origin"}));
    fuzz::expect(web::body_length(*request) <= web::longest_web_body);
  }
  if (request && !is_form && answer.status < 300) fuzz::expect(web::body_length(*request) == 0);
  if (!request) return;
  const auto field = (*request)[boost::beast::http::field::cookie];
  if (const auto value = web::cookie_of({field.data(), field.size()}, "canopus_8080")) {
    fuzz::expect(value->find(';') == std::string_view::npos);
  }
}

void check_users(std::string_view bytes) {
  if (const auto form = web::read_form(bytes)) fuzz::expect(form->size() <= web::most_form_fields);
  const auto users = web::parse_web_users(bytes, "users");
  if (!users) return fuzz::expect(users.error().starts_with("users:"));
  for (const web::WebAccount& user : *users) {
    fuzz::expect(web::is_user_name(user.name) && web::is_password_hash(user.hash));
    fuzz::expect(std::ranges::count(*users, user.name, &web::WebAccount::name) == 1);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  static const auto files = page_files();
  check_request(bytes, {.address = "127.0.0.1", .port = 8080, .files = files});
  check_request(bytes, {.address = "0.0.0.0",
                        .port = 8080,
                        .origin = "https://plant.example",
                        .has_users = true,
                        .files = files});
  check_users(bytes);
  if (const auto wish = web::parse_client_message(bytes)) {
    fuzz::expect(wish->messages.has_value() + wish->views.has_value() + wish->command.has_value() == 1);
    fuzz::expect(!wish->views || wish->views->size() <= web::ClientMessage::most_views);
  }
  return 0;
}
