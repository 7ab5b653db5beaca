#pragma once
// The PDOs of a file, checked for consistency: generated, repaired, reported.

#include "canopus/eds/draft.hpp"

namespace canopus::eds {

/// Adds the PDOs that NrOfRXPDO and NrOfTXPDO announce and CompactPDO describes but no section does [CiA
/// 306].
void generate_compact_pdos(Draft& draft, const DeviceInfo& device, unsigned line, Problems& problems);

/// COB-IDs of the pre-defined connection set that lack their $NODEID would be the same in every node: adds
/// it.
void repair_cob_ids(Draft& draft, Problems& problems);

/// Checks default mappings: objects that exist, lengths, 64 bits; objects that are mapped by default are made
/// mappable.
void review_mappings(Draft& draft, std::uint32_t dummy_usage, Problems& problems);

}  // namespace canopus::eds
