#include "canopus/module/models/rj71cn91/object_table.hpp"

#include "canopus/module/q_iqr/canopen_options.hpp"

namespace canopus::module::rj71cn91 {

std::shared_ptr<const canopen::DictionaryDescription> object_dictionary() {
  static const auto description = q_iqr::make_dictionary({.device_name = "RJ71CN91",
                                                          .hardware_version = "01",
                                                          .software_version = "02",
                                                          .vendor = 0x0000'01D0,
                                                          .product = 0x0000'0100,
                                                          .revision = 0x0001'0000});
  return description;
}

}  // namespace canopus::module::rj71cn91
