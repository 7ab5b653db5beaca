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

/// What a command changes of a plant file.
struct PlantUse {
  std::optional<std::uint64_t> seed{};
  std::vector<std::string> links{};    ///< "line1=socketcan:can0"; with one bus "socketcan:can0"
  plant::BusOpener* opener = nullptr;  ///< as in Plant::build()
  std::optional<std::string> text{};   ///< in place of the file's, which need not be there then
};

/// The plant, switched off, or nullptr after its mistakes were printed on `err`.
[[nodiscard]] std::unique_ptr<plant::Plant> load_plant(const std::string& path,
                                                       plant::PlantObserver& observer, Output& err,
                                                       const PlantUse& use = {});

/// The first hundred in the order of the file, and how many more there are.
void print_errors(std::vector<text::FileError> errors, const std::string& path, Output& err);

}  // namespace canopus::cli
