#pragma once
// Writes XDD and XDC files [CiA 311].

#include "canopus/eds/writer.hpp"

namespace canopus::eds {

/// A device file as an XDD or, with a commissioning, as an XDC, in UTF-8. All data of an object are in its
/// CANopenObject; the application process has the descriptions alone. rwr and rww become rw, for TPDOs or RPDOs.
[[nodiscard]] WrittenFile write_xdd(const DeviceFile& file);

/// The texts of CiA 306 as CiA 311 has them: "12-31-2025" as "2025-12-31", "04:49PM" and "4:49 PM" as "16:49:00". Empty: neither.
[[nodiscard]] std::string xdd_date(std::string_view date);
[[nodiscard]] std::string xdd_time(std::string_view time);

}  // namespace canopus::eds
