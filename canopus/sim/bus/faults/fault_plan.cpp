#include "canopus/sim/bus/faults/fault_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/controller/bit_stream.hpp"
#include "canopus/sim/bus/faults/termination.hpp"

namespace canopus::sim {
namespace {

const char* name_of(FaultKind kind) {
  switch (kind) {
    case FaultKind::drop: return "drop";
    case FaultKind::corrupt: return "corrupt";
    case FaultKind::duplicate: return "duplicate";
    case FaultKind::delay: return "delay";
    case FaultKind::babble: return "babble";
    case FaultKind::stuck_dominant: return "stuck dominant";
    case FaultKind::jam: return "jam";
    case FaultKind::cut: return "cut";
    case FaultKind::drive: return "drive";
    case FaultKind::stuck_recessive: return "stuck recessive";
    case FaultKind::late: return "late";
    case FaultKind::noise: return "noise";
    case FaultKind::overload: return "overload";
    case FaultKind::single_shot: return "single-shot";
    case FaultKind::early: return "early";
    case FaultKind::termination: return "termination";
  }
  return "?";
}

/// A fault that is there for some time, and not one of single frames.
bool is_timed(FaultKind kind) {
  switch (kind) {
    case FaultKind::drop:
    case FaultKind::corrupt:
    case FaultKind::duplicate:
    case FaultKind::delay:
    case FaultKind::drive: return false;
    default: return true;
  }
}

can::Duration with_times_of(const Fault& fault, can::Duration grid) {
  if (fault.kind == FaultKind::termination) return can::Duration(1);  // its time comes of voltages
  const can::Duration until = fault.until == can::never ? can::Duration{} : fault.until.time_since_epoch();
  for (const can::Duration one :
       {fault.from.time_since_epoch(), until, fault.delay, fault.interval, fault.bit_time}) {
    grid = can::Duration(std::gcd(grid.count(), one.count()));
  }
  return grid;
}

/// What is wrong with the numbers of a fault that is_timed(); empty: nothing.
std::string wrong_timed_value(const Fault& fault) {
  const bool has_ports = fault.kind != FaultKind::noise && fault.kind != FaultKind::termination;
  if (has_ports && fault.ports.empty()) return "it names no port";
  switch (fault.kind) {
    case FaultKind::babble:
      if (fault.interval < can::Duration{}) return "interval is negative";
      if (fault.frame.identifier >
          (fault.frame.extended ? can::max_extended_identifier : can::max_base_identifier)) {
        return "identifier is above " + std::string(fault.frame.extended ? "1FFFFFFFH" : "7FFH");
      }
      return {};
    case FaultKind::late: return fault.delay > can::Duration{} ? "" : "delay is not longer than 0";
    case FaultKind::noise:
      return fault.bit_error_rate > 0 && fault.bit_error_rate <= 1 ? ""
                                                                   : "bit_error_rate is not above 0, up to 1";
    case FaultKind::overload:
      return fault.overload_frames == 1 || fault.overload_frames == 2 ? "" : "overload_frames is not 1 or 2";
    case FaultKind::early:
      return fault.early_bits >= 1 && fault.early_bits <= max_early_bits ? "" : "early_bits are not 1 to 10";
    case FaultKind::termination:
      if (fault.resistors > max_resistors) return "resistors are not 0 to 20";
      return fault.length >= 0 && fault.length <= max_line_length ? "" : "length is not 0 to 10000 m";
    default: return {};
  }
}

/// What is wrong with the numbers of the fault; empty: nothing.
std::string wrong_value(const Fault& fault) {
  if (fault.until < fault.from) return "until is before from";
  if (is_timed(fault.kind)) return wrong_timed_value(fault);
  if (fault.first == 0) return "first = 0: frames are numbered from 1";
  if (fault.every == 0) return "every = 0: 1 means every frame";
  if (!(fault.probability >= 0 && fault.probability <= 1)) return "probability is not 0 to 1";
  if (fault.kind == FaultKind::delay && fault.delay <= can::Duration{}) return "delay is not longer than 0";
  if (fault.bit && *fault.bit >= BitStream::max_bits) return "bit is not 0 to 159";
  if (fault.kind == FaultKind::drive) {
    if (fault.levels.empty() || fault.levels.size() > max_driven_levels) return "levels are not 1 to 100000";
    if (fault.bit_time < can::Duration{}) return "bit_time is negative";
    if (fault.field &&
        (*fault.field == can::FrameField::idle || *fault.field > can::FrameField::intermission))
      return "field is none of a frame";
  }
  return {};
}

}  // namespace

std::expected<FaultPlan, std::string> FaultPlan::make(const std::vector<Fault>& faults, std::uint64_t seed,
                                                      const Target& target) {
  FaultPlan plan;
  plan.random_.seed(seed);
  plan.count_ = faults.size();
  for (std::size_t number = 0; number < faults.size(); ++number) {
    const Fault& fault = faults[number];
    const std::string where = "fault " + std::to_string(number + 1) + " (" + name_of(fault.kind) + "): ";
    if (const std::string wrong = wrong_value(fault); !wrong.empty()) return std::unexpected(where + wrong);
    plan.time_grid_ = with_times_of(fault, plan.time_grid_);
    const auto unknown = [&](const std::string& name) {
      return std::unexpected(where + "no port \"" + name + "\" on bus \"" + std::string(target.bus_name) +
                             "\"");
    };
    if (is_timed(fault.kind)) {
      if (fault.kind == FaultKind::late && fault.delay >= target.bit) {
        return std::unexpected(where + "delay is not shorter than a bit");
      }
      TimedFault timed{.fault = fault, .ports = {}, .number = number};
      for (const std::string& name : fault.ports) {
        timed.ports.push_back(target.port_named(name));
        if (timed.ports.back() == nullptr) return unknown(name);
      }
      plan.add(std::move(timed));
      continue;
    }
    Rule rule{.fault = fault, .number = number};
    if (!fault.sender.empty() && (rule.sender = target.port_named(fault.sender)) == nullptr) {
      return unknown(fault.sender);
    }
    if (!fault.receiver.empty() && (rule.receiver = target.port_named(fault.receiver)) == nullptr) {
      return unknown(fault.receiver);
    }
    if (fault.kind == FaultKind::drive && !fault.bit && !fault.field) {
      plan.driver_.add(fault.from, fault.bit_time > can::Duration{} ? fault.bit_time : target.bit,
                       fault.levels);
      continue;
    }
    (fault.kind == FaultKind::delay ? plan.delays_ : plan.frames_).push_back(std::move(rule));
  }
  return plan;
}

/// Noise of several ports is one of each.
void FaultPlan::add(TimedFault fault) {
  if (fault.fault.kind != FaultKind::noise || fault.ports.empty()) {
    if (fault.fault.kind == FaultKind::noise) fault.random.seed(random_());
    return timed_faults_.push_back(std::move(fault));
  }
  for (BusPort* port : fault.ports) {
    timed_faults_.push_back({.fault = fault.fault, .ports = {port}, .number = fault.number});
    timed_faults_.back().random.seed(random_());
  }
}

std::uint64_t FaultPlan::TimedFault::bits_to_next_hit() {
  const double chance = std::ldexp(static_cast<double>((random() >> 11) + 1), -53);  // above 0, up to 1
  const double bits =
      fault.bit_error_rate >= 1 ? 0 : std::floor(std::log(chance) / std::log1p(-fault.bit_error_rate));
  constexpr double most = 1e12;
  return static_cast<std::uint64_t>(std::min(bits, most));
}

bool FaultPlan::hits(Rule& rule, const BusPort& sender, const can::Frame& frame, can::Time now) {
  const Fault& fault = rule.fault;
  if (now < fault.from || now >= fault.until) return false;
  if (rule.sender != nullptr && rule.sender != &sender) return false;
  if (fault.identifier && (*fault.identifier != frame.identifier || fault.extended != frame.extended)) {
    return false;
  }
  const std::uint64_t number = ++rule.seen;
  if (number < fault.first || (number - fault.first) % fault.every != 0 || rule.hit >= fault.count)
    return false;
  if (fault.probability < 1.0 && std::ldexp(static_cast<double>(random_() >> 11), -53) >= fault.probability) {
    return false;
  }
  ++rule.hit;
  return true;
}

FrameFaults FaultPlan::on_frame(const BusPort& sender, can::Duration bit, const can::Frame& frame,
                                can::Time now) {
  FrameFaults faults;
  for (Rule& rule : frames_) {
    if (rule.fault.kind == FaultKind::drive) {
      drive(rule, sender, bit, frame, now);
      continue;
    }
    if (!hits(rule, sender, frame, now)) continue;
    if (rule.fault.kind == FaultKind::drop) {
      if (rule.receiver == nullptr) {
        faults.drop_everywhere = true;
      } else {
        faults.drop_at = rule.receiver;
      }
      continue;
    }
    if (faults.corruptions == FrameFaults::max_corruptions) continue;
    const unsigned bits = can::frame_bits(frame);
    FrameFaults::Corruption& corruption = faults.corruption[faults.corruptions++];
    if (rule.fault.kind == FaultKind::duplicate) {
      corruption = {.bit = bits - 1, .at = nullptr};
    } else {
      corruption = {.bit = rule.fault.bit ? *rule.fault.bit : static_cast<unsigned>(random_() % bits),
                    .at = rule.receiver};
    }
  }
  return faults;
}

void FaultPlan::drive(Rule& rule, const BusPort& sender, can::Duration bit, const can::Frame& frame,
                      can::Time now) {
  const Fault& fault = rule.fault;
  const auto begin = field_begin(frame, fault.field.value_or(can::FrameField::start_of_frame));
  if (!begin || !hits(rule, sender, frame, now)) return;
  driver_.add(now + bit * static_cast<std::int64_t>(*begin + fault.bit.value_or(0)),
              fault.bit_time > can::Duration{} ? fault.bit_time : bit, fault.levels);
}

can::Duration FaultPlan::on_send(const BusPort& sender, const can::Frame& frame, can::Time now) {
  for (Rule& rule : delays_) {
    if (hits(rule, sender, frame, now)) return rule.fault.delay;
  }
  return {};
}

bool FaultPlan::end_rules(std::size_t number, can::Time now) noexcept {
  bool is_ended = false;
  for (auto* rules : {&frames_, &delays_}) {
    for (Rule& rule : *rules) {
      if (rule.number != number) continue;
      rule.fault.until = std::min(rule.fault.until, now);
      is_ended = true;
    }
  }
  return is_ended;
}

std::vector<FaultState> FaultPlan::states() const {
  std::vector<FaultState> states(count_);
  for (const auto* rules : {&frames_, &delays_}) {
    for (const Rule& rule : *rules) states[rule.number].hits += rule.hit;
  }
  for (const TimedFault& timed : timed_faults_) states[timed.number].is_active |= timed.active;
  return states;
}

can::Time FaultPlan::TimedFault::next() const noexcept {
  if (!active) return fault.from;
  return std::min(fault.until, next_act);
}

can::Time FaultPlan::next_change() const noexcept {
  can::Time next = can::never;
  for (const TimedFault& timed : timed_faults_) next = std::min(next, timed.next());
  return next;
}

}  // namespace canopus::sim
