#pragma once
// A CPU that runs an instruction list: the devices' names of a real model, the image plain memory, and one module at number 0.

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/instruction_list/compiler.hpp"
#include "canopus/plc/execution/cpu_devices.hpp"
#include "canopus/program/machine.hpp"

namespace list_plc {

namespace il = canopus::instruction_list;
using canopus::program::DeviceError;
using canopus::program::DevicePoint;
using il::Family;

inline const canopus::plc::CpuModel& model_of(Family family) {
  switch (family) {
    case Family::q: return canopus::plc::q03udvcpu();
    case Family::iqr: return canopus::plc::r04cpu();
    case Family::fx3: return canopus::plc::fx3u();
    case Family::fx5: break;
  }
  return canopus::plc::fx5u();
}

class Image final : public canopus::program::DeviceImage {
 public:
  explicit Image(const canopus::plc::CpuModel& model) : model_(model) {}

  DeviceError read_words(const DevicePoint& first, std::span<std::uint16_t> words) override {
    if (const DeviceError error = check(first, words.size()); error != DeviceError::none) return error;
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = memory[key(first, i)];
    return DeviceError::none;
  }
  DeviceError write_words(const DevicePoint& first, std::span<const std::uint16_t> words) override {
    if (const DeviceError error = check(first, words.size()); error != DeviceError::none) return error;
    for (std::size_t i = 0; i < words.size(); ++i) memory[key(first, i)] = words[i];
    return DeviceError::none;
  }
  DeviceError read_bits(const DevicePoint& first, unsigned count, std::uint32_t& bits) override {
    if (const DeviceError error = check(first, count); error != DeviceError::none) return error;
    bits = 0;
    for (unsigned i = 0; i < count; ++i) bits |= std::uint32_t{memory[key(first, i)]} << i;
    return DeviceError::none;
  }
  DeviceError write_bits(const DevicePoint& first, unsigned count, std::uint32_t bits) override {
    if (const DeviceError error = check(first, count); error != DeviceError::none) return error;
    for (unsigned i = 0; i < count; ++i) memory[key(first, i)] = bits >> i & 1U;
    return DeviceError::none;
  }

  DeviceError refresh(const DevicePoint& first, std::uint32_t count) override {
    if (const DeviceError error = check(first, count); error != DeviceError::none) return error;
    refreshed.emplace_back(first.number, count);
    return DeviceError::none;
  }
  void set_clock(std::chrono::local_seconds time) override { clock = time; }

  std::map<std::uint64_t, std::uint16_t> memory;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> refreshed;  // first point, count
  std::chrono::local_seconds clock{};
  static std::uint64_t key(const DevicePoint& point, std::size_t further) {
    return (std::uint64_t{point.is_buffer} << 63U) + (std::uint64_t{point.device} << 40U) + point.number +
           further;
  }

 private:
  DeviceError check(const DevicePoint& first, std::size_t count) const {
    if (first.is_buffer && first.unit != 0) return DeviceError::no_module;
    const bool is_index_register =  // of an FX3, which has them for its programs alone
        model_.family == canopus::plc::CpuFamily::fx3 &&
        first.device == static_cast<std::uint16_t>(canopus::plc::Device::z) && first.number + count <= 8;
    const bool is_there = first.is_buffer     ? first.number + count <= 1000
                          : is_index_register ? true

                                              : model_.has(static_cast<canopus::plc::Device>(first.device),
                                                           first.number, static_cast<std::uint32_t>(count));
    return is_there ? DeviceError::none : DeviceError::out_of_range;
  }

  const canopus::plc::CpuModel& model_;
};

/// "LD X0", "OUT T0 K50" -> a program CSV in UTF-8; the first line is line 4 of the file.
inline std::string csv(const std::vector<std::string>& lines) {
  std::string text =
      "\"MAIN\"\r\n\"PLC Information:\"\t\"CPU\"\r\n"
      "\"Step No.\"\t\"Line Statement\"\t\"Instruction\"\t\"I/O(Device)\"\t\"Blank\"\t\"PI "
      "Statement\"\t\"Note\"\r\n";
  const auto quoted = [](const std::string& field) {
    std::string made = "\"";
    for (const char c : field) made += c == '"' ? std::string("\"\"") : std::string(1, c);
    return made + '"';
  };
  int step = 0;
  for (const std::string& line : lines) {
    std::vector<std::string> words(1);
    bool is_quoted = false;
    for (const char c : line) {
      if (c == '"') is_quoted = !is_quoted;
      if (c == ' ' && !is_quoted)
        words.emplace_back();
      else
        words.back() += c;
    }
    text += quoted(std::to_string(step++)) + "\t\"\"\t" + quoted(words[0]) + '\t' +
            quoted(words.size() > 1 ? words[1] : "") + "\t\"\"\t\"\"\t\"\"\r\n";
    for (std::size_t i = 2; i < words.size(); ++i)
      text += "\"\"\t\"\"\t\"\"\t" + quoted(words[i]) + "\t\"\"\t\"\"\t\"\"\r\n";
  }
  return text;
}

inline std::string text(const std::vector<il::CompileError>& errors) {
  std::string all;
  for (const il::CompileError& error : errors)
    all += error.file + ':' + std::to_string(error.line) + ": " + error.message + '\n';
  return all;
}

inline std::string errors_of(Family family, const std::vector<std::string>& lines,
                             const std::vector<il::Label>& labels = {}) {
  const canopus::plc::CpuDeviceNames names(model_of(family));
  const std::vector<il::Source> sources = {{"MAIN.csv", csv(lines)}};
  return text(il::compile(sources, family, names, nullptr, labels).errors);
}

class ListPlc {
 public:
  ListPlc(Family family, std::vector<std::string> lines, bool with_end = true,
          const std::vector<il::Label>& labels = {})
      : names(model_of(family)), image(model_of(family)) {
    if (with_end) lines.emplace_back("END");
    const std::vector<il::Source> sources = {{"MAIN.csv", csv(lines)}};
    il::Compilation made = il::compile(sources, family, names, nullptr, labels);
    EXPECT_EQ(text(made.errors), "");
    if (made.program) machine = std::make_unique<canopus::program::Machine>(std::move(made.program));
  }
  /// Scans of 10 ms; the fault as text.
  std::string run(int scans = 1) {
    for (int i = 0; i < scans; ++i) {
      if (!machine) return "no program";
      const auto fault = machine->scan(now, &image);
      now += 10'000'000;
      if (fault) return canopus::program::fault_text(machine->program(), *fault);
    }
    return "";
  }
  /// "D0", "M0", "T0.contact" by their real names: "TS0", "TN0".
  int get(std::string_view name) {
    const auto point = names.point(name);
    EXPECT_TRUE(point) << name;
    return point ? image.memory[Image::key(*point, 0)] : -1;
  }
  int word(std::string_view name) { return static_cast<std::int16_t>(get(name)); }
  std::int64_t double_word(const std::string& letters, int number) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(get(letters + std::to_string(number))) |
                                     static_cast<std::uint32_t>(get(letters + std::to_string(number + 1)))
                                         << 16U);
  }
  void set(std::string_view name, int value) {
    const auto point = names.point(name);
    ASSERT_TRUE(point) << name;
    image.memory[Image::key(*point, 0)] = static_cast<std::uint16_t>(value);
  }

  canopus::plc::CpuDeviceNames names;
  Image image;
  std::unique_ptr<canopus::program::Machine> machine;
  std::int64_t now = 0;  // ns
};

}  // namespace list_plc
