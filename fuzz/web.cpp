// Heads of requests of any bytes to the web server: each gets one answer, and a file or a WebSocket only when it names this
// server. The same bytes as what a watcher says.

#include <cctype>
#include <string>
#include <string_view>

#include "canopus/serve/web/web_request.hpp"
#include "canopus/serve/web/web_wish.hpp"

#include "input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t length = serve::end_of_head(bytes);
  fuzz::expect(length <= bytes.size());
  const std::string_view head = length == 0 ? bytes : bytes.substr(0, length);
  const auto request = serve::read_head(head);
  const serve::WebAnswer answer = request ? serve::answer_to(*request, "127.0.0.1", 8080) : request.error();
  fuzz::expect(answer.status == 101 || answer.status == 200 || (answer.status >= 400 && answer.status < 600));
  const std::string text = serve::written(answer);
  fuzz::expect(text.starts_with("HTTP/1.1 "));
  if (answer.status == 101 || answer.status == 200) {
    fuzz::expect(head.size() <= serve::longest_web_head);
    std::string lower(head);
    for (char& letter : lower) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    fuzz::expect(lower.find("127.0.0.1:8080") != std::string::npos ||
                 lower.find("localhost:8080") != std::string::npos);
  }
  if (const auto wish = serve::read_wish(bytes)) {
    fuzz::expect(wish->messages.has_value() != wish->views.has_value());
    fuzz::expect(!wish->views || wish->views->size() <= serve::WebWish::most_views);
  }
  return 0;
}
