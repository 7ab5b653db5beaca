#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/files/given_file.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/master/network_master.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using manager::BootRecord;
using manager::BootStep;

struct MasterArguments {
  BusOptions bus;
  std::string network;
  std::string duration;
  bool stay = false;
  bool quiet = false;
};

std::string_view state_name(std::uint8_t state) {
  switch (state) {
    case manager::node_state::missing: return "missing";
    case manager::node_state::stopped: return "stopped";
    case manager::node_state::operational: return "operational";
    case manager::node_state::pre_operational: return "pre-operational";
    default: return "unknown";
  }
}

std::string_view describe(manager::ErrorControlEvent event) {
  switch (event) {
    case manager::ErrorControlEvent::heartbeat_lost: return "its heartbeat is lost";
    case manager::ErrorControlEvent::node_lost: return "it does not answer guarding";
    case manager::ErrorControlEvent::unexpected_state: return "it is not in the state it was commanded to";
  }
  return "";
}

/// Lines of progress, for people or programs.
class Printer final : public master::NetworkObserver {
 public:
  Printer(bool json, bool quiet, bool colour) : json_(json), quiet_(quiet), colour_(colour) {}

  void boot_went_on(const master::NetworkSlave& slave, const BootRecord& record, can::Time now) override {
    if (record.step == BootStep::idle) return;
    if (json_) return event("step", slave, now, boot_fields(record, now));
    line(slave, now, manager::describe(record), "2");
  }
  void slave_booted(const master::NetworkSlave& slave, can::Time now) override {
    if (json_) return event("booted", slave, now, {});
    line(slave, now, "booted", "32");
  }
  void slave_failed(const master::NetworkSlave& slave, const BootRecord& record, can::Time now) override {
    if (json_) return event("failed", slave, now, boot_fields(record, now));
    line(slave, now, manager::describe(record), "31");
  }
  void state_changed(const master::NetworkSlave& slave, std::uint8_t state, can::Time now) override {
    if (state == manager::node_state::unknown) return;
    if (json_) return event("state", slave, now, {{"state", state_name(state)}});
    line(slave, now, std::string(state_name(state)), "36");
  }
  void error_control_event(const master::NetworkSlave& slave, manager::ErrorControlEvent what,
                           can::Time now) override {
    if (json_) return event("error control", slave, now, {{"what", describe(what)}});
    line(slave, now, std::string(describe(what)), "31");
  }
  void error_control_resolved(const master::NetworkSlave& slave, can::Time now) override {
    if (json_) return event("heard again", slave, now, {});
    line(slave, now, "is back", "32");
  }

  void master_changed(bool is_own, std::uint8_t master, can::Time now) override {
    if (json_) {
      return print_json(
          {{"event", "master"}, {"time", can::seconds(now)}, {"active", is_own}, {"node", master}});
    }
    if (quiet_) return;
    print_line("{:12.6f}  {}", can::seconds(now), describe_master(is_own, master));
  }

  /// Prints the state of every node. True when the network is as configured.
  bool summary(const master::NetworkMaster& network, can::Time now) {
    bool good = true;
    bool stands_by = false;
    unsigned booted = 0;
    for (const master::NetworkSlave& slave : network.slaves()) {
      const auto result = network.result(slave);
      const BootRecord& record = network.master().boot_record(slave.node);
      if (result == master::NetworkMaster::Result::booted) ++booted;
      if (result == master::NetworkMaster::Result::left_to_the_active_master) stands_by = true;
      if (result == master::NetworkMaster::Result::failed ||
          result == master::NetworkMaster::Result::given_up)
        good = false;
      print_result(slave, result, record, network.master().node_state(slave.node), now);
    }
    const manager::NmtMaster& master = network.master();
    if (json_) {
      print_json({{"event", "summary"},
                  {"time", can::seconds(now)},
                  {"active", master.active()},
                  {"slaves", network.slaves().size()},
                  {"booted", booted},
                  {"good", good}});
    } else if (stands_by) {
      print_line("{}", describe_master(false, master.active_master()));
    } else {
      print_line("{} of {} booted", booted, ascii::counted(network.slaves().size(), "slave"));
    }
    return good;
  }

 private:
  static std::string describe_master(bool is_own, std::uint8_t master) {
    if (is_own) return "this node is the active master";
    if (master == 0) return "there is no active master yet";
    return fmt::format("node {} is the active master, this one stands by", master);
  }
  static text::Json boot_fields(const BootRecord& record, can::Time now) {
    text::Json fields = text::Json::object();
    plant::add_boot(fields, record, now);
    return fields;
  }

  void print_result(const master::NetworkSlave& slave, master::NetworkMaster::Result result,
                    const BootRecord& record, std::uint8_t state, can::Time now) {
    switch (result) {
      case master::NetworkMaster::Result::booted:
        if (!json_ && !quiet_) {
          print_line("{}: {}, {}", master::describe(slave), paint("booted", "32", colour_),
                     state_name(state));
        } else if (json_) {
          event("result", slave, now, {{"result", "booted"}, {"state", state_name(state)}});
        }
        return;
      case master::NetworkMaster::Result::absent:
        if (json_) return event("result", slave, now, {{"result", "absent"}});
        if (!quiet_) print_line("{}: {} (optional)", master::describe(slave), paint("absent", "33", colour_));
        return;
      case master::NetworkMaster::Result::given_up:
        if (json_) return event("result", slave, now, {{"result", "given up"}});
        if (!quiet_) {
          print_line("{}: {}, another slave ended the start-up", master::describe(slave),
                     paint("given up", "33", colour_));
        }
        return;
      case master::NetworkMaster::Result::left_to_the_active_master: return;
      case master::NetworkMaster::Result::failed: break;
    }
    if (json_) {
      text::Json fields = boot_fields(record, now);
      fields["result"] = "failed";
      return event("result", slave, now, std::move(fields));
    }
    const std::string reason = manager::explain(record, now);
    print_line("{}: {}: {}", master::describe(slave), paint("not booted", "31", colour_), reason);
  }

