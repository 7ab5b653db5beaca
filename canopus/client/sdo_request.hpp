#pragma once
// An SDO transfer as a person asks for it, in words, and its answer as a JSON row: the same for `canopus sdo` and for the page.

#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/data_type.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/client/domain_words.hpp"
#include "canopus/client/sdo_transfer.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::client {

/// The object that is read or written, and how its value is shown.
struct SdoTarget {
  std::uint8_t node = 0;
  text::ObjectName object{};
  std::optional<canopen::DataType> type{};  ///< nothing: bytes
  std::string type_name{};                  ///< as it was said
  /// Of the node that a concise DCF is for: names and types; may be null.
  std::shared_ptr<const canopen::DictionaryDescription> names{};
  /// Of the node itself: units, words and ranges of values; may be null.
  std::shared_ptr<const canopen::DictionaryDescription> dictionary{};
  std::string title{};  ///< name of the object in it

  /// `type`: empty: none. The error is a sentence.
  [[nodiscard]] static std::expected<SdoTarget, std::string> parse(std::string_view node,
                                                                   const std::string& object,
                                                                   const std::string& type);
  /// As `--type` has it; empty: none. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> set_type(const std::string& name);
  /// The object is this entry of the node's device file; its type counts if none was set.
  void use(std::shared_ptr<const canopen::DictionaryDescription> dictionary, const canopen::Entry& entry,
           std::string title);
  /// "1017:00"
  [[nodiscard]] std::string object_text() const;
  /// "1017:00", or "1017:00 Producer heartbeat time"
  [[nodiscard]] std::string object_title() const;
};

/// The value of a target with a type as a line: "500 ms  01F4H", "1591  0637H  operation enabled (...)". The error is a wrong
/// length.
[[nodiscard]] std::expected<std::string, std::string> show_value(const SdoTarget& target,
                                                                 std::span<const std::uint8_t> bytes);

/// A value as it is written, of the type or, without one, where `raw`, of bytes in hexadecimal. Within the range of the device
/// file. The error is a sentence.
[[nodiscard]] std::expected<std::vector<std::uint8_t>, std::string> bytes_of_value(const SdoTarget& target,
                                                                                   const std::string& value,
                                                                                   bool raw);

/// The bytes of a value that was read, as many as the type has; a remark says what is unusual about the answer, which is in
/// order if the size was not indicated and the type is known.
struct ReadValue {
  std::span<const std::uint8_t> bytes{};
  std::string remark{};  ///< "4 bytes came, u16 has 2: the others are 0"; empty: none
};
[[nodiscard]] ReadValue value_of(std::span<const std::uint8_t> bytes, const SdoSpeed& speed,
                                 std::optional<canopen::DataType> type);

/// Whether a value is shown as domain_words() has it: one of type domain, a concise DCF, and many bytes of no type.
[[nodiscard]] bool is_domain(const SdoTarget& target, std::span<const std::uint8_t> bytes);
[[nodiscard]] DomainWords words_of(const SdoTarget& target, std::span<const std::uint8_t> bytes);

/// {"node", "object", "bytes"}, with a type "type" and "value", with a device file "name", "unit", "state" and "bits", as far as
/// it has them; where is_domain() "domain" and "transfer"; "remark" of value_of().
[[nodiscard]] text::Json row_of(const SdoTarget& target, std::span<const std::uint8_t> bytes,
                                const SdoSpeed& speed);
/// {"node", "object", "abort", "reason"}; the bus has no abort code.
[[nodiscard]] text::Json row_of(const SdoTarget& target, const SdoFailure& failure);

}  // namespace canopus::client
