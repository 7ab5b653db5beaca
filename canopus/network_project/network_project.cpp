#include "canopus/network_project/network_project.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/eds/xdd.hpp"

namespace canopus::network_project {
namespace {

using Done = NetworkProject::Done;

std::string first_problem(const std::vector<eds::Problem>& problems) {
  return fmt::format("line {}: {}", problems.front().line, problems.front().message);
}

/// A file name that is valid on any system.
std::string as_file_name(std::string_view name) {
  std::string text;
  for (const char c : ascii::lower(name)) {
    const bool is_plain = ascii::is_letter(c) || ascii::is_digit(c) || c == '_';
    if (is_plain) {
      text += c;
    } else if (!text.empty() && text.back() != '-') {
      text += '-';
    }
  }
  constexpr std::size_t longest = 60;
  text.resize(std::min(text.size(), longest));
  while (text.ends_with('-')) text.pop_back();
  return text;
}

}  // namespace

std::string ProjectNode::shown_name() const {
  return listed.name.empty() ? fmt::format("node {}", id())
                             : fmt::format("node {} ({})", id(), eds::printable(listed.name));
}

std::optional<std::uint64_t> ProjectNode::value(std::uint16_t index, std::uint8_t sub) const {
  return device == nullptr ? std::nullopt : eds::default_value(*device->dictionary, index, sub, id());
}

NetworkProject::NetworkProject(std::string list_path, ReadFile read, Nodelist list, std::size_t network)
    : list_path_(std::move(list_path)), read_(std::move(read)), list_(std::move(list)), network_(network) {}

std::expected<NetworkProject, std::string> NetworkProject::open(std::string list, ReadFile read,
                                                                std::size_t network, FindFile find) {
  const auto text = read(list);
  if (!text) return std::unexpected(text.error());
  if (!*text) return std::unexpected("there is no such file");
  Nodelist nodelist(**text);
  if (nodelist.networks().empty()) return std::unexpected(first_problem(nodelist.problems()));
  if (network >= nodelist.networks().size()) {
    return std::unexpected(
        fmt::format("has {}, not {}", ascii::counted(nodelist.networks().size(), "network"), network + 1));
  }
  NetworkProject project(std::move(list), std::move(read), std::move(nodelist), network);
  project.find_ = std::move(find);
  project.original_[project.list_path_] = **text;
  project.read_notes();
  project.read_nodes();
  return project;
}

std::expected<NetworkProject, std::string> NetworkProject::make(std::string list, ReadFile read,
                                                                std::string_view network_name) {
  const auto text = read(list);
  if (!text) return std::unexpected(text.error());
  if (*text) return std::unexpected("the file is there already");
  NetworkProject project(std::move(list), std::move(read), Nodelist(), 0);
  project.original_[project.list_path_] = std::nullopt;
  project.read_notes();
  if (auto named = project.set_name(network_name); !named) return std::unexpected(named.error());
  return project;
}

std::string NetworkProject::in_folder(std::string_view name) const {
  const std::size_t slash = list_path_.rfind('/');
  return slash == std::string::npos ? std::string(name) : list_path_.substr(0, slash + 1) + std::string(name);
}

std::string NetworkProject::path_in_other_case(const std::string& name) const {
  if (!find_) return {};
  const auto found = find_(in_folder(""), name);
  return found ? in_folder(*found) : std::string();
}

void NetworkProject::read_notes() {
  const std::string path = notes_path(list_path_);
  auto text = read_(path);
  // An unreadable file has no notes, and is not overwritten.
  notes_ = text ? ProjectNotes(*text, network_) : ProjectNotes::unreadable(text.error());
  if (text) original_[path] = std::move(*text);
}

void NetworkProject::read_nodes() {
  nodes_.clear();
  for (const ListedNode& listed : network().nodes) {
    ProjectNode node{.listed = listed, .path = {}};
    read_node(node);
    nodes_.push_back(std::move(node));
  }
}

void NetworkProject::read_node(ProjectNode& node) {
  if (node.listed.dcf_name.empty()) {
    node.unreadable = "the list names no DCF for it";
    return;
  }
  const auto listed = listed_path(node.listed.dcf_name);
  if (!listed) {
    node.unreadable = listed.error();
    return;
  }
  node.path = in_folder(listed->path);
  auto text = read_(node.path);
  if (text && !*text) {
    if (std::string other = path_in_other_case(listed->path); !other.empty()) {
      node.path_note =
          fmt::format("{} is not there, {} is taken: its name differs in upper and lower case alone",
                      eds::printable(node.path), eds::printable(other));
      node.path = std::move(other);
      text = read_(node.path);
    }
  }
  if (!text || !*text) {
    node.unreadable = text ? "there is no such file" : text.error();
    return;
  }
  original_[node.path] = **text;
  put(node, eds::DeviceText(**text));
}

void NetworkProject::put(ProjectNode& node, eds::DeviceText text) {
  node.text = std::move(text);
  eds::ReadResult read = eds::read_device_file(node.text->text());
  node.device = std::move(read.file);
  node.problems = std::move(read.problems);
  node.unreadable = node.device == nullptr ? first_problem(node.problems) : std::string();
  node.pdos = node.device == nullptr ? std::vector<Pdo>() : read_pdos(*node.device, node.id());
}

const ProjectNode* NetworkProject::find(std::uint8_t node_id) const noexcept {
  const auto place = std::ranges::find(nodes_, node_id, &ProjectNode::id);
  return place == nodes_.end() ? nullptr : &*place;
}

ProjectNode* NetworkProject::find_own(std::uint8_t node_id) noexcept {
  const auto place = std::ranges::find(nodes_, node_id, &ProjectNode::id);
  return place == nodes_.end() ? nullptr : &*place;
}

std::expected<const ProjectNode*, std::string> NetworkProject::find(std::string_view node) const {
  if (const auto number = ascii::parse_number_with_prefix<unsigned>(node)) {
    const auto place =
        std::ranges::find_if(nodes_, [&](const ProjectNode& one) { return one.id() == *number; });
    if (place != nodes_.end()) return &*place;
    return std::unexpected(fmt::format("the project has no node {}", *number));
  }
  const ProjectNode* found = nullptr;
  for (const ProjectNode& one : nodes_) {
    if (one.listed.name == node) return &one;
    if (!ascii::equal_ignoring_case(one.listed.name, node)) continue;
    if (found != nullptr) {
      return std::unexpected(fmt::format("{} and {} are called \"{}\": use the node-ID", found->shown_name(),
                                         one.shown_name(), eds::printable(node)));
    }
    found = &one;
  }
  if (found != nullptr) return found;
  return std::unexpected(
      fmt::format("the project has no node \"{}\"; expected a node-ID or a name", eds::printable(node)));
}

std::uint32_t NetworkProject::bit_rate() const {
  std::uint32_t rate = 0;
  for (const ProjectNode& node : nodes_) {
    if (node.device == nullptr || !node.device->commissioning) continue;
    const std::uint32_t own = node.device->commissioning->bit_rate;
    if (own == 0) continue;
    if (rate != 0 && own != rate) return 0;
    rate = own;
  }
  return rate;
}

std::uint8_t NetworkProject::free_node_id() const noexcept {
  for (std::uint8_t id = 1; id <= highest_node_id; ++id) {
    if (find(id) == nullptr) return id;
  }
  return 0;
}

Done NetworkProject::set_name(std::string_view name) { return list_.set_network_name(network_, name); }

std::expected<ProjectNode*, std::string> NetworkProject::editable(std::uint8_t node_id) {
  ProjectNode* node = find_own(node_id);
  if (node == nullptr) return std::unexpected(fmt::format("the project has no node {}", node_id));
  if (node->device == nullptr) {
    return std::unexpected(
        fmt::format("{}: {}", node->path.empty() ? node->shown_name() : node->path, node->unreadable));
  }
  return node;
}

Done NetworkProject::set_bit_rate(std::uint32_t bit_rate) {
  std::vector<std::pair<ProjectNode*, eds::DeviceText>> changed;
  for (ProjectNode& one : nodes_) {
    const auto node = editable(one.id());
    if (!node) return std::unexpected(node.error());
    const auto& rates = one.device->device.bit_rates;
    if (!rates.empty() && std::ranges::find(rates, bit_rate) == rates.end()) {
      std::string known;
      for (const std::uint32_t rate : rates)
        known += fmt::format("{}{}", known.empty() ? "" : ", ", rate / 1000);
      return std::unexpected(fmt::format("{} does not have {} kbit/s: its file says {}", one.shown_name(),
                                         bit_rate / 1000, known));
    }
    eds::DeviceText text = *one.text;
    const auto done =
        text.configure({}, {.node_id = one.id(), .node_name = {}, .bit_rate = bit_rate, .network_name = {}});
    if (!done) return std::unexpected(fmt::format("{}: {}", one.path, done.error()));
    changed.emplace_back(&one, std::move(text));
  }
  for (auto& [node, text] : changed) put(*node, std::move(text));
  return {};
}

std::expected<std::string, std::string> NetworkProject::free_file_name(const std::string& name,
                                                                       std::uint8_t node_id,
                                                                       std::string_view extension) const {
  const std::string plain = as_file_name(name);
  const std::array candidates = {plain.empty() ? fmt::format("node{}", node_id) : plain,
                                 fmt::format("{}{}{}", plain, plain.empty() ? "node" : "-", node_id),
                                 fmt::format("node-{}-{}", node_id, plain)};
  for (const std::string& candidate : candidates) {
    std::string file = fmt::format("{}.{}", candidate, extension);
    const std::string path = in_folder(file);
    const bool is_used = std::ranges::any_of(
        nodes_, [&](const ProjectNode& node) { return ascii::equal_ignoring_case(node.path, path); });
    if (is_used) continue;
    const auto there = read_(path);
    if (!there) return std::unexpected(there.error());
    if (!*there) return file;
  }
  return std::unexpected(fmt::format("there are files {0}.{3}, {1}.{3} and {2}.{3} already", candidates[0],
                                     candidates[1], candidates[2], extension));
}

std::expected<std::uint8_t, std::string> NetworkProject::add_node(const NewNode& node) {
  const std::uint8_t id = node.node_id != 0 ? node.node_id : free_node_id();
  if (id == 0) return std::unexpected("all 127 node-IDs are in use");
  if (id > highest_node_id) return std::unexpected(fmt::format("node-ID {}: expected 1 to 127", id));
  if (const ProjectNode* other = find(id); other != nullptr) {
    const std::uint8_t free = free_node_id();
    return std::unexpected(fmt::format("{} has this node-ID{}", other->shown_name(),
                                       free == 0 ? "" : fmt::format("; {} is free", free)));
  }
  const eds::ReadResult read = eds::read_device_file(node.eds);
  if (read.file == nullptr) return std::unexpected(first_problem(read.problems));
  ListedNode listed{.node_id = id, .name = node.name, .reference = {}, .dcf_name = {}};
  if (listed.name.empty()) listed.name = std::string(eds::trim(read.file->device.product_name));
  auto name = free_file_name(listed.name, id, eds::is_xml(node.eds) ? "xdc" : "dcf");
  if (!name) return std::unexpected(std::move(name.error()));
  listed.dcf_name = std::move(*name);
  auto text =
      eds::make_device_configuration(node.eds, {.file_name = listed.dcf_name, .eds_name = node.eds_name},
                                     {.node_id = id,
                                      .node_name = listed.name,
                                      .bit_rate = node.bit_rate != 0 ? node.bit_rate : bit_rate(),
                                      .network_name = network().name});
  if (!text) return std::unexpected(std::move(text.error()));
  if (auto done = list_.set_node(network_, listed); !done) return std::unexpected(done.error());
  ProjectNode added{.listed = *network().find(id), .path = in_folder(listed.dcf_name)};
  original_.try_emplace(added.path);
  put(added, std::move(*text));
  const auto place = std::ranges::find_if(nodes_, [&](const ProjectNode& one) { return one.id() > id; });
  nodes_.insert(place, std::move(added));
  return id;
}

Done NetworkProject::set_note(std::uint8_t node_id, std::string_view note) {
  if (find(node_id) == nullptr) return std::unexpected(fmt::format("the project has no node {}", node_id));
  const auto done = notes_.set(node_id, note);
  if (!done) return std::unexpected(fmt::format("{}: {}", notes_path(list_path_), done.error()));
  return {};
}

Done NetworkProject::remove_node(std::uint8_t node_id) {
  if (find(node_id) == nullptr) return std::unexpected(fmt::format("the project has no node {}", node_id));
  if (auto done = set_note(node_id, ""); !done) return done;
  if (auto done = list_.remove_node(network_, node_id); !done) return done;
  std::erase_if(nodes_, [&](const ProjectNode& node) { return node.id() == node_id; });
  return {};
}

Done NetworkProject::change_node(std::uint8_t node_id, const ListedNode& node) {
  ProjectNode* own = find_own(node_id);
  if (own == nullptr) return std::unexpected(fmt::format("the project has no node {}", node_id));
  const bool moves = node.node_id != node_id;
  if (const ProjectNode* other = find(node.node_id); moves && other != nullptr) {
    return std::unexpected(fmt::format("{} has node-ID {}", other->shown_name(), node.node_id));
  }
  std::optional<eds::DeviceText> text;
  if (moves || node.name != own->listed.name) {
    if (auto usable = editable(node_id); !usable) return std::unexpected(usable.error());
    text = own->text;
    const auto made =
        text->configure({}, {.node_id = node.node_id, .node_name = node.name, .network_name = {}});
    if (!made) return std::unexpected(fmt::format("{}: {}", own->path, made.error()));
  }
  Nodelist list = list_;
  ProjectNotes notes = notes_;
  if (moves) {
    if (auto done = list.remove_node(network_, node_id); !done) return done;
    const std::string note = notes.note(node_id);
    if (auto done = notes.set(node_id, ""); !done) return done;
    if (auto done = notes.set(node.node_id, note); !done) return done;
  }
  if (auto done = list.set_node(network_, node); !done) return done;
  notes_ = std::move(notes);
  list_ = std::move(list);
  own->listed = *network().find(node.node_id);
  if (text) put(*own, std::move(*text));
  std::ranges::sort(nodes_, {}, &ProjectNode::id);
  return {};
}

Done NetworkProject::set_value(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                               std::string_view value) {
  const auto node = editable(node_id);
  if (!node) return std::unexpected(node.error());
  eds::DeviceText text = *(*node)->text;
  if (auto done = text.set_parameter_value(index, sub, value); !done) return done;
  put(**node, std::move(text));
  return {};
}

Done NetworkProject::remove_value(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub) {
  const auto node = editable(node_id);
  if (!node) return std::unexpected(node.error());
  eds::DeviceText text = *(*node)->text;
  if (auto done = text.remove_parameter_value(index, sub); !done) return done;
  put(**node, std::move(text));
  return {};
}

std::map<std::string, std::optional<std::string>> NetworkProject::changes() const {
  std::map<std::string, std::optional<std::string>> now;
  for (const auto& [path, text] : original_) now[path] = std::nullopt;
  now[list_path_] = list_.text();
  // Keeps the files of other networks of the same list.
  for (const ListedNetwork& other : list_.networks()) {
    for (const ListedNode& node : other.nodes) {
      const auto listed = listed_path(node.dcf_name);
      if (!listed) continue;
      auto kept = original_.find(in_folder(listed->path));
      if (kept == original_.end()) kept = original_.find(path_in_other_case(listed->path));
      if (kept != original_.end()) now[kept->first] = kept->second;
    }
  }
  if (const auto path = notes_path(list_path_); original_.contains(path)) now[path] = notes_.text();
  for (const ProjectNode& node : nodes_) {
    if (node.text) now[node.path] = node.text->text();
  }
  std::erase_if(now, [&](const auto& file) {
    const auto before = original_.find(file.first);
    return before != original_.end() && before->second == file.second;
  });
  return now;
}

}  // namespace canopus::network_project
