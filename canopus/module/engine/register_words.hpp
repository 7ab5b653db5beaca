#pragma once
// Registers of the CPU that are a module's: a register's number is the address of its word in the model's table
// [AS-FCOPM 10.1.2]. The D and SR registers of one module have different numbers.

#include <algorithm>
#include <span>

#include "canopus/module/interface/module.hpp"

namespace canopus::module {

class RegisterWords final : public RegisterAccess {
 public:
  /// Everything must outlive it.
  RegisterWords(std::span<const RegisterRange> ranges, BufferMemoryAccess& words)
      : ranges_(ranges), words_(words) {}

  [[nodiscard]] std::span<const RegisterRange> registers() const noexcept override { return ranges_; }
  [[nodiscard]] std::uint16_t read_register(RegisterKind kind, std::uint32_t number, can::Time now) override {
    return owns(kind, number) ? words_.program_read(number, now) : std::uint16_t{0};
  }
  void write_register(RegisterKind kind, std::uint32_t number, std::uint16_t value, can::Time now) override {
    if (owns(kind, number)) words_.write_word(number, value, now);
  }

 private:
  [[nodiscard]] bool owns(RegisterKind kind, std::uint32_t number) const noexcept {
    return std::ranges::any_of(ranges_, [&](const RegisterRange& range) {
      return range.kind == kind && number >= range.first && number <= range.last;
    });
  }

  std::span<const RegisterRange> ranges_;
  BufferMemoryAccess& words_;
};

}  // namespace canopus::module
