#include "canopus/network_project/nodelist.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::network_project {
namespace {

using Severity = eds::Problem::Severity;
using Done = std::expected<void, std::string>;

bool is_decimal(std::string_view text) noexcept {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// "topology", "topology2" ... (folded).
bool is_topology(std::string_view section) noexcept {
  constexpr std::string_view word = "topology";
  return section == word || (section.starts_with(word) && is_decimal(section.substr(word.size())));
}

struct NodeKey {
  unsigned node_id = 0;   // 0: none that a node can have
  std::string_view item;  // "present", "name" ...
};

/// node5present (folded). Nothing for other keys.
std::optional<NodeKey> node_key(std::string_view key) {
  if (!key.starts_with("node")) return std::nullopt;
  const std::string_view rest = key.substr(4);
  const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
  if (digits == 0) return std::nullopt;
  NodeKey result{0, rest.substr(digits)};
  if (digits <= 3 && rest.front() != '0')
    result.node_id = ascii::parse_number<unsigned>(rest.substr(0, digits)).value_or(0);
  if (result.node_id > highest_node_id) result.node_id = 0;
  constexpr std::string_view known[] = {"present", "name", "refd", "dcfname"};
  if (std::ranges::find(known, result.item) == std::end(known)) return std::nullopt;
  return result;
}

/// Without quotes round it.
std::string_view unquoted(std::string_view value) noexcept {
  const bool is_quoted =
      value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front();
  return is_quoted ? eds::trim(value.substr(1, value.size() - 2)) : value;
}

std::string key_of(std::uint8_t node_id, std::string_view item) {
  return "Node" + std::to_string(node_id) + std::string(item);
}

}  // namespace

const ListedNode* ListedNetwork::find(std::uint8_t node_id) const noexcept {
  const auto place = std::ranges::find(nodes, node_id, &ListedNode::node_id);
  return place == nodes.end() ? nullptr : &*place;
}

std::expected<std::string, std::string> path_in_project(std::string_view name) {
  const auto refused = [&](std::string_view why) {
    return std::unexpected("\"" + eds::printable(name) + "\" " + std::string(why));
  };
  if (eds::trim(name).empty()) return std::unexpected("no file is named");
  if (std::ranges::any_of(name, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; })) {
    return refused("has control characters");
  }
  std::string path(name);
  std::ranges::replace(path, '\\', '/');
  if (path.starts_with('/') || (path.size() > 1 && path[1] == ':')) {
    return refused("is absolute: the files of a project lie in its folder");
  }
  if (path.ends_with('/')) return refused("names a folder");
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (path.substr(begin, end - begin) == "..") return refused("leads out of the project's folder");
    begin = end + 1;
  }
  return path;
}

std::expected<ListedPath, std::string> listed_path(std::string_view name) {
  const bool has_drive = name.size() > 1 && name[1] == ':' && ascii::is_letter(name.front());
  if (!has_drive && !name.starts_with("\\\\")) {
    auto path = path_in_project(name);
    if (!path) return std::unexpected(std::move(path.error()));
    return ListedPath{*std::move(path), {}};
  }
  const std::string_view file = name.substr(name.find_last_of(has_drive ? "\\/:" : "\\/") + 1);
  auto path = path_in_project(file);
  if (!path) return std::unexpected(std::move(path.error()));
  return ListedPath{*path, "\"" + eds::printable(name) + "\" is a path of another computer: " +
                               eds::printable(*path) + " in the project's folder is taken"};
}

Nodelist::Nodelist() : Nodelist("[Topology]\r\nNetName=\r\nNodes=0x00\r\n") {}

Nodelist::Nodelist(std::string_view text) : file_(text) {
  read();
  problems_ = found_.release();
}

void Nodelist::report(Severity severity, unsigned line, std::string message) {
  found_.report(severity, std::max(line, 1U), std::move(message));
}

void Nodelist::read() {
  if (!file_.problem().empty()) return report(Severity::error, 1, file_.problem());
  if (std::string note = file_.encoding_note(); !note.empty()) report(Severity::note, 1, std::move(note));
  for (const std::string& section : file_.sections()) {
    if (is_topology(section)) read_network(section);
  }
  if (networks_.empty()) {
    report(Severity::error, 1, "there is no section [Topology]: this is no list of nodes of CiA 306");
  }
  for (const ListedNetwork& network : networks_) review(network);
}

void Nodelist::read_network(const std::string& section) {
  const auto text = [&](std::string_view key) {
    const std::string value = file_.value(section, key).value_or("");
    const std::string_view bare = unquoted(value);
    if (bare.size() != value.size()) {
      found_.repeated(Severity::note, "quotes", file_.line(section, key),
                      std::string(key) + '=' + eds::printable(value) + ": the quotes round it are taken off");
    }
    return std::string(bare);
  };
  ListedNetwork network{section, text("NetName"), text("NetRefd"), text("EDSBaseName"), {}};
  std::map<unsigned, unsigned> without_present;  // node-ID and the first of its lines
  for (const std::string& key : file_.keys(section)) {
    const auto meaning = node_key(key);
    if (!meaning) continue;
    const unsigned line = file_.line(section, key);
    if (meaning->node_id == 0) {
      report(Severity::warning, line,
             "key " + eds::printable(key) + ": a node-ID is 1 to 127, without zeros before it: not read");
      continue;
    }
    const auto id = static_cast<std::uint8_t>(meaning->node_id);
    if (meaning->item != "present") {
      if (file_.line(section, key_of(id, "Present")) == 0) without_present.emplace(meaning->node_id, line);
      continue;
    }
    const std::string value = text(key);
    const auto number = eds::read_number(value);
    if (!number || number->adds_node_id) {
      report(
          Severity::warning, line,
          key_of(id, "Present=") + eds::printable(value) + ": 0x01 or 0x00 is expected: taken as not there");
    }
    network.nodes.push_back({id, number && !number->adds_node_id && number->magnitude != 0,
                             text(key_of(id, "Name")), text(key_of(id, "Refd")), text(key_of(id, "DCFName")),
                             line});
  }
  for (const auto& [id, line] : without_present) {
    report(Severity::warning, line,
           "node " + std::to_string(id) + " has no Node" + std::to_string(id) +
               "Present: it is not in the network");
  }
  std::ranges::sort(network.nodes, {}, &ListedNode::node_id);
  networks_.push_back(std::move(network));
}

