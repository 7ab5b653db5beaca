#pragma once
// What kind of file or folder a command was given: `canopus run io.eds` names the command for a device file.

#include <cstdint>
#include <string>

namespace canopus::cli {

enum class FileKind : std::uint8_t {
  unknown,         ///< neither its name nor its tables say so
  plant,           ///< *.toml with buses, or a folder with plant.toml
  network,         ///< *.toml of `canopus master`
  device_file,     ///< EDS, DCF, XDD, XDC
  project,         ///< *.cpj, or a folder with nodelist.cpj
  module_project,  ///< *.xml of `canopus configure`
  trace,
  folder,  ///< neither plant.toml nor nodelist.cpj is in it
};

/// By its name; a TOML file by its tables, a folder by what is in it. A file that is not there has the kind of its name.
[[nodiscard]] FileKind kind_of_file(const std::string& path);

/// "io.eds is a device file; `canopus eds check io.eds` checks it": for a command that takes other files.
[[nodiscard]] std::string describe_given_file(const std::string& path, FileKind kind);

/// The plant file that PLANT means: plant.toml of a folder, else the file itself. The error is the sentence about a file
/// that is no plant.
struct GivenPlant {
  std::string path;
  std::string wrong{};
};
[[nodiscard]] GivenPlant given_plant(const std::string& path);

}  // namespace canopus::cli
