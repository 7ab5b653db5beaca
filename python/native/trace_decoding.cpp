#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canopus/cli/analysis/analysis_names.hpp"
#include "canopus/cli/analysis/message_printer.hpp"
#include "canopus/cli/analysis/trace_walk.hpp"
#include "canopus/text/json.hpp"
#include "canopus/trace/decode/decoder.hpp"

#include "plant_run.hpp"

namespace canopus::python {
namespace {

[[noreturn]] void refuse(const cli::TextOutput& errors) {
  std::string text = errors.text();
  while (text.ends_with('\n')) text.pop_back();
  throw PlantProblem(text);
}

}  // namespace

std::string decode_trace(const std::string& path, const std::string& plant, const std::string& network,
                         const std::vector<std::string>& nodes, bool frames) {
  cli::TextOutput errors;
  cli::TextOutput lines;
  auto names = cli::load_names({.plant = plant, .network = network, .nodes = nodes}, errors);
  if (!names) refuse(errors);
  trace::Decoder decoder(std::move(*names), {.frames = frames, .transfers = !frames});
  std::vector<std::string> channels;
  const auto print = [&](const trace::Message& message) {
    lines.json(
        cli::to_json(message, message.channel < channels.size() ? channels[message.channel] : std::string()));
  };
  const int code =
      cli::walk_trace(path, errors, [&](const trace::TraceRecord& record, std::string_view channel) {
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
