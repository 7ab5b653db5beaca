#pragma once
// Checks of a project: its files, its bit rate, and the PDOs that go between its nodes.

#include <cstdint>
#include <set>
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

/// CAN-IDs (CobId::key()) of PDOs that nodes outside of the project send and receive: a module of the plant.
struct ExternalPdos {
  std::set<std::uint32_t> sent{};
  std::set<std::uint32_t> received{};
  friend bool operator==(const ExternalPdos&, const ExternalPdos&) = default;
};

/// Errors first, then warnings, then notes; each by node-ID. Problems of device files are among them, except
/// notes.
[[nodiscard]] std::vector<Finding> review(const NetworkProject& project, const ExternalPdos& external = {});

}  // namespace canopus::network_project
