#include "canopus/cli/trace/trace_options.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "canopus/cli/options/command.hpp"
#include "canopus/trace/print/node_names.hpp"

namespace canopus::cli {

void add_names_options(Command& command, NamesOptions& options) {
  add_node_names_options(command, options.of, "names of nodes and objects, mapped PDOs");
  command
      .add_option("--eds", options.device_files,
                  "Device file (EDS or DCF) of a node, as 3=encoder.eds; may be given again")
      ->type_name("NODE=FILE")
      ->allow_extra_args(false);
  command.add_old_spelling({.old = "--node", .now = "--eds", .value = [](std::string_view value) {
                              return value.contains('=') ? std::optional(std::string(value)) : std::nullopt;
                            }});
}

std::vector<std::string> files_of(const NamesOptions& options) {
  std::vector<std::string> files;
  for (const std::string& name : {options.of.plant, options.of.network, options.of.project}) {
    if (!name.empty()) files.push_back(name);
  }
  for (const std::string& node : options.device_files) {
    if (const std::size_t equals = node.find('='); equals != std::string::npos)
      files.push_back(node.substr(equals + 1));
  }
  return files;
}

std::optional<trace::Names> load_names(const NamesOptions& options, Output& err) {
  auto names = load_node_names(options.of);
  if (!names) {
    if (!names.error().empty()) err.line("canopus: {}", names.error());
    return std::nullopt;
  }
  for (const std::string& node : options.device_files) {
    if (!trace::add_node_names(node, *names, err)) return std::nullopt;
  }
  return std::move(*names);
}

void add_filter_options(Command& command, trace::FilterOptions& options, bool of_file) {
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* help,
                        const char* type) {
    command.add_option(name, values, help)->type_name(type)->allow_extra_args(false);
  };
  command
      .add_option(
          "--filter", options.expression,
          "Only messages that match all of these terms, as on the page of a run: 'service=sdo,pdo node=3 "
          "!object=6000 abort=06020000 \"a text\"'; all SDO aborts: 'service=sdo abort'")
      ->type_name("EXPRESSION");
  list("--node", options.nodes,
       "Only messages of this node: its node-ID, or what its name begins with; may be given again", "NODE");
  command.add_old_spelling({.old = "--only-node", .now = "--node"});
  list("--service", options.services,
       "Only this service: nmt, flying-master, sync, time, emcy, pdo, mpdo, sdo, error-control, lss, layer2, "
       "error-frame, failsafe; may be given again",
       "SERVICE");
  list("--object", options.objects,
       "Only SDOs and PDOs with this object, as 6000 or 6000:01; may be given again", "OBJECT");
  list("--can-id", options.identifiers, "Only frames of this CAN-ID, hexadecimal; may be given again", "ID");
  command.add_old_spelling({.old = "--id", .now = "--can-id"});
  if (!of_file) return;
  list("--channel", options.channels, "Only this channel of the file; may be given again", "NAME");
  command.add_option("--from", options.from, "Only from this time after the first frame on, as 1.5s")
      ->type_name("TIME");
  command.add_option("--to", options.to, "Only up to this time after the first frame")->type_name("TIME");
}

bool ChannelChoice::wants(std::string_view channel) {
  if (names_.empty()) return true;
  // most frames are of the channel of the frame before
  if (seen_.empty() || seen_.back() != channel) {
    const auto found = std::ranges::find(seen_, channel);
    if (found == seen_.end()) {
      seen_.emplace_back(channel);
    } else {
      std::swap(*found, seen_.back());
    }
  }
  return std::ranges::find(names_, channel) != names_.end();
}

bool ChannelChoice::report_missing(Output& err) const {
  constexpr std::size_t most_shown = 8;
  bool all_came = true;
  for (const std::string& name : names_) {
    if (std::ranges::find(seen_, name) != seen_.end()) continue;
    all_came = false;
    std::vector<std::string> known = seen_;
    std::ranges::sort(known);
    std::string list;
    for (std::size_t i = 0; i < std::min(known.size(), most_shown); ++i) {
      list += (i == 0 ? "" : ", ") + (known[i].empty() ? std::string("one without a name") : known[i]);
    }
    if (known.size() > most_shown) list += ", ...";
    err.line("canopus: --channel {}: no frame that was read is of this channel; there are: {}", name,
             list.empty() ? "none" : list);
  }
  return all_came;
}

}  // namespace canopus::cli
