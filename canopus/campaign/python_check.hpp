#pragma once
// An invariant that is a function in Python. Each run has a Python process of its own, so that nothing of one run reaches the next
// one: it gets the events of the run as lines of JSON (docs/events.md) while the plant runs, and returns what it found at the end.

#include <memory>
#include <string>

#include "canopus/campaign/campaign_file.hpp"
#include "canopus/campaign/invariant_checks.hpp"

namespace canopus::campaign {

/// Bounds of the process: a function without an end is a failure of its run.
inline constexpr int python_seconds = 60;                           ///< of a processor
inline constexpr std::size_t python_memory = std::size_t{2} << 30;  ///< bytes of address space

[[nodiscard]] std::string python_path(const std::string& campaign_path, const Invariant& invariant);

/// Whether Python, the file and the function in it are there. The error is a sentence that begins with the key.
[[nodiscard]] std::string find_python_function(const std::string& path, const std::string& function);

/// Throws std::runtime_error while it runs if no process can be started: the run shows nothing.
[[nodiscard]] std::unique_ptr<InvariantCheck> make_python_check(const Invariant& invariant, RunResult& result,
                                                                std::string path);

}  // namespace canopus::campaign
