#include "canopus/module/fx3u_can/object_table.hpp"

#include "canopus/module/fx3u_can/buffer_table.hpp"
#include "canopus/module/intelligent/network_side.hpp"

namespace canopus::module::fx3u_can {

std::shared_ptr<const canopen::DictionaryDescription> object_dictionary() {
  static const auto description = intelligent::make_dictionary({.device_name = "FX3U-CAN",
                                                                .hardware_version = "1.00",
                                                                .software_version = "1.12",
                                                                .vendor = 0x0000'0071,
                                                                .product = 7170,
                                                                .revision = 0x0001'000C},
                                                               {exchange_layout, true});
  return description;
}

}  // namespace canopus::module::fx3u_can
