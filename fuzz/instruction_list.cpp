// Any bytes as a program CSV: compiled or refused, and what is accepted runs within its watchdog.

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "canopus/instruction_list/compiler.hpp"
#include "canopus/program/machine.hpp"

#include "input.hpp"

namespace {

using namespace canopus;

/// Devices by their letters, 40 points each; U0 is a module.
class Devices final : public program::DeviceImage, public program::DeviceNames {
 public:
  program::DeviceError read_words(const program::DevicePoint& first,
                                  std::span<std::uint16_t> words) override {
    if (first.number + words.size() > points) return program::DeviceError::out_of_range;
    std::ranges::fill(words, std::uint16_t{3});
    return program::DeviceError::none;
  }
  program::DeviceError write_words(const program::DevicePoint& first,
                                   std::span<const std::uint16_t> words) override {
    return first.number + words.size() > points ? program::DeviceError::out_of_range
                                                : program::DeviceError::none;
  }
  program::DeviceError read_bits(const program::DevicePoint& first, unsigned count,
                                 std::uint32_t& bits) override {
    bits = 1;
    return first.number + count > points ? program::DeviceError::out_of_range : program::DeviceError::none;
  }
  program::DeviceError write_bits(const program::DevicePoint& first, unsigned count, std::uint32_t) override {
    return first.number + count > points ? program::DeviceError::out_of_range : program::DeviceError::none;
  }
  [[nodiscard]] std::expected<program::DevicePoint, std::string> point(std::string_view name) const override {
    static constexpr std::array<std::string_view, 18> bits = {"X",  "Y",  "M",  "L",   "V",   "B",
                                                              "SM", "TS", "TC", "STS", "STC", "CS",
                                                              "CC", "S",  "F",  "SB",  "HCS", "DX"};
    const std::size_t digit = std::min(name.find_first_of("0123456789"), name.size());
    if (digit == 0 || digit == name.size()) return std::unexpected("expected a device");
    std::uint32_t number = 0;
    for (const char c : name.substr(digit))
      number = c >= '0' && c <= '9' ? (10 * number + unsigned(c - '0')) % 1000 : number;
    if (number >= points) return std::unexpected("expected a smaller number");
    return program::DevicePoint{.device = static_cast<std::uint16_t>(name.front()),
                                .number = number,
                                .is_buffer = name.starts_with("U0"),
                                .is_bit = std::ranges::find(bits, name.substr(0, digit)) != bits.end()};
  }
  [[nodiscard]] bool looks_like_device(std::string_view name) const override {
    return point(name).has_value();
  }

 private:
  static constexpr std::uint32_t points = 40;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using fuzz::expect;
  if (size == 0) return 0;
  Devices devices;
  const auto family = static_cast<instruction_list::Family>(data[0] % 4);
  const std::vector<instruction_list::Source> sources = {
      {"MAIN.csv", std::string(reinterpret_cast<const char*>(data + 1), size - 1)}};
  instruction_list::Compilation made = instruction_list::compile(sources, family, devices);
  expect((made.program != nullptr) == made.errors.empty());
  for (const instruction_list::CompileError& error : made.errors)
    expect(!error.message.empty() && error.line > 0);
  if (!made.program) return 0;
  program::Machine machine(made.program);
  machine.set_watchdog(20'000);
  for (int i = 0; i < 3; ++i) (void)machine.scan(i * 10'000'000LL, &devices);
  for (const program::Symbol& symbol : machine.program().symbols)
    expect(machine.read(symbol.name).has_value());
  machine.warm_start();
  machine.change(made.program);
  (void)machine.scan(0, &devices);
  return 0;
}
