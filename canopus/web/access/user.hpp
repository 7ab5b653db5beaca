#pragma once
// Who looks at the page, and what he may do.

#include <cstdint>
#include <string>
#include <string_view>

namespace canopus::web {

/// Each may do what the ones before it may.
enum class WebRole : std::uint8_t {
  look,
  operate,    ///< what ends with the run: NMT commands, faults of a simulated bus, values that are forced
  configure,  ///< what stays: the project, configurations of devices
};

struct WebUser {
  std::string name{};  ///< empty: there are no users, it is who runs the program
  std::string address{};
  WebRole role = WebRole::look;
};

[[nodiscard]] constexpr std::string_view name_of(WebRole role) noexcept {
  switch (role) {
    case WebRole::look: return "look";
    case WebRole::operate: return "operate";
    case WebRole::configure: return "configure";
  }
  return "";
}

}  // namespace canopus::web
