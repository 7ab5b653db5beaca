#pragma once

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/module/models/as_fcopm/configuration.hpp"

namespace canopus::module::as_fcopm {

/// The object dictionary of the slave [AS-FCOPM 10.7].
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> object_dictionary();

/// What the master works with: the printed objects of both roles, and objects of CiA 302-2 and PDOs that follow from
/// the configuration, which the manual does not show. A configuration that check() finds good.
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> master_dictionary(
    const Configuration& configuration, const Layout& layout);

/// The master's objects for the bytes of its PDO `number` (0..255): sub-indexes 01H to 08H.
inline constexpr std::uint16_t received_bytes_index = 0x3000;
inline constexpr std::uint16_t sent_bytes_index = 0x3200;

inline constexpr std::uint16_t slave_input_index = 0x2000;   ///< sub k: D24031 + k
inline constexpr std::uint16_t slave_output_index = 0x2001;  ///< sub k: D25031 + k

}  // namespace canopus::module::as_fcopm
