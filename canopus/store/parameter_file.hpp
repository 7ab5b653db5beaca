#pragma once
// The parameters that a node saves by 1010H, in a file that is replaced atomically (file_memory.hpp).

#include <filesystem>
#include <string>

#include "canopus/canopen/dictionary/parameter_store.hpp"
#include "canopus/store/file_memory.hpp"

namespace canopus::store {

class ParameterFile final : public canopen::ParameterStore {
 public:
  /// The file `name` in `folder`; for valid names and owners: file_memory.hpp.
  ParameterFile(std::filesystem::path folder, std::string name, std::string owner = {})
      : memory_(std::move(folder), std::move(owner)), name_(std::move(name)) {}

  /// Empty when there is no file, or when it is damaged: the node then starts with its defaults. A plant that
  /// finds damage does not start at all.
  [[nodiscard]] std::vector<std::uint8_t> load() override { return memory_.read(name_).bytes; }
  canopen::AbortCode save(std::span<const std::uint8_t> image) override {
    return memory_.write(name_, image) ? canopen::AbortCode::none : canopen::AbortCode::hardware_error;
  }

 private:
  FileMemory memory_;
  std::string name_;
};

}  // namespace canopus::store
