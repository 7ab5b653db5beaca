#pragma once

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::module::fx2n_32can {

/// The object dictionary [FX2N-32CAN 5, 7.4, 8].
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> object_dictionary();

}  // namespace canopus::module::fx2n_32can
