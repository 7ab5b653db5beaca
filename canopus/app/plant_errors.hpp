#pragma once
// What is wrong with a plant file, collected on the way: each with its place.

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/app/plant_file.hpp"

namespace canopus::app {

class PlantErrors {
 public:
  template <typename... Arguments>
  void add(Place place, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    errors_.push_back({place, fmt::format(text, std::forward<Arguments>(arguments)...)});
  }
  void add(const std::vector<PlantError>& others) {
    errors_.insert(errors_.end(), others.begin(), others.end());
  }
  [[nodiscard]] bool empty() const noexcept { return errors_.empty(); }
  [[nodiscard]] std::vector<PlantError> take() { return std::exchange(errors_, {}); }

 private:
  std::vector<PlantError> errors_;
};

}  // namespace canopus::app
