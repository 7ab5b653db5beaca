#include "canopus/campaign/chosen_rules.hpp"

#include <chrono>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/campaign/random_stream.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::campaign {
namespace {

/// Draws the knobs of a rule, in the order of its keys.
class Drawing {
 public:
  Drawing(std::uint64_t seed, const Rule& rule, std::vector<Knob>& knobs)
      : random_(seed, rule.name), knobs_(knobs) {}

  /// True: it comes into the run. Always the first number of the stream.
  bool is_chosen(double chance) {
    constexpr std::uint64_t steps = 1'000'000;
    return random_.below(steps) < static_cast<std::uint64_t>(chance * static_cast<double>(steps) + 0.5);
  }
  toml::table fixed(const toml::table& values, const std::string& path) {
    toml::table result;
    for (const auto& [key, value] : values) {
      const std::string name = path + "." + std::string(key.str());
      value.visit(
          [&](const auto& node) { put(node, name, [&](auto&& each) { result.insert(key.str(), each); }); });
    }
    return result;
  }

 private:
  toml::array fixed(const toml::array& values, const std::string& path) {
    toml::array result;
    std::size_t number = 0;
    for (const toml::node& value : values) {
      const std::string name = fmt::format("{}.{}", path, number++);
      value.visit([&](const auto& node) { put(node, name, [&](auto&& each) { result.push_back(each); }); });
    }
    return result;
  }
  template <typename Node, typename Put>
  void put(const Node& node, const std::string& path, Put put_value) {
    if constexpr (std::is_same_v<Node, toml::table>) {
      if (const toml::array* choices = node["choose"].as_array(); choices != nullptr && node.size() == 1) {
        const toml::node& choice = (*choices)[random_.below(choices->size())];
        choice.visit([&](const auto& each) { put(each, path, put_value); });
        knobs_.push_back({path, text::describe_found(choice)});
      } else if (node.size() == 2 && node.contains("low") && node.contains("high")) {
        put_range(*node.get("low"), *node.get("high"), path, put_value);
      } else {
        put_value(fixed(node, path));
      }
    } else if constexpr (std::is_same_v<Node, toml::array>) {
      put_value(fixed(node, path));
    } else {
      put_value(node);
    }
  }
  template <typename Put>
  void put_range(const toml::node& low, const toml::node& high, const std::string& path, Put put_value) {
    if (low.is_string()) {
      const auto from = *text::parse_duration(low.as_string()->get());
      const auto to = *text::parse_duration(high.as_string()->get());
      const can::Duration unit = std::chrono::microseconds(1);
      const bool in_units = from % unit == can::Duration{} && to % unit == can::Duration{};
      const std::int64_t number =
          in_units ? random_.between(from / unit, to / unit) : random_.between(from.count(), to.count());
      const std::string value = fmt::format("{}{}", number, in_units ? "us" : "ns");
      knobs_.push_back({path, value});
      put_value(value);
    } else if (low.is_integer() && high.is_integer()) {
      const std::int64_t value = random_.between(low.as_integer()->get(), high.as_integer()->get());
      knobs_.push_back({path, fmt::format("{}", value)});
      put_value(value);
    } else {
      // One of 1001 values, cut to six digits: no machine rounds them to another one.
      constexpr std::int64_t steps = 1000;
      const double from = *low.value<double>();
      const double step = static_cast<double>(random_.between(0, steps)) / static_cast<double>(steps);
      const std::string value = fmt::format("{:.6g}", from + (*high.value<double>() - from) * step);
      knobs_.push_back({path, value});
      put_value(ascii::parse_number<double>(value).value_or(from));
    }
  }

  RandomStream random_;
  std::vector<Knob>& knobs_;
};

/// The rule, if `chance` has it.
std::optional<ChosenRule> drawn(const Rule& rule, std::uint64_t seed, double chance) {
  ChosenRule chosen{.rule = &rule};
  Drawing drawing(seed, rule, chosen.knobs);
  if (!drawing.is_chosen(chance)) return std::nullopt;
  chosen.values = drawing.fixed(rule.values, std::string(key_of(rule.kind)));
  return chosen;
}

}  // namespace

ChosenRule chosen_rule(const Rule& rule, std::uint64_t seed) { return *drawn(rule, seed, 1); }

std::vector<ChosenRule> choose_rules(const CampaignFile& campaign, std::uint64_t seed) {
  std::vector<ChosenRule> rules;
  if (const Rule* canary = campaign.canary_of(seed)) {
    rules.push_back(chosen_rule(*canary, seed));
    return rules;
  }
  for (const Rule& rule : campaign.rules) {
    if (rule.is_canary) continue;
    if (auto chosen = drawn(rule, seed, rule.chance)) rules.push_back(std::move(*chosen));
  }
  return rules;
}

}  // namespace canopus::campaign
