#pragma once
// The campaign file: a plant in variants, rules that disturb it, and invariants that must hold, in TOML. docs/campaign.md is the
// reference for people. Reading it finds every mistake at once and opens no other file.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/text/file_error.hpp"
#include "canopus/text/toml.hpp"
#include "canopus/trace/filter/filter_expression.hpp"

namespace canopus::campaign {

/// What a campaign may have at most: a run looks at every invariant, and a report at every rule.
inline constexpr std::size_t most_rules = 256;
inline constexpr std::size_t most_invariants = 256;
inline constexpr std::size_t most_variants = 64;
inline constexpr std::uint64_t most_seeds = 10'000'000;
inline constexpr can::Duration longest_run = std::chrono::hours(24);

/// Where the keys of a table stand, and those of the tables in it.
using KeyPlaces = std::map<std::string, text::Place, std::less<>>;
/// The place of the key that a message is about ("device = ...", "word: ...", "unknown key rate"), or else the other one.
[[nodiscard]] text::Place place_of_key_in(std::string_view message, const KeyPlaces& places,
                                          text::Place otherwise);

/// What a rule or a variant is about, by name; what is empty is not meant.
struct Target {
  std::string bus{};
  std::string device{};
  std::string plc{};
  std::string module{};
};

/// Keys that replace those of a table of the plant file.
struct Change {
  text::Place place{};
  Target target{};
  toml::table set{};
};

/// A plant of the campaign: every seed runs each of them.
struct Variant {
  text::Place place{};
  std::string name{};
  std::string plant{};                 ///< path, relative to the campaign file
  std::vector<std::string> program{};  ///< in place of that of the plant's PLC; paths as above
  std::string plc{};                   ///< which PLC has it; empty: the plant has one
  std::vector<Change> changes{};
};

enum class RuleKind : std::uint8_t {
  fault,      ///< adds a [[bus.fault]]
  set,        ///< keys of a device, module, PLC or bus
  script,     ///< adds a [[device.script]]
  power_cut,  ///< of a device or a PLC
  cpu_stop,   ///< of a PLC
  write,      ///< a word or a variable of a PLC, by its operator
};

/// A disturbance that a seed may choose. `values` may hold knobs: { low, high } or { choose }.
struct Rule {
  text::Place place{};
  KeyPlaces places{};
  std::string name{};
  RuleKind kind = RuleKind::fault;
  double chance = 0.5;  ///< 0..1, that a seed has it
  bool is_canary = false;
  Target target{};
  toml::table values{};
};

enum class InvariantKind : std::uint8_t {
  operational,  ///< no node is out of operation for longer than `within`
  value,        ///< of an object, a word or a variable
  frames,       ///< which match `filter`
  event,        ///< lines of `canopus run --json`
  reaction,     ///< a frame `to` within a time after a frame `from`
  python,       ///< a function in Python that gets the events of the run
};

enum class Expectation : std::uint8_t {
  always,
  never,
  sometimes  ///< in one run at least; never reached: a hole of the campaign
};

struct Invariant {
  text::Place place{};
  KeyPlaces places{};
  std::string name{};
  InvariantKind kind = InvariantKind::operational;
  Expectation expectation = Expectation::always;
  can::Duration after{};                   ///< it counts from this plant time on
  std::vector<std::string> nodes{};        ///< operational: names; empty: all
  std::optional<can::Duration> within{};   ///< operational, reaction
  Target target{};                         ///< value
  std::string object{};                    ///< of the device
  std::string word{};                      ///< of the PLC: "D100", "U0\G10000"
  std::string variable{};                  ///< of the PLC's program
  std::optional<double> low{};             ///< value
  std::optional<double> high{};            ///< value
  std::optional<can::Duration> changes{};  ///< value: it changes within this time
  trace::FilterExpression filter{};        ///< frames; reaction: from; python: messages that it gets
  bool has_filter = false;                 ///< python
  trace::FilterExpression answer{};        ///< reaction: to
  std::string event{};                     ///< "error", "lift"; docs/events.md
  std::string text{};                      ///< that the line has
  std::string file{};                      ///< python: path, relative to the campaign file
  std::string function{};                  ///< its name
};

struct CampaignFile {
  std::string path{};
  std::string name{};
  std::uint64_t first_seed = 1;
  std::uint64_t seeds = 100;
  can::Duration duration{};
  can::Duration sample_interval =
      std::chrono::milliseconds(10);  ///< how often states and values are looked at
  std::vector<Variant> variants{};    ///< one at least
  std::vector<Rule> rules{};
  std::vector<Invariant> invariants{};

  /// Canaries have a seed each, the first ones; it runs without any other rule. Null: another seed.
  [[nodiscard]] const Rule* canary_of(std::uint64_t seed) const noexcept;
};

struct CampaignReading {
  CampaignFile campaign{};  ///< what could be read; with errors not to be used
  std::vector<text::FileError> errors{};
};
[[nodiscard]] CampaignReading read_campaign(std::string_view text, std::string path);

/// "fault", "power_cut": the key of the rule's table.
[[nodiscard]] std::string_view key_of(RuleKind kind) noexcept;

}  // namespace canopus::campaign
