#pragma once
// Objects of a device and their values as people write them: on the command line, in scripts of a plant file,
// in the header row of a CSV file, and to the control server.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/sim/device/device.hpp"
#include "canopus/text/json.hpp"

namespace canopus::plant {

/// Every number of a device's process, in order of index and sub-index.
[[nodiscard]] std::vector<canopen::Entry> process_values(const sim::Device& device);

/// The one selected by "6000:01" or by a parameter's name in the device file ("Digital inputs 1 to 8", upper
/// and lower case are the same). The error names the mistake: no such object or name, a name that more than
/// one has, an object that is no number.
[[nodiscard]] std::expected<canopen::Entry, std::string> find_process_value(const sim::Device& device,
                                                                            std::string_view text);

/// "17", "-3", "0x1F", "true", "2.5" as the bit pattern of the entry. The error names the type, its range, or the
/// limit of the device file that it exceeds.
[[nodiscard]] std::expected<std::uint64_t, std::string> parse_value(
    std::string_view text, const canopen::Entry& entry, const canopen::DictionaryDescription& description);

/// A value of the plant file, for parse_value().
[[nodiscard]] std::string text_of(const text::Scalar& value);

/// "17", "-3", "true", "2.5".
[[nodiscard]] std::string show_value(canopen::DataType type, std::uint64_t bits);
/// The same as a number or boolean of JSON; what JSON has no number for (an infinity) as its text.
[[nodiscard]] text::Json json_value(canopen::DataType type, std::uint64_t bits);

}  // namespace canopus::plant
