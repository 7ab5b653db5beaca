// Any bytes as a nodelist.cpj: read, and a node added that is read again.

#include "canopus/network_project/nodelist.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus::network_project;
  const std::string_view text(reinterpret_cast<const char*>(data), size);  // NOLINT
  Nodelist list(text);
  if (list.text() != text) std::abort();
  for (const canopus::eds::Problem& problem : list.problems()) {
    if (problem.line == 0 || problem.message.empty()) std::abort();
  }
  for (const ListedNetwork& network : list.networks()) {
    for (const ListedNode& node : network.nodes) {
      if (node.node_id < 1 || node.node_id > 127 || network.find(node.node_id) != &node) std::abort();
    }
  }
  if (!list.set_node(0, {9, true, "Name", "", "name.dcf"})) {
    if (list.text() != text) std::abort();
    return 0;
  }
  const Nodelist again(list.text());
  const ListedNode* node = again.networks().at(0).find(9);
  if (node == nullptr || !node->present || node->name != "Name" || node->dcf_name != "name.dcf") std::abort();
  const std::string before = list.text();
  const bool is_removed = list.remove_node(0, 9).has_value();
  // Refused where the rest would be read in another encoding.
  if (is_removed ? list.networks().at(0).find(9) != nullptr : list.text() != before) std::abort();
  return 0;
}
