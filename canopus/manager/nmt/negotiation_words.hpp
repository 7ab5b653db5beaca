#pragma once
// What the times of a flying master come to, for people: after what time it answers a negotiation, and whether priorities overlap
// [CiA 302-2; RJ71CN91 1.9].

#include <cstdint>
#include <string>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/manager/nmt/flying_master.hpp"

namespace canopus::manager {

/// 1F90H of a dictionary; a sub-index that it has not has the default of a device of this node-ID, 1..127.
[[nodiscard]] FlyingMasterTiming flying_timing(const canopen::ObjectDictionary& objects,
                                               std::uint8_t node_id);

/// "negotiation: 500 ms + 1 x 1500 ms + 5 x 10 ms = 2.05 s after a reset, and 100 ms more while it looks for an active master; asked for
/// by another one: 1.55 s". After a reset: the delay, then negotiation_wait(), and between them the time-out 1F90:01; who is asked later
/// waits negotiation_wait() alone.
[[nodiscard]] std::string negotiation_words(const FlyingMasterTiming& timing, std::uint8_t node_id);

/// What is wrong with the slots: 127 device time slots must be less than a priority time slot, or a node of one priority answers when
/// one of the next has begun to. Empty: nothing.
[[nodiscard]] std::string overlapping_slots(const FlyingMasterTiming& timing);

}  // namespace canopus::manager
