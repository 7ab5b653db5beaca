#include "canopus/project/nodelist/project_members.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "canopus/eds/number.hpp"
#include "canopus/project/nodelist/nodelist.hpp"

namespace canopus::project {
namespace {

/// A number of [DeviceComissioning], in either spelling; 0 when there is none.
std::uint64_t commissioned(const eds::IniText& dcf, std::string_view key) {
  for (const std::string_view section : {"DeviceComissioning", "DeviceCommissioning"}) {
    const auto value = dcf.value(section, key);
    if (!value) continue;
    const auto number = eds::read_number(*value);
    return number && !number->negative ? number->magnitude : 0;
  }
  return 0;
}

}  // namespace

ProjectMembers read_members(
    const std::string& list, std::size_t network,
    const std::function<std::expected<std::string, std::string>(const std::string& path)>& read) {
  ProjectMembers result;
  const auto text = read(list);
  if (!text) {
    result.errors.push_back(text.error());
    return result;
  }
  const Nodelist nodelist(*text);
  for (const eds::Problem& problem : nodelist.problems()) {
    if (problem.severity != eds::Problem::Severity::error) continue;
    result.errors.push_back(list + ":" + std::to_string(problem.line) + ": " + problem.message);
  }
  if (!result.errors.empty()) return result;
  if (network >= nodelist.networks().size()) {
    result.errors.push_back(list + ": has " + eds::counted(nodelist.networks().size(), "network") + ", not " +
                            std::to_string(network + 1));
    return result;
  }
  const std::size_t slash = list.rfind('/');
  const std::string folder = slash == std::string::npos ? std::string() : list.substr(0, slash + 1);
  std::optional<std::uint32_t> rate;  // 0: they differ
  for (const ListedNode& node : nodelist.networks()[network].nodes) {
    if (!node.present) continue;
    const std::string who =
        list + ":" + std::to_string(node.line) + ": node " + std::to_string(node.node_id) + ": ";
    const auto path = path_in_project(node.dcf_name);
    if (!path) {
      result.errors.push_back(who + path.error());
      continue;
    }
    const auto dcf_text = read(folder + *path);
    if (!dcf_text) {
      result.errors.push_back(who + dcf_text.error());
      continue;
    }
    const eds::IniText dcf(*dcf_text);
    result.members.push_back({.node_id = node.node_id,
                              .name = node.name,
                              .path = folder + *path,
                              .is_manager = commissioned(dcf, "CANopenManager") != 0});
    const auto own =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(commissioned(dcf, "Baudrate"), 1000) * 1000);
    if (own != 0) rate = rate.value_or(own) == own ? own : 0;
  }
  result.bit_rate = rate.value_or(0);
  return result;
}

}  // namespace canopus::project
