#pragma once
// Programs in C as shared objects: canopus/program/canopus_program.h says what is in one.

#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include "canopus/program/program.hpp"

namespace canopus::c_program {

/// By the ending of its name: "main.so".
[[nodiscard]] bool is_shared_object(std::string_view path);

/// Loads the file as it is now, with variables of its own, for one machine. THIS RUNS ITS CODE, with all rights of this process: only
/// with its user's permission. `devices`: those of the CPU that is to run it. The error is a sentence without the file's name.
[[nodiscard]] std::expected<std::shared_ptr<const program::Program>, std::string> load(
    const std::string& path, const program::DeviceNames& devices);

}  // namespace canopus::c_program
