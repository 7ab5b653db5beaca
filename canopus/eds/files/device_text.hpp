#pragma once
// A device file of either kind, changed at the requested places and nowhere else: an EDS or DCF by IniText, an XDD or XDC by
// xml::Text. A file that came from a foreign tool and is saved unchanged is the same bytes; one value is one line.

#include <expected>
#include <string>
#include <string_view>
#include <variant>

#include "canopus/eds/configuration_text.hpp"
#include "canopus/eds/xml/text.hpp"

namespace canopus::eds {

class DeviceText {
 public:
  /// Takes any bytes; the content decides the kind.
  explicit DeviceText(std::string_view text);

  /// The file as it is now. Unchanged, these are the bytes it was made from.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] bool is_xml() const noexcept { return !std::holds_alternative<IniText>(file_); }

  using Done = std::expected<void, std::string>;
  /// Gives a sub-index this ParameterValue or actualValue; of an XDC, its parameter when that has one already and no
  /// other object refers to it. Fails, and nothing is changed, as eds::set_parameter_value() does.
  [[nodiscard]] Done set_parameter_value(std::uint16_t index, std::uint8_t sub, std::string_view value);
  /// Takes that value out, so that the default counts; there is none: nothing happens.
  [[nodiscard]] Done remove_parameter_value(std::uint16_t index, std::uint8_t sub);
  /// Sets the node for which the file is, as make_configuration() does. An XDC has no place for LastEDS, which is left out,
  /// and for an LSS serial number, which is refused.
  [[nodiscard]] Done configure(const ConfigurationNames& names, const Commissioning& commissioning);

 private:
  struct Unreadable {
    std::string bytes;
    std::string reason;
  };
  struct Xdd {
    xml::Text text;
    std::optional<Encoding> encoding;  // of the file; its text here is UTF-8
  };
  [[nodiscard]] static std::variant<IniText, Xdd, Unreadable> read(std::string_view text);
  [[nodiscard]] static std::string bytes(const Xdd& file);

  std::variant<IniText, Xdd, Unreadable> file_;
};

/// An EDS or XDD as the DCF or XDC of one node.
[[nodiscard]] std::expected<DeviceText, std::string> make_device_configuration(
    std::string_view file, const ConfigurationNames& names, const Commissioning& commissioning);

}  // namespace canopus::eds
