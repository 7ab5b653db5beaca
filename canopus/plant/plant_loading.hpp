#pragma once
// A plant file read and built in one go: every mistake is found at once, in the file itself and in what it
// names, and printed with its place.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canopus/plant/plant.hpp"
#include "canopus/text/output.hpp"

namespace canopus::plant {

/// Changes of a plant file by a command.
struct PlantUse {
  std::optional<std::uint64_t> seed{};
  std::vector<std::string> links{};   ///< "line1=socketcan:can0"; with one bus "socketcan:can0"
  BusOpener* opener = nullptr;        ///< as in Plant::build()
  std::optional<std::string> text{};  ///< in place of the file's, which need not be there then
  bool allows_native_code = false;    ///< its PLCs may run programs that are shared objects
};

/// The plant, switched off, or nullptr after its mistakes were printed on `err`.
[[nodiscard]] std::unique_ptr<Plant> load_plant(const std::string& path, PlantObserver& observer,
                                                text::Output& err, const PlantUse& use = {});

}  // namespace canopus::plant
