#pragma once
// Writes an EDS file [CiA 306] of a device that is described in code.

#include <string>

#include "canopus/eds/device_file.hpp"

namespace canopus::eds {

/// The file's text, lines ending in CR LF. Arrays whose sub-indexes are all alike are written compactly
/// (CompactSubObj); defaults that follow the node-ID as $NODEID+...
[[nodiscard]] std::string write_device_file(const FileInfo& file, const DeviceInfo& device,
                                            const canopen::DictionaryDescription& dictionary);

}  // namespace canopus::eds
