#include "canopus/module/models/fx3u_can/object_table.hpp"

#include "canopus/module/models/fx3u_can/buffer_table.hpp"

namespace canopus::module::fx3u_can {

std::shared_ptr<const canopen::DictionaryDescription> object_dictionary() {
  static const auto description =
      q_iqr::make_dictionary(identity, {.exchange = exchange_layout, .rpdo_timers = true});
  return description;
}

}  // namespace canopus::module::fx3u_can
