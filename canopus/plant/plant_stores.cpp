#include "canopus/plant/plant_stores.hpp"

#include <array>
#include <cerrno>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/store/file_memory.hpp"
#include "canopus/text/file_name.hpp"

namespace canopus::plant {

namespace fs = std::filesystem;

/// The files of one owner: a device's beside each other, a module's in a folder of its own.
struct PlantStores::Files {
  bool in_own_folder = false;
  std::span<const std::string_view> names;  ///< of a device: endings

  /// Folder and name of one of them.
  [[nodiscard]] std::pair<fs::path, std::string> place(const fs::path& folder, const std::string& name,
                                                       std::string_view which) const {
    if (in_own_folder) return {folder / name, std::string(which)};
    return {folder, name + std::string(which)};
  }
};

namespace {

constexpr std::array<std::string_view, 2> device_endings{"", ".lss"};

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() != fs::file_type::not_found;
}

bool is_stored_file(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  std::array<char, 4> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  return std::string_view(head.data(), head.size()) == "CNPS";
}

/// A file that Canopus has stored, or a folder with such files.
bool is_stored(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return is_stored_file(path);
  for (const auto& entry : fs::directory_iterator(path, ignored)) {
    if (is_stored_file(entry.path())) return true;
  }
  return false;
}

/// Why a folder that is there cannot be used, or nothing.
std::string reason_not_usable(const fs::path& path) {
  std::error_code ignored;
  if (!is_there(path)) return {};
  if (!fs::is_directory(path, ignored)) return "it is not a folder";
  if (::access(path.c_str(), R_OK | W_OK | X_OK) == 0) return {};
  return "cannot be read and written: " + store::describe_error(errno);
}

/// `device "encoder" (node 3) of bus "line1"`
std::string owner_of(const DeviceSection& device, std::string_view unit) {
  std::string node(unit);
  if (node.starts_with("node-"))
    node = fmt::format("node {}", std::stoi(node.substr(5)));
  else
    node = "LSS address " + node;
  if (device.name.empty()) return fmt::format("the device with {} of bus \"{}\"", node, device.bus);
  return fmt::format("device \"{}\" ({}) of bus \"{}\"", device.name, node, device.bus);
}

}  // namespace

const PlantStores::Folder* PlantStores::folder(const std::string& store, text::Place place,
                                               text::FileErrors& errors) {
  if (store.find('\0') != std::string::npos) {
    errors.add(place, "store: a path cannot hold the character NUL");
    return nullptr;
  }
  const fs::path path = (plant_folder_ / store).lexically_normal();
  std::error_code unknown;
  fs::path key = fs::weakly_canonical(path, unknown);
  if (unknown) key = path;
  const auto [known, is_new] = folders_.try_emplace(key, Folder{place, store, path});
  if (is_new) {
    if (const std::string why = reason_not_usable(path); !why.empty()) {
      errors.add(place, "store = \"{}\": {}", store, why);
    }
  }
  return &known->second;
}

bool PlantStores::is_old(const fs::path& folder, const Claim& claim) const {
  if (claim.name == claim.old_name) return false;
  for (const std::string_view ending : device_endings) {
    if (is_there(folder / (claim.name + std::string(ending)))) return false;
  }
  for (const std::string_view ending : device_endings) {
    if (is_there(folder / (claim.old_name + std::string(ending)))) return true;
  }
  return false;
}

void PlantStores::claim(const Folder& folder, const Claim& claim, const Files& files,
                        text::FileErrors& errors) {
  std::error_code unknown;
  fs::path key = fs::weakly_canonical(folder.path, unknown);
  if (unknown) key = folder.path;
  const auto [other, is_free] = claims_[key].try_emplace(claim.name, claim);
  if (!is_free) {
    errors.add(claim.place,
               "store = \"{}\": {} and {} (line {}) would share \"{}\" there; give them names that "
               "differ, or folders of their own",
               folder.written, claim.owner, other->second.owner, other->second.place.line, claim.name);
    return;
  }
  const std::string& present = is_old(folder.path, claim) ? claim.old_name : claim.name;
  for (const std::string_view which : files.names) {
    const auto [where, name] = files.place(folder.path, present, which);
    const std::string damage = store::FileMemory(where, claim.owner).damage(name);
    if (!damage.empty()) errors.add(claim.place, "store: {}", damage);
  }
}

StoredAs PlantStores::claim(const DeviceSection& device, const std::string& unit, text::FileErrors& errors) {
  const Folder* found = folder(device.store, device.store_place, errors);
  if (found == nullptr) return {};
  Claim mine{.place = device.store_place, .owner = owner_of(device, unit), .name = {}, .old_name = unit};
  mine.name = text::file_name_of(device.bus);
  if (!device.name.empty()) mine.name += "." + text::file_name_of(device.name);
  mine.name += "." + unit;
  claim(*found, mine, {.in_own_folder = false, .names = device_endings}, errors);
  return {found->path, mine.name, mine.owner};
}

