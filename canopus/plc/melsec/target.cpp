#include "canopus/plc/melsec/target.hpp"

#include <array>
#include <optional>
#include <string_view>

namespace canopus::plc::melsec {

namespace {

struct DeviceCode {
  std::uint8_t binary = 0;
  std::string_view ascii_q;
  std::string_view ascii_iqr;
};

// By Device; those of the AS300 alone have none.
constexpr std::array<DeviceCode, device_count> codes = {{
    {0x9C, "X", "X"},
    {0x9D, "Y", "Y"},
    {0x90, "M", "M"},
    {0x92, "L", "L"},
    {0x93, "F", "F"},
    {0x94, "V", "V"},
    {0xA0, "B", "B"},
    {0xA1, "SB", "SB"},
    {0x91, "SM", "SM"},
    {0xC1, "TS", "TS"},
    {0xC0, "TC", "TC"},
    {0xC7, "SS", "STS"},
    {0xC6, "SC", "STC"},
    {0xC4, "CS", "CS"},
    {0xC3, "CC", "CC"},
    {0xA8, "D", "D"},
    {0xB4, "W", "W"},
    {0xB5, "SW", "SW"},
    {0xA9, "SD", "SD"},
    {0xAF, "R", "R"},
    {0xB0, "ZR", "ZR"},
    {0xCC, "Z", "Z"},
    {0xC2, "TN", "TN"},
    {0xC8, "SN", "STN"},
    {0xC5, "CN", "CN"},
    {0x98, "S", "S"},
    {},
    {},
}};

constexpr std::uint8_t cpu_buffer = 0xFA;

/// What the extension of a target points at, before the device code is known.
enum class Extension : std::uint8_t { none, module, other };

std::optional<Device> device_of(std::uint32_t code) {
  for (std::size_t i = 0; i < codes.size(); ++i)
    if (codes[i].binary == code && code != 0) return static_cast<Device>(i);
  return std::nullopt;
}

/// "D*", "D " or "D" within a field of fixed width.
std::string_view unpadded(std::span<const std::uint8_t> field, std::array<char, 4>& memory) {
  std::size_t size = 0;
  for (const std::uint8_t character : field) memory[size++] = static_cast<char>(character);
  while (size > 0 && (memory[size - 1] == '*' || memory[size - 1] == ' ')) --size;
  return {memory.data(), size};
}

std::optional<Device> device_of(std::string_view text, bool iqr) {
  for (std::size_t i = 0; i < codes.size(); ++i)
    if ((iqr ? codes[i].ascii_iqr : codes[i].ascii_q) == text && !text.empty()) return static_cast<Device>(i);
  return std::nullopt;
}

/// Puts device or G and extension together.
std::expected<Target, EndCode> joined(std::optional<Device> device, bool is_g, Extension extension,
                                      std::uint32_t module_number, std::uint32_t number) {
  if (extension == Extension::other) return std::unexpected(EndCode::no_device_extension);
  if (is_g) {
    // G alone says nothing: whose buffer memory?
    if (extension == Extension::none) return std::unexpected(EndCode::device_not_accessible);
    if (module_number > 0xFF) return std::unexpected(EndCode::no_module);
    return Target{true, Device::d, static_cast<std::uint16_t>(16 * module_number), number};
  }
  if (!device) return std::unexpected(EndCode::device_not_accessible);
  if (extension == Extension::module) return std::unexpected(EndCode::no_device_extension);
  return Target{false, *device, 0, number};
}

std::expected<Target, EndCode> read_binary(FieldReader& reader, Layout layout) {
  const std::uint16_t device_modification = layout.extended ? reader.u16() : std::uint16_t{0};
  const std::uint32_t number = layout.iqr ? reader.u32() : reader.u24();
  const std::uint16_t code = layout.iqr ? reader.u16() : reader.u8();
  Extension extension = Extension::none;
  std::uint16_t module_number = 0;
  if (layout.extended) {
    const std::uint16_t extension_modification = reader.u16();
    module_number = reader.u16();
    const std::uint8_t memory = reader.u8();
    const bool modified = device_modification != 0 || extension_modification != 0;
    const bool is_module = memory == module_access || memory == cpu_buffer;
    const bool is_none = memory == 0 && module_number == 0;
    if (modified || (!is_module && !is_none))  // also link direct, F9H
      extension = Extension::other;
    else if (is_module)
      extension = Extension::module;
  }
  return joined(device_of(code), code == buffer_memory_code, extension, module_number, number);
}

std::expected<Target, EndCode> read_ascii(FieldReader& reader, Layout layout) {
  std::array<char, 4> memory{};
  Extension extension = Extension::none;
  std::uint32_t module_number = 0;
  const std::size_t modification = layout.iqr ? 4 : 3;
  const auto is_zero = [](std::span<const std::uint8_t> text) {
    for (const std::uint8_t character : text)
      if (character != '0') return false;
    return true;
  };
  bool modified = false;
  if (layout.extended) {
    modified = !is_zero(reader.raw(2));
    const auto letter = reader.raw(1);
    module_number = reader.digits(3, 16);
    if (!letter.empty() && letter[0] == 'U')
      extension = Extension::module;
    else if (!is_zero(letter) || module_number != 0)
      extension = Extension::other;
    modified = !is_zero(reader.raw(modification)) || modified;
  }
  const std::string_view code = unpadded(reader.raw(layout.iqr ? 4 : 2), memory);
  const std::optional<Device> device = device_of(code, layout.iqr);
  const bool hexadecimal = device && device_info(*device).hexadecimal;
  const std::size_t digits = !layout.iqr ? 6 : layout.extended ? 10 : 8;
  const bool is_g = code == "G";
  // A device that is unknown has numbers of an unknown kind: take the wider one, the code decides below.
  const std::uint32_t number = reader.digits(digits, hexadecimal || (!device && !is_g) ? 16 : 10);
  if (layout.extended) modified = !is_zero(reader.raw(modification)) || modified;
  if (modified) extension = Extension::other;
  return joined(device, is_g, extension, module_number, number);
}

}  // namespace

std::expected<Target, EndCode> read_target(FieldReader& reader, Layout layout) noexcept {
  return reader.code() == DataCode::ascii ? read_ascii(reader, layout) : read_binary(reader, layout);
}

std::uint8_t device_code(Device device) noexcept { return codes[static_cast<std::size_t>(device)].binary; }

std::string_view device_text(Device device, bool iqr) noexcept {
  const DeviceCode& code = codes[static_cast<std::size_t>(device)];
  return iqr ? code.ascii_iqr : code.ascii_q;
}

}  // namespace canopus::plc::melsec
