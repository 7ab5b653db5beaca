// Any bytes as a program in Structured Text: compiled or refused, and what is accepted runs within its watchdog.

#include <string>
#include <vector>

#include "canopus/program/machine.hpp"
#include "canopus/structured_text/compiler.hpp"

#include "input.hpp"

namespace {

using namespace canopus;

/// X and M are bits, D and Z words; U0 is a module.
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
    if (!looks_like_device(name)) return std::unexpected("expected a device");
    return program::DevicePoint{.number = static_cast<std::uint32_t>(name.back() - '0'),
                                .is_buffer = name.front() == 'U',
                                .is_bit = name.front() == 'X' || name.front() == 'M'};
  }
  [[nodiscard]] bool looks_like_device(std::string_view name) const override {
    return name.size() > 1 && std::string_view("XMDZU").contains(name.front()) && name.back() >= '0' &&
           name.back() <= '9';
  }

 private:
  static constexpr std::uint32_t points = 20;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using fuzz::expect;
  Devices devices;
  const std::vector<structured_text::Source> sources = {
      {"main.st", std::string(reinterpret_cast<const char*>(data), size)}};
  structured_text::Compilation made = structured_text::compile(sources, &devices);
  expect((made.program != nullptr) == made.errors.empty());
  for (const structured_text::CompileError& error : made.errors) expect(!error.message.empty());
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
