#pragma once
// The bytes of an uploaded value. A server may answer expedited without the number of bytes (e = 1, s = 0, command 42H): then
// the type of the object says how many of the four are the value's [CiA 301 7.2.4.3.6].

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace canopus::canopen {

struct UploadedValue {
  enum class Remark : std::uint8_t {
    none,
    size_not_indicated,  ///< `bytes` are as many as the type has; without a type all four
    longer_than_type     ///< the server indicated more bytes than the type has; the others were 0
  };
  std::span<const std::uint8_t> bytes{};
  Remark remark = Remark::none;
};

/// `length`: bytes that the type has; 0: no type is known, or one of variable length. What fits neither rule stays as it came.
[[nodiscard]] inline UploadedValue uploaded_value(std::span<const std::uint8_t> bytes, bool size_indicated,
                                                  std::size_t length) noexcept {
  using Remark = UploadedValue::Remark;
  constexpr std::size_t expedited = 4;
  const bool is_longer = length != 0 && bytes.size() > length && bytes.size() <= expedited;
  if (!size_indicated) return {is_longer ? bytes.first(length) : bytes, Remark::size_not_indicated};
  const bool is_filled_up =
      is_longer && std::ranges::all_of(bytes.subspan(length), [](std::uint8_t byte) { return byte == 0; });
  return is_filled_up ? UploadedValue{bytes.first(length), Remark::longer_than_type} : UploadedValue{bytes};
}

}  // namespace canopus::canopen
