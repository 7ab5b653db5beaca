#include "canopus/cli/commands/plc_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "canopus/cli/terminal/option_checks.hpp"
#include "canopus/cli/terminal/print.hpp"
#include "canopus/client/plc_address.hpp"
#include "canopus/client/plc_client.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {

namespace {

using plc::melsec::Target;

constexpr int done = 0;
constexpr int refused = 1;
constexpr int usage = 2;

struct Arguments {
  client::PlcConnection connection;
  bool frame_3e = false;
  std::string timeout = "3s";
  std::string address;
  std::vector<std::string> values;
  std::uint32_t count = 1;
  std::string format = "both";
  bool as_signed = false;
  std::string interval = "200ms";
  std::string duration;
  bool no_verify = false;
};

int complain(int exit_code, const std::string& message) {
  print_error("canopus plc: {}", message);
  return exit_code;
}

bool is_bit(const Target& target) { return !target.is_buffer && plc::device_info(target.device).is_bit; }

std::string shown(std::uint16_t word, const Arguments& arguments) {
  const int decimal = arguments.as_signed ? static_cast<std::int16_t>(word) : static_cast<int>(word);
  if (arguments.format == "dec") return fmt::format("{}", decimal);
  if (arguments.format == "hex") return fmt::format("{:04X}H", word);
  return fmt::format("{:>6}  {:04X}H", decimal, word);
}

std::string shown_bit(bool on) { return on ? "ON" : "OFF"; }

/// Connects, then does it. Everything on the command line has been understood by then.
int with_client(const Arguments& arguments, const std::function<int(client::PlcClient&)>& action) {
  const auto timeout = text::parse_duration(arguments.timeout);
  if (!timeout) return complain(usage, "--timeout: " + timeout.error());
  if (*timeout < std::chrono::milliseconds(1)) return complain(usage, "--timeout: expected at least 1ms");
  client::PlcConnection connection = arguments.connection;
  connection.timeout = std::chrono::ceil<std::chrono::milliseconds>(*timeout);
  auto client = client::PlcClient::connect(connection);
  if (!client) return complain(refused, client.error());
  return action(*client);
}

/// Values of the points, as text.
client::PlcClient::Result<std::vector<std::string>> read_points(client::PlcClient& client,
                                                                const Target& target,
                                                                const Arguments& arguments) {
  std::vector<std::string> texts;
  if (is_bit(target)) {
    const auto bits = client.read_bits(target, arguments.count);
    if (!bits) return std::unexpected(bits.error());
    for (const std::uint8_t bit : *bits) texts.push_back(shown_bit(bit != 0));
  } else {
    const auto words = client.read_words(target, arguments.count);
    if (!words) return std::unexpected(words.error());
    for (const std::uint16_t word : *words) texts.push_back(shown(word, arguments));
  }
  return texts;
}

int read(const Target& target, const Arguments& arguments) {
  return with_client(arguments, [&](client::PlcClient& client) {
    const auto texts = read_points(client, target, arguments);
    if (!texts) return complain(refused, texts.error());
    const std::size_t width = client::plc_address(target, arguments.count - 1).size();
    for (std::uint32_t i = 0; i < texts->size(); ++i)
      print_line("{:<{}}  {}", client::plc_address(target, i), width, (*texts)[i]);
    return done;
  });
}

/// Why a point may show something else than what was written to it: a CPU answers 0000H all the same.
std::string_view why_not_written(const Target& target) {
  if (target.is_buffer) return "the module does not let it be written, or changes it as well";
  if (target.device == plc::Device::x) return "an input shows what its module says";
  return "the PLC does not let it be written, or writes it as well";
}

/// Reads back what was written, unless that is not wanted. Complains of the first point that shows something
/// else; `same` compares, `shown` shows.
template <typename Value, typename Read, typename Show>
int verify(const Target& target, const Arguments& arguments, std::span<const Value> written, Read read,
           Show show) {
  if (arguments.no_verify) return done;
  const auto found = read(static_cast<std::uint32_t>(written.size()));
  if (!found) return complain(refused, "written, but it cannot be read back: " + found.error());
  const auto [wanted, other] = std::ranges::mismatch(written, *found);
  if (wanted == written.end()) return done;
  const auto offset = static_cast<std::uint32_t>(wanted - written.begin());
  return complain(refused,
                  fmt::format("{} was written with {} and shows {}: {}", client::plc_address(target, offset),
                              show(*wanted), show(*other), why_not_written(target)));
}

int write_and_verify(client::PlcClient& client, const Target& target, const Arguments& arguments,
                     std::span<const std::uint8_t> bits) {
  const auto written = client.write_bits(target, bits);
  if (!written) return complain(refused, written.error());
  return verify(
      target, arguments, bits, [&](std::uint32_t count) { return client.read_bits(target, count); },
      [](std::uint8_t bit) { return shown_bit(bit != 0); });
}

int write_and_verify(client::PlcClient& client, const Target& target, const Arguments& arguments,
                     std::span<const std::uint16_t> words) {
  const auto written = client.write_words(target, words);
  if (!written) return complain(refused, written.error());
  return verify(
      target, arguments, words, [&](std::uint32_t count) { return client.read_words(target, count); },
      [](std::uint16_t word) { return fmt::format("{} ({:04X}H)", word, word); });
}

int write_bits(const Target& target, const Arguments& arguments) {
  std::vector<std::uint8_t> bits;
  for (const std::string& text : arguments.values) {
    const auto bit = client::parse_plc_bit(text);
    if (!bit) return complain(usage, bit.error());
    bits.push_back(*bit ? 1 : 0);
  }
  return with_client(arguments, [&](client::PlcClient& client) {
    return write_and_verify(client, target, arguments, std::span<const std::uint8_t>(bits));
  });
}

int write_words(const Target& target, const Arguments& arguments) {
  std::vector<std::uint16_t> words;
  for (const std::string& text : arguments.values) {
    const auto word = client::parse_plc_word(text);
    if (!word) return complain(usage, word.error());
    words.push_back(*word);
  }
  return with_client(arguments, [&](client::PlcClient& client) {
    return write_and_verify(client, target, arguments, std::span<const std::uint16_t>(words));
  });
}

int write(const Target& target, const Arguments& arguments) {
  return is_bit(target) ? write_bits(target, arguments) : write_words(target, arguments);
}

int switch_bit(const Target& target, const Arguments& arguments, bool on) {
  if (!is_bit(target))
    return complain(usage,
                    client::plc_address(target) + " is a word; set and reset take bit devices (Y1, M100)");
  return with_client(arguments, [&](client::PlcClient& client) {
    const std::uint8_t bit = on ? 1 : 0;
    return write_and_verify(client, target, arguments, std::span<const std::uint8_t>(&bit, 1));
  });
}

using WatchClock = std::chrono::steady_clock;

/// The first values, then every change with its time.
int watch_until(client::PlcClient& client, const Target& target, const Arguments& arguments,
                WatchClock::duration interval, WatchClock::time_point start, WatchClock::time_point end) {
  std::vector<std::string> before(arguments.count);
  const std::size_t width = client::plc_address(target, arguments.count - 1).size();
  WatchClock::time_point next = start;
  while (true) {
    const auto texts = read_points(client, target, arguments);
    if (!texts) return complain(refused, texts.error());
    const double seconds = std::chrono::duration<double>(WatchClock::now() - start).count();
    for (std::uint32_t i = 0; i < texts->size(); ++i)
      if ((*texts)[i] != before[i])
        print_line("{:9.3f} s  {:<{}}  {}", seconds, client::plc_address(target, i), width, (*texts)[i]);
    before = *texts;
    next += interval;
    if (next < WatchClock::now())
      next = WatchClock::now();  // a slow PLC is asked again at once, not in a burst
    if (next > end) return done;
    std::this_thread::sleep_until(next);
  }
}

int watch(const Target& target, const Arguments& arguments) {
  const auto interval = text::parse_duration(arguments.interval);
  if (!interval) return complain(usage, "--interval: " + interval.error());
  if (*interval < std::chrono::milliseconds(1)) return complain(usage, "--interval: expected at least 1ms");
  const WatchClock::time_point start = WatchClock::now();
  WatchClock::time_point end = WatchClock::time_point::max();
  if (!arguments.duration.empty()) {
    const auto duration = text::parse_duration(arguments.duration);
    if (!duration) return complain(usage, "--for: " + duration.error());
    end = start + *duration;
  }
  return with_client(arguments, [&](client::PlcClient& client) {
    return watch_until(client, target, arguments, *interval, start, end);
  });
}

/// A CPU in STOP answers 0000H, too, and stays in STOP [SH-080931 11.2].
int pause(client::PlcClient& client) {
  if (const auto paused = client.remote_pause(); !paused) return complain(refused, paused.error());
  const auto stopped = client.read_bits({.device = plc::Device::sm, .number = 203}, 1);
  if (!stopped || stopped->front() == 0) return done;
  return complain(refused, "the CPU is in STOP and stays there: PAUSE is reached from RUN alone");
}

int type(client::PlcClient& client) {
  const auto found = client.read_type();
  if (!found) return complain(refused, found.error());
  print_line("{}  {:04X}H", found->name, found->code);
  return done;
}

int with_target(const Arguments& arguments,
                const std::function<int(const Target&, const Arguments&)>& action) {
  const auto target = client::parse_plc_address(arguments.address);
  return target ? action(*target, arguments) : complain(usage, target.error());
}

void add_connection_options(CLI::App& command, Arguments& arguments) {
  command.add_option("--host", arguments.connection.host, "the PLC's address")->capture_default_str();
  command.add_option("--port", arguments.connection.port, "TCP port")
      ->type_name("PORT")
      ->check(number_from(1, 65535))
      ->capture_default_str();
  auto* frame_3e = command.add_flag("--3e", arguments.frame_3e, "3E frames (the default)");
  command.add_flag("--4e", arguments.connection.frame_4e, "4E frames, with serial numbers")
      ->excludes(frame_3e);
  command.add_flag("--ascii", arguments.connection.ascii, "ASCII instead of binary");
  command.add_option("--timeout", arguments.timeout, "to connect and for each answer")->capture_default_str();
}

void add_address(CLI::App& command, Arguments& arguments, const char* help) {
  command.add_option("ADDRESS", arguments.address, help)->required();
}

void add_verify_option(CLI::App& command, Arguments& arguments) {
  command.add_flag("--no-verify", arguments.no_verify, "do not read back what was written");
}

void add_reading_options(CLI::App& command, Arguments& arguments) {
  command.add_option("-n,--count", arguments.count, "points: words, or bits of a bit device")
      ->type_name("NUMBER")
      ->check(number_from(1, 65536))
      ->capture_default_str();
  command.add_option("--format", arguments.format, "how words are shown")
      ->type_name("dec|hex|both")
      ->check(one_of_words({"dec", "hex", "both"}))
      ->capture_default_str();
  command.add_flag("--signed", arguments.as_signed, "decimal from -32768 to 32767");
}

}  // namespace

