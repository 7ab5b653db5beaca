#include <cmath>
#include <limits>
#include <memory>

#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/bus/node_names.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/stop_signals.hpp"
#include "canopus/cli/trace/trace_input_file.hpp"
#include "canopus/cli/trace/trace_options.hpp"
#include "canopus/cli/trace/trace_player.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

struct ReplayOptions {
  BusOptions bus;
  std::string file, from, to;
  std::string speed = "1";
  std::uint64_t loops = 1;
  std::vector<std::string> identifiers, channels;
  std::string node;
  NodeNamesOptions names;
};

/// "601", "580-5FF", "18EBFF00x": both ends.
struct IdentifierRange {
  std::uint32_t first = 0, last = 0;
  bool extended = false;
};

std::optional<IdentifierRange> parse_range(std::string_view text) {
  IdentifierRange range;
  range.extended = text.ends_with('x');
  if (range.extended) text.remove_suffix(1);
  const std::size_t dash = text.find('-');
  const auto number = [&](std::string_view word, std::uint32_t& value) {
    const auto read = ascii::parse_number<std::uint32_t>(word, 16);
    value = read.value_or(0);
    return read && value <= (range.extended ? can::max_extended_identifier : can::max_base_identifier);
  };
  if (!number(text.substr(0, dash), range.first)) return std::nullopt;
  range.last = range.first;
  if (dash != std::string_view::npos && !number(text.substr(dash + 1), range.last)) return std::nullopt;
  if (range.last < range.first) return std::nullopt;
  return range;
}

/// Which records are sent.
struct Choice {
  std::vector<IdentifierRange> identifiers;
  /// Without --from there is none: a clock may have stepped back.
  can::Duration from = can::Duration::min();
  can::Duration to = can::Duration::max();
  unsigned node = 0;

  [[nodiscard]] bool wants(const trace::TraceRecord& record, can::Duration since) const {
    if (record.error_frame || since < from || since > to) return false;
    if (node != 0 && !is_for_node(record.frame)) return false;
    return identifiers.empty() || std::ranges::any_of(identifiers, [&](const IdentifierRange& range) {
             return record.frame.extended == range.extended && record.frame.identifier >= range.first &&
                    record.frame.identifier <= range.last;
           });
  }
  /// The frames that the node receives in the pre-defined connection set [CiA 301 7.3.3]: NMT, SYNC, TIME,
  /// its RPDOs, its SDO server, node guarding, LSS.
  [[nodiscard]] bool is_for_node(const can::Frame& frame) const {
    if (frame.extended) return false;
    switch (frame.identifier) {
      case 0x000: return frame.length() < 2 || frame.data[1] == 0 || frame.data[1] == node;
      case 0x080:
      case 0x100:
      case 0x7E5: return true;
      default: break;
    }
    if ((frame.identifier & 0x7FU) != node) return false;
    switch (frame.identifier & 0x780U) {
      case 0x200:
      case 0x300:
      case 0x400:
      case 0x500:
      case 0x600: return true;
      case 0x700: return frame.remote;
      default: return false;
    }
  }
};

std::expected<Choice, std::string> choice_of(const ReplayOptions& options) {
  Choice choice;
  for (const std::string& text : options.identifiers) {
    const auto range = parse_range(text);
    if (!range) {
      return std::unexpected(
          fmt::format("--can-id: \"{}\" is no CAN-ID; expected for example 601, 580-5FF or 18EBFF00x", text));
    }
    choice.identifiers.push_back(*range);
  }
  for (const auto& [text, name, value] :
       {std::tuple{&options.from, "--from", &choice.from}, std::tuple{&options.to, "--to", &choice.to}}) {
    if (text->empty()) continue;
    const auto duration = text::parse_duration(*text);
    if (!duration) return std::unexpected(fmt::format("{}: {}", name, duration.error()));
    *value = *duration;
  }
  if (!options.from.empty() && choice.from > choice.to) {
    return std::unexpected(std::string("--from is later than --to"));
  }
  if (!options.node.empty()) {
    const auto node = find_node_id(options.names, options.node);
    if (!node) return std::unexpected(node.error().empty() ? node.error() : "--node: " + node.error());
    choice.node = *node;
  }
  return choice;
}

