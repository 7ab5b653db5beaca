#include "canopus/module/models/me3can1_q/object_table.hpp"

#include "canopus/module/q_iqr/canopen_options.hpp"

namespace canopus::module::me3can1_q {

std::shared_ptr<const canopen::DictionaryDescription> object_dictionary() {
  static const auto description = q_iqr::make_dictionary({.device_name = "ME3CAN1-Q",
                                                          .hardware_version = "1.00",
                                                          .software_version = "1.00",
                                                          .vendor = 0x0000'0071,
                                                          .product = 0x0000'ED63,
                                                          .revision = 0x0001'0000});
  return description;
}

}  // namespace canopus::module::me3can1_q