void add_plc_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& plc = *app.add_subcommand("plc", "Read and write a PLC over the MELSEC communication protocol");
  plc.require_subcommand(1);
  plc.footer(
      "Addresses: D100, M0, X1F (X Y B W SB SW in hexadecimal), U3\\G256 for buffer memory; quote the "
      "backslash.\n"
      "What is written is read back: a CPU answers as if all were well when a word or an input cannot be "
      "written.\n"
      "Exit code: 0 done, 1 the PLC refused, shows something else than what was written, or could not be "
      "reached,\n"
      "2 wrong command line.");
  const auto add = [&](const char* name, const char* help, std::function<int()> action) {
    CLI::App& command = *plc.add_subcommand(name, help);
    add_connection_options(command, *arguments);
    // The shared pointer keeps the arguments as long as the command.
    command.callback([arguments, &exit_code, action = std::move(action)] { exit_code = action(); });
    return &command;
  };

  auto* reading = add("read", "Show words or bits", [arguments] { return with_target(*arguments, read); });
  add_address(*reading, *arguments, "the first device or buffer memory address");
  add_reading_options(*reading, *arguments);

  auto* writing = add("write", "Write words or bits", [arguments] { return with_target(*arguments, write); });
  add_address(*writing, *arguments, "the first device or buffer memory address");
  writing->add_option("VALUE", arguments->values, "1234, -5, 0x4D2, 4D2H; ON or OFF for bits")->required();
  add_verify_option(*writing, *arguments);

  for (const bool on : {true, false}) {
    auto* switching =
        add(on ? "set" : "reset", on ? "Turn a bit device ON" : "Turn a bit device OFF", [arguments, on] {
          return with_target(*arguments, [on](const Target& target, const Arguments& all) {
            return switch_bit(target, all, on);
          });
        });
    add_address(*switching, *arguments, "Y1, M100");
    add_verify_option(*switching, *arguments);
  }

  auto* watching = add("watch", "Show values and then every change, with its time",
                       [arguments] { return with_target(*arguments, watch); });
  add_address(*watching, *arguments, "the first device or buffer memory address");
  add_reading_options(*watching, *arguments);
  watching->add_option("--interval", arguments->interval, "time between two readings")->capture_default_str();
  watching->add_option("--for", arguments->duration, "stop after this time instead of Ctrl-C");

  add("run", "Remote RUN", [arguments] {
    return with_client(*arguments, [](client::PlcClient& client) {
      const auto result = client.remote_run();
      return result ? done : complain(refused, result.error());
    });
  });
  add("stop", "Remote STOP", [arguments] {
    return with_client(*arguments, [](client::PlcClient& client) {
      const auto result = client.remote_stop();
      return result ? done : complain(refused, result.error());
    });
  });
  add("pause", "Remote PAUSE: the program stops, outputs stay as they are",
      [arguments] { return with_client(*arguments, pause); });
  add("type", "Show the CPU's name and code", [arguments] {
    return with_client(*arguments, [](client::PlcClient& client) { return type(client); });
  });
}

}  // namespace canopus::cli
