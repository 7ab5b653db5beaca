// Commands about the PDOs of a project.

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/network_project/pdo_link.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using network_project::NetworkProject;
using network_project::Pdo;
using network_project::ProjectNode;
using Json = text::Json;

/// "tpdo1", "RPDO3"; nothing: the node has none of that name.
const Pdo* find_pdo(const ProjectNode& node, std::string_view name) {
  const auto found = std::ranges::find_if(
      node.pdos, [&](const Pdo& pdo) { return ascii::equal_ignoring_case(pdo.name(), name); });
  return found == node.pdos.end() ? nullptr : &*found;
}

std::string title_of(const ProjectNode& node, std::uint16_t index, std::uint8_t sub) {
  const canopen::Entry entry = node.device->dictionary->find(index, sub);
  return entry ? network_project::object_title(*node.device, entry) : "?";
}

Json pdo_json(const ProjectNode& node, const Pdo& pdo,
              const std::vector<network_project::SignalLink>& links) {
  Json json{{"node", node.id()},
            {"pdo", pdo.name()},
            {"active", pdo.is_active()},
            {"cob_id", pdo.cob_id.raw},
            {"can_id", pdo.cob_id.identifier()},
            {"transmission_type", pdo.transmission_type}};
  if (pdo.inhibit_time) json["inhibit_us"] = *pdo.inhibit_time * 100;
  if (pdo.event_timer) json["event_ms"] = *pdo.event_timer;
  json["bytes"] = pdo.length();
  json["mapping"] = Json::array();
  unsigned bit = 0;
  for (const network_project::MappedObject& object : pdo.mapping) {
    Json mapped{{"bit", bit}, {"bits", object.bits}};
    if (!object.is_dummy()) {
      mapped["object"] = canopen::object_text(object.index, object.sub);
      mapped["name"] = title_of(node, object.index, object.sub);
    }
    for (const network_project::SignalLink& link : links) {
      const auto& own = pdo.transmit ? link.from : link.to;
      const auto& other = pdo.transmit ? link.to : link.from;
      const bool is_it = own.node_id == node.id() && (pdo.transmit ? link.tpdo : link.rpdo) == pdo.number &&
                         link.first_bit == bit;
      if (!is_it) continue;
      mapped[pdo.transmit ? "to" : "from"].push_back(
          Json{{"node", other.node_id}, {"object", canopen::object_text(other.index, other.sub)}});
    }
    bit += object.bits;
    json["mapping"].push_back(std::move(mapped));
  }
  return json;
}

/// "-> node 5 (drive): 60FF:00 Target velocity"
std::string other_ends(const NetworkProject& project, const ProjectNode& node, const Pdo& pdo, unsigned bit,
                       const std::vector<network_project::SignalLink>& links) {
  std::string text;
  for (const network_project::SignalLink& link : links) {
    const auto& own = pdo.transmit ? link.from : link.to;
    const auto& other = pdo.transmit ? link.to : link.from;
    if (own.node_id != node.id() || (pdo.transmit ? link.tpdo : link.rpdo) != pdo.number ||
        link.first_bit != bit)
      continue;
    const ProjectNode& end = *project.find(other.node_id);
    text += fmt::format("{}{} {}: {} {}", text.empty() ? "  " : ", ", pdo.transmit ? "->" : "<-",
                        end.shown_name(), eds::object_text(other.index, other.sub),
                        title_of(end, other.index, other.sub));
  }
  return text;
}

void print_pdo(const NetworkProject& project, const ProjectNode& node, const Pdo& pdo,
               const std::vector<network_project::SignalLink>& links) {
  std::string times;
  if (pdo.inhibit_time.value_or(0) != 0)
    times += fmt::format(", inhibit time {} ms", *pdo.inhibit_time / 10.0);
  if (pdo.event_timer.value_or(0) != 0) times += fmt::format(", event timer {} ms", *pdo.event_timer);
  print_line("  {:<6}  {}  {}, {}{}", pdo.name(),
             pdo.is_active() ? network_project::describe_can_id(pdo.cob_id) : "off",
             ascii::counted(pdo.length(), "byte"),
             network_project::describe_transmission_type(pdo.transmission_type, pdo.transmit), times);
  unsigned bit = 0;
  for (const network_project::MappedObject& object : pdo.mapping) {
    const std::string what = object.is_dummy()
                                 ? "(unused)"
                                 : fmt::format("{} {}", eds::object_text(object.index, object.sub),
                                               title_of(node, object.index, object.sub));
    print_line("    bit {:>2} {:>2}  {}{}", bit, object.bits, what,
               other_ends(project, node, pdo, bit, links));
    bit += object.bits;
  }
}