/// 0 for max; nothing if it is no speed.
std::optional<double> parse_speed(std::string_view text) {
  if (text == "max") return 0;
  const auto speed = ascii::parse_number<double>(text);
  return speed && *speed >= 0.001 && *speed <= 1e6 ? speed : std::nullopt;
}

/// A bus that takes nothing for so long is not waited for any more.
constexpr can::Duration standstill = std::chrono::seconds(10);

/// Longest time in which a server's buffers are sent on a slow bus.
constexpr can::Duration flush_time = std::chrono::seconds(60);

/// Waits until what was sent is on the bus, as long as it gets on.
BusLoop::End wait_for_sent(BusLoop& bus) {
  while (true) {
    const std::size_t before = bus.under_way();
    const auto end =
        bus.run([&] { return bus.under_way() == 0 || bus.under_way() < before; }, bus.now() + standstill);
    if (end != BusLoop::End::done) return end;
    if (bus.under_way() == 0) return bus.run([&] { return bus.is_flushed(); }, bus.now() + flush_time);
  }
}

/// The time without progress of a bus that accepts no frames.
class Standstill {
 public:
  /// True when it is too long. Call it periodically.
  bool is_too_long(const BusLoop& bus, const TracePlayer& player) {
    const bool gets_on = !player.is_held() || player.sent() != sent_ || bus.under_way() != under_way_;
    sent_ = player.sent();
    under_way_ = bus.under_way();
    if (gets_on || !since_) since_ = bus.now();
    return bus.now() - *since_ >= standstill;
  }

 private:
  std::optional<can::Time> since_;
  std::uint64_t sent_ = 0;
  std::size_t under_way_ = 0;
};

/// Sends the trace once. `sent` goes on from where it was. time_over: the bus does not take the rest.
BusLoop::End play(BusLoop& bus, TraceInputFile& in, const Choice& choice, ChannelChoice& channels,
                  double speed, std::uint64_t& sent) {
  std::optional<can::Time> first;
  TracePlayer player(
      bus,
      [&]() -> std::optional<TracePlayer::Step> {
        while (const auto record = in.next()) {
          if (!first) first = record->time;
          const can::Duration since = record->time - *first;
          const bool is_of_channel = channels.wants(in.reader().channel(record->channel));
          if (is_of_channel && choice.wants(*record, since)) {
            return TracePlayer::Step{since, record->frame};
          }
        }
        return std::nullopt;
      },
      speed);
  const bool progress = is_terminal(STDERR_FILENO);
  bus.add(player);
  // what was left out at the begin is not waited for
  player.start(bus.now(), std::max(choice.from, can::Duration::zero()));
  BusLoop::End end = BusLoop::End::time_over;
  Standstill still;
  while (end == BusLoop::End::time_over && !still.is_too_long(bus, player)) {
    if (progress) {
      show_progress(Line("{:.1f} s, {}", can::seconds(can::Time(player.position())),
                         ascii::counted(sent + player.sent(), "frame")));
    }
    end = bus.run([&] { return player.is_done(); }, bus.now() + std::chrono::milliseconds(200));
  }
  bus.remove(player);
  sent += player.sent();
  return end;
}

