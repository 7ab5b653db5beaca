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
    {0x2C, "RD", "RD"},
    {0x2E, "HG", "HG"},
}};

/// The kind of a target's extension, before the device code is known.
enum class Extension : std::uint8_t { none, module, other };

/// The modification of a number: none, or an index register. Other kinds (LZ, indirect) are not supported.
struct Modification {
  enum class Kind : std::uint8_t { none, z, other } kind = Kind::none;
  std::uint32_t number = 0;
};

Modification modification_of(std::uint16_t field) {
  constexpr unsigned z = 0x4000;
  if (field == 0) return {};
  if ((field & 0xFF00U) == z) return {Modification::Kind::z, field & 0xFFU};
  return {Modification::Kind::other, 0};
}

/// "000", "Z04".
Modification modification_of(std::span<const std::uint8_t> text) {
  if (text.empty()) return {};
  Modification result;
  if (text[0] == 'Z') result.kind = Modification::Kind::z;
  for (const std::uint8_t character : text.subspan(result.kind == Modification::Kind::z ? 1 : 0)) {
    if (character < '0' || character > '9') return {Modification::Kind::other, 0};
    result.number = 10 * result.number + (character - unsigned{'0'});
  }
  if (result.kind == Modification::Kind::none && result.number != 0) return {Modification::Kind::other, 0};
  return result;
}

/// Adds it, as a signed value; an index register or a sum that does not exist is beyond the last number.
std::expected<std::uint32_t, EndCode> modified(std::uint32_t number, const Modification& by,
                                               std::span<const std::uint16_t> index_registers) {
  if (by.kind == Modification::Kind::none) return number;
  if (by.kind == Modification::Kind::other || index_registers.empty())
    return std::unexpected(EndCode::no_device_extension);
  if (by.number >= index_registers.size()) return std::unexpected(EndCode::device_out_of_range);
  const std::int64_t sum = std::int64_t{number} + static_cast<std::int16_t>(index_registers[by.number]);
  if (sum < 0 || sum > 0xFFFFFFFF) return std::unexpected(EndCode::device_out_of_range);
  return static_cast<std::uint32_t>(sum);
}

constexpr std::uint8_t no_device = 0xFF;

/// The Device of each code, or no_device.
constexpr std::array<std::uint8_t, 256> devices_by_code = [] {
  std::array<std::uint8_t, 256> devices{};
  devices.fill(no_device);
  for (std::size_t i = 0; i < codes.size(); ++i)
    if (codes[i].binary != 0) devices[codes[i].binary] = static_cast<std::uint8_t>(i);
  return devices;
}();

std::optional<Device> device_of(std::uint32_t code) {
  if (code >= devices_by_code.size() || devices_by_code[code] == no_device) return std::nullopt;
  return static_cast<Device>(devices_by_code[code]);
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
    // G needs the unit number of its module.
    if (extension == Extension::none) return std::unexpected(EndCode::device_not_accessible);
    if (module_number > 0xFF) return std::unexpected(EndCode::no_module);
    return Target{true, Device::d, static_cast<std::uint16_t>(16 * module_number), number};
  }
  if (!device) return std::unexpected(EndCode::device_not_accessible);
  if (*device == Device::hg) {
    if (extension == Extension::none) return std::unexpected(EndCode::device_not_accessible);
    if (module_number != own_cpu) return std::unexpected(EndCode::no_module);
    return Target{false, Device::hg, 0, number};
  }
  if (extension == Extension::module) return std::unexpected(EndCode::no_device_extension);
  return Target{false, *device, 0, number};
}

/// A target as it is written, before its index registers are added.
struct Written {
  std::optional<Device> device;
  bool is_g = false;
  Extension extension = Extension::none;
  std::uint32_t module_number = 0;
  std::uint32_t number = 0;
  Modification of_device;
  Modification of_extension;
};

Written read_binary(FieldReader& reader, Layout layout) {
  Written written;
  if (layout.extended) written.of_device = modification_of(reader.u16());
  written.number = layout.iqr ? reader.u32() : reader.u24();
  const std::uint16_t code = layout.iqr ? reader.u16() : reader.u8();
  written.device = device_of(code);
  written.is_g = code == buffer_memory_code;
  if (!layout.extended) return written;
  written.of_extension = modification_of(reader.u16());
  written.module_number = reader.u16();
  const std::uint8_t memory = reader.u8();
  if (memory == module_access || memory == cpu_buffer)
    written.extension = Extension::module;
  else if (memory != 0 || written.module_number != 0)  // also link direct, F9H
    written.extension = Extension::other;
  return written;
}

Written read_ascii(FieldReader& reader, Layout layout) {
  Written written;
  std::array<char, 4> memory{};
  const std::size_t modification = layout.iqr ? 4 : 3;
  bool indirect = false;
  if (layout.extended) {
    for (const std::uint8_t character : reader.raw(2)) indirect = indirect || character != '0';
    const auto letter = reader.raw(1);
    written.module_number = reader.digits(3, 16);
    if (!letter.empty() && letter[0] == 'U')
      written.extension = Extension::module;
    else if ((!letter.empty() && letter[0] != '0') || written.module_number != 0)
      written.extension = Extension::other;
    written.of_extension = modification_of(reader.raw(modification));
  }
  const std::string_view code = unpadded(reader.raw(layout.iqr ? 4 : 2), memory);
  written.device = device_of(code, layout.iqr);
  const bool hexadecimal = written.device && device_info(*written.device).hexadecimal;
  const std::size_t digits = !layout.iqr ? 6 : layout.extended ? 10 : 8;
  written.is_g = code == "G";
  // A device that is unknown has numbers of an unknown kind: take the wider one, the code decides below.
  const bool octal = layout.octal_io && (written.device == Device::x || written.device == Device::y);
  const bool wide = hexadecimal || (!written.device && !written.is_g);
  written.number = reader.digits(digits, octal ? 8 : wide ? 16 : 10);
  if (layout.extended) written.of_device = modification_of(reader.raw(modification));
  if (indirect) written.of_device.kind = Modification::Kind::other;
  return written;
}

}  // namespace

std::expected<Target, EndCode> read_target(FieldReader& reader, Layout layout,
                                           std::span<const std::uint16_t> index_registers) noexcept {
  if (reader.code() == DataCode::binary && !layout.extended) {
    const Written plain = read_binary(reader, layout);
    return joined(plain.device, plain.is_g, Extension::none, 0, plain.number);
  }
  const Written written =
      reader.code() == DataCode::ascii ? read_ascii(reader, layout) : read_binary(reader, layout);
  const auto module_number = modified(written.module_number, written.of_extension, index_registers);
  if (!module_number) return std::unexpected(module_number.error());
  const auto number = modified(written.number, written.of_device, index_registers);
  if (!number) return std::unexpected(number.error());
  return joined(written.device, written.is_g, written.extension, *module_number, *number);
}

std::uint8_t device_code(Device device) noexcept { return codes[static_cast<std::size_t>(device)].binary; }

std::string_view device_text(Device device, bool iqr) noexcept {
  const DeviceCode& code = codes[static_cast<std::size_t>(device)];
  return iqr ? code.ascii_iqr : code.ascii_q;
}

}  // namespace canopus::plc::melsec
