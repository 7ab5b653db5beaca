// Any records: the decoder says something of each frame, keeps what it keeps bounded, and ends every transfer
// once. 12 octets are a record: channel and flags, 3 octets of identifier, 8 of data.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/report/statistics.hpp"
#include "canopus/trace/report/trace_picture.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  trace::Decoder decoder({}, {.frames = true});
  trace::Statistics statistics;
  trace::TracePicture picture({});
  can::Time now{};
  std::size_t frames = 0;
  const auto add_message = [&](const trace::Message& message) {
    if (message.kind.empty() || message.data.size() > trace::most_sdo_data) std::abort();
    if (!message.is_transfer) ++frames;
    statistics.message(message, decoder);
    picture.message(message);
  };
  for (; size >= 12; data += 12, size -= 12) {
    trace::TraceRecord record{.channel = static_cast<std::uint16_t>(data[0] & 1U)};
    record.transmitted = (data[0] & 2U) != 0;
    record.error_frame = (data[0] & 4U) != 0;
    record.frame.extended = (data[0] & 8U) != 0;
    record.frame.remote = (data[0] & 16U) != 0;
    record.frame.identifier =
        (data[1] | data[2] << 8 | data[3] << 16) &
        (record.frame.extended ? can::max_extended_identifier : can::max_base_identifier);
    record.frame.dlc = (data[0] & 32U) != 0 ? data[3] & 0x0FU : 8;
    for (std::size_t i = 0; i < record.frame.length(); ++i) record.frame.data[i] = data[4 + i];
    now += std::chrono::microseconds(100 << (data[0] >> 6 & 3U) * 4);
    record.time = now;
    statistics.record(record, "can0");
    const std::size_t before = frames;
    decoder.receive(record, "can0", add_message);
    if (frames != before + 1) std::abort();
  }
  decoder.finish(add_message);
  statistics.finish();
  if (!picture.svg("fuzz").ends_with("</svg>\n")) std::abort();
  return 0;
}
