#pragma once
// A program that is machine code: made by another compiler, loaded from a file.

#include <cstdint>
#include <optional>
#include <span>

#include "canopus/program/data_type.hpp"
#include "canopus/program/device_image.hpp"

namespace canopus::program {

struct Fault;

/// Its variables are symbols of a Program, which is for one machine alone: that has their values between the scans, in its memory.
class Plugin {
 public:
  virtual ~Plugin() = default;

  /// What is no variable of the program's symbols gets its initial value.
  virtual void start() = 0;
  /// One scan, from the values in the memory to new ones. It may throw nothing.
  [[nodiscard]] virtual std::optional<Fault> scan(std::span<Slot> memory, std::int64_t now,
                                                  DeviceImage* devices) noexcept = 0;
};

}  // namespace canopus::program
