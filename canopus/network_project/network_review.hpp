#pragma once
// Checks of a project: its files, its bit rate, and the PDOs that go between its nodes.

#include <cstdint>
#include <string>
#include <vector>

#include "canopus/network_project/network_project.hpp"

namespace canopus::network_project {

/// The fault, its reason and a remedy, in one sentence or two.
struct Finding {
  eds::Problem::Severity severity = eds::Problem::Severity::warning;
  std::uint8_t node_id = 0;  ///< 0: the network
  std::string path;          ///< of the file
  unsigned line = 0;         ///< in it, from 1; 0: nowhere
  std::string message;
};

/// Errors first, then warnings, then notes; each by node-ID. Problems of device files are among them, except
/// notes.
[[nodiscard]] std::vector<Finding> review(const NetworkProject& project);

}  // namespace canopus::network_project
