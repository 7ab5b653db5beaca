#include "canopus/network_project/project_members.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "canopus/ascii/counted.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/xdd.hpp"

namespace canopus::network_project {
namespace {

/// The commissioning data of a DCF; those of an XDC, whose elements are found by their schema, come from the
/// device file reader.
struct Commissioned {
  bool is_manager = false;
  std::uint32_t bit_rate = 0;  // bit/s; 0: it has none
};

/// A number of [DeviceComissioning], in either spelling; 0 when there is none.
std::uint64_t number_of(const eds::IniText& dcf, std::string_view key) {
  for (const std::string_view section : {"DeviceComissioning", "DeviceCommissioning"}) {
    const auto value = dcf.value(section, key);
    if (!value) continue;
    const auto number = eds::read_number(*value);
    return number && !number->negative ? number->magnitude : 0;
  }
  return 0;
}

Commissioned commissioned(std::string_view text) {
  if (!eds::is_xml(text)) {
    const eds::IniText dcf(text);
    const std::uint64_t kilobits = std::min<std::uint64_t>(number_of(dcf, "Baudrate"), 1000);
    return {.is_manager = number_of(dcf, "CANopenManager") != 0,
            .bit_rate = static_cast<std::uint32_t>(kilobits * 1000)};
  }
  const eds::ReadResult read = eds::read_device_file(text);
  if (read.file == nullptr || !read.file->commissioning) return {};
  return {.is_manager = read.file->commissioning->canopen_manager,
          .bit_rate = read.file->commissioning->bit_rate};
}

}  // namespace

ProjectMembers read_members(const std::string& list, const std::expected<std::string, std::string>& text,
                            std::size_t network,
                            const std::function<std::expected<std::string, std::string>(
                                const std::string& folder, const std::string& name)>& read_dcf,
                            const FindFile& find) {
  ProjectMembers result;
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
    result.errors.push_back(list + ": has " + ascii::counted(nodelist.networks().size(), "network") +
                            ", not " + std::to_string(network + 1));
    return result;
  }
  const std::size_t slash = list.rfind('/');
  const std::string folder = slash == std::string::npos ? std::string() : list.substr(0, slash + 1);
  std::optional<std::uint32_t> rate;  // 0: they differ
  for (const ListedNode& node : nodelist.networks()[network].nodes) {
    if (!node.present) continue;
    const std::string place =
        list + ":" + std::to_string(node.line) + ": node " + std::to_string(node.node_id) + ": ";
    const auto listed = listed_path(node.dcf_name);
    if (!listed) {
      result.errors.push_back(place + listed.error());
      continue;
    }
    std::string path = listed->path;
    auto dcf_text = read_dcf(folder, path);
    if (!dcf_text && find) {
      if (const auto other = find(folder, path)) {
        path = *other;
        dcf_text = read_dcf(folder, path);
      }
    }
    if (!dcf_text) {
      result.errors.push_back(place + dcf_text.error());
      continue;
    }
    const Commissioned own = commissioned(*dcf_text);
    result.members.push_back(
        {.node_id = node.node_id, .name = node.name, .path = folder + path, .is_manager = own.is_manager});
    if (own.bit_rate != 0) rate = rate.value_or(own.bit_rate) == own.bit_rate ? own.bit_rate : 0;
  }
  result.bit_rate = rate.value_or(0);
  return result;
}

}  // namespace canopus::network_project
