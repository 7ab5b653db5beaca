// Any bytes as a message of the page: a command becomes a command line in which none of its fields is an option of its own, or is
// refused with a sentence; so are lists of frames and the form of a new plant.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "canopus/text/json.hpp"
#include "canopus/web/commands/arguments.hpp"
#include "canopus/web/commands/frame_sending.hpp"
#include "canopus/web/commands/new_plant.hpp"
#include "canopus/web/server/client_message.hpp"

namespace {

using namespace canopus;

/// What has no command line: lists of frames and of devices are within their limits, or refused with a sentence.
void check_lists(const text::Json& wish) {
  const auto frames = web::FrameList::parse(wish);
  if (!frames && frames.error().empty()) std::abort();
  if (frames &&
      (frames->frames.empty() || frames->frames.size() * frames->repeat > web::FrameList::most_sent))
    std::abort();
  const auto plant = web::NewPlant::parse(wish, true);
  if (!plant && plant.error().empty()) std::abort();
  if (!plant) return;
  for (const web::NewDevice& device : plant->devices)
    if (device.node == 0 || device.node > 127 || device.file.contains('/') || device.file.starts_with('.'))
      std::abort();
  if (const auto text = plant->plant_text("a"); text && !text->contains("[[bus]]")) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto wish = web::parse_client_message({reinterpret_cast<const char*>(data), size});
  if (!wish || !wish->command) return 0;
  const web::WebBus bus{
      .name = "a", .project = "PROJECT", .network = 2, .address = "BUS", .device_files = {"EDS"}};
  const web::WebSettings settings{.file = "SETTINGS", .model = "RJ71CN91", .plc = {"--plc=HOST"}};
  const auto said = text::parse_json(wish->command->text).value();
  if (said.is_object()) check_lists(said);
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
