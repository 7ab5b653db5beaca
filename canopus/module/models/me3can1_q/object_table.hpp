#pragma once
// Object dictionary of the ME3CAN1-Q in CANopen 405 mode [ME3CAN1-Q Tab. 4-6 to 4-10, 4.9].

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::module::me3can1_q {

/// The same description for every module of this kind; built at the first call.
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> object_dictionary();

}  // namespace canopus::module::me3can1_q
