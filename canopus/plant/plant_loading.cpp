#include "canopus/plant/plant_loading.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::plant {

namespace {

constexpr std::size_t enough_errors = 100;

/// The names of a plant's buses, for people.
std::string bus_names(const PlantFile& plant) {
  std::string names;
  for (const BusSection& bus : plant.buses) names += (names.empty() ? "" : ", ") + bus.name;
  return names;
}

/// Puts a bus on the link that the command line names. False after a mistake was printed.
bool change_link(PlantFile& plant, std::string_view text, text::Output& err) {
  const auto wrong = [&](std::string_view what) {
    err.line("canopus: --bus {}: {}", text::printable(text), text::printable(what));
    return false;
  };
  // The name of a bus may hold a '=', an address may, too: the longest name that fits.
  BusSection* bus = nullptr;
  std::size_t name = 0;
  for (BusSection& candidate : plant.buses) {
    if (text.starts_with(candidate.name + "=") && candidate.name.size() >= name) {
      bus = &candidate;
      name = candidate.name.size();
    }
  }
  std::string link(bus == nullptr ? text : text.substr(name + 1));
  if (bus == nullptr) {
    const std::string_view before_address = text.substr(0, text.find(':'));
    if (before_address.contains('=')) {
      return wrong(fmt::format("there is no bus \"{}\"; expected one of {}",
                               before_address.substr(0, before_address.find('=')), bus_names(plant)));
    }
    if (plant.buses.size() != 1)
      return wrong("expected BUS=ADDRESS with one of the buses " + bus_names(plant));
    bus = &plant.buses.front();
  }
  if (bus->link_by_option) return wrong("this bus has a --bus already");
  // A path of the command line is relative to the working directory, not to the plant file.
  constexpr std::string_view replay = "replay:";
  std::error_code unknown;
  if (link.starts_with(replay) && link.size() > replay.size()) {
    link = std::string(replay) + std::filesystem::absolute(link.substr(replay.size()), unknown).string();
  }
  if (const auto good = set_link(*bus, link); !good) return wrong(good.error());
  bus->link_by_option = true;
  bus->link_place = bus->place;
  return true;
}

/// What a file is that has the name of another kind, and the command for it; empty for others.
std::string other_kind(const std::string& path) {
  const std::string extension = ascii::lower(std::filesystem::path(path).extension().string());
  const auto command = [&](std::string_view what, std::string_view words) {
    return fmt::format("{}, not a plant file; use `canopus {} {}`", what, words, text::printable(path));
  };
  if (extension == ".eds" || extension == ".dcf" || extension == ".xdd" || extension == ".xdc")
    return command("a device file", "eds check");
  if (extension == ".cpj") return command("a project", "project check");
  if (extension == ".xml") return command("a file of module settings", "configure check");
  return {};
}

}  // namespace

std::unique_ptr<Plant> load_plant(const std::string& path, PlantObserver& observer, text::Output& err,
                                  const PlantUse& use) {
  const auto text = use.text ? std::expected<std::string, std::string>(*use.text) : text::read_file(path);
  if (!text) {
    err.line("canopus: {}", text.error());
    return nullptr;
  }
  if (const std::string kind = other_kind(path); !use.text && !kind.empty()) {
    err.line("canopus: {} is {}", text::printable(path), kind);
    return nullptr;
  }
  PlantReading reading = read_plant(*text, path);
  for (PlcSection& plc : reading.plant.plcs) plc.allows_native_code = use.allows_native_code;
  std::vector<text::FileError> errors = std::move(reading.errors);
  if (errors.empty()) {
    for (const std::string& link : use.links) {
      if (!change_link(reading.plant, link, err)) return nullptr;
    }
  }
  if (errors.size() < enough_errors) {  // also with some, to find the others
    auto plant = Plant::build(std::move(reading.plant), observer, use.seed, use.opener);
    if (!plant) errors.insert(errors.end(), plant.error().begin(), plant.error().end());
    if (errors.empty()) return std::move(*plant);
  }
  // A generated text has no lines that a user could open.
  if (use.text) std::ranges::for_each(errors, [](text::FileError& error) { error.place = {}; });
  text::print_errors(std::move(errors), path, err);
  return nullptr;
}

}  // namespace canopus::plant
