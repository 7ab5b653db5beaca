#pragma once
// The lines of the control server, as JSON: common to all requests and answers (docs/control.md).

#include <expected>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "canopus/can/time.hpp"
#include "canopus/text/json.hpp"

namespace canopus::serve {

using Json = text::Json;
/// The result of a request, or a sentence with the reason of its refusal.
template <typename Value>
using Result = std::expected<Value, std::string>;

/// Seconds of plant time, to the microsecond.
[[nodiscard]] double plant_seconds(can::Time time);

/// The fields of a request.
class ControlFields {
 public:
  explicit ControlFields(const Json& fields) : fields_(fields) {}

  /// An error for every field that is not of this request; `request` and `id` are of every one.
  [[nodiscard]] Result<void> check(std::span<const std::string_view> known) const;
  [[nodiscard]] Result<void> check(std::initializer_list<std::string_view> known) const {
    return check(std::span(known.begin(), known.size()));
  }
  [[nodiscard]] bool has(std::string_view key) const { return fields_.contains(key); }
  /// nullptr when it is not there.
  [[nodiscard]] const Json* find(std::string_view key) const;
  [[nodiscard]] Result<std::string> text(std::string_view key) const;
  [[nodiscard]] Result<can::Duration> duration(std::string_view key) const;

 private:
  const Json& fields_;
};

/// The answer's line, with its line feed. `fields` is what came: no object, when it was no JSON object.
[[nodiscard]] std::string control_answer(const Json& fields, const Result<Json>& result, can::Time now);

/// Parses a line; the result is no object if the line is not a JSON object.
[[nodiscard]] inline Json control_request(std::string_view line) {
  return text::parse_json(line).value_or(Json());
}

}  // namespace canopus::serve
