#include "canopus/campaign/run_result.hpp"

#include <algorithm>
#include <bit>
#include <chrono>

#include <fmt/format.h>

namespace canopus::campaign {
namespace {

constexpr unsigned steps = 4;  // classes from one power of two to the next

std::uint64_t microseconds(can::Duration time) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(time / std::chrono::microseconds(1), 0));
}

double seconds(can::Duration time) { return static_cast<double>(microseconds(time)) / 1e6; }

unsigned class_of(can::Duration time) {
  const std::uint64_t us = microseconds(time);
  if (us < steps) return static_cast<unsigned>(us);
  const unsigned octave = static_cast<unsigned>(std::bit_width(us)) - 1;
  return octave * steps + static_cast<unsigned>(us >> (octave - 2) & (steps - 1)) - steps;
}

}  // namespace

can::Duration TimeHistogram::begin_of(unsigned number) noexcept {
  if (number < steps) return std::chrono::microseconds(number);
  const unsigned shift = number / steps - 1;
  constexpr unsigned last_shift =
      51;  // behind it there is no time of a run, but a file may name such a class
  constexpr std::int64_t longest = can::Duration::max() / std::chrono::microseconds(1);
  const std::int64_t begin = shift > last_shift ? longest : std::int64_t{number % steps + steps} << shift;
  return std::chrono::microseconds(std::min(begin, longest));
}

void TimeHistogram::add(can::Duration time) {
  ++classes_[class_of(time)];
  ++count_;
  longest_ = std::max(longest_, time);
}

void TimeHistogram::add(const TimeHistogram& other) {
  for (const auto& [number, count] : other.classes_) classes_[number] += count;
  count_ += other.count_;
  longest_ = std::max(longest_, other.longest_);
}

can::Duration TimeHistogram::quantile(double share) const {
  const double wanted = share * static_cast<double>(count_);
  std::uint64_t sum = 0;
  for (const auto& [number, count] : classes_) {
    sum += count;
    if (static_cast<double>(sum) >= wanted) return std::min(begin_of(number + 1), longest_);
  }
  return longest_;
}

text::Json TimeHistogram::to_json() const {
  text::Json classes = text::Json::object();
  for (const auto& [number, count] : classes_) classes[std::to_string(number)] = count;
  return {{"count", count_}, {"longest", seconds(longest_)}, {"classes", std::move(classes)}};
}

bool TimeHistogram::read(const text::Json& value) {
  const auto longest = value.find("longest");
  const auto classes = value.find("classes");
  if (longest == value.end() || !longest->is_number() || classes == value.end() || !classes->is_object())
    return false;
  for (const text::JsonMember& member : classes->items()) {
    unsigned number = 0;
    for (const char digit : member.key) {
      if (digit < '0' || digit > '9' || number > 1000) return false;
      number = number * 10 + static_cast<unsigned>(digit - '0');
    }
    if (number > 64 * steps || !member.value.is_number_unsigned()) return false;
    const auto count = member.value.get<std::uint64_t>();
    classes_[number] += count;
    count_ += count;
  }
  longest_ = std::max(longest_, can::Duration(std::chrono::microseconds(static_cast<std::int64_t>(
                                    std::clamp(longest->get<double>(), 0.0, 1e9) * 1e6 + 0.5))));
  return true;
}

std::string without_numbers(std::string_view text) {
  std::string result;
  for (const char each : text) {
    const bool is_digit = each >= '0' && each <= '9';
    if (!is_digit) {
      result += each;
    } else if (!result.ends_with('#')) {
      result += '#';
    }
  }
  return result;
}

std::string InvariantFailure::fingerprint() const {
  return node.empty() ? fmt::format("{}: {}", invariant, reason)
                      : fmt::format("{}: {}: {}", invariant, node, reason);
}

text::Json to_json(const CampaignFile& campaign, const RunResult& result,
                   const std::vector<ChosenRule>& rules) {
  text::Json shown_rules = text::Json::array();
  for (const ChosenRule& chosen : rules) {
    text::Json knobs = text::Json::object();
    for (const Knob& knob : chosen.knobs) knobs[knob.name] = knob.value;
    shown_rules.push_back({{"name", chosen.rule->name}, {"knobs", std::move(knobs)}});
  }
  text::Json failures = text::Json::array();
  for (const InvariantFailure& failure : result.failures) {
    failures.push_back({{"invariant", failure.invariant},
                        {"node", failure.node},
                        {"reason", failure.reason},
                        {"t", seconds(failure.at.time_since_epoch())},
                        {"detail", failure.detail}});
  }
  text::Json line{{"seed", result.seed}, {"variant", campaign.variants[result.variant].name}};
  const bool is_canary = campaign.canary_of(result.seed) != nullptr;
  if (is_canary) line["canary"] = rules.front().rule->name;
  line["outcome"] = result.failures.empty() ? "passed" : "failed";
  line["rules"] = std::move(shown_rules);
  line["failures"] = std::move(failures);
  line["reached"] = text::Json(result.reached);
  line["boot"] = result.boot ? text::Json(seconds(*result.boot)) : text::Json();
  text::Json reactions = text::Json::object();
  for (const auto& [name, times] : result.reactions) reactions[name] = times.to_json();
  line["reactions"] = std::move(reactions);
  line["frames"] = result.frames;
  line["checksum"] = fmt::format("{:016x}", result.checksum);
  return line;
}

}  // namespace canopus::campaign
