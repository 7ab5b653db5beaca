#pragma once
// The download that configures a slave by its DCF, as a concise DCF [CiA 302-3]: every configured value
// (ParameterValue) that can be written, and settings that come on top. A PDO is switched off while it is
// changed, as CiA 301 demands: COB-ID bit 31 set, number of mapped objects 0, mapping, number, COB-ID. The
// date and time of the configuration (1020H) come last. Commands (1010H, 1011H) are not settings and are left
// out.

#include <cstdint>
#include <expected>
#include <span>
#include <vector>

#include "canopus/eds/device_file.hpp"
#include "canopus/text/file_error.hpp"
#include "canopus/text/object_value.hpp"

namespace canopus::master {

/// The concise DCF; no bytes when there is nothing to write. Errors are about `settings`: an object that the
/// file does not have or that cannot be written, a value that does not fit.
[[nodiscard]] std::expected<std::vector<std::uint8_t>, std::vector<text::FileError>> concise_dcf_of(
    const eds::DeviceFile& file, std::span<const text::ObjectSetting> settings, std::uint8_t node_id);

}  // namespace canopus::master