/// "NODE.SIGNAL": the node's name may have points, too.
std::expected<network_project::SignalEnd, std::string> parse_signal(const NetworkProject& project,
                                                                    const std::string& text) {
  std::string why;
  for (std::size_t point = text.find('.'); point != std::string::npos; point = text.find('.', point + 1)) {
    const auto node = project.find(std::string_view(text).substr(0, point));
    if (!node) {
      if (why.empty()) why = node.error();
      continue;
    }
    const auto entry = find_object(**node, std::string_view(text).substr(point + 1));
    if (!entry) return std::unexpected(entry.error());
    return network_project::SignalEnd{(*node)->id(), entry->index, entry->sub};
  }
  if (!why.empty()) return std::unexpected(std::move(why));
  return std::unexpected(
      fmt::format("\"{}\": expected NODE.SIGNAL, for example 5.6000:01 or Pump.Statusword", text));
}

void print_changes(const ProjectArguments& arguments, const NetworkProject& project,
                   const std::vector<network_project::PdoChange>& changes) {
  const auto links = find_links(project);
  for (const network_project::PdoChange& change : changes) {
    const ProjectNode& node = *project.find(change.node_id);
    if (arguments.bus.json) {
      print_json(pdo_json(node, change.after, links));
      continue;
    }
    print_line("{}: {} was {}", node.shown_name(), change.after.name(),
               change.before.is_active()
                   ? fmt::format("{}: {}", network_project::describe_can_id(change.before.cob_id),
                                 network_project::describe_mapping(change.before))
                   : "off");
    print_pdo(project, node, change.after, links);
  }
}

/// The node and PDO of the arguments.
struct Found {
  std::uint8_t node_id = 0;
  Pdo pdo{};
};
std::expected<Found, std::string> find_pdo(const NetworkProject& project, const ProjectArguments& arguments) {
  const auto node = project.find(arguments.node);
  if (!node) return std::unexpected(node.error());
  const Pdo* const pdo = find_pdo(**node, arguments.pdo);
  if (pdo != nullptr) return Found{(*node)->id(), *pdo};
  std::string known;
  for (const Pdo& one : (*node)->pdos) known += (known.empty() ? "" : ", ") + one.name();
  return std::unexpected(fmt::format("{} has no {}; it has {}", (*node)->shown_name(),
                                     eds::printable(arguments.pdo), known.empty() ? "none" : known));
}

/// Times and COB-ID that the options give; the error names what was expected.
std::expected<void, std::string> apply_options(const ProjectArguments& arguments,
                                               const NetworkProject& project, std::uint8_t node_id,
                                               Pdo& pdo) {
  const auto number = [](const std::string& text, std::uint64_t most) -> std::optional<std::uint64_t> {
    const auto read = eds::read_number(text);
    const bool is_good = read && !read->negative && !read->adds_node_id && read->magnitude <= most;
    return is_good ? std::optional(read->magnitude) : std::nullopt;
  };
  if (!arguments.type.empty()) {
    const auto type = number(arguments.type, 255);
    if (!type || (*type > 240 && *type < 252)) {
      return std::unexpected(fmt::format("--type {}: expected 0 to 240 or 252 to 255", arguments.type));
    }
    pdo.transmission_type = static_cast<std::uint8_t>(*type);
  }
  const auto time = [](const std::string& text, can::Duration unit,
                       const char* option) -> std::expected<std::uint16_t, std::string> {
    const auto duration = text::parse_duration(text);
    const bool is_good = duration && *duration % unit == can::Duration{} && *duration / unit <= 0xFFFF;
    if (is_good) return static_cast<std::uint16_t>(*duration / unit);
    return std::unexpected(fmt::format("{} {}: expected a time in steps of {}, at most {}", option, text,
                                       text::describe_duration(unit),
                                       text::describe_duration(0xFFFF * unit)));
  };
  if (!arguments.inhibit.empty()) {
    const auto inhibit = time(arguments.inhibit, std::chrono::microseconds(100), "--inhibit");
    if (!inhibit) return std::unexpected(inhibit.error());
    if (!pdo.inhibit_time) return std::unexpected(pdo.name() + " has no inhibit time (sub-index 03H)");
    pdo.inhibit_time = *inhibit;
  }
  if (!arguments.event.empty()) {
    const auto event = time(arguments.event, std::chrono::milliseconds(1), "--event");
    if (!event) return std::unexpected(event.error());
    if (!pdo.event_timer) return std::unexpected(pdo.name() + " has no event timer (sub-index 05H)");
    pdo.event_timer = *event;
  }
  if (arguments.cob_id.empty()) return {};
  if (arguments.cob_id == "free") {
    pdo.cob_id.raw =
        (pdo.cob_id.raw & canopen::CobId::bit_30) | network_project::free_can_id(project, node_id);
    return {};
  }
  const auto id = number(arguments.cob_id, 0x1FFF'FFFF);
  if (!id)
    return std::unexpected(
        fmt::format("--can-id {}: expected 0x181 to 0x1FFFFFFF, or free", arguments.cob_id));
  const std::uint32_t extended = *id > 0x7FF ? canopen::CobId::extended_bit : 0;
  pdo.cob_id.raw = (pdo.cob_id.raw & canopen::CobId::bit_30) | extended | static_cast<std::uint32_t>(*id);
  if (canopen::is_restricted(pdo.cob_id)) {
    return std::unexpected(
        fmt::format("--can-id {}: CiA 301 has this CAN-ID for another service", arguments.cob_id));
  }
  return {};
}

}  // namespace

