#pragma once
// The code of a program as one machine executes it: with the places of its variables and of its CPU's devices in memory in place of their
// numbers, and with runs of instructions on bits as one. It does to variables and devices what Program::code does, which stays the
// reference (tests/plc/linked_code_test.cpp).
//
// An instruction stands where its original does. One that does the work of several stands in place of the first, and goes on behind the
// last; the others stay, for jumps to them. Positions in the source, breaks and what a break halts are therefore the same for both.

#include <cstdint>
#include <span>
#include <vector>

#include "canopus/program/program.hpp"

namespace canopus::program {

/// One of the bits that are combined one after the other. The result is bit (2 * result before + this bit) of `function`.
struct BitOperand {
  std::uint8_t* bit = nullptr;  ///< 0 or 1
  std::uint32_t function = 0;
};
inline constexpr std::size_t most_bit_operands = 8;

/// What operands b and c of a linked instruction point to.
template <typename Pointed>
[[nodiscard]] Pointed* pointer_in(const Instruction& instruction) noexcept {
  return reinterpret_cast<Pointed*>(
      static_cast<std::uintptr_t>(std::uint64_t{instruction.c} << 32U | instruction.b));
}

class LinkedCode {
 public:
  /// For these slots as the program's memory and this image, which may be nullptr. They must stay where they are.
  void link(const Program& program, std::span<Slot> memory, DeviceImage* devices);
  /// The next use links again.
  void clear() noexcept { memory_ = nullptr; }
  [[nodiscard]] bool is_of(std::span<const Slot> memory, const DeviceImage* devices) const noexcept {
    return memory_ != nullptr && memory_ == memory.data() && layout_ == layout_of(devices);
  }
  [[nodiscard]] std::span<const Instruction> code() const noexcept { return code_; }
  [[nodiscard]] const DeviceMemory* device_memory() const noexcept { return device_memory_.data(); }

 private:
  /// Puts one instruction in place of those on bits that begin at `first`, if there are several; where to go on, or `first`.
  std::size_t link_bits(std::size_t first, std::span<const std::uint32_t> frames, std::span<Slot> memory);
  /// The same of other instructions; where to go on.
  std::size_t link_row(std::size_t first);
  static std::uint64_t layout_of(const DeviceImage* devices) noexcept {
    return devices == nullptr ? 0 : devices->memory_layout();
  }

  std::vector<Instruction> code_;
  std::vector<DeviceMemory> device_memory_;  // of each of Program::devices
  std::vector<BitOperand> operands_;  // of each instruction in a row, and behind them where the result goes
  const Slot* memory_ = nullptr;
  std::uint64_t layout_ = 0;
};

}  // namespace canopus::program
