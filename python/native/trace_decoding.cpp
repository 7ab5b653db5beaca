#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canopus/text/json.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/print/message_printer.hpp"
#include "canopus/trace/print/trace_walk.hpp"

#include "node_names.hpp"
#include "plant_run.hpp"

namespace canopus::python {
std::string decode_trace(const std::string& path, const std::string& plant, const std::string& network,
                         const std::vector<std::string>& nodes, bool frames) {
  text::TextOutput errors;
  text::TextOutput lines;
  trace::Decoder decoder(node_names(plant, network, nodes), {.frames = frames, .transfers = !frames});
  std::vector<std::string> channels;
  const auto print = [&](const trace::Message& message) {
    lines.json(trace::to_json(message,
                              message.channel < channels.size() ? channels[message.channel] : std::string()));
  };
  const int code =
      trace::walk_trace(path, errors, [&](const trace::TraceRecord& record, std::string_view channel) {
        if (record.channel >= channels.size()) channels.resize(record.channel + 1U);
        if (channels[record.channel].empty()) channels[record.channel] = channel;
        decoder.receive(record, channel, print);
        return true;
      });
  if (code != 0) refuse(errors);
  decoder.finish(print);
  return lines.text();
}

}  // namespace canopus::python
