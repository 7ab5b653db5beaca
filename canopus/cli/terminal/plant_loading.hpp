#pragma once
// A plant file read and built in one go: every mistake is found at once, in the file itself and in what it
// names, and printed with its place.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canopus/cli/terminal/print.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::cli {

/// The plant, switched off, or nullptr after its mistakes were printed on `err`. `opener` as in Plant::build().
[[nodiscard]] std::unique_ptr<plant::Plant> load_plant(const std::string& path,
                                                       plant::PlantObserver& observer, Output& err,
                                                       std::optional<std::uint64_t> seed = std::nullopt,
                                                       plant::BusOpener* opener = nullptr);

/// The first hundred in the order of the file, and how many more there are.
void print_errors(std::vector<text::FileError> errors, const std::string& path, Output& err);

}  // namespace canopus::cli
