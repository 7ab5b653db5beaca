// Any bytes as a trace: the first byte chooses the format (or lets the content say it), the rest is the file. What is
// read is a frame that a bus could carry, every call comes to an end, and each record can be written in every format
// and read again.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

#include "canopus/trace/file/reader_base.hpp"
#include "canopus/trace/file/trace_encoder.hpp"

namespace {

using namespace canopus::trace;

void require(bool condition) {
  if (!condition) std::abort();
}

/// A frame a bus can carry, as the header of can::Frame says.
void check(const TraceReader& reader, const TraceRecord& record) {
  const auto& frame = record.frame;
  require(record.channel < reader.channel_count());
  require(frame.dlc <= 15);
  require(frame.identifier <=
          (frame.extended ? canopus::can::max_extended_identifier : canopus::can::max_base_identifier));
  for (std::size_t i = frame.length(); i < frame.data.size(); ++i) require(frame.data[i] == 0);
}

void write_and_read(FileFormat format, std::string_view channel, const TraceRecord& record) {
  TraceEncoder encoder(format);
  std::string bytes(encoder.begin());
  bytes += encoder.encode(channel, record);
  bytes += encoder.end();
  auto reader = open_reader(TraceInput::from_memory("again", bytes), format);
  require(reader.has_value());
  const auto again = (*reader)->next();
  require(again && *again);
  require((*again)->error_frame == record.error_frame);
  require(record.error_frame || (*again)->frame == record.frame);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::optional<FileFormat> format;
  if (data[0] < format_names.size()) format = format_names[data[0]].format;
  std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  auto reader = open_reader(TraceInput::from_memory("fuzz", std::move(bytes)), format);
  if (!reader) {
    require(reader.error().starts_with("fuzz"));
    return 0;
  }
  // a record takes a byte at least, also of what zlib makes a thousand of
  for (std::size_t calls = 0;; ++calls) {
    require(calls <= size * 1100);
    const auto next = (*reader)->next();
    if (!next) {
      require(next.error().starts_with("fuzz"));
      continue;
    }
    if (!*next) break;
    check(**reader, **next);
    if (calls > 3) continue;
    for (const FormatName& entry : format_names) {
      if (!entry.is_written) continue;
      const std::string_view channel = (*reader)->channel((*next)->channel);
      write_and_read(entry.format, channel, **next);
    }
  }
  require(!(*reader)->next().value());  // the end stays the end
  return 0;
}
