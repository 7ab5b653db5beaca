#include "canopus/manager/configuration/master_dictionary.hpp"

#include <string>
#include <utility>

namespace canopus::manager {

namespace {
constexpr unsigned nodes = 127;
}  // namespace

std::shared_ptr<const canopen::DictionaryDescription> master_dictionary() {
  constexpr std::uint32_t generic_device = 0;  // 1000H of a device without a profile
  using canopen::Access;
  using canopen::DataType;
  using canopen::EntrySpec;
  using canopen::ObjectCode;
  canopen::DictionaryBuilder builder;
  const auto read_only = [](std::string name, DataType type, std::uint32_t value = 0) {
    return EntrySpec{.name = std::move(name),
                     .type = type,
                     .access = Access::read_only,
                     .value = canopen::little_endian(value, canopen::byte_length(type))};
  };
  const auto array = [&builder](std::uint16_t index, const char* name, DataType type,
                                unsigned count = nodes) {
    builder.uniform(index, ObjectCode::array, name, static_cast<std::uint8_t>(count),
                    {.name = name, .type = type});
  };
  builder.variable(0x1000, read_only("Device type", DataType::unsigned32, generic_device));
  builder.variable(0x1001, read_only("Error register", DataType::unsigned8));
  array(0x1016, "Consumer heartbeat time", DataType::unsigned32);
  builder.variable(0x1017, {.name = "Producer heartbeat time", .type = DataType::unsigned16});
  builder.uniform(0x1018, ObjectCode::record, "Identity object", 4,
                  read_only("Identity", DataType::unsigned32));
  builder.variable(0x102A, {.name = "NMT inhibit time", .type = DataType::unsigned16});
  array(0x1F26, "Expected configuration date", DataType::unsigned32);
  array(0x1F27, "Expected configuration time", DataType::unsigned32);
  array(0x1F55, "Expected software identification", DataType::unsigned32);
  builder.variable(0x1F80, {.name = "NMT start-up"});
  array(0x1F81, "NMT slave assignment", DataType::unsigned32);
  array(0x1F82, "Request NMT", DataType::unsigned8, nodes + 1);
  array(0x1F83, "Request node guarding", DataType::unsigned8, nodes + 1);
  array(0x1F84, "Device type identification", DataType::unsigned32);
  array(0x1F85, "Vendor identification", DataType::unsigned32);
  array(0x1F86, "Product code", DataType::unsigned32);
  array(0x1F87, "Revision number", DataType::unsigned32);
  array(0x1F88, "Serial number", DataType::unsigned32);
  builder.variable(0x1F89, {.name = "Boot time"});
  array(0x1F8A, "Restore configuration", DataType::unsigned8);
  array(0x1F90, "NMT flying master timing parameters", DataType::unsigned16, 6);
  return builder.build();
}

}  // namespace canopus::manager
