#include "canopus/serve/plant_runs.hpp"

#include <algorithm>
#include <utility>

namespace canopus::serve {

PlantRuns::PlantRuns(plant::Plant& plant, Order order, std::function<void()> over)
    : plant_(plant), order_(order), over_(std::move(over)) {
  plant.timeline().add(*this, "clients that wait");
}

plc::Rack* PlantRuns::rack(const Run& run) const {
  return run.goal.plc ? &plant_.rack(*run.goal.plc) : nullptr;
}

PlantRuns::Number PlantRuns::start(Goal goal, Done done) {
  Run& run = runs_.emplace_back();
  alarm().add_part(run.due);
  run.number = ++last_number_;
  run.goal = std::move(goal);
  run.done = std::move(done);
  begin_next();
  return run.number;
}

void PlantRuns::cancel(Number number) {
  std::erase_if(runs_, [number](const Run& run) { return run.number == number; });
  begin_next();
}

bool PlantRuns::wants_time() const noexcept {
  return std::ranges::any_of(runs_, [](const Run& run) { return run.has_begun && !run.is_over; });
}

void PlantRuns::report() {
  while (true) {
    const auto run = std::ranges::find_if(runs_, &Run::is_over);
    if (run == runs_.end()) break;
    const Done done = std::move(run->done);
    const Outcome outcome = run->outcome;
    runs_.erase(run);
    done(outcome);
  }
  begin_next();
}

void PlantRuns::end_all() {
  for (Run& run : runs_) {
    if (run.is_over) continue;
    run.outcome.plant_ended = true;
    finish(run, plant_.timeline().now());
  }
}

void PlantRuns::begin_next() {
  const can::Time now = plant_.timeline().now();
  for (Run& run : runs_) {
    if (!run.has_begun) begin(run, now);
    if (order_ == Order::in_turn) break;
  }
}

void PlantRuns::begin(Run& run, can::Time now) {
  run.has_begun = true;
  if (const plc::Rack* of = rack(run)) {
    run.scans_before = of->scan().ended(now);
    if (run.goal.scans) run.end = of->scan().end_of(*run.goal.scans, now);
  }
  if (run.goal.duration) run.end = std::min(run.end, can::later(now, *run.goal.duration));
  evaluate(run, now);
}

void PlantRuns::evaluate(Run& run, can::Time now) {
  plc::Rack* const of = rack(run);
  can::Time next = run.end;
  if (run.goal.until && of != nullptr) {
    run.outcome.is_met = run.goal.until->holds(*of, now);
    next = std::min(run.end, of->scan().end_of(1, now));
  }
  run.due = next;
  if (run.outcome.is_met || now >= run.end) finish(run, now);
}

void PlantRuns::finish(Run& run, can::Time now) {
  if (const plc::Rack* of = rack(run); of != nullptr && run.has_begun) {
    const std::uint64_t ended = of->scan().ended(now);
    run.outcome.scans = ended - std::min(ended, run.scans_before);  // fewer after a new start of the CPU
  }
  run.is_over = true;
  run.due = can::never;
  over_();
}

void PlantRuns::tick(can::Time now) {
  for (Run& run : runs_) {
    if (run.has_begun && !run.is_over && run.due <= now) evaluate(run, now);
  }
}

}  // namespace canopus::serve