int list_network_pdos(const ProjectArguments& arguments) {
  return with_network(arguments, [&](const ProjectFolder&, const NetworkProject& project) {
    std::vector<const ProjectNode*> nodes;
    if (arguments.node.empty()) {
      for (const ProjectNode& node : project.nodes()) nodes.push_back(&node);
    } else {
      const auto node = project.find(arguments.node);
      if (!node) return project_failed(project_code::refused, node.error());
      nodes.push_back(*node);
    }
    const auto links = find_links(project);
    for (const ProjectNode* node : nodes) {
      if (!arguments.bus.json)
        print_line("{}{}", node->shown_name(), node->device == nullptr ? ": " + node->unreadable : "");
      for (const Pdo& pdo : node->pdos) {
        if (!pdo.is_active() && !arguments.all_values) continue;
        if (arguments.bus.json) {
          print_json(pdo_json(*node, pdo, links));
        } else {
          print_pdo(project, *node, pdo, links);
        }
      }
    }
    return project_code::done;
  });
}

int map_network_pdo(const ProjectArguments& arguments) {
  return change_network(
      arguments, fmt::format("pdo map {} {}", arguments.node, arguments.pdo),
      [&](ProjectFolder&, NetworkProject& project) {
        const auto found = find_pdo(project, arguments);
        if (!found) return project_failed(project_code::refused, found.error());
        Pdo pdo = found->pdo;
        const ProjectNode& node = *project.find(found->node_id);
        if (!arguments.items.empty()) pdo.mapping.clear();
        for (const std::string& item : arguments.items) {
          const auto entry = find_object(node, item);
          if (!entry) return project_failed(project_code::refused, entry.error());
          const unsigned bits = canopen::bit_length(entry->description->type);
          const bool is_mappable =
              pdo.transmit ? entry->description->tpdo_mappable : entry->description->rpdo_mappable;
          if (bits == 0 || !is_mappable) {
            return project_failed(
                project_code::refused,
                fmt::format("{}: {} cannot be mapped into {} by its device file", node.shown_name(),
                            eds::object_text(entry->index, entry->sub), pdo.name()));
          }
          pdo.mapping.push_back({entry->index, entry->sub, static_cast<std::uint8_t>(bits)});
        }
        pdo.cob_id.raw &= ~canopen::CobId::invalid_bit;
        if (const auto taken = apply_options(arguments, project, found->node_id, pdo); !taken) {
          return project_failed(project_code::usage, taken.error());
        }
        if (!canopen::usable(pdo.cob_id).is_valid() || pdo.cob_id.identifier() == 0) {
          return project_failed(
              project_code::refused,
              fmt::format("{}: {} has no CAN-ID yet: give it one with --can-id, for example --can-id free",
                          node.shown_name(), pdo.name()));
        }
        if (const auto done = project.set_pdo(found->node_id, pdo); !done) {
          return project_failed(project_code::refused, done.error());
        }
        print_changes(arguments, project, {{found->node_id, found->pdo, pdo}});
        return project_code::done;
      });
}

int switch_network_pdo_off(const ProjectArguments& arguments) {
  return change_network(arguments, fmt::format("pdo off {} {}", arguments.node, arguments.pdo),
                        [&](ProjectFolder&, NetworkProject& project) {
                          const auto found = find_pdo(project, arguments);
                          if (!found) return project_failed(project_code::refused, found.error());
                          Pdo pdo = found->pdo;
                          pdo.cob_id.raw |= canopen::CobId::invalid_bit;
                          if (const auto done = project.set_pdo(found->node_id, pdo); !done) {
                            return project_failed(project_code::refused, done.error());
                          }
                          print_changes(arguments, project, {{found->node_id, found->pdo, pdo}});
                          return project_code::done;
                        });
}

int link_network_signals(const ProjectArguments& arguments) {
  const std::string title = fmt::format("pdo link {} {}", arguments.items[0], arguments.items[1]);
  return change_network(arguments, title, [&](ProjectFolder&, NetworkProject& project) {
    const auto from = parse_signal(project, arguments.items[0]);
    if (!from) return project_failed(project_code::refused, from.error());
    const auto to = parse_signal(project, arguments.items[1]);
    if (!to) return project_failed(project_code::refused, to.error());
    const auto changes = link_signals(project, *from, *to);
    if (!changes) return project_failed(project_code::refused, changes.error());
    if (changes->empty() && !arguments.bus.json) print_line("it is linked already");
    print_changes(arguments, project, *changes);
    return project_code::done;
  });
}

}  // namespace canopus::cli
