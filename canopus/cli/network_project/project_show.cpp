// Commands that only read a project.

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/cli/network_project/network_check.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/client/sdo_value.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/network_project/network_load.hpp"
#include "canopus/text/json.hpp"
#include "canopus/trace/decode/object_meaning.hpp"

namespace canopus::cli {
namespace {

using network_project::NetworkProject;
using network_project::ProjectNode;
using Json = text::Json;
using Severity = eds::Problem::Severity;

std::size_t count(const ProjectNode& node, bool transmit) {
  return static_cast<std::size_t>(std::ranges::count_if(node.pdos, [&](const network_project::Pdo& pdo) {
    return pdo.transmit == transmit && pdo.is_active();
  }));
}

/// "12 %"
std::string percent(double share) { return fmt::format("{:.{}f} %", share * 100, share < 0.1 ? 1 : 0); }

std::string describe_load(const network_project::NetworkLoad& load) {
  if (load.bit_rate == 0) return "bit rate not known";
  std::string text = fmt::format("{} kbit/s, load {} by timers and SYNC, {} at most", load.bit_rate / 1000,
                                 percent(load.steady), percent(load.most));
  if (load.unlimited != 0) {
    text += fmt::format(" and {} without a limit", ascii::counted(load.unlimited, "TPDO"));
  }
  return text;
}

std::string product_of(const ProjectNode& node) {
  return node.device == nullptr ? node.unreadable : node.device->device.product_name;
}

Json node_json(const NetworkProject& project, const ProjectNode& node) {
  Json json{{"node", node.id()}, {"name", node.listed.name}, {"present", node.listed.present}};
  if (!node.listed.reference.empty()) json["reference"] = node.listed.reference;
  if (const std::string note = project.notes().note(node.id()); !note.empty()) json["note"] = note;
  json["file"] = node.path;
  if (node.device == nullptr) {
    json["error"] = node.unreadable;
    return json;
  }
  json["product"] = node.device->device.product_name;
  json["vendor"] = node.device->device.vendor_name;
  const eds::Identity identity = eds::identity(*node.device);
  const auto add = [&](const char* key, std::optional<std::uint32_t> value) {
    if (value) json[key] = *value;
  };
  add("device_type", identity.device_type);
  add("vendor_id", identity.vendor_id);
  add("product_code", identity.product_code);
  add("revision", identity.revision);
  add("serial", identity.serial_number);
  json["tpdos"] = count(node, true);
  json["rpdos"] = count(node, false);
  return json;
}

/// A value as the DCF has it; nothing for one that has no bytes there (a DOMAIN with a file).
std::optional<std::vector<std::uint8_t>> bytes_of(const ProjectNode& node, const canopen::Entry& entry) {
  const auto& dictionary = *node.device->dictionary;
  if (canopen::is_variable_length(entry.description->type)) return dictionary.default_slot(entry.offset);
  const auto value = node.value(entry.index, entry.sub);
  if (!value) return std::nullopt;
  return can::little_endian(*value, entry.description->length);
}

/// Calls visit(entry) for each sub-index that the DCF gives a value, or for all.
template <typename Visit>
void for_each_value(const ProjectNode& node, bool all, Visit visit) {
  const auto& dictionary = *node.device->dictionary;
  for (const canopen::ObjectDescription& object : dictionary.objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const canopen::Entry entry = dictionary.find(object, static_cast<std::uint8_t>(sub));
      const eds::EntryFacts* facts = node.device->find_facts(object.index, static_cast<std::uint8_t>(sub));
      if (entry && (all || (facts != nullptr && facts->configured))) visit(entry);
    }
  }
}

/// Further attributes of a sub-index in the DCF.
void add_facts(Json& line, const ProjectNode& node, const canopen::Entry& entry) {
  const canopen::EntryDescription& description = *entry.description;
  const eds::EntryFacts* const facts = node.device->find_facts(entry.index, entry.sub);
  line["configured"] = facts != nullptr && facts->configured;
  if (facts != nullptr && facts->configured && !facts->default_text.empty())
    line["default"] = facts->default_text.text();
  if (facts != nullptr && !facts->denotation.empty()) line["denotation"] = facts->denotation.text();
  if (description.tpdo_mappable) line["tpdo"] = true;
  if (description.rpdo_mappable) line["rpdo"] = true;
  using enum canopen::DataType;
  const bool has_limits = description.limits != 0 && !canopen::is_variable_length(description.type) &&
                          description.type != real32 && description.type != real64;
  if (!has_limits) return;
  const canopen::Limits& limits = node.device->dictionary->limits(entry);
  const auto shown = [&](std::uint64_t limit) {
    return client::json_value(can::little_endian(limit, description.length), description.type);
  };
  if (limits.low) line["low"] = shown(*limits.low);
  if (limits.high) line["high"] = shown(*limits.high);
}

int show_node(const ProjectArguments& arguments, const NetworkProject& project, const ProjectNode& node) {
  const bool json = arguments.bus.json;
  if (json) {
    print_json(node_json(project, node));
  } else {
    print_line("{}{}", node.shown_name(), node.listed.present ? "" : ", not present");
    if (!node.listed.reference.empty()) print_line("  reference  {}", node.listed.reference);
    if (const std::string note = project.notes().note(node.id()); !note.empty())
      print_line("  note       {}", note);
    print_line("  DCF        {}", node.path.empty() ? "-" : node.path);
    print_line("  product    {}", product_of(node));
  }
  if (node.device == nullptr) return project_code::file;
  if (!json) {
    const eds::Identity identity = eds::identity(*node.device);
    print_line("  identity   device type {:08X}H, vendor-ID {:08X}H, product {:08X}H, revision {:08X}H",
               identity.device_type.value_or(0), identity.vendor_id.value_or(0),
               identity.product_code.value_or(0), identity.revision.value_or(0));
  }
  for_each_value(node, arguments.all_values, [&](const canopen::Entry& entry) {
    const canopen::DataType type = entry.description->type;
    const auto bytes = bytes_of(node, entry);
    const std::string title = network_project::object_title(*node.device, entry);
    if (json) {
      Json line{{"node", node.id()},
                {"object", canopen::object_text(entry.index, entry.sub)},
                {"name", title},
                {"type", eds::name(type)},
                {"access", eds::name(entry.description->access)}};
      line["value"] = bytes ? client::json_value(*bytes, type) : Json();
      if (const auto unit = trace::object_meaning(entry.index, entry.sub).unit; !unit.empty())
        line["unit"] = unit;
      add_facts(line, node, entry);
      return print_json(line);
    }
    const auto value =
        bytes ? client::show_value(*bytes, type) : std::expected<std::string, std::string>("-");
    print_line("  {}  {:<24}  {}", canopen::object_text(entry.index, entry.sub),
               value ? *value : value.error(), title);
  });
  return project_code::done;
}

}  // namespace

