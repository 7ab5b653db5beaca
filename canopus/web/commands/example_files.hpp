#pragma once
// The first plant (examples/first-plant) and its device files, which are part of the program: there is something to look at
// wherever it runs.

#include <span>
#include <string_view>

namespace canopus::web {

struct ExampleFile {
  std::string_view path{};  ///< below a folder: "first-plant/plant.toml"
  std::string_view content{};
};

[[nodiscard]] std::span<const ExampleFile> example_files() noexcept;

}  // namespace canopus::web