int replay(const ReplayOptions& options) {
  const auto choice = choice_of(options);
  if (!choice && choice.error().empty()) return exit_code::usage;  // the mistakes of a file were printed
  if (!choice) return complain(exit_code::usage, choice.error());
  const auto speed = parse_speed(options.speed);
  if (!speed) {
    return complain(exit_code::usage,
                    fmt::format("--speed: \"{}\" is no speed; expected a number such as 2 or 0.5, or max",
                                options.speed));
  }
  if (options.file == "-" && options.loops != 1) {
    return complain(exit_code::usage, "--loop: the standard input can be read only once");
  }
  StopWatch stop(HangUp::left_alone);
  const auto open = [&] {
    return TraceInputFile::open(options.file, {}, standard_error(), [&stop] { return !stop.came(); });
  };
  auto in = open();
  if (!in) return exit_code::usage;
  if (stop.came()) return exit_code::done;
  return with_bus(
      options.bus,
      [&](BusLoop& bus, can::Duration) {
        const can::Time started = bus.now();
        bool complained = false;
        bus.set_complaint([&complained](std::string_view text) {
          complained = true;
          print_error("canopus: the bus: {}", text);
        });
        std::uint64_t sent = 0;
        std::uint64_t mistakes = 0;
        bool is_read = true;
        auto end = BusLoop::End::done;
        ChannelChoice channels(options.channels);
        for (std::uint64_t loop = 0;
             end == BusLoop::End::done && (options.loops == 0 || loop < options.loops); ++loop) {
          const std::uint64_t before = sent;
          if (loop > 0) in = open();
          if (!in) return exit_code::failed;
          end = play(bus, *in, *choice, channels, *speed, sent);
          mistakes += in->mistakes();
          if (loop == 0) is_read = in->finish();
          if (sent == before || stop.came()) break;  // nothing to send: once is enough
        }
        const bool is_played = end == BusLoop::End::done;
        if (is_played) end = wait_for_sent(bus);
        end_progress();
        const std::size_t waiting = bus.under_way();
        print_line("{} sent in {:.3f} s",
                   ascii::counted(sent - std::min<std::uint64_t>(sent, waiting), "frame"),
                   can::seconds(bus.now()) - can::seconds(started));
        const bool all_channels = !is_played || channels.report_missing(standard_error());
        // Ctrl-C is how one ends a replay
        if (end == BusLoop::End::lost) return complain(exit_code::failed, bus.failure());
        if (end == BusLoop::End::time_over && is_played && waiting == 0) {
          return complain(exit_code::failed, "the other side does not say that the bus took all frames");
        }
        if (end == BusLoop::End::time_over) {
          return complain(
              exit_code::failed,
              fmt::format("the bus has taken nothing for {} s; not sent: {}{}",
                          std::chrono::duration_cast<std::chrono::seconds>(standstill).count(),
                          ascii::counted(waiting, "frame"), is_played ? "" : " and the rest of the trace"));
        }
        if (complained)
          return complain(exit_code::failed, "the bus reported errors: frames may be missing on it");
        return mistakes == 0 && is_read && all_channels ? exit_code::done : exit_code::failed;
      },
      BusTime::real);
}

void build_replay_command(Command& command, int& exit_code) {
  const auto options = std::make_shared<ReplayOptions>();
  command.add_option("FILE", options->file, "Trace in any format that is read; - is the standard input")
      ->required();
  add_bus_options(command, options->bus, "How long to wait for the bus at the start", false);
  command
      .add_option("--speed", options->speed,
                  "2 is twice as fast; max is as fast as the bus accepts the frames")
      ->type_name("N|max")
      ->capture_default_str();
  command.add_option("--loop", options->loops, "How often; 0 until Ctrl-C")
      ->type_name("N")
      ->capture_default_str()
      ->check(number_from(0, std::numeric_limits<std::uint32_t>::max()));
  command.add_option("--from", options->from, "Begin this long after the first frame")->type_name("TIME");
  command.add_option("--to", options->to, "End this long after the first frame")->type_name("TIME");
  command
      .add_option("--can-id", options->identifiers,
                  "Only these CAN-IDs: 601, 580-5FF, 18EBFF00x; may be given again")
      ->type_name("ID");
  command.add_old_spelling({.old = "--id", .now = "--can-id"});
  command.add_option("--channel", options->channels, "Only this channel of the trace; may be given again")
      ->type_name("NAME");
  command
      .add_option("--node", options->node,
                  "Only what this node receives: NMT, SYNC, TIME, its RPDOs, its SDO server, guarding, LSS")
      ->type_name("NODE");
  add_node_names_options(command, options->names, "names of nodes, for --node");
  command.footer(
      "Each frame is sent at its time since the first one; error frames are not sent. All channels go to one "
      "bus.\n"
      "Exit codes: 0 sent, or ended by Ctrl-C; 1 the bus was lost, reported errors or accepts no more, parts "
      "of the "
      "trace\n"
      "could not be read, or a --channel is not in it; 2 wrong command line or file.\n"
      "\n"
      "Example: canopus replay drive.blf --bus socketcan:can0 --node 5 --speed 2");
  command.callback([options, &exit_code] { exit_code = replay(*options); });
}

}  // namespace

void add_replay_command(Command& app, int& exit_code) {
  app.add_subcommand("replay", "Send the frames of a trace on a bus",
                     [&exit_code](Command& command) { build_replay_command(command, exit_code); });
}

}  // namespace canopus::cli
