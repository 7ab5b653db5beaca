#pragma once
// Requests of the control server of a plant: list the devices, read, force and release their values. One JSON
// object in a line is a request, one is its answer. docs/control.md describes them.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/plant/catalogue/error_history.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/json.hpp"

namespace canopus::serve {

/// [{"title": "errors now", "lines": [{"where": "G29 bit 3", "code": "", "meaning": "...", "t": 12.5}]}]: `t` where it is known.
[[nodiscard]] text::Json error_groups(const std::vector<plant::ErrorGroup>& groups);

class DeviceControl {
 public:
  explicit DeviceControl(plant::Plant& plant) : plant_(plant) {}

  /// The answer to a request, one line with its line feed, also to an invalid one. The plant's timeline must
  /// be at the present time.
  [[nodiscard]] std::string answer(std::string_view request);

 private:
  plant::Plant& plant_;
};

}  // namespace canopus::serve
