#pragma once
// Writes EDS and DCF files [CiA 306].

#include <string>
#include <vector>

#include "canopus/eds/device_file.hpp"

namespace canopus::eds {

/// The EDS of a device that is described in code: its text, lines ending in CR LF. Arrays whose sub-indexes are all
/// alike are written compactly (CompactSubObj); defaults that follow the node-ID as $NODEID+...
[[nodiscard]] std::string write_device_file(const FileInfo& file, const DeviceInfo& device,
                                            const canopen::DictionaryDescription& dictionary);

struct WrittenFile {
  std::string text;
  std::vector<std::string> warnings;  ///< what the format cannot express, or expresses otherwise
};

/// Sub-indexes that a written file describes, as many as a file that is read may.
inline constexpr std::size_t most_written_sub_indexes = 100'000;

/// Why write_eds() and write_xdd() would write too much: both describe every sub-index, which a file with CompactSubObj
/// has 254 of in six lines. Empty: they would not.
[[nodiscard]] std::string too_much_to_write(const DeviceFile& file);

/// A device file as an EDS or, with a commissioning, as a DCF; lines end in CR LF. Every sub-index has its
/// section.
[[nodiscard]] WrittenFile write_eds(const DeviceFile& file);

inline constexpr std::string_view modules_are_lost =
    "the modules a modular device can take: the objects of those that are plugged in are written";

/// A sub-index's default, or the configured value, as value_text() has it; nothing where that has nothing.
[[nodiscard]] std::optional<std::string> default_text(const canopen::DictionaryDescription& dictionary,
                                                      const canopen::Entry& entry);

/// Whether the file allows to map a sub-index. One that the file maps without allowing it may be mapped, too; the reader
/// repairs that again.
[[nodiscard]] bool is_said_to_be_mappable(const canopen::EntryDescription& entry) noexcept;

}  // namespace canopus::eds
