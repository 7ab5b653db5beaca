// Any text as a campaign file: every mistake has a message and a place inside the text, what is read without a mistake is within its
// ranges, and every seed can choose its rules: values without knobs, whatever their tables hold.

#include "canopus/campaign/campaign_file.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "canopus/campaign/chosen_rules.hpp"

#include "input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  using fuzz::expect;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1;
  const campaign::CampaignReading reading = campaign::read_campaign(text, "campaign.toml");
  for (const text::FileError& error : reading.errors) {
    expect(!error.message.empty() && error.place.line <= lines);
    expect(text::describe(error, "campaign.toml").starts_with("campaign.toml:"));
  }
  if (!reading.errors.empty()) return 0;
  const campaign::CampaignFile& file = reading.campaign;
  expect(file.seeds >= 1 && file.seeds <= campaign::most_seeds);
  expect(file.duration > can::Duration{} && file.duration <= campaign::longest_run);
  expect(file.sample_interval > can::Duration{});
  expect(!file.variants.empty() && file.variants.size() <= campaign::most_variants);
  expect(file.rules.size() <= campaign::most_rules);
  expect(!file.invariants.empty() && file.invariants.size() <= campaign::most_invariants);
  for (const campaign::Invariant& invariant : file.invariants) {
    expect(!invariant.name.empty() && invariant.after >= can::Duration{} &&
           invariant.after <= campaign::longest_run);
    expect(!invariant.low || !invariant.high || *invariant.low <= *invariant.high);
  }
  for (std::uint64_t seed = file.first_seed; seed < file.first_seed + 8; ++seed) {
    for (const campaign::ChosenRule& chosen : campaign::choose_rules(file, seed)) {
      expect(chosen.rule != nullptr && chosen.rule->chance >= 0 && chosen.rule->chance <= 1);
      for (const campaign::Knob& knob : chosen.knobs) expect(!knob.name.empty() && !knob.value.empty());
    }
  }
  return 0;
}
