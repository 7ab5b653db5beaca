#pragma once
// The non-volatile memory of a plant's devices and modules, by owner: a file per device, a folder per module,
// named after their owner, in the folder that `store` names. Two owners never share one, what cannot be read
// is an error before anything starts, and a folder belongs to one run at a time.
//
//   state/.lock                              the run that uses the folder (store/folder_lock.hpp)
//   state/line1.encoder.node-003             bus, name, node-ID (or LSS address); .lss: what LSS stored
//   state/rack1.U000-ME3CAN1-Q/              PLC, head address, model
//   state/rack1.program/                     RETAIN variables of the PLC's program
//
// Earlier versions named node-003 and U000-ME3CAN1-Q alone: a run takes those over, if only one owner can be
// meant.

#include <cstdint>
#include <expected>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/plant/file/plant_file.hpp"
#include "canopus/store/folder_lock.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::plant {

/// The storage of an owner.
struct StoredAs {
  std::filesystem::path folder;
  std::string name;   ///< of the file in it; empty for a module, which has the folder for itself
  std::string owner;  ///< for people, and kept in each file: device "encoder" (node 3) of bus "line1"
};

class PlantStores {
 public:
  /// Paths of `store` are relative to `plant_folder`.
  explicit PlantStores(std::filesystem::path plant_folder) : plant_folder_(std::move(plant_folder)) {}

  /// Claims the storage of a device with a `store`. `unit` is "node-003", or its LSS address while it has no
  /// node-ID.
  [[nodiscard]] StoredAs claim(const DeviceSection& device, const std::string& unit,
                               text::FileErrors& errors);
  /// Claims the storage of a module of a PLC with a `store`; `names` are the files in its folder.
  [[nodiscard]] StoredAs claim(const PlcSection& plc, const ModuleSection& module,
                               std::span<const std::string_view> names, text::FileErrors& errors);
  /// Claims the storage of the RETAIN variables of a PLC with a `store`: a folder of their own.
  [[nodiscard]] StoredAs claim(const PlcSection& plc, text::FileErrors& errors);
  /// Call it after the last claim: reports files with two possible owners, and files without an owner.
  void review(text::FileErrors& errors, std::vector<text::FileWarning>& warnings) const;

  /// Locks the folders for as long as this object lives, and gives files of earlier versions their names.
  /// Call it before anything is switched on.
  [[nodiscard]] std::vector<text::FileError> open();

 private:
  struct Folder {
    text::Place place{};
    std::string written;  ///< as the plant file has it
    std::filesystem::path path;
  };
  struct Claim {
    text::Place place{};
    std::string owner;
    std::string name;      ///< of its file or folder
    std::string old_name;  ///< as earlier versions had it
  };
  struct Files;
  /// The folder of `store`, or nullptr after an error.
  const Folder* folder(const std::string& store, text::Place place, text::FileErrors& errors);
  void claim(const Folder& folder, const Claim& claim, const Files& files, text::FileErrors& errors);
  [[nodiscard]] bool is_old(const std::filesystem::path& folder, const Claim& claim) const;

  std::filesystem::path plant_folder_;
  std::map<std::filesystem::path, Folder> folders_;  // by canonical path
  std::map<std::filesystem::path, std::map<std::string, Claim>> claims_;
  std::vector<store::FolderLock> locks_;
};

}  // namespace canopus::plant
