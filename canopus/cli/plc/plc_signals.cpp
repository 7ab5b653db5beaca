#include "canopus/cli/plc/plc_signals.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/cli/bus/node_names.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/plc_access.hpp"
#include "canopus/client/node_id.hpp"
#include "canopus/client/sdo_value.hpp"
#include "canopus/network_project/network_project.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::cli {

namespace {

using plant::ProcessSignal;
using plc::RackAddress;

constexpr const char* default_plant = "plant.toml";

/// "line1:drive" and "6041" of "line1:drive.6041", at each dot.
std::vector<std::pair<std::string, std::string>> splits(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> found;
  for (std::size_t dot = text.find('.'); dot != std::string::npos; dot = text.find('.', dot + 1)) {
    if (dot > 0 && dot + 1 < text.size()) found.emplace_back(text.substr(0, dot), text.substr(dot + 1));
  }
  return found;
}

/// A plant file has a device or module of this name or node-ID, or no program whose variable the text could name. A file with
/// mistakes has nothing.
bool is_of_plant(const std::string& path, std::string_view node) {
  const auto content = text::read_file(path);
  if (!content) return false;
  if (const std::size_t colon = node.find(':'); colon != std::string_view::npos)
    node.remove_prefix(colon + 1);
  const plant::PlantFile plant = plant::read_plant(*content, path).plant;
  const unsigned number = client::parse_node(node);
  const auto is_it = [&](const auto& section) {
    return number != 0 ? section.node == number : ascii::equal_ignoring_case(section.name, node);
  };
  const auto has_it = [&](const plant::PlcSection& plc) { return std::ranges::any_of(plc.modules, is_it); };
  const auto has_program = [](const plant::PlcSection& plc) { return !plc.program_files.empty(); };
  return std::ranges::any_of(plant.devices, is_it) || std::ranges::any_of(plant.plcs, has_it) ||
         (!plant.plcs.empty() && std::ranges::none_of(plant.plcs, has_program));
}

/// It cannot be a variable of a program, nor a bit of a word (D20.5): "4.6041", "drive.6041", "drive.Position actual value".
bool is_no_variable(std::string_view object) {
  constexpr std::size_t index_digits = 4;
  return object.contains(' ') ||
         (object.size() >= index_digits && ascii::is_digit(object.front()) && text::parse_object(object));
}

std::string plant_of(const PlcArguments& arguments) {
  return arguments.plant.empty() ? default_plant : arguments.plant;
}

bool is_same(const RackAddress& a, const RackAddress& b) {
  return a.is_buffer == b.is_buffer && a.device == b.device && a.head_address == b.head_address &&
         a.number == b.number;
}

std::string address_text(const RackAddress& word) {
  return client::to_text({.at = word}, 0, client::PlcNotation::melsec);
}

/// "U0\G10009-G10010", "U0\G13000 bits 0-7", "U0\G10000.1-G10001.0" from bit 1 of the first word on.
std::string place_text(const ProcessSignal& signal, const std::vector<RackAddress>& words) {
  const unsigned first = signal.bits.front().bit;
  const unsigned last = signal.bits.back().bit;
  const bool are_whole = signal.bits.size() == 16 * words.size();
  if (words.size() == 1) {
    const std::string word = address_text(words.front());
    if (are_whole) return word;
    return first == last ? fmt::format("{} bit {}", word, first)
                         : fmt::format("{} bits {}-{}", word, first, last);
  }
  const std::string end =
      words.back().is_buffer ? fmt::format("G{}", words.back().number) : address_text(words.back());
  return are_whole ? fmt::format("{}-{}", address_text(words.front()), end)
                   : fmt::format("{}.{:X}-{}.{:X}", address_text(words.front()), first, end, last);
}

/// The words from `first` on that follow each other.
std::size_t row_from(const std::vector<RackAddress>& words, std::size_t first) {
  std::size_t count = 1;
  RackAddress next = words[first];
  while (first + count < words.size() && ++next.number == words[first + count].number &&
         is_same(next, words[first + count]))
    ++count;
  return count;
}

/// Which of the signal's words has its bit `i`.
std::size_t word_of(const PlcSignal& signal, std::size_t i) {
  const auto found = std::ranges::find_if(
      signal.words, [&](const RackAddress& word) { return is_same(word, signal.at.bits[i].word); });
  return static_cast<std::size_t>(found - signal.words.begin());
}

std::string title_behind(const PlcSignal& signal) {
  return signal.target.title.empty() ? std::string() : " " + signal.target.title;
}

struct LoadedPlant {
  std::unique_ptr<plant::Plant> plant{};
  plant::ProcessSignals found{};
};

/// The error is empty after mistakes of the plant file were printed.
std::expected<LoadedPlant, std::string> load(const PlcArguments& arguments) {
  class : public plant::PlantObserver {
  } no_observer;
  const std::string path = plant_of(arguments);
  std::error_code ignored;
  if (arguments.plant.empty() && !std::filesystem::exists(path, ignored)) {
    return std::unexpected(fmt::format(
        "\"{}\" is a signal of a plant, and this folder has no plant.toml; expected --plant with its file",
        arguments.address));
  }
  LoadedPlant loaded{
      .plant = plant::load_plant(path, no_observer, standard_error(), {.allows_native_code = false})};
  if (loaded.plant == nullptr) return std::unexpected(std::string());
  loaded.found = plant::process_signals(*loaded.plant);
  if (arguments.plc.empty()) return loaded;
  std::erase_if(loaded.found.signals, [&](const ProcessSignal& signal) {
    return loaded.plant->plc_section(signal.plc).name != arguments.plc;
  });
  return loaded;
}

PlcSignal described(const ProcessSignal& signal, const trace::NodeDescription& node) {
  PlcSignal found{.at = signal, .target = {.node = node.node_id, .object = signal.object}};
  if (const auto entry = node.dictionary->find(signal.object.index, signal.object.sub))
    found.target.use(node.dictionary, entry, network_project::object_title(*node.dictionary, entry));
  found.name = fmt::format("{}.{}", node.name.empty() ? fmt::format("{}", node.node_id) : node.name,
                           found.target.object_text());
  for (const ProcessSignal::Bit& bit : signal.bits) {
    if (found.words.empty() || !is_same(found.words.back(), bit.word)) found.words.push_back(bit.word);
  }
  found.place = place_text(signal, found.words);
  return found;
}

/// "6041:00 (Statusword), 6040:00 (Controlword)"
std::string signals_of_node(const plant::ProcessSignals& found, const trace::NodeDescription& node) {
  std::vector<std::string> shown;
  for (const ProcessSignal& signal : found.signals) {
    if (signal.bus != node.bus || signal.node_id != node.node_id) continue;
    const PlcSignal known = described(signal, node);
    std::string text = known.target.object_text();
    if (!known.target.title.empty()) text += fmt::format(" ({})", known.target.title);
    if (std::ranges::find(shown, text) == shown.end()) shown.push_back(std::move(text));
  }
  return shown.empty() ? "none of this node" : fmt::format("{}", fmt::join(shown, ", "));
}

/// A port of the PLC that takes 3E frames.
std::optional<std::uint16_t> port_of(const plant::PlcSection& plc, bool udp) {
  const auto port = std::ranges::find_if(plc.ports, [udp](const plant::MelsecPortSection& section) {
    return section.udp == udp && section.settings.takes_3e;
  });
  return port == plc.ports.end() ? std::nullopt : std::optional(port->listen.port);
}

/// The node and the text for its object; the error names similar nodes.
std::expected<std::pair<const trace::NodeDescription*, std::string>, std::string> split_at_node(
    const trace::Names& names, const std::string& text) {
  const auto parts = splits(text);
  if (parts.empty())
    return std::unexpected(
        fmt::format("\"{}\" is not a signal; expected NODE.OBJECT, for example drive.6041", text));
  for (const auto& [node, object] : parts) {
    const auto found = find_named_node(names, node);
    if (!found) return std::unexpected(found.error());
    if (*found != nullptr) return std::pair(*found, object);
  }
  return std::unexpected(no_such_node(names, parts.front().first, "--plant"));
}

/// Reads the words of the signal, in as few requests as there are rows of them.
client::PlcClient::Result<std::vector<std::uint16_t>> read_words(client::PlcClient& client,
                                                                 const PlcSignal& signal) {
  std::vector<std::uint16_t> all;
  for (std::size_t first = 0; first < signal.words.size();) {
    const std::size_t count = row_from(signal.words, first);
    const auto row = client.read_words({.at = signal.words[first]}, static_cast<std::uint32_t>(count));
    if (!row) return row;
    all.insert(all.end(), row->begin(), row->end());
    first += count;
  }
  return all;
}

std::string shown_value(const PlcSignal& signal, const std::vector<std::uint8_t>& bytes) {
  if (signal.target.type) {
    if (const auto text = client::show_value(signal.target, bytes)) return *text;
  }
  return client::hexadecimal(bytes, " ");
}

/// Connects to the PLC of the signal: that of the command line, else of the plant file.
int with_plc(const PlcSignal& signal, PlcArguments arguments,
             const std::function<int(client::PlcClient&)>& action) {
  const bool names_port = arguments.port || !arguments.setup.empty() || arguments.modbus;
  if (!names_port) arguments.port = signal.port;
  return with_client(arguments, action);
}

int no_signal(const std::string& why) { return why.empty() ? usage : plc_failed(usage, why); }

/// Prints a value when it is another than the last one.
class SignalPrinter {
 public:
  SignalPrinter(const PlcSignal& signal, const PlcArguments& arguments)
      : signal_(signal), arguments_(arguments) {
    if (arguments.csv) print_line("time,{}", signal.name);
  }
  void print(double seconds, const std::vector<std::uint8_t>& bytes) {
    if (bytes == last_) return;
    last_ = bytes;
    const text::Json value = signal_.target.type ? client::json_value(bytes, *signal_.target.type)
                                                 : text::Json(client::hexadecimal(bytes, ""));
    if (arguments_.json) {
      const double milliseconds = static_cast<double>(static_cast<std::int64_t>(seconds * 1000));
      print_line("{}", text::Json{{"time", milliseconds / 1000}, {signal_.name, value}}.dump());
    } else if (arguments_.csv) {
      print_line("{:.3f},{}", seconds, value.dump());
    } else {
      print_line("{:9.3f} s  {}  {}", seconds, signal_.name, shown_value(signal_, bytes));
    }
  }