StoredAs PlantStores::claim(const PlcSection& plc, const ModuleSection& module,
                            std::span<const std::string_view> names, text::FileErrors& errors) {
  const Folder* found = folder(plc.store, plc.store_place, errors);
  if (found == nullptr) return {};
  Claim mine{.place = plc.store_place,
             .owner = fmt::format("the {} at head {:03X}H of ", module.model, module.head),
             .name = {},
             .old_name = fmt::format("U{:03X}-{}", module.head, module.model)};
  mine.owner += plc.name.empty() ? "a PLC without a name" : fmt::format("PLC \"{}\"", plc.name);
  if (!plc.name.empty()) mine.name = text::file_name_of(plc.name) + ".";
  mine.name += mine.old_name;
  claim(*found, mine, {.in_own_folder = true, .names = names}, errors);
  return {found->path / mine.name, {}, mine.owner};
}

StoredAs PlantStores::claim(const PlcSection& plc, text::FileErrors& errors) {
  const Folder* found = folder(plc.store, plc.store_place, errors);
  if (found == nullptr) return {};
  Claim mine{.place = plc.store_place,
             .owner = plc.name.empty() ? "the program of a PLC without a name"
                                       : fmt::format("the program of PLC \"{}\"", plc.name),
             .name = plc.name.empty() ? "program" : text::file_name_of(plc.name) + ".program",
             .old_name = {}};
  mine.old_name = mine.name;
  constexpr std::array<std::string_view, 1> names{plc::ProgramExecution::retained_name};
  claim(*found, mine, {.in_own_folder = true, .names = names}, errors);
  return {found->path / mine.name, {}, mine.owner};
}

void PlantStores::review(text::FileErrors& errors, std::vector<text::FileWarning>& warnings) const {
  for (const auto& [key, found] : folders_) {
    const auto claimed = claims_.find(key);
    if (claimed == claims_.end()) continue;
    std::map<std::string, std::vector<const Claim*>> by_old_name;
    std::set<std::string> known;
    for (const auto& [name, claim] : claimed->second) {
      for (const std::string_view ending : device_endings) known.insert(name + std::string(ending));
      if (!is_old(found.path, claim)) continue;
      by_old_name[claim.old_name].push_back(&claim);
      for (const std::string_view ending : device_endings) known.insert(claim.old_name + std::string(ending));
    }
    for (const auto& [old_name, meant] : by_old_name) {
      const Claim& first = *meant.front();
      if (meant.size() == 1) {
        warnings.push_back(
            {first.place, fmt::format("store = \"{}\": \"{}\" there is of an earlier version; a run "
                                      "keeps it as \"{}\", for {}",
                                      found.written, old_name, first.name, first.owner)});
        continue;
      }
      std::vector<std::string> choices;
      for (const Claim* claim : meant)
        choices.push_back(fmt::format("\"{}\" for {}", claim->name, claim->owner));
      errors.add(
          first.place,
          "store = \"{}\": \"{}\" there is of an earlier version, which did not say whose it is; delete it, "
          "or rename it: {}",
          found.written, old_name, fmt::join(choices, ", or "));
    }
    std::vector<std::string> unknown;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(found.path, ignored)) {
      const std::string name = entry.path().filename().string();
      if (known.contains(name) || name.starts_with(".") || name.ends_with(".new")) continue;
      if (is_stored(entry.path())) unknown.push_back("\"" + name + "\"");
    }
    if (unknown.empty()) continue;
    std::ranges::sort(unknown);
    constexpr std::size_t enough = 5;
    const std::size_t count = unknown.size();
    if (count > enough) unknown.resize(enough);
    warnings.push_back(
        {found.place, fmt::format("store = \"{}\": no device or module of this plant owns {}{} there",
                                  found.written, fmt::join(unknown, ", "), count > enough ? ", ..." : "")});
  }
}

std::vector<text::FileError> PlantStores::open() {
  text::FileErrors errors;
  for (const auto& [key, found] : folders_) {
    auto lock = store::FolderLock::acquire(found.path);
    if (!lock) {
      errors.add(found.place, "store = \"{}\": {}", found.written, lock.error());
      continue;
    }
    locks_.push_back(std::move(*lock));
    for (const auto& [name, claim] : claims_[key]) {
      if (!is_old(found.path, claim)) continue;
      for (const std::string_view ending : device_endings) {
        const std::string from = claim.old_name + std::string(ending);
        if (!is_there(found.path / from)) continue;
        std::error_code why;
        fs::rename(found.path / from, found.path / (name + std::string(ending)), why);
        if (why)
          errors.add(claim.place, "store = \"{}\": cannot rename \"{}\": {}", found.written, from,
                     why.message());
      }
    }
  }
  return errors.release();
}

}  // namespace canopus::plant
