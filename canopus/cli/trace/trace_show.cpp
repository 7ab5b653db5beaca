#include <memory>
#include <optional>

#include <unistd.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/trace/trace_options.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/filter/filter_expression.hpp"
#include "canopus/trace/print/message_printer.hpp"
#include "canopus/trace/print/trace_walk.hpp"

namespace canopus::cli {
namespace {

struct ShowOptions {
  std::string file{};
  NamesOptions names{};
  trace::FilterOptions filter{};
  std::string time = "z";
  bool frames = false;
  bool json = false;
};

int show(const ShowOptions& options) {
  auto names = load_names(options.names, standard_error());
  const auto filter = trace::MessageFilter::make(options.filter, standard_error());
  const auto expression = trace::FilterExpression::make(options.filter, standard_error());
  if (!names || !filter || !expression) return 2;
  trace::Decoder decoder(std::move(*names), {.frames = options.frames, .transfers = !options.frames});
  trace::MessagePrinter printer({.time = static_cast<trace::TimeColumn>(options.time.front()),
                                 .frames = options.frames,
                                 .json = options.json,
                                 .colour = wants_colour(STDOUT_FILENO)},
                                standard_output());
  std::optional<can::Time> zero;
  ChannelChoice choice(options.filter.channels);
  std::vector<std::string> channels;
  bool is_any_shown = false;
  const auto print = [&](const trace::Message& message) {
    const std::string_view channel =
        message.channel < channels.size() ? std::string_view(channels[message.channel]) : std::string_view();
    const can::Duration since = message.time - *zero;
    if (filter->wants(message, since) &&
        expression->wants(message, channel, since, [&] { return trace::searched_text(message, channel); })) {
      printer.print(message, channel);
      is_any_shown = true;
    }
  };
  const int code = trace::walk_trace(options.file, standard_error(),
                                     [&](const trace::TraceRecord& record, std::string_view channel) {
                                       if (!zero) printer.set_zero(*(zero = record.time));
                                       if (filter->is_over(record.time - *zero)) return false;
                                       if (record.channel >= channels.size())
                                         channels.resize(record.channel + 1U);
                                       if (channels[record.channel].empty())
                                         channels[record.channel] = channel;
                                       if (choice.wants(channel)) decoder.receive(record, channel, print);
                                       return true;
                                     });
  if (code == 2) return code;
  decoder.finish(print);
  if (!choice.report_missing(standard_error())) return 1;
  if (zero && !is_any_shown) standard_error().line("canopus: the trace has no such message");
  return code;
}

}  // namespace

void add_trace_show(Command& trace, int& exit_code) {
  const auto options = std::make_shared<ShowOptions>();
  Command* command = trace.add_subcommand("show", "Decode the frames of a trace");
  command->add_option("FILE", options->file, "Trace in any format that is read; - is the standard input")
      ->required();
  add_names_options(*command, options->names);
  add_filter_options(*command, options->filter, true);
  command
      ->add_option("-t,--time", options->time,
                   "Time column: z since the first frame, a absolute, d since the line before, A date")
      ->type_name("z|a|d|A")
      ->check(one_of_words({"z", "a", "d", "A"}))
      ->capture_default_str();
  command->add_flag("--frames", options->frames, "Every frame with its bytes; SDO transfers are not folded");
  command->add_flag("--json", options->json, "Print JSON, one object per line");
  command->footer(
      "An SDO transfer is one line, at the time of its last frame. PDO mappings, COB-IDs and times come "
      "from\n"
      "the files given, and are learnt from the SDO traffic in the trace itself.\n"
      "Exit codes: 0 shown, 1 the trace cannot be read to its end or has not the --channel, 2 wrong command "
      "line or file.");
  command->callback([options, &exit_code] { exit_code = show(*options); });
}

}  // namespace canopus::cli
