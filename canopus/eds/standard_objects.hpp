#pragma once
// Objects that CiA 301 and CiA 302 define: their names, and the types that files may leave out.

#include <cstdint>
#include <optional>
#include <string_view>

#include "canopus/canopen/dictionary/data_type.hpp"

namespace canopus::eds {

/// Name of an object from 1000H to 1FFFH; empty: it is defined by neither, or it is an SDO's or a PDO's, of which there
/// are many.
[[nodiscard]] std::string_view standard_name(std::uint16_t index) noexcept;

/// Its data type [CiA 301 7.5.2, CiA 302-2, CiA 302-3, CiA 302-7]. Nothing: there is no such sub-index in them.
[[nodiscard]] std::optional<canopen::DataType> standard_type(std::uint16_t index, std::uint8_t sub) noexcept;

}  // namespace canopus::eds
