#pragma once
// The communication profile of a file against CiA 301: objects that it describes without a value get the
// standard's default, COB-IDs with a restricted CAN-ID are reported.

#include <string>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/eds/draft.hpp"
#include "canopus/eds/problems.hpp"

namespace canopus::eds {

/// 1005H, 1012H, 1014H, 1028H, 12xxH, 14xxH and 18xxH without a value: the defaults of CiA 301 7.5, of the
/// first four PDOs the pre-defined connection set, the other PDOs switched off; transmission type FFH, which
/// CiA 301 leaves to the device.
void set_missing_defaults(Draft& draft, Problems& problems);

/// COB-IDs that no node uses, because CiA 301 restricts their CAN-ID [CiA 301 7.3.5]. The values stay.
void review_restricted_identifiers(const Draft& draft, Problems& problems);

/// The consequence for the service whose COB-ID is refused: "TPDO1 is not sent".
[[nodiscard]] std::string consequence_of_refusal(canopen::CobIdUse use, std::uint16_t index);

}  // namespace canopus::eds
