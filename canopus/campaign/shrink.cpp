#include "canopus/campaign/shrink.hpp"

#include <algorithm>
#include <utility>

namespace canopus::campaign {
namespace {

class Shrinking {
 public:
  Shrinking(const Campaign& campaign, std::string fingerprint, const std::function<bool()>& is_over)
      : campaign_(campaign), fingerprint_(std::move(fingerprint)), is_over_(is_over) {}

  std::optional<ShrunkFailure> carry_out(const RunPlan& plan) {
    if (!accepts(plan)) return std::nullopt;
    shorten();
    make_certain();
    choose_few_rules();
    remove_one_by_one();
    remove_devices();
    shorten();
    if (was_ended_) return std::nullopt;  // what came out would depend on the moment
    best_.runs = runs_;
    return std::move(best_);
  }

 private:
  /// Runs the plan; if it shows the failure, it is the best one so far.
  bool accepts(RunPlan plan) {
    was_ended_ = was_ended_ || is_over_();
    if (was_ended_ || runs_ >= most_shrinking_runs) return false;
    ++runs_;
    const auto result = run(campaign_, plan, fingerprint_);
    if (!result) return false;
    const auto found = std::ranges::find(result->failures, fingerprint_, &InvariantFailure::fingerprint);
    if (found == result->failures.end()) return false;
    best_.plan = std::move(plan);
    best_.failure = *found;
    return true;
  }
  /// The run ends with the sample in which the failure is found.
  void shorten() {
    RunPlan plan = best_.plan;
    const can::Duration interval = campaign_.file.sample_interval;
    const can::Duration at = best_.failure.at.time_since_epoch();
    plan.duration =
        std::min(plan.duration, (at + interval - can::Duration{1}) / interval * interval + interval);
    if (plan.duration < best_.plan.duration) (void)accepts(std::move(plan));
  }
  /// Faults by chance hit other frames as soon as another rule is gone. What always happens does not.
  void make_certain() {
    for (std::size_t i = 0; i < best_.plan.rules.size(); ++i) {
      if (!best_.plan.rules[i].values.contains("probability")) continue;
      std::vector<ChosenRule> rules = best_.plan.rules;
      const std::string name = std::string(key_of(rules[i].rule->kind)) + ".probability";
      rules[i].values.insert_or_assign("probability", 1.0);
      std::erase_if(rules[i].knobs, [&](const Knob& knob) { return knob.name == name; });
      rules[i].knobs.push_back({name, "1"});
      (void)accepts(with_rules(std::move(rules)));
    }
  }
  RunPlan with_rules(std::vector<ChosenRule> rules) const {
    RunPlan plan = best_.plan;
    plan.rules = std::move(rules);
    return plan;
  }
  /// No rule, one of them, or two: what most failures need.
  void choose_few_rules() {
    const std::vector<ChosenRule> all = best_.plan.rules;
    if (all.empty() || accepts(with_rules({}))) return;
    for (const ChosenRule& rule : all) {
      if (all.size() > 1 && accepts(with_rules({rule}))) return;
    }
    constexpr std::size_t few = 12;  // 66 pairs
    for (std::size_t i = 0; i < all.size() && all.size() > 2 && all.size() <= few; ++i) {
      for (std::size_t j = i + 1; j < all.size(); ++j) {
        if (accepts(with_rules({all[i], all[j]}))) return;
      }
    }
  }
  /// Until none is left that is not needed. In large halves first, if there are many.
  void remove_one_by_one() {
    if (best_.plan.rules.size() <= 2) return;
    for (std::size_t size = best_.plan.rules.size() / 2; size > 0; size /= 2) {
      for (std::size_t first = 0; first < best_.plan.rules.size();) {
        std::vector<ChosenRule> rules = best_.plan.rules;
        const auto begin = rules.begin() + static_cast<std::ptrdiff_t>(first);
        rules.erase(begin, begin + static_cast<std::ptrdiff_t>(std::min(size, rules.size() - first)));
        if (!accepts(with_rules(std::move(rules)))) first += size;
      }
    }
  }
  void remove_devices() {
    for (const std::string& name : campaign_.plants[best_.plan.variant].device_names()) {
      RunPlan plan = best_.plan;
      plan.without_devices.push_back(name);
      (void)accepts(std::move(plan));
    }
  }

  const Campaign& campaign_;
  std::string fingerprint_;
  const std::function<bool()>& is_over_;
  bool was_ended_ = false;
  std::size_t runs_ = 0;
  ShrunkFailure best_;
};

}  // namespace

std::optional<ShrunkFailure> shrink(const Campaign& campaign, const RunPlan& plan,
                                    const std::string& fingerprint, const std::function<bool()>& is_over) {
  return Shrinking(campaign, fingerprint, is_over).carry_out(plan);
}

}  // namespace canopus::campaign
