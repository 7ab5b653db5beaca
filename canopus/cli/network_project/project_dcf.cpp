// Commands that hold a node of a project against a DCF: save it, compare with another one, take its values over.

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/eds/writer.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using network_project::NetworkProject;
using network_project::ProjectNode;
using Json = text::Json;

/// A value that the project's node and the DCF have otherwise, as device files write it; nothing: it is not configured there.
struct DcfDifference {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::string name{};
  std::optional<std::string> project{};
  std::optional<std::string> dcf{};
  bool is_known = true;  // the project's device has the object
};

using ConfiguredValues = std::map<std::pair<std::uint16_t, std::uint8_t>, std::string>;

ConfiguredValues configured_values(const eds::DeviceFile& file) {
  ConfiguredValues values;
  for (const eds::EntryFacts& facts : file.facts) {
    if (!facts.configured) continue;
    const auto entry = file.dictionary->find(facts.index, facts.sub);
    if (!entry) continue;
    if (auto text = eds::default_text(*file.dictionary, entry))
      values[{facts.index, facts.sub}] = std::move(*text);
  }
  return values;
}

std::vector<DcfDifference> differences(const eds::DeviceFile& project, const eds::DeviceFile& dcf) {
  std::map<std::pair<std::uint16_t, std::uint8_t>, DcfDifference> all;
  for (auto& [place, text] : configured_values(project)) all[place].project = text;
  for (auto& [place, text] : configured_values(dcf)) all[place].dcf = text;
  std::vector<DcfDifference> found;
  for (auto& [place, one] : all) {
    if (one.project == one.dcf) continue;
    std::tie(one.index, one.sub) = place;
    const auto own = project.dictionary->find(one.index, one.sub);
    one.is_known = static_cast<bool>(own);
    if (own) {
      one.name = project.dictionary->name(own);
    } else if (const auto theirs = dcf.dictionary->find(one.index, one.sub)) {
      one.name = dcf.dictionary->name(theirs);
    }
    found.push_back(std::move(one));
  }
  return found;
}

std::string_view state_of(const DcfDifference& one) {
  if (!one.is_known) return "not in the device";
  return !one.dcf ? "only in the project" : !one.project ? "only in the DCF" : "different";
}

void print_result(const ProjectArguments& arguments, const DcfDifference& one) {
  const std::string object = canopen::object_text(one.index, one.sub);
  if (arguments.bus.json) {
    Json row{{"object", object}, {"name", one.name}, {"state", state_of(one)}};
    if (one.project) row["project"] = *one.project;
    if (one.dcf) row["dcf"] = *one.dcf;
    return print_json(row);
  }
  print_line("{}  {}  {} -> {}  {}", object, text::printable(one.name),
             text::printable(one.project.value_or("-")), text::printable(one.dcf.value_or("-")),
             state_of(one));
}

/// The device file of `arguments.file`, of the same device as the node's; else `code` is the exit code.
std::shared_ptr<const eds::DeviceFile> read_dcf(const ProjectArguments& arguments, const ProjectNode& node,
                                                int& code) {
  const auto fail = [&](int failure, const std::string& why) {
    code = project_failed(failure, fmt::format("{}: {}", arguments.file, why));
    return nullptr;
  };
  if (node.device == nullptr)
    return fail(project_code::file, fmt::format("{}: {}", node.shown_name(), node.trouble()));
  const auto text = text::read_file(arguments.file);
  if (!text) {
    code = project_failed(project_code::file, text.error());
    return nullptr;
  }
  const eds::ReadResult read = eds::read_device_file(*text);
  if (read.file == nullptr) {
    return fail(project_code::file, read.problems.empty() ? std::string("is no device file")
                                                          : fmt::format("{}: {}", read.problems.front().line,
                                                                        read.problems.front().message));
  }
  const eds::Identity own = eds::identity(*node.device);
  const eds::Identity theirs = eds::identity(*read.file);
  const auto differs = [](const auto& a, const auto& b) { return a && b && *a != 0 && *b != 0 && *a != *b; };
  if (differs(own.vendor_id, theirs.vendor_id) || differs(own.product_code, theirs.product_code)) {
    return fail(
        project_code::refused,
        fmt::format("is of another device: vendor-ID {:08X}H, product code {:08X}H; {} has {:08X}H, {:08X}H",
                    theirs.vendor_id.value_or(0), theirs.product_code.value_or(0), node.shown_name(),
                    own.vendor_id.value_or(0), own.product_code.value_or(0)));
  }
  return read.file;
}

}  // namespace

int save_dcf(const ProjectArguments& arguments) {
  return with_network(arguments, [&](const ProjectFolder& folder, const NetworkProject& project) {
    const auto node = project.find(arguments.node);
    if (!node) return project_failed(project_code::refused, node.error());
    if (!(*node)->text) {
      return project_failed(project_code::file,
                            fmt::format("{}: {}", folder.shown_path((*node)->path), (*node)->unreadable));
    }
    const auto written = write_new_file(arguments.file, (*node)->text->text());
    if (!written) return project_failed(project_code::file, written.error());
    if (arguments.bus.json) {
      print_json(Json{{"event", "saved"}, {"node", (*node)->id()}, {"file", (*node)->path}});
    } else {
      print_line("{}: {}", arguments.file, (*node)->shown_name());
    }
    return project_code::done;
  });
}

int compare_dcf(const ProjectArguments& arguments) {
  return with_network(arguments, [&](const ProjectFolder&, const NetworkProject& project) {
    const auto node = project.find(arguments.node);
    if (!node) return project_failed(project_code::refused, node.error());
    int code = project_code::done;
    const auto dcf = read_dcf(arguments, **node, code);
    if (dcf == nullptr) return code;
    const auto found = differences(*(*node)->device, *dcf);
    for (const DcfDifference& one : found) print_result(arguments, one);
    if (found.empty() && !arguments.bus.json) print_line("{}: the same values", (*node)->shown_name());
    return found.empty() ? project_code::done : project_code::different;
  });
}

int load_dcf(const ProjectArguments& arguments) {
  return change_network(
      arguments, "dcf load " + arguments.node, [&](ProjectFolder&, NetworkProject& project) {
        const auto node = project.find(arguments.node);
        if (!node) return project_failed(project_code::refused, node.error());
        int code = project_code::done;
        const auto dcf = read_dcf(arguments, **node, code);
        if (dcf == nullptr) return code;
        const std::uint8_t id = (*node)->id();
        const std::string shown = (*node)->shown_name();
        for (const DcfDifference& one : differences(*(*node)->device, *dcf)) {
          print_result(arguments, one);
          if (!one.is_known) continue;
          const auto done = one.dcf ? project.set_value(id, one.index, one.sub, *one.dcf)
                                    : project.remove_value(id, one.index, one.sub);
          if (!done) {
            return project_failed(
                project_code::refused,
                fmt::format("{}: {}: {}", shown, canopen::object_text(one.index, one.sub), done.error()));
          }
        }
        return project_code::done;
      });
}

}  // namespace canopus::cli
