#pragma once
// Contents of a device file without a place in DeviceFile: they are lost when the file is written again.

#include <string>
#include <string_view>
#include <vector>

namespace canopus::eds {

/// Of a file of either kind that read_device_file() takes, in sentences; not more than 20 of them.
[[nodiscard]] std::vector<std::string> beyond_device_file(std::string_view text);

}  // namespace canopus::eds