 private:
  const PlcSignal& signal_;
  const PlcArguments& arguments_;
  std::vector<std::uint8_t> last_;
};

}  // namespace

void add_plant_option(Command& command, PlcArguments& arguments) {
  command
      .add_option(
          "--plant", arguments.plant,
          "plant file: ADDRESS is a signal, NODE.OBJECT [plant.toml of this folder, if it has the node]")
      ->type_name("PLANT");
}

bool is_signal(const PlcArguments& arguments) {
  if (!arguments.at.empty() || plc_point(arguments.address, arguments)) return false;
  if (!arguments.plant.empty()) return true;
  const auto parts = splits(arguments.address);
  return std::ranges::any_of(parts, [](const auto& part) {
    return is_no_variable(part.second) || is_of_plant(default_plant, part.first);
  });
}

std::expected<PlcSignal, std::string> find_signal(const PlcArguments& arguments) {
  const auto loaded = load(arguments);
  if (!loaded) return std::unexpected(loaded.error());
  const auto& [plant, found] = *loaded;
  const auto parts = split_at_node(found.nodes, arguments.address);
  if (!parts) return std::unexpected(parts.error());
  const auto& [node, object] = *parts;
  const auto entry = network_project::find_object(*node->dictionary, shown_node(*node), object);
  if (!entry) return std::unexpected(entry.error());
  const auto signal = std::ranges::find_if(found.signals, [&](const ProcessSignal& known) {
    return known.bus == node->bus && known.node_id == node->node_id && known.object.index == entry->index &&
           known.object.sub == entry->sub;
  });
  if (signal == found.signals.end()) {
    return std::unexpected(
        fmt::format("{:04X}:{:02X} ({}) of {} is in no PDO that the module of a PLC exchanges; exchanged: {}",
                    entry->index, entry->sub, network_project::object_title(*node->dictionary, *entry),
                    shown_node(*node), signals_of_node(found, *node)));
  }
  PlcSignal described_signal = described(*signal, *node);
  described_signal.port = port_of(plant->plc_section(signal->plc), arguments.connection.udp);
  return described_signal;
}

