#include "canopus/campaign/campaign_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/words.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::campaign {
namespace {

using text::TableReader;

struct RuleName {
  std::string_view key;
  RuleKind kind;
};
constexpr std::array rule_names{
    RuleName{"fault", RuleKind::fault},       RuleName{"set", RuleKind::set},
    RuleName{"script", RuleKind::script},     RuleName{"power_cut", RuleKind::power_cut},
    RuleName{"cpu_stop", RuleKind::cpu_stop}, RuleName{"write", RuleKind::write}};

struct InvariantName {
  std::string_view name;
  InvariantKind kind;
};
constexpr std::array invariant_names{
    InvariantName{"operational", InvariantKind::operational}, InvariantName{"value", InvariantKind::value},
    InvariantName{"frames", InvariantKind::frames},           InvariantName{"event", InvariantKind::event},
    InvariantName{"reaction", InvariantKind::reaction},       InvariantName{"python", InvariantKind::python}};

template <typename Names>
std::vector<std::string_view> list_of(const Names& names, auto member) {
  std::vector<std::string_view> all;
  for (const auto& name : names) all.push_back(name.*member);
  return all;
}

/// "expected one of a, b": a form that schemas understand.
std::string expected_one_of(std::span<const std::string_view> words) {
  return fmt::format("expected one of {}", fmt::join(words, ", "));
}

void note_places(KeyPlaces& places, const toml::table& table) {
  for (const auto& [key, value] : table) {
    places.emplace(key.str(), text::place_of(key.source()));
    if (const toml::table* const inner = value.as_table()) note_places(places, *inner);
  }
}

/// A table whose keys another reader checks. `each` gets its values as they stand in the file: a copy has no places.
toml::table read_any_table(
    TableReader& table, std::string_view key, KeyPlaces& places, std::string_view example,
    const std::function<void(const toml::node&)>& each = [](const toml::node&) {}) {
  toml::table values;
  table.entries(
      key,
      [&](std::string_view name, const toml::node& value, text::Place place) {
        each(value);
        values.insert_or_assign(name, value);
        places.emplace(name, place);
        if (const toml::table* const inner = value.as_table()) note_places(places, *inner);
      },
      example);
  return values;
}

bool has(const TableReader& table, std::string_view key) { return table.place(key) != table.place(); }

std::vector<std::string> read_names(TableReader& table, std::string_view key, std::string_view expected) {
  std::vector<std::string> names;
  table.elements(key, [&](const toml::node& element) {
    if (const auto* name = element.as_string(); name != nullptr && !name->get().empty()) {
      names.push_back(name->get());
    } else {
      table.error(key, expected);
    }
  });
  return names;
}

Target read_target(TableReader& table) {
  return {.bus = table.text("bus").value_or(""),
          .device = table.text("device").value_or(""),
          .plc = table.text("plc").value_or(""),
          .module = table.text("module").value_or("")};
}

can::Duration read_duration(TableReader& table, std::string_view key, can::Duration otherwise,
                            can::Duration least, can::Duration most, bool required = false) {
  const auto duration = table.parsed(key, text::parse_duration, required);
  if (!duration) return otherwise;
  if (*duration >= least && *duration <= most) return *duration;
  table.error(
      key, fmt::format("expected {} to {}", text::describe_duration(least), text::describe_duration(most)));
  return otherwise;
}

bool is_knob_pair(const toml::node& low, const toml::node& high) {
  if (low.is_integer() && high.is_integer()) return low.as_integer()->get() <= high.as_integer()->get();
  if (low.is_number() && high.is_number()) {
    const auto from = low.value<double>();
    const auto to = high.value<double>();  // nothing: a whole number that no double has
    return from && to && *from <= *to && std::isfinite(*to - *from);
  }
  if (!low.is_string() || !high.is_string()) return false;
  const auto from = text::parse_duration(low.as_string()->get());
  const auto to = text::parse_duration(high.as_string()->get());
  return from && to && *from <= *to;
}

/// { low = 1, hihg = 5 }, { low = 1 }, { chose = [1, 2] }.
bool is_misspelt_knob(const toml::table& table) {
  constexpr std::array<std::string_view, 3> keys{"low", "high", "choose"};
  const auto is_near = [&](const auto& item) { return !text::nearest(item.first.str(), keys).empty(); };
  return !table.empty() && table.size() <= 2 && std::ranges::all_of(table, is_near);
}

/// { low = 1, high = 5 } and { choose = [1, 2] } anywhere in the values of a rule.
void check_knobs(const toml::node& node, TableReader& table) {
  if (const auto* array = node.as_array()) {
    for (const toml::node& element : *array) check_knobs(element, table);
  }
  const auto* inner = node.as_table();
  if (inner == nullptr) return;
  const toml::node* const low = inner->get("low");
  const toml::node* const high = inner->get("high");
  const toml::node* const choose = inner->get("choose");
  const auto wrong = [&](std::string_view expected) {
    table.error(text::place_of(node.source()), std::string(expected));
  };
  if (choose != nullptr) {
    if (inner->size() != 1 || !choose->is_array() || choose->as_array()->empty())
      wrong("expected { choose = [1, 2, 5] } with one value at least, and no other key");
  } else if (low != nullptr && high != nullptr && inner->size() == 2) {
    if (!is_knob_pair(*low, *high))
      wrong(
          "expected { low = 1, high = 5 } or { low = \"1ms\", high = \"5s\" }: two numbers or two times, the "
          "lower one first");
  } else if (is_misspelt_knob(*inner)) {
    wrong("expected { low = 1, high = 5 } or { choose = [1, 2, 5] }");
  } else {
    for (const auto& [key, value] : *inner) check_knobs(value, table);
  }
}

Rule read_rule(TableReader& table) {
  Rule rule{.place = table.place(), .name = table.text("name", true).value_or("")};
  for (const std::string_view key :
       {"bus", "device", "plc", "module", "fault", "set", "script", "power_cut", "cpu_stop", "write"})
    if (has(table, key)) rule.places.emplace(key, table.place(key));
  rule.chance = table.number("chance").value_or(rule.chance);
  if (!(rule.chance >= 0 && rule.chance <= 1)) table.error("chance", "expected 0 to 1");
  rule.is_canary = table.boolean("canary").value_or(false);
  if (rule.is_canary && has(table, "chance"))
    table.error("chance", "a canary has none: it has a seed of its own");
  rule.target = read_target(table);
  std::size_t found = 0;
  for (const RuleName& name : rule_names) {
    toml::table values = read_any_table(table, name.key, rule.places, "{ at = \"5s\", for = \"1s\" }",
                                        [&](const toml::node& value) { check_knobs(value, table); });
    if (!has(table, name.key)) continue;
    ++found;
    rule.kind = name.kind;
    rule.values = std::move(values);
  }
  if (found != 1) {
    table.error(rule.place, fmt::format("rule: expected one of the keys {}; found {}",
                                        text::one_of(list_of(rule_names, &RuleName::key)), found));
  }
  const Target& target = rule.target;
  const auto needs = [&](bool is_there, std::string_view key, std::string_view expected) {
    if (found == 1 && !is_there) table.error(key, expected);
  };
  switch (rule.kind) {
    case RuleKind::fault: break;
    case RuleKind::set:
      needs(!target.bus.empty() || !target.device.empty() || !target.plc.empty() || !target.module.empty(),
            "device", "expected device, module, plc or bus: whose keys are set");
      break;
    case RuleKind::script: needs(!target.device.empty(), "device", "expected the name of a device"); break;
    case RuleKind::power_cut:
      needs(target.device.empty() != target.plc.empty(), "device", "expected device or plc, one of them");
      break;
    case RuleKind::cpu_stop:
    case RuleKind::write: break;
  }
  return rule;
}

Variant read_variant(TableReader& table, const std::string& plant) {
  Variant variant{.place = table.place(),
                  .name = table.text("name", true).value_or(""),
                  .plant = table.text("plant").value_or(plant)};
  if (variant.plant.empty() && !table.is_wrong("plant"))
    table.error("plant", "expected the path of a plant file");
  variant.program = read_names(table, "program", "expected paths in quotes, for example [\"main.st\"]");
  variant.plc = table.text("plc").value_or("");
  table.tables("change", "variant.change", [&](TableReader& inner) {
    Change change{.place = inner.place(), .target = read_target(inner)};
    KeyPlaces places;
    change.set = read_any_table(inner, "set", places, "{ start = \"1s\" }");
    if (!has(inner, "set")) inner.error("set", "expected a table, for example { start = \"1s\" }");
    const Target& target = change.target;
    if (target.bus.empty() && target.device.empty() && target.plc.empty() && target.module.empty())
      inner.error("device", "expected device, module, plc or bus: whose keys are set");
    variant.changes.push_back(std::move(change));
  });
  return variant;
}

trace::FilterExpression read_filter(TableReader& table, std::string_view key, bool required) {
  auto filter = table.parsed(key, trace::FilterExpression::parse, required);
  return filter ? std::move(*filter) : trace::FilterExpression{};
}

void read_value(TableReader& table, Invariant& invariant) {
  invariant.target = read_target(table);
  invariant.object = table.text("object").value_or("");
  invariant.word = table.text("word").value_or("");
  invariant.variable = table.text("variable").value_or("");
  const int sources = static_cast<int>(!invariant.object.empty()) +
                      static_cast<int>(!invariant.word.empty()) +
                      static_cast<int>(!invariant.variable.empty());
  if (sources != 1) table.error("object", "expected object, word or variable, one of them");
  if (!invariant.object.empty() && invariant.target.device.empty())
    table.error("device", "expected the name of the device that has the object");
  invariant.low = table.number("low");
  invariant.high = table.number("high");
  if (const auto changes = table.parsed("changes_within", text::parse_duration)) invariant.changes = *changes;
  if (!invariant.low && !invariant.high && !invariant.changes)
    table.error("low", "expected low, high or changes_within");
  if (invariant.low && invariant.high && *invariant.low > *invariant.high)
    table.error("high", "expected low or more");
  if (invariant.changes && invariant.expectation != Expectation::always)
    table.error("changes_within", "expected with expect = \"always\" alone");
}

Expectation read_expectation(TableReader& table, InvariantKind kind, bool is_known) {
  const bool is_seen = kind == InvariantKind::frames || kind == InvariantKind::event;
  const Expectation otherwise = is_seen ? Expectation::never : Expectation::always;
  const auto text = table.text("expect");
  if (!text) return otherwise;
  if (*text == "sometimes" && (is_seen || kind == InvariantKind::value)) return Expectation::sometimes;
  if (*text == "never" && (is_seen || kind == InvariantKind::value)) return Expectation::never;
  if (*text == "always" && !is_seen) return Expectation::always;
  table.error("expect", !is_known || kind == InvariantKind::value
                            ? "expected \"always\", \"never\" or \"sometimes\""
                        : is_seen ? "expected \"never\" or \"sometimes\""
                                  : "expected \"always\"");
  return otherwise;
}

bool is_name(std::string_view text) {
  return !ascii::is_digit(text.front()) && std::ranges::all_of(text, [](char c) {
    return ascii::is_letter(c) || ascii::is_digit(c) || c == '_';
  });
}

Invariant read_invariant(TableReader& table) {
  Invariant invariant{.place = table.place(), .name = table.text("name", true).value_or("")};
  const std::string kind = table.text("kind", true).value_or("");
  const auto known = std::ranges::find(invariant_names, kind, &InvariantName::name);
  if (known != invariant_names.end()) {
    invariant.kind = known->kind;
  } else if (!table.is_wrong("kind")) {
    table.error("kind", expected_one_of(list_of(invariant_names, &InvariantName::name)));
  }
  for (const std::string_view key :
       {"nodes", "bus", "device", "plc", "module", "object", "word", "variable", "file", "function"})
    if (has(table, key)) invariant.places.emplace(key, table.place(key));
  invariant.expectation = read_expectation(table, invariant.kind, known != invariant_names.end());
  invariant.after = read_duration(table, "after", {}, can::Duration{}, longest_run);
  const bool is_known = known != invariant_names.end();
  const auto read_within = [&] {
    invariant.within =
        read_duration(table, "within", std::chrono::seconds(1), can::Duration{1}, longest_run, is_known);
  };
  switch (invariant.kind) {
    case InvariantKind::operational:
      read_within();
      invariant.nodes = read_names(table, "nodes", "expected names of nodes, for example [\"encoder\"]");
      break;
    case InvariantKind::value: read_value(table, invariant); break;
    case InvariantKind::frames: invariant.filter = read_filter(table, "filter", true); break;
    case InvariantKind::event:
      invariant.event = table.text("event", true).value_or("");
      if (!invariant.event.empty() && std::ranges::count(plant::event_names, invariant.event) == 0)
        table.error("event", expected_one_of(plant::event_names));
      invariant.text = table.text("text").value_or("");
      break;
    case InvariantKind::reaction:
      invariant.filter = read_filter(table, "from", true);
      invariant.answer = read_filter(table, "to", true);
      read_within();
      break;
    case InvariantKind::python:
      invariant.file = table.text("file", true).value_or("");
      invariant.function = table.text("function", true).value_or("");
      if (!invariant.function.empty() && !is_name(invariant.function))
        table.error("function", "expected the name of a function in the file: letters, digits and _");
      invariant.has_filter = has(table, "filter");
      invariant.filter = read_filter(table, "filter", false);
      break;
  }
  return invariant;
}

template <typename Part>
void check_names(const std::vector<Part>& parts, std::size_t most, std::string_view what,
                 std::vector<text::FileError>& errors) {
  std::set<std::string_view> names;
  for (const Part& part : parts) {
    if (!names.insert(part.name).second && !part.name.empty())
      errors.push_back(
          {part.place, fmt::format("{}: there is another one of the name \"{}\"", what, part.name)});
  }
  if (parts.size() > most)
    errors.push_back({parts[most].place, fmt::format("{}: at most {} are possible", what, most)});
}

void read_campaign_table(TableReader& table, CampaignFile& campaign, std::string& plant) {
  campaign.name = table.text("name").value_or("campaign");
  plant = table.text("plant").value_or("");
  campaign.duration = read_duration(table, "duration", std::chrono::seconds(10), std::chrono::milliseconds(1),
                                    longest_run, true);
  campaign.sample_interval = read_duration(table, "sample_interval", campaign.sample_interval,
                                           std::chrono::microseconds(100), std::chrono::seconds(10));
  const auto seeds = table.integer("seeds", 1, most_seeds, "expected 1 to 10000000");
  if (seeds) campaign.seeds = static_cast<std::uint64_t>(*seeds);
  const auto first =
      table.integer("first_seed", 0, INT64_MAX - static_cast<std::int64_t>(most_seeds), "expected 0 or more");
  if (first) campaign.first_seed = static_cast<std::uint64_t>(*first);
}

}  // namespace

