#pragma once

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/module/q_iqr/canopen_options.hpp"

namespace canopus::module::fx3u_can {

inline constexpr q_iqr::Identity identity{.device_name = "FX3U-CAN",
                                          .hardware_version = "1.00",
                                          .software_version = "1.12",
                                          .vendor = 0x0000'0071,
                                          .product = 7170,
                                          .revision = 0x0001'000C};

/// The object dictionary in CANopen 405 mode [FX3U-CAN 5.6, 5.9].
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> object_dictionary();
/// The object dictionary in CANopen 417 mode [FX3U-CAN 5.6, 5.10].
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> lift_dictionary();

}  // namespace canopus::module::fx3u_can
