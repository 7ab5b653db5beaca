#include "canopus/serve/control_message.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "canopus/text/nearest_word.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::serve {

double plant_seconds(can::Time time) {
  return static_cast<double>(time.time_since_epoch() / std::chrono::microseconds(1)) / 1e6;
}

Result<void> ControlFields::check(std::span<const std::string_view> known) const {
  for (const auto& [key, value] : fields_.items()) {
    if (key == "request" || key == "id") continue;
    if (std::ranges::find(known, key) != known.end()) continue;
    std::vector<std::string_view> expected{"request", "id"};
    expected.insert(expected.end(), known.begin(), known.end());
    return std::unexpected(
        fmt::format("\"{}\" is no field of this request; expected {}", key, text::one_of(expected)));
  }
  return {};
}

const Json* ControlFields::find(std::string_view key) const {
  const auto found = fields_.find(key);
  return found == fields_.end() ? nullptr : &*found;
}

Result<std::string> ControlFields::text(std::string_view key) const {
  const Json* found = find(key);
  if (found == nullptr) return std::unexpected(fmt::format("{} is missing; expected a string", key));
  if (!found->is_string()) return std::unexpected(fmt::format("{}: expected a string", key));
  return found->get<std::string>();
}

Result<can::Duration> ControlFields::duration(std::string_view key) const {
  const auto written = text(key);
  const auto duration = written ? text::parse_duration(*written) : std::unexpected(written.error());
  if (!written) return std::unexpected(written.error());
  if (!duration) return std::unexpected(fmt::format("{}: {}", key, duration.error()));
  if (*duration == can::Duration::zero())
    return std::unexpected(fmt::format("{}: expected more than 0", key));
  return *duration;
}

std::string control_answer(const Json& fields, const Result<Json>& result, can::Time now) {
  Json answer;
  if (fields.is_object() && fields.contains("id") && fields["id"].is_primitive()) answer["id"] = fields["id"];
  answer["ok"] = result.has_value();
  answer["t"] = plant_seconds(now);
  if (result) {
    answer.update(*result);
  } else {
    answer["error"] = result.error();
  }
  return text::printable_json(answer.dump()) + '\n';
}

}  // namespace canopus::serve
