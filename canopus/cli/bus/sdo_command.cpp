#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <ranges>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/bus/sdo_names.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/device_names.hpp"
#include "canopus/client/sdo_request.hpp"
#include "canopus/client/sdo_transfer_on_bus.hpp"
#include "canopus/client/sdo_value.hpp"
#include "canopus/text/byte_size.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {
namespace {

struct SdoArguments {
  BusOptions bus;
  std::string node;
  std::string object;
  std::string type;
  std::string value;
  std::string file;
  SdoNamesOptions names;
  std::string limit = "16M";
  bool raw = false;
  bool block = false;
};

using client::SdoTarget;

std::expected<SdoTarget, std::string> target_of(const SdoArguments& arguments) {
  return find_sdo_target(arguments.names, arguments.node, arguments.object, arguments.type);
}

/// The mistakes of a file have been printed where there is no sentence.
int complain_of_usage(const std::string& sentence) {
  return sentence.empty() ? exit_code::usage : complain(exit_code::usage, sentence);
}

/// How fast it went; of what goes in one frame nobody asks.
void print_speed(const client::SdoSpeed& speed) {
  if (speed.form != client::SdoSpeed::Form::expedited) print_line("  {}", client::describe(speed));
}

/// Bytes passed so far, on a terminal's stderr, once a transfer takes longer than a moment.
class ProgressLine {
 public:
  explicit ProgressLine(const BusLoop& bus) : bus_(bus), next_(bus.now() + std::chrono::milliseconds(500)) {}
  ~ProgressLine() {
    if (shown_) end_progress();
  }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(std::size_t bytes, std::size_t of) {
    if (bus_.now() < next_ || !is_terminal(STDERR_FILENO)) return;
    next_ = bus_.now() + std::chrono::milliseconds(100);
    shown_ = true;
    show_progress(of == 0 ? Line("{}", ascii::counted(bytes, "byte"))
                          : Line("{} of {}, {} %", bytes, ascii::counted(of, "byte"), bytes * 100 / of));
  }

 private:
  const BusLoop& bus_;
  can::Time next_;
  bool shown_ = false;
};

int failed(const SdoArguments& arguments, const SdoTarget& target, const client::SdoFailure& failure) {
  if (arguments.bus.json) {
    print_json(client::row_of(target, failure));
    return exit_code::failed;
  }
  return complain(exit_code::failed,
                  fmt::format("node {}, {}: {}", target.node, target.object_text(), failure.reason));
}

int print_value(const SdoArguments& arguments, const SdoTarget& target, std::span<const std::uint8_t> came,
                const client::SdoSpeed& speed) {
  const auto [bytes, remark] = client::value_of(came, speed, target.type);
  if (!remark.empty() && !arguments.bus.json)
    print_error("canopus: warning: node {}, {}: {}", target.node, target.object_text(), remark);
  if (arguments.raw) {
    standard_output().content({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return exit_code::done;
  }
  if (!arguments.file.empty()) {
    std::FILE* out = std::fopen(arguments.file.c_str(), "wb");
    const bool written = out != nullptr && std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
    int reason = errno;
    const bool closed = out == nullptr || std::fclose(out) == 0;
    if (written && !closed) reason = errno;
    if (!written || !closed) {
      return complain(exit_code::failed,
                      fmt::format("cannot write {}: {}", arguments.file, std::strerror(reason)));
    }
    print_line("{}  {} in {}", target.object_text(), ascii::counted(bytes.size(), "byte"), arguments.file);
    print_speed(speed);
    return exit_code::done;
  }
  if (arguments.bus.json) {
    print_json(client::row_of(target, came, speed));
    return exit_code::done;
  }
  if (client::is_domain(target, bytes)) {
    const auto lines = client::lines_of(client::words_of(target, bytes));
    print_line("{}  {}", target.object_title(), lines.front());
    for (const std::string& line : lines | std::views::drop(1)) print_line("{}", line);
    print_speed(speed);
    return exit_code::done;
  }
  if (!target.type) {
    print_line("{}  {}", target.object_title(), client::show_bytes(bytes));
    return exit_code::done;
  }
  const auto shown = client::show_value(target, bytes);
  if (!shown) {
    return complain(exit_code::failed,
                    fmt::format("node {}, {}: {}", target.node, target.object_text(), shown.error()));
  }
  print_line("{}  {}", target.object_title(), *shown);
  return exit_code::done;
}

/// A size is 32 bits wide in an SDO.
std::expected<std::size_t, std::string> limit_of(const SdoArguments& arguments) {
  constexpr std::uint64_t most = 0xFFFFFFFF;
  const auto limit = text::parse_byte_size(arguments.limit);
  if (!limit) return std::unexpected("--limit: " + limit.error());
  if (*limit > most)
    return std::unexpected(fmt::format("--limit {}: expected at most 4095M", arguments.limit));
  return static_cast<std::size_t>(*limit);
}

int read(const SdoArguments& arguments) {
  const auto target = target_of(arguments);
  if (!target) return complain_of_usage(target.error());
  const auto limit = limit_of(arguments);
  if (!limit) return complain(exit_code::usage, limit.error());
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    bus.need({link::IdentifierFilter::only(canopen::cob_id::sdo_response + target->node)});
    client::SdoOnBus sdo(bus, target->node, time_out, arguments.block);
    sdo.set_limit(*limit);
    std::expected<std::vector<std::uint8_t>, client::SdoFailure> bytes;
    {
      ProgressLine progress(bus);
      sdo.set_progress([&progress](std::size_t done, std::size_t of) { progress.show(done, of); });
      bytes = sdo.read(target->object);
    }
    if (bytes) return print_value(arguments, *target, *bytes, sdo.speed());
    client::SdoFailure failure = bytes.error();
    if (failure.code == canopen::SdoClient::buffer_too_small) failure.reason += ", which --limit can raise";
    return failed(arguments, *target, failure);
  });
}

std::expected<std::vector<std::uint8_t>, std::string> file_content(const std::string& name) {
  const auto text = text::read_file_or_pipe(name);
  if (!text) return std::unexpected(text.error());
  return std::vector<std::uint8_t>(text->begin(), text->end());
}

std::expected<std::vector<std::uint8_t>, std::string> bytes_to_write(const SdoArguments& arguments,
                                                                     const SdoTarget& target) {
  if (!arguments.file.empty()) {
    if (!arguments.value.empty()) return std::unexpected("either a VALUE or --file, not both");
    return file_content(arguments.file);
  }
  return client::bytes_of_value(target, arguments.value, arguments.raw);
}

int write(const SdoArguments& arguments) {
  const auto target = target_of(arguments);
  if (!target) return complain_of_usage(target.error());
  const auto bytes = bytes_to_write(arguments, *target);
  if (!bytes) return complain(exit_code::usage, bytes.error());
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    bus.need({link::IdentifierFilter::only(canopen::cob_id::sdo_response + target->node)});
    client::SdoOnBus sdo(bus, target->node, time_out, arguments.block);
    std::expected<void, client::SdoFailure> result;
    {
      ProgressLine progress(bus);
      sdo.set_progress([&progress](std::size_t done, std::size_t of) { progress.show(done, of); });
      result = sdo.write(target->object, *bytes);
    }
    if (!result) return failed(arguments, *target, result.error());
    if (arguments.bus.json) return print_value(arguments, *target, *bytes, sdo.speed());
    if (bytes->size() > 16) {
      print_line("{}  {} written", target->object_title(), ascii::counted(bytes->size(), "byte"));
    } else {
      print_line("{}  {} written", target->object_title(), client::hexadecimal(*bytes));
    }
    print_speed(sdo.speed());
    return exit_code::done;
  });
}