std::vector<std::uint8_t> value_in_words(const PlcSignal& signal, const std::vector<std::uint16_t>& words) {
  const std::size_t bytes = (signal.at.bits.size() + 7) / 8;
  const std::size_t of_type = signal.target.type ? canopen::byte_length(*signal.target.type) : 0;
  std::vector<std::uint8_t> value(std::max(bytes, of_type));
  for (std::size_t i = 0; i < signal.at.bits.size(); ++i) {
    if ((words[word_of(signal, i)] >> signal.at.bits[i].bit & 1U) != 0)
      value[i / 8] = static_cast<std::uint8_t>(value[i / 8] | 1U << i % 8);
  }
  return value;
}

std::vector<std::uint16_t> words_with_value(const PlcSignal& signal, std::vector<std::uint16_t> words,
                                            const std::vector<std::uint8_t>& value) {
  for (std::size_t i = 0; i < signal.at.bits.size() && i / 8 < value.size(); ++i) {
    std::uint16_t& word = words[word_of(signal, i)];
    const auto mask = static_cast<std::uint16_t>(1U << signal.at.bits[i].bit);
    const bool is_set = (value[i / 8] >> i % 8 & 1U) != 0;
    word = static_cast<std::uint16_t>(is_set ? word | mask : word & ~mask);
  }
  return words;
}

