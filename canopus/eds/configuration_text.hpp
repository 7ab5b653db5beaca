#pragma once
// An EDS becomes a node's DCF [CiA 306], and the DCF gets values: only the lines concerned are new or differ.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "canopus/eds/device_file.hpp"
#include "canopus/eds/ini_text.hpp"

namespace canopus::eds {

/// The node that a DCF is for, beyond its Commissioning.
struct ConfigurationNames {
  std::string file_name;  ///< FileName
  std::string eds_name;   ///< LastEDS: the file it is made from
};

/// The text of an EDS (or DCF) as the DCF of one node. Written are [FileInfo] FileName and LastEDS, and of
/// [DeviceComissioning] what `commissioning` gives; a number that is 0 or a name that is empty is left as it is.
/// The bit rate, bit/s, is written in kbit/s. Fails with the reason: a file that cannot be read as a device's, a
/// node-ID other than 1 to 127, a name with a line end in it or of more than 246 letters.
[[nodiscard]] std::expected<IniText, std::string> make_configuration(std::string_view eds,
                                                                     const ConfigurationNames& names,
                                                                     const Commissioning& commissioning);

/// Gives a sub-index this ParameterValue, in its own section or, for a member of a compact object, in its
/// list of values ([2000Value]). Fails, and nothing is changed, with the reason: the file has no such object
/// or sub-index or no place for its value, or the value does not fit its type or limits. Access is not
/// checked. Reads the whole file.
[[nodiscard]] std::expected<void, std::string> set_parameter_value(IniText& file, std::uint16_t index,
                                                                   std::uint8_t sub, std::string_view value);

/// Takes the ParameterValue of a sub-index out, so that its default counts; there is none: nothing happens. Fails, and
/// nothing is changed, as set_parameter_value() does.
[[nodiscard]] std::expected<void, std::string> remove_parameter_value(IniText& file, std::uint16_t index,
                                                                      std::uint8_t sub);

/// The mistake of a value for this sub-index (type, limits), as a sentence about `key`; empty: none.
[[nodiscard]] std::string value_problem(const canopen::DictionaryDescription& dictionary,
                                        const canopen::Entry& entry, std::string_view key,
                                        std::string_view value);
/// Why this cannot be written into a file: a node-ID other than 1 to 127, a name of more than 246 letters; empty: it can.
[[nodiscard]] std::string commissioning_problem(const Commissioning& commissioning);

}  // namespace canopus::eds