void build_sdo_command(Command& sdo, int& exit_code) {
  const auto arguments = std::make_shared<SdoArguments>();
  sdo.require_subcommand(1);
  sdo.footer(
      "Objects are written as in CiA documents, in hexadecimal: 1018:01, 1008 (sub-index 00H), 0x6064, "
      "6064H; with\n"
      "--plant, --network, --project or --eds, or beside a plant.toml or nodelist.cpj, also by name, as "
      "nodes "
      "are.\n"
      "Exit code: 0 done, 1 the node aborted or does not answer, 2 wrong command line.");
  const auto add_common = [&](Command& command) {
    command.add_option("NODE", arguments->node, "node-ID, 1 to 127, or name, or BUS:NODE")->required();
    command.add_option("OBJECT", arguments->object, "INDEX[:SUB] in hexadecimal, or name")->required();
    command
        .add_option("--type", arguments->type,
                    "type of the value, in place of the device file's: " + text::one_of(client::type_names()))
        ->type_name("TYPE");
    add_sdo_names_options(command, arguments->names);
    command.add_flag("--block", arguments->block,
                     "block transfer, whatever the size; a node that answers otherwise is a failure");
    add_bus_options(command, arguments->bus, "for each answer of the node");
  };

  Command* reading = sdo.add_subcommand("read", "Show an object (SDO upload)");
  add_common(*reading);
  reading->add_option("--file", arguments->file, "put the bytes into this file")->type_name("FILE");
  reading->add_option("--limit", arguments->limit, "most bytes that are taken: 65536, 64K, 16M, 1G")
      ->type_name("SIZE")
      ->capture_default_str();
  reading->add_flag("--raw", arguments->raw, "put the bytes on the output as they are");
  reading->footer(
      "A concise DCF (1F22H) is shown as the objects that it writes; a value of type domain, or a long one "
      "of no\n"
      "type, as its first 4096 bytes with the text in them; with the speed of the transfer.\n"
      "Examples: canopus sdo read 2 1018:01 --type u32\n"
      "          canopus sdo read servo 'Position actual value' --plant plant.toml");
  reading->callback([arguments, &exit_code] { exit_code = read(*arguments); });

  Command* writing = sdo.add_subcommand("write", "Write an object (SDO download)");
  add_common(*writing);
  writing->add_option("VALUE", arguments->value, "1234, -5, 0x4D2, 4D2H, 1.5, true, text, bytes as 01A0FF");
  writing->add_option("--file", arguments->file, "write the bytes of this file")->type_name("FILE");
  writing->add_flag("--raw", arguments->raw, "VALUE is bytes in hexadecimal");
  writing->footer("Example: canopus sdo write 2 1017 500 --type u16");
  writing->callback([arguments, &exit_code] { exit_code = write(*arguments); });
}

}  // namespace

void add_sdo_command(Command& app, int& exit_code) {
  app.add_subcommand("sdo", "Read and write objects of a node on a bus",
                     [&exit_code](Command& sdo) { build_sdo_command(sdo, exit_code); });
}

}  // namespace canopus::cli
