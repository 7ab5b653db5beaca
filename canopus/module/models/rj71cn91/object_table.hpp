#pragma once
// Object dictionary of the RJ71CN91 in CANopen 405 mode [RJ71CN91 App. 3].

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::module::rj71cn91 {

/// The same description for every module of this kind; built at the first call.
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> object_dictionary();

}  // namespace canopus::module::rj71cn91