text::Place place_of_key_in(std::string_view message, const KeyPlaces& places, text::Place otherwise) {
  constexpr std::string_view unknown = "unknown key ";
  if (const std::size_t at = message.find(unknown); at != std::string_view::npos)
    message.remove_prefix(at + unknown.size());
  std::string_view key = message.substr(0, message.find_first_of(" :;"));
  if (const std::size_t dot = key.rfind('.'); dot != std::string_view::npos)
    key.remove_prefix(dot + 1);  // "bus.fault: ..."
  const auto place = places.find(key);
  return place == places.end() ? otherwise : place->second;
}

std::string_view key_of(RuleKind kind) noexcept {
  return std::ranges::find(rule_names, kind, &RuleName::kind)->key;
}

const Rule* CampaignFile::canary_of(std::uint64_t seed) const noexcept {
  std::uint64_t number = first_seed;
  for (const Rule& rule : rules) {
    if (rule.is_canary && number++ == seed) return &rule;
  }
  return nullptr;
}

CampaignReading read_campaign(std::string_view text, std::string path) {
  CampaignReading reading;
  CampaignFile& campaign = reading.campaign;
  campaign.path = std::move(path);
  const auto root = text::parse_toml(text);
  if (!root) {
    reading.errors.push_back(root.error());
    return reading;
  }
  TableReader table(*root, "campaign file", reading.errors);
  std::string plant;
  if (root->get("campaign") == nullptr) table.error({1, 1}, "expected [campaign]");
  table.table("campaign", "campaign", "expected a table, written as [campaign]",
              [&](TableReader& inner) { read_campaign_table(inner, campaign, plant); });
  table.tables("variant", "variant",
               [&](TableReader& inner) { campaign.variants.push_back(read_variant(inner, plant)); });
  table.tables("rule", "rule", [&](TableReader& inner) { campaign.rules.push_back(read_rule(inner)); });
  table.tables("invariant", "invariant",
               [&](TableReader& inner) { campaign.invariants.push_back(read_invariant(inner)); });
  table.finish();
  if (campaign.variants.empty()) {
    if (plant.empty() && reading.errors.empty())
      reading.errors.push_back({{1, 1}, "campaign: plant is missing; expected the path of a plant file"});
    campaign.variants.push_back({.name = "plant", .plant = plant});
  }
  if (campaign.invariants.empty())
    reading.errors.push_back({{1, 1}, "expected one [[invariant]] at least: what must hold in every run"});
  check_names(campaign.variants, most_variants, "variant", reading.errors);
  check_names(campaign.rules, most_rules, "rule", reading.errors);
  check_names(campaign.invariants, most_invariants, "invariant", reading.errors);
  const auto canaries = std::ranges::count_if(campaign.rules, &Rule::is_canary);
  if (static_cast<std::uint64_t>(canaries) > campaign.seeds)
    reading.errors.push_back({{1, 1}, "seeds: each canary needs a seed of its own"});
  return reading;
}

}  // namespace canopus::campaign