int show_network(const ProjectArguments& arguments) {
  return with_network(arguments, [&](const ProjectFolder& folder, const NetworkProject& project) {
    if (!arguments.node.empty()) {
      const auto node = project.find(arguments.node);
      if (!node) return project_failed(project_code::refused, node.error());
      return show_node(arguments, project, **node);
    }
    const network_project::NetworkLoad load = reckon_load(project);
    if (arguments.bus.json) {
      print_json(Json{{"network", project.network().name},
                      {"file", folder.shown_list()},
                      {"networks", project.list().networks().size()},
                      {"bit_rate", load.bit_rate},
                      {"load", load.steady},
                      {"load_at_most", load.most},
                      {"unlimited", load.unlimited}});
      for (const ProjectNode& node : project.nodes()) print_json(node_json(project, node));
      return project_code::done;
    }
    const std::string& name = project.network().name;
    print_line("{}: {}, {}", name.empty() ? folder.shown_list() : name,
               ascii::counted(project.nodes().size(), "node"), describe_load(load));
    if (project.nodes().empty()) return project_code::done;
    std::size_t width = 4;
    for (const ProjectNode& node : project.nodes())
      width = std::max(width, std::min<std::size_t>(node.listed.name.size(), 30));
    print_line("{:>4}  {:<{}}  {:>5}  {:>5}  {:<24}  {}", "node", "name", width, "TPDOs", "RPDOs", "product",
               "DCF");
    for (const ProjectNode& node : project.nodes()) {
      print_line("{:>4}  {:<{}}  {:>5}  {:>5}  {:<24}  {}{}", node.id(), node.listed.name, width,
                 count(node, true), count(node, false), product_of(node), node.path.empty() ? "-" : node.path,
                 node.listed.present ? "" : "  not present");
    }
    for (const ProjectNode& node : project.nodes()) {
      const std::string note = project.notes().note(node.id());
      if (!note.empty()) print_line("note on {}: {}", node.shown_name(), note);
    }
    return project_code::done;
  });
}

int check_network(const ProjectArguments& arguments) {
  return with_network(arguments, [&](const ProjectFolder& folder, const NetworkProject& project) {
    network_project::ExternalPdos external;
    if (!arguments.plant.empty()) {
      auto found = external_pdos(project, arguments.plant, standard_error());
      if (!found) return project_code::file;
      external = std::move(*found);
    }
    std::map<Severity, unsigned> counts;
    for (const network_project::Finding& finding : review_network(project, external)) {
      ++counts[finding.severity];
      const std::string path = folder.shown_path(finding.path);
      if (arguments.bus.json) {
        Json json{{"severity", eds::name(finding.severity)}, {"file", path}};
        if (finding.line != 0) json["line"] = finding.line;
        if (finding.node_id != 0) json["node"] = finding.node_id;
        json["message"] = finding.message;
        print_json(json);
        continue;
      }
      const bool colour = wants_colour(STDOUT_FILENO);
      const char* const code = finding.severity == Severity::error     ? "31"
                               : finding.severity == Severity::warning ? "33"
                                                                       : "2";
      const std::string place = finding.line == 0 ? path : fmt::format("{}:{}", path, finding.line);
      print_line("{}: {}: {}", place, paint(eds::name(finding.severity), code, colour), finding.message);
    }
    const auto counted = [&](Severity severity) {
      return ascii::counted(counts[severity], eds::name(severity));
    };
    if (!arguments.bus.json) {
      print_line("{}: {}, {}, {}", folder.shown_list(), counted(Severity::error), counted(Severity::warning),
                 counted(Severity::note));
    }
    const bool is_good =
        counts[Severity::error] == 0 && (!arguments.strict || counts[Severity::warning] == 0);
    return is_good ? project_code::done : project_code::different;
  });
}

}  // namespace canopus::cli
