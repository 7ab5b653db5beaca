// Any text as a line of a candump log: a frame that is written and read again is the same, an error points
// into the line.

#include "canopus/trace/file/candump_log.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus::trace;
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  const auto entry = read_candump_line(line);
  if (!entry) {
    if (entry.error().column < 1 || entry.error().column > size + 1) std::abort();
    return 0;
  }
  if (entry->error_frame) return 0;
  std::array<char, candump_max_line> text;
  const std::size_t length = write_candump_line(text, entry->channel, entry->frame, entry->time);
  const auto again = read_candump_line({text.data(), length});
  if (!again || again->frame != entry->frame) std::abort();
  return 0;
}
