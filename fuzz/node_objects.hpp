#pragma once
// The node of fuzz/node.cpp: an object dictionary with every service of CiA 301, an object that streams, and a
// memory for stored parameters.

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/dictionary/parameter_store.hpp"

#include "input.hpp"

namespace canopus::fuzz {

using canopen::AbortCode;
using canopen::Access;
using canopen::DataType;
using canopen::little_endian;
using canopen::ObjectCode;

inline constexpr std::uint8_t own_id = 5;
inline constexpr std::uint16_t pdo_count = 10;
inline constexpr std::uint16_t stream_object = 0x2040;

/// Transmission types and mappings of the PDOs as delivered; those in 1A00H count for TPDOs, in 1600H for
/// RPDOs.
struct PdoDefaults {
  std::uint8_t transmission_type;
  std::uint16_t inhibit_time;
  std::uint16_t event_timer;
  std::uint8_t mapped;
  std::uint32_t objects[4];
};
inline constexpr PdoDefaults rpdos[pdo_count] = {
    {0, 0, 0, 2, {0x62000108, 0x62000208}},
    {1, 0, 0, 2, {0x64110110, 0x64110210}},
    {240, 0, 50, 4, {0x62200101, 0x62200201, 0x00010001, 0x62200301}},
    {254, 0, 20, 1, {0x65000040}},
    {255, 0, 0, 4, {0x00050008, 0x62000308, 0x00060010, 0x64110310}},
    {255, 0, 0, 0xFF, {}},
    {254, 0, 0, 0xFE, {}},
    {255, 0, 1, 0, {}},
    {255, 0, 0, 3, {0x62200401, 0x62000408, 0x62200501}},
    {255, 0, 0, 1, {0x65010018}},
};
inline constexpr PdoDefaults tpdos[pdo_count] = {
    {0, 0, 0, 2, {0x60000108, 0x60000208}},
    {1, 0, 0, 2, {0x64010110, 0x64010210}},
    {3, 0, 0, 4, {0x60200101, 0x60200201, 0x60000308, 0x60200301}},
    {252, 0, 0, 1, {0x65000040}},
    {253, 0, 0, 1, {0x64010310}},
    {254, 100, 20, 2, {0x60000408, 0x64010410}},
    {255, 0, 0, 3, {0x60200401, 0x60000508, 0x60200501}},
    {254, 50, 0, 0xFF, {}},
    {255, 0, 0, 0xFE, {}},
    {255, 10, 5, 1, {0x65010018}},
};

inline void add_pdos(canopen::DictionaryBuilder& b, std::uint16_t first, std::uint32_t identifier,
                     const PdoDefaults (&pdos)[pdo_count]) {
  for (std::uint16_t i = 0; i < pdo_count; ++i) {
    const auto index = static_cast<std::uint16_t>(first + i);
    b.object(index, ObjectCode::record, "PDO");
    const bool transmits = first == 0x1800;
    const bool on_request = pdos[i].transmission_type == 252 || pdos[i].transmission_type == 253;
    const std::uint32_t flags = i == 9 ? 0x80000000U : transmits && !on_request ? 0x40000000U : 0U;
    b.sub(index, 1, {.value = little_endian(flags | (identifier + 0x10U * i), 4)});
    b.sub(index, 2, {.type = DataType::unsigned8, .value = {pdos[i].transmission_type}});
    b.sub(index, 3, {.type = DataType::unsigned16, .value = little_endian(pdos[i].inhibit_time, 2)});
    b.sub(index, 5, {.type = DataType::unsigned16, .value = little_endian(pdos[i].event_timer, 2)});
    if (transmits) b.sub(index, 6, {.type = DataType::unsigned8});
    const auto mapping = static_cast<std::uint16_t>(index + 0x200);
    b.object(mapping, ObjectCode::array, "Mapping");
    b.sub(mapping, 0, {.type = DataType::unsigned8, .value = {pdos[i].mapped}});
    for (std::uint8_t sub = 1; sub <= 8; ++sub) {
      b.sub(mapping, sub, {.value = little_endian(sub <= 4 ? pdos[i].objects[sub - 1] : 0, 4)});
    }
  }
}

inline std::shared_ptr<const canopen::DictionaryDescription> build_node_objects() {
  canopen::DictionaryBuilder b;
  const auto variable = [&b](std::uint16_t index, DataType type, std::uint64_t value = 0,
                             Access access = Access::read_write) {
    const unsigned length = (canopen::bit_length(type) + 7) / 8;
    b.variable(index,
               {.name = "Object", .type = type, .access = access, .value = little_endian(value, length)});
  };
  using enum DataType;
  variable(0x1000, unsigned32, 0x191, Access::read_only);
  variable(0x1001, unsigned8, 0, Access::read_only);
  b.uniform(0x1003, ObjectCode::array, "History", 3, {.access = Access::read_only});
  b.sub(0x1003, 0, {.type = unsigned8, .access = Access::read_write});
  variable(0x1005, unsigned32, 0x80);
  variable(0x1006, unsigned32, 3000);
  variable(0x1007, unsigned32, 500);
  b.variable(0x1008, {.name = "Name",
                      .type = visible_string,
                      .access = Access::constant,
                      .value = canopen::text("CANOPUS")});
  variable(0x100C, unsigned16, 20);
  variable(0x100D, unsigned8, 2);
  b.uniform(0x1010, ObjectCode::array, "Store", 4, {.value = little_endian(1, 4)});
  b.uniform(0x1011, ObjectCode::array, "Restore", 4, {.value = little_endian(1, 4)});
  variable(0x1012, unsigned32, 0x8000'0100);
  b.variable(0x1014, {.value = little_endian(0x80, 4), .adds_node_id = true});
  variable(0x1015, unsigned16);
  b.uniform(0x1016, ObjectCode::array, "Consumers", 4, {});
  b.sub(0x1016, 0, {.type = unsigned8, .access = Access::constant, .value = {4}});
  variable(0x1017, unsigned16);
  b.uniform(0x1018, ObjectCode::record, "Identity", 4, {.access = Access::read_only});
  variable(0x1019, unsigned8);
  b.uniform(0x1028, ObjectCode::array, "EMCY", 12, {.value = little_endian(0x80000000, 4)});
  b.uniform(0x1029, ObjectCode::array, "Error behaviour", 1, {.type = unsigned8});
  constexpr std::uint16_t channels[] = {0x1200, 0x1201, 0x1202, 0x1280};
  for (const std::uint16_t channel : channels) {
    b.object(channel, ObjectCode::record, "SDO");
    const bool is_default = channel == 0x1200;
    const std::uint32_t request = is_default ? 0x605U : channel == 0x1201 ? 0x6A0U : 0x80000000U;
    const std::uint32_t response = is_default ? 0x585U : channel == 0x1201 ? 0x6A1U : 0x80000000U;
    b.sub(channel, 1, {.value = little_endian(request, 4)});
    b.sub(channel, 2, {.value = little_endian(response, 4)});
    b.sub(channel, 3, {.type = unsigned8});
  }
  add_pdos(b, 0x1400, 0x300, rpdos);
  add_pdos(b, 0x1800, 0x200, tpdos);
  b.uniform(0x1FA0, ObjectCode::array, "Scanner list", 4, {.value = little_endian(0x04'2000'00, 4)});
  b.uniform(0x1FD0, ObjectCode::array, "Dispatcher list", 4,
            {.type = unsigned64, .value = little_endian(0x03'6200'01'2000'01'09, 8)});
  const DataType types[] = {boolean,    integer8,    integer16,  integer32,       unsigned8,
                            unsigned16, unsigned32,  real32,     visible_string,  octet_string,
                            domain,     time_of_day, integer24,  real64,          integer40,
                            integer48,  integer56,   integer64,  unsigned24,      unsigned40,
                            unsigned48, unsigned56,  unsigned64, time_difference, unicode_string};
  std::uint16_t next = 0x2000;
  for (const DataType type : types) b.variable(next++, {.name = "Value", .type = type});
  b.variable(0x2020, {.name = "Write-only", .type = unsigned8, .access = Access::write_only});
  b.variable(0x2022, {.name = "Limited",
                      .type = integer16,
                      .limits = {.low = static_cast<std::uint64_t>(-100), .high = 100}});
  b.variable(stream_object, {.name = "Stream", .type = domain});
  b.uniform(0x6000, ObjectCode::array, "Inputs", 8, {.type = unsigned8, .tpdo_mappable = true});
  b.uniform(0x6020, ObjectCode::array, "Input bits", 8, {.type = boolean, .tpdo_mappable = true});
  b.uniform(0x6200, ObjectCode::array, "Outputs", 8, {.type = unsigned8, .rpdo_mappable = true});
  b.uniform(0x6220, ObjectCode::array, "Output bits", 8, {.type = boolean, .rpdo_mappable = true});
  b.uniform(0x6401, ObjectCode::array, "Analogue inputs", 4, {.type = integer16, .tpdo_mappable = true});
  b.uniform(0x6411, ObjectCode::array, "Analogue outputs", 4, {.type = integer16, .rpdo_mappable = true});
  b.variable(0x6500, {.type = unsigned64, .rpdo_mappable = true, .tpdo_mappable = true});
  b.variable(0x6501, {.type = integer24, .rpdo_mappable = true, .tpdo_mappable = true});
  return b.build();
}

class Stream final : public canopen::ObjectHandler, public canopen::ObjectStream {
 public:
  canopen::ObjectStream* stream(const canopen::Entry&) override { return this; }
  std::expected<std::optional<std::size_t>, AbortCode> open_read(const canopen::Entry&, can::Time) override {
    if (open_) return std::unexpected(AbortCode::device_state);
    open_ = reads_ = true;
    left_ = length;
    return length % 2 != 0 ? std::optional(length) : std::nullopt;
  }
  AbortCode open_write(const canopen::Entry&, std::optional<std::size_t>, can::Time) override {
    if (open_) return AbortCode::device_state;
    open_ = true;
    reads_ = false;
    left_ = length;
    return AbortCode::none;
  }
  AbortCode close(const canopen::Entry&, bool complete, can::Time) override {
    expect(open_);
    open_ = false;
    return complete && length == 13 ? AbortCode::hardware_error : AbortCode::none;
  }
  std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t> into) override {
    expect(open_ && reads_);
    if (length == 1000 && left_ < 500) return std::unexpected(AbortCode::hardware_error);
    const std::size_t count = std::min(into.size(), left_);
    std::fill_n(into.begin(), count, std::uint8_t{0x55});
    left_ -= count;
    return count;
  }
  AbortCode write(std::span<const std::uint8_t> bytes) override {
    expect(open_ && !reads_);
    if (bytes.size() > left_) return AbortCode::out_of_memory;
    left_ -= bytes.size();
    return AbortCode::none;
  }
  [[nodiscard]] bool is_open() const noexcept { return open_; }

  std::size_t length = 100;

 private:
  std::size_t left_ = 0;
  bool open_ = false;
  bool reads_ = false;
};

class Store final : public canopen::ParameterStore {
 public:
  std::vector<std::uint8_t> load() override { return image; }
  AbortCode save(std::span<const std::uint8_t> bytes) override {
    if (fails) return AbortCode::hardware_error;
    image.assign(bytes.begin(), bytes.end());
    return AbortCode::none;
  }
  std::vector<std::uint8_t> image;
  bool fails = false;
};

}  // namespace canopus::fuzz
