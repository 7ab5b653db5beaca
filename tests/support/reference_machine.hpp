#pragma once
// Executes the code of a program as its compiler made it, with every device reached by the functions of its image: what a Machine, whose code
// is linked to memory, is compared with.

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "canopus/program/execution.hpp"

namespace testing_support {

class ReferenceMachine {
 public:
  explicit ReferenceMachine(std::shared_ptr<const canopus::program::Program> program)
      : program_(std::move(program)), memory_(program_->initial) {}

  std::optional<canopus::program::Fault> scan(std::int64_t now, canopus::program::DeviceImage& devices) {
    canopus::program::Execution execution{.code = program_->code,
                                          .positions = program_->positions,
                                          .program = *program_,
                                          .memory = memory_,
                                          .initial = program_->initial,
                                          .devices = &devices,
                                          .now = now,
                                          .budget = 1'000'000};
    for (const std::uint32_t number : program_->programs) {
      const canopus::program::Function& function = program_->functions[number];
      if (auto fault = canopus::program::execute(execution, function.entry, function.frame)) return fault;
    }
    return std::nullopt;
  }
  [[nodiscard]] canopus::program::Slot at(std::uint32_t place) const { return memory_[place]; }

 private:
  std::shared_ptr<const canopus::program::Program> program_;
  std::vector<canopus::program::Slot> memory_;
};

}  // namespace testing_support