void Nodelist::review(const ListedNetwork& network) {
  std::map<std::string, unsigned> owners;  // by path
  for (const ListedNode& node : network.nodes) {
    const std::string node_name = "node " + std::to_string(node.node_id);
    if (node.dcf_name.empty()) {
      if (node.present)
        report(Severity::warning, node.line,
               node_name + " has no DCF: Node" + std::to_string(node.node_id) + "DCFName");
      continue;
    }
    const unsigned line = file_.line(network.section, key_of(node.node_id, "DCFName"));
    const auto listed = listed_path(node.dcf_name);
    if (!listed) {
      report(Severity::warning, line, "DCF of " + node_name + ": " + listed.error());
      continue;
    }
    if (!listed->note.empty()) report(Severity::note, line, "DCF of " + node_name + ": " + listed->note);
    const auto [owner, is_first] = owners.emplace(ascii::lower(listed->path), node.node_id);
    if (!is_first) {
      report(
          Severity::warning, line,
          node_name + " has the DCF of node " + std::to_string(owner->second) + ": each node needs its own");
    }
  }
  const auto value = file_.value(network.section, "Nodes");
  if (!value) return;
  const auto announced = eds::read_number(*value);
  const auto present =
      static_cast<std::size_t>(std::ranges::count(network.nodes, true, &ListedNode::present));
  // Some tools count the nodes that are there, others those that are listed.
  if (announced && (announced->magnitude == network.nodes.size() || announced->magnitude == present)) return;
  report(Severity::warning, file_.line(network.section, "Nodes"),
         "Nodes=" + eds::printable(*value) + ", but " + ascii::counted(network.nodes.size(), "node") +
             " listed: the list counts");
}

Done Nodelist::usable(std::size_t network) const {
  for (const eds::Problem& problem : problems_) {
    if (problem.severity != Severity::error) continue;
    return std::unexpected("line " + std::to_string(problem.line) + ": " + problem.message);
  }
  if (network < networks_.size()) return {};
  return std::unexpected("there are " + ascii::counted(networks_.size(), "network") + " in the project");
}

void Nodelist::set_file(eds::IniText file) {
  file_ = std::move(file);
  networks_.clear();
  read();
  found_ = {};  // the problems are those of the file that was read
}

Done Nodelist::set_network_name(std::size_t network, std::string_view name) {
  if (const Done done = usable(network); !done) return done;
  eds::IniText file = file_;
  if (const Done done = file.set(networks_[network].section, "NetName", name); !done) return done;
  set_file(std::move(file));
  return {};
}

Done Nodelist::count_nodes(eds::IniText& file, const std::string& section) {
  std::size_t count = 0;
  for (const std::string& key : file.keys(section)) {
    const auto meaning = node_key(key);
    count += meaning && meaning->node_id != 0 && meaning->item == "present" ? 1 : 0;
  }
  const std::string old = file.value(section, "Nodes").value_or("");
  const auto number = eds::read_number(old);
  if (number && number->magnitude == count) return {};
  return file.set(section, "Nodes",
                  number && !number->hexadecimal ? std::to_string(count) : "0x" + ascii::hex(count, 2));
}

Done Nodelist::set_node(std::size_t network, const ListedNode& node) {
  if (const Done done = usable(network); !done) return done;
  if (node.node_id < 1 || node.node_id > highest_node_id) return std::unexpected("a node-ID is 1 to 127");
  const ListedNetwork& listed = networks_[network];
  const ListedNode* old = listed.find(node.node_id);
  if (!node.dcf_name.empty() && (old == nullptr || old->dcf_name != node.dcf_name)) {
    if (const auto path = path_in_project(node.dcf_name); !path) return std::unexpected(path.error());
  }
  eds::IniText file = file_;
  // Overwrites leftover keys of a node without NodeXPresent.
  const auto set = [&](std::string_view item, const std::string& value) -> Done {
    const std::string key = key_of(node.node_id, item);
    if (unquoted(file.value(listed.section, key).value_or("")) == value) return {};
    const Done done = file.set(listed.section, key, value);
    return done ? done : std::unexpected(key + ": " + done.error());
  };
  Done done;
  if (old == nullptr || old->present != node.present) done = set("Present", node.present ? "0x01" : "0x00");
  if (done) done = set("Name", node.name);
  if (done) done = set("Refd", node.reference);
  if (done) done = set("DCFName", node.dcf_name);
  if (done && old == nullptr) done = count_nodes(file, listed.section);
  if (done) set_file(std::move(file));
  return done;
}

Done Nodelist::remove_node(std::size_t network, std::uint8_t node_id) {
  if (const Done done = usable(network); !done) return done;
  const ListedNetwork& listed = networks_[network];
  if (listed.find(node_id) == nullptr) return {};
  eds::IniText file = file_;
  for (const std::string_view item : {"Present", "Name", "Refd", "DCFName"}) {
    if (const Done done = file.remove(listed.section, key_of(node_id, item)); !done) return done;
  }
  if (const Done done = count_nodes(file, listed.section); !done) return done;
  set_file(std::move(file));
  return {};
}

}  // namespace canopus::network_project
