// Heads of requests of any bytes to the web server, without and with users: each gets one answer, and a file or a WebSocket only
// when it names this server. The same bytes as a form, as the file of users, and as what a watcher says.

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <string>
#include <string_view>

#include "canopus/serve/web/client_message.hpp"
#include "canopus/serve/web/web_form.hpp"
#include "canopus/serve/web/web_password.hpp"
#include "canopus/serve/web/web_request.hpp"
#include "canopus/serve/web/web_users.hpp"

#include "input.hpp"

namespace {

using namespace canopus;

bool names(std::string_view head, std::initializer_list<std::string_view> places) {
  std::string lower(head);
  for (char& letter : lower) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return std::ranges::any_of(places,
                             [&](std::string_view place) { return lower.find(place) != std::string::npos; });
}

void look_at_request(std::string_view bytes, const serve::WebPlace& place) {
  const std::size_t length = serve::end_of_head(bytes);
  fuzz::expect(length <= bytes.size());
  const std::string_view head = length == 0 ? bytes : bytes.substr(0, length);
  const auto request = serve::read_head(head);
  const serve::WebAnswer answer = request ? serve::answer_to(*request, place) : request.error();
  fuzz::expect(answer.status == 101 || answer.status == 200 || (answer.status >= 400 && answer.status < 600));
  fuzz::expect(serve::written(answer).starts_with("HTTP/1.1 "));
  if (answer.status == 101 || answer.status == 200) {
    fuzz::expect(head.size() <= serve::longest_web_head);
    fuzz::expect(place.has_users ? names(head, {":8080", "plant.example"})
                                 : names(head, {"127.0.0.1:8080", "localhost:8080"}));
  }
  const bool is_form = answer.next == serve::WebNext::log_in || answer.next == serve::WebNext::log_out;
  if (is_form) {
    fuzz::expect(place.has_users && names(head, {"http://", "https://plant.example"}) &&
                 names(head, {"origin"}));
    fuzz::expect(serve::body_length(*request) <= serve::longest_web_body);
  }
  if (request && !is_form && answer.status < 300) fuzz::expect(serve::body_length(*request) == 0);
  if (!request) return;
  const auto field = (*request)[boost::beast::http::field::cookie];
  if (const auto value = serve::cookie_of({field.data(), field.size()}, "canopus_8080")) {
    fuzz::expect(value->find(';') == std::string_view::npos);
  }
}

void look_at_users(std::string_view bytes) {
  if (const auto form = serve::read_form(bytes)) fuzz::expect(form->size() <= serve::most_form_fields);
  const auto users = serve::parse_web_users(bytes, "users");
  if (!users) return fuzz::expect(users.error().starts_with("users:"));
  for (const serve::WebAccount& user : *users) {
    fuzz::expect(serve::is_user_name(user.name) && serve::is_password_hash(user.hash));
    fuzz::expect(std::ranges::count(*users, user.name, &serve::WebAccount::name) == 1);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  look_at_request(bytes, {.address = "127.0.0.1", .port = 8080});
  look_at_request(bytes,
                  {.address = "0.0.0.0", .port = 8080, .origin = "https://plant.example", .has_users = true});
  look_at_users(bytes);
  if (const auto wish = serve::parse_client_message(bytes)) {
    fuzz::expect(wish->messages.has_value() + wish->views.has_value() + wish->command.has_value() == 1);
    fuzz::expect(!wish->views || wish->views->size() <= serve::ClientMessage::most_views);
  }
  return 0;
}
