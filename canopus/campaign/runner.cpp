#include "canopus/campaign/runner.hpp"

#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "canopus/campaign/plant_run.hpp"

namespace canopus::campaign {
namespace {

class Runner {
 public:
  Runner(const Campaign& campaign, Results& results, const RunnerUse& use)
      : campaign_(campaign),
        results_(results),
        use_(use),
        end_(campaign.file.seeds * campaign.file.variants.size()) {
    next_ = use.shard.number - 1;
    progress_.all = next_ < end_ ? (end_ - next_ - 1) / use.shard.count + 1 : 0;
    progress_.done = results.done();
    progress_.failed = results.failed();
  }

  std::expected<Progress, std::string> carry_out() {
    {
      std::vector<std::jthread> threads;
      for (std::size_t i = 1; i < use_.jobs; ++i) threads.emplace_back([this] { work(); });
      work();
    }
    if (exception_) std::rethrow_exception(exception_);
    if (!error_.empty()) return std::unexpected(error_);
    return progress_;
  }

 private:
  void work() {
    try {
      while (const auto number = take()) {
        const std::size_t variants = campaign_.file.variants.size();
        const RunPlan plan =
            plan_of(campaign_, *number % variants, campaign_.file.first_seed + *number / variants);
        const RunResult result = run_or_fail(campaign_, plan);
        add(*number, to_json(campaign_.file, result, plan.rules).dump(), !result.failures.empty());
      }
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      if (!exception_) exception_ = std::current_exception();
      is_over_ = true;
    }
  }
  /// The next run that is not done yet.
  std::optional<std::uint64_t> take() {
    const std::scoped_lock lock(mutex_);
    while (next_ < end_ && results_.has(next_)) next_ += use_.shard.count;
    if (!is_over_ && use_.is_over && use_.is_over(progress_)) is_over_ = true;
    if (is_over_ || next_ >= end_) return std::nullopt;
    return std::exchange(next_, next_ + use_.shard.count);
  }
  void add(std::uint64_t number, const std::string& line, bool has_failed) {
    const std::scoped_lock lock(mutex_);
    if (const auto added = results_.add(number, line); !added) {
      error_ = added.error();
      is_over_ = true;
      return;
    }
    ++progress_.done;
    ++progress_.ran;
    if (has_failed) ++progress_.failed;
  }

  const Campaign& campaign_;
  Results& results_;
  const RunnerUse& use_;
  std::mutex mutex_;
  std::uint64_t next_ = 0;
  std::uint64_t end_;
  bool is_over_ = false;
  Progress progress_;
  std::string error_;
  std::exception_ptr exception_;
};

}  // namespace

std::expected<Progress, std::string> run_all(const Campaign& campaign, Results& results,
                                             const RunnerUse& use) {
  return Runner(campaign, results, use).carry_out();
}

}  // namespace canopus::campaign