int read_signal(const PlcArguments& arguments) {
  const auto signal = find_signal(arguments);
  if (!signal) return no_signal(signal.error());
  return with_plc(*signal, arguments, [&](client::PlcClient& client) {
    const auto words = read_words(client, *signal);
    if (!words) return plc_failed(refused, words.error());
    print_line("{}  {}{}  {}", signal->place, signal->name, title_behind(*signal),
               shown_value(*signal, value_in_words(*signal, *words)));
    return done;
  });
}

int write_signal(const PlcArguments& arguments) {
  if (arguments.values.size() != 1)
    return plc_failed(usage,
                      "VALUE: a signal has one value; expected it in quotes if there are blanks in it");
  const auto signal = find_signal(arguments);
  if (!signal) return no_signal(signal.error());
  if (!signal->at.is_output) {
    return plc_failed(usage, fmt::format("{}{} comes from the node, in its {}: the PLC cannot write it",
                                         signal->name, title_behind(*signal), signal->at.pdo));
  }
  const auto value = client::bytes_of_value(signal->target, arguments.values.front(), !signal->target.type);
  if (!value) return plc_failed(usage, value.error());
  return with_plc(*signal, arguments, [&](client::PlcClient& client) {
    const auto before = read_words(client, *signal);
    if (!before) return plc_failed(refused, before.error());
    const auto words = words_with_value(*signal, *before, *value);
    for (std::size_t first = 0; first < words.size();) {
      const std::size_t count = row_from(signal->words, first);
      const int code = write_and_verify(client, {.at = signal->words[first]}, arguments,
                                        std::span<const std::uint16_t>(words).subspan(first, count));
      if (code != done) return code;
      first += count;
    }
    return done;
  });
}

int watch_signal(const PlcArguments& arguments) {
  const auto times = watch_times(arguments);
  if (!times) return plc_failed(usage, times.error());
  const auto signal = find_signal(arguments);
  if (!signal) return no_signal(signal.error());
  return with_plc(*signal, arguments, [&](client::PlcClient& client) {
    SignalPrinter printer(*signal, arguments);
    return watch(*times, [&](double seconds) {
      const auto words = read_words(client, *signal);
      if (!words) return plc_failed(refused, words.error());
      printer.print(seconds, value_in_words(*signal, *words));
      return done;
    });
  });
}

int list_signals(const PlcArguments& arguments) {
  const auto loaded = load(arguments);
  if (!loaded) return no_signal(loaded.error());
  std::vector<PlcSignal> signals;
  for (const trace::NodeDescription& node : loaded->found.nodes.nodes()) {
    for (const ProcessSignal& signal : loaded->found.signals) {
      if (signal.bus == node.bus && signal.node_id == node.node_id)
        signals.push_back(described(signal, node));
    }
  }
  std::size_t names = 0;
  std::size_t places = 0;
  for (const PlcSignal& signal : signals) {
    names = std::max(names, signal.name.size());
    places = std::max(places, signal.place.size());
  }
  for (const PlcSignal& signal : signals) {
    print_line("{:<{}}  {}  {:<{}}  {:<5}  {:<4}  {}", signal.name, names, signal.at.is_output ? "->" : "<-",
               signal.place, places, signal.at.pdo, signal.target.type_name, signal.target.title);
  }
  if (signals.empty()) print_line("no module of this plant exchanges signals by PDO");
  return done;
}

}  // namespace canopus::cli
