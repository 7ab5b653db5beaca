// Any bytes as a message of the page: what it wants to be done becomes a command line in which nothing that it says is an option of
// its own, or is refused with a sentence.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "canopus/text/json.hpp"
#include "canopus/web/commands/arguments.hpp"
#include "canopus/web/server/client_message.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  const auto wish = web::parse_client_message({reinterpret_cast<const char*>(data), size});
  if (!wish || !wish->command) return 0;
  const web::WebBus bus{
      .name = "a", .project = "PROJECT", .network = 2, .address = "BUS", .device_files = {"EDS"}};
  const web::WebSettings settings{.file = "SETTINGS", .model = "RJ71CN91", .plc = {"--host=HOST"}};
  const auto said = text::parse_json(wish->command->text).value();
  const bool is_of_settings = said.is_object() && said.contains("settings");
  const auto line = is_of_settings ? web::web_command_line(said, settings) : web::web_command_line(said, bus);
  if (!line) {
    if (line.error().empty()) std::abort();
    return 0;
  }
  const auto& words = line->arguments;
  const auto end = std::ranges::find(words, "--");
  if (end == words.end()) std::abort();
  // Before the end of the options: the command's own words, and options with a value of which no other option can be made.
  for (auto word = words.begin(); word != end; ++word) {
    if (word->contains('\0')) std::abort();
    const bool is_option = word->starts_with("--");
    const bool is_word =
        std::ranges::all_of(*word, [](char c) { return (c >= 'a' && c <= 'z') || c == '-'; });
    if (!is_option && !is_word) std::abort();
  }
  if (std::ranges::count_if(words.begin(), end,
                            [](const std::string& word) { return word.starts_with("--bus="); }) > 1)
    std::abort();
  if (web::shown_command(words).empty()) std::abort();
  return 0;
}