  void line(const master::NetworkSlave& slave, can::Time now, const std::string& text,
            std::string_view colour) {
    if (quiet_) return;
    print_line("{:12.6f}  {}: {}", can::seconds(now), master::describe(slave), paint(text, colour, colour_));
  }
  void event(const char* name, const master::NetworkSlave& slave, can::Time now, text::Json more) {
    text::Json object{{"event", name}, {"time", can::seconds(now)}, {"node", slave.node}};
    if (!slave.name.empty()) object["name"] = slave.name;
    for (const auto& [key, value] : more.items()) object[key] = value;
    print_json(object);
  }

  bool json_;
  bool quiet_;
  bool colour_;
};

std::optional<master::NetworkFile> read_network_file(const std::string& path) {
  master::NetworkReading reading;
  const FileKind kind = kind_of_file(path);
  if (kind != FileKind::network && kind != FileKind::project && kind != FileKind::unknown) {
    complain(exit_code::usage, describe_given_file(path, kind));
    return std::nullopt;
  }
  if (kind == FileKind::project) {
    std::error_code ignored;
    const bool is_folder = std::filesystem::is_directory(path, ignored);
    reading =
        master::read_project(is_folder ? (std::filesystem::path(path) / "nodelist.cpj").string() : path);
  } else {
    const auto text = text::read_file(path);
    if (!text) {
      complain(exit_code::usage, text.error());
      return std::nullopt;
    }
    reading = master::read_network(*text, path);
  }
  for (const text::FileError& error : reading.errors) print_error("{}", describe(error, path));
  if (!reading.errors.empty()) return std::nullopt;
  return std::move(reading.network);
}

/// A bus that takes nothing: the network is built once before the bus is joined, so that a wrong file is reported
/// without one.
class NoBus final : public can::Sink {
 public:
  bool send(const can::Frame&) override { return false; }
};

int boot(const MasterArguments& arguments) {
  std::optional<can::Duration> duration;
  if (!arguments.duration.empty()) {
    const auto parsed = text::parse_duration(arguments.duration);
    if (!parsed) return complain(exit_code::usage, "--for: " + parsed.error());
    duration = *parsed;
  }
  auto file = read_network_file(arguments.network);
  if (!file) return exit_code::usage;
  constexpr can::Duration default_boot_time = std::chrono::seconds(30);
  if (!file->boot_time) file->boot_time = duration && !arguments.stay ? *duration : default_boot_time;

  Printer printer(arguments.bus.json, arguments.quiet, !arguments.bus.json && wants_colour(STDOUT_FILENO));
  NoBus no_bus;
  if (const auto trial = master::NetworkMaster::build(*file, no_bus, printer); !trial) {
    for (const text::FileError& error : trial.error()) print_error("{}", describe(error, file->path));
    return exit_code::usage;
  }
  const auto boot_on = [&](BusLoop& bus, can::Duration time_out) -> int {
    auto network = master::NetworkMaster::build(*file, bus, printer);
    if (!network) return complain(exit_code::failed, "a device file changed meanwhile");
    master::NetworkMaster& master = **network;
    master.set_sdo_time_out(time_out);
    bus.add(master);
    const can::Time end = duration ? can::later(bus.now(), *duration) : can::never;
    master.power_on(bus.now());
    BusLoop::End how = bus.run([&] { return master.start_up_over(); }, end);
    if (how == BusLoop::End::done && arguments.stay) how = bus.run([] { return false; }, end);
    const bool good = printer.summary(master, bus.now());
    bus.remove(master);
    if (how == BusLoop::End::lost) return complain(exit_code::failed, bus.failure());
    if (how == BusLoop::End::interrupted && !arguments.stay) {
      return complain(exit_code::failed, "interrupted");
    }
    return good ? exit_code::done : exit_code::failed;
  };
  return with_bus(arguments.bus, boot_on, BusTime::real);
}

void build_master_command(Command& command, int& exit_code) {
  const auto arguments = std::make_shared<MasterArguments>();
  command
      .add_option("FILE", arguments->network,
                  "Network file (TOML, see docs/commands.md), or a project: its folder, or its nodelist.cpj")
      ->required();
  command.add_old_spelling({.old = "--dcf", .now = ""});
  command.add_flag("--stay", arguments->stay, "Stay the network's master, until Ctrl-C or the end of --for");
  command.add_option("--for", arguments->duration, "End after this time, for example 10s")->type_name("TIME");
  auto* quiet = command.add_flag("-q,--quiet", arguments->quiet, "Print failures and the last line alone");
  add_bus_options(command, arguments->bus, "for each SDO answer of a slave");
  quiet->excludes(command.get_option("--json"));
  command.footer(
      "Without --stay it ends when the start-up is over; the slaves stay as they are.\n"
      "Exit code: 0 all mandatory slaves booted and no slave failed, 1 some did not, or no bus, 2 wrong file "
      "or "
      "usage.\n"
      "Example: canopus master network.toml --bus socketcan:can0");
  command.callback([arguments, &exit_code] { exit_code = boot(*arguments); });
}

}  // namespace

void add_master_command(Command& app, int& exit_code) {
  app.add_subcommand("master", "Boot a network as its NMT master, without a PLC",
                     [&exit_code](Command& command) { build_master_command(command, exit_code); });
}

}  // namespace canopus::cli
