#pragma once
// What a browser sends of forms and cookies, read from the bytes alone.

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace canopus::web {

using WebForm = std::map<std::string, std::string, std::less<>>;
inline constexpr std::size_t most_form_fields = 8;

/// A body of application/x-www-form-urlencoded; nothing for what is none: a '%' without two hexadecimal digits, a name twice,
/// too many fields.
[[nodiscard]] std::optional<WebForm> read_form(std::string_view body);

/// The value of the cookie of this name in a Cookie field (RFC 6265); nothing when it is missing or there twice: whoever can set
/// a second one must not choose.
[[nodiscard]] std::optional<std::string_view> cookie_of(std::string_view field,
                                                        std::string_view name) noexcept;

}  // namespace canopus::web
