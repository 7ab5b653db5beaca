#include "canopus/cli/terminal/plant_loading.hpp"

#include <algorithm>
#include <utility>

#include "canopus/plant/file/plant_file.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::cli {

namespace {

constexpr std::size_t enough_errors = 100;

}  // namespace

std::unique_ptr<plant::Plant> load_plant(const std::string& path, plant::PlantObserver& observer, Output& err,
                                         std::optional<std::uint64_t> seed, plant::BusOpener* opener) {
  const auto text = text::read_file(path);
  if (!text) {
    err.line("canopus: {}", text.error());
    return nullptr;
  }
  plant::PlantReading reading = plant::read_plant(*text, path);
  std::vector<text::FileError> errors = std::move(reading.errors);
  if (errors.size() < enough_errors) {  // also with some, to find the others
    auto plant = plant::Plant::build(reading.plant, observer, seed, opener);
    if (!plant) errors.insert(errors.end(), plant.error().begin(), plant.error().end());
    if (errors.empty()) return std::move(*plant);
  }
  print_errors(std::move(errors), path, err);
  return nullptr;
}

void print_errors(std::vector<text::FileError> errors, const std::string& path, Output& err) {
  std::ranges::stable_sort(errors, {}, &text::FileError::place);
  for (std::size_t i = 0; i < errors.size() && i < enough_errors; ++i)
    err.line("{}", describe(errors[i], path));
  if (errors.size() > enough_errors) {
    err.line("{}: {} more mistakes", path, errors.size() - enough_errors);
  }
}

}  // namespace canopus::cli
