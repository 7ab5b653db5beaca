#pragma once
// The object dictionary of a master without objects of its own: a program that wants to be the NMT master of
// a network needs no EDS for itself.

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::manager {

/// 1000H, 1001H, 1016H (127 entries), 1017H, 1018H, 102AH, 1F26H, 1F27H, 1F55H, 1F80H-1F8AH, 1F90H [CiA 301,
/// CiA 302-2], all 0. The values are put in from NodeListener::reset_done(), before NmtMaster::start().
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> master_dictionary();

}  // namespace canopus::manager
