#include "canopus/sim/bus/controller/bit_timing.hpp"

#include <algorithm>

namespace canopus::sim {

std::string_view problem(const BitTiming& timing) noexcept {
  if (timing.propagation < 1 || timing.propagation > 8) return "PROP is 1 to 8 quanta";
  if (timing.phase1 < 1 || timing.phase1 > 8) return "PHASE1 is 1 to 8 quanta";
  if (timing.phase2 < 2 || timing.phase2 > 8) return "PHASE2 is 2 to 8 quanta";
  if (timing.jump_width < 1 || timing.jump_width > 4) return "SJW is 1 to 4 quanta";
  if (timing.jump_width > std::min(timing.phase1, timing.phase2)) return "SJW is not above PHASE1 or PHASE2";
  if (timing.quanta() < 8) return "a bit has 8 to 25 quanta";
  return {};
}

unsigned clock_tolerance(const BitTiming& timing) noexcept {
  if (!problem(timing).empty()) return 0;
  const unsigned million = 1'000'000;
  const unsigned edges = timing.jump_width * million / (20 * timing.quanta());
  const unsigned flag =
      std::min(timing.phase1, timing.phase2) * million / (2 * (13 * timing.quanta() - timing.phase2));
  return std::min(edges, flag);
}

void BitClock::begin_bit() noexcept {
  quantum_ = 0;
  sample_ = timing_.sample_point();
  end_ = timing_.quanta();
}

bool BitClock::begin_quantum() noexcept {
  if (++quantum_ < end_) return false;
  begin_bit();
  return true;
}

void BitClock::skip(unsigned quanta) noexcept {
  quantum_ += quanta;
  for (unsigned quantum = 0; quantum < std::min(quanta, 3U); ++quantum)
    seen_ = (seen_ << 1 | (seen_ & 1U)) & 7U;
}

void BitClock::skip_to_next_bit() noexcept {
  skip(to_end());
  begin_bit();
}

BitClock::Quantum BitClock::monitor(bool dominant, bool hard, bool driving) noexcept {
  const bool edge = dominant && (seen_ & 1U) == 0;
  seen_ = (seen_ << 1 | (dominant ? 1U : 0U)) & 7U;
  Quantum quantum;
  if (quantum_ == sample_) {
    const bool majority = seen_ == 3 || seen_ >= 5;
    quantum.samples = true;
    quantum.dominant = sampled_ = timing_.triple_sampling ? majority : dominant;
    synchronised_ = false;
  }
  if (edge && !sampled_ && !synchronised_) {
    synchronised_ = true;
    quantum.begins = synchronise(hard, driving);
  }
  return quantum;
}

bool BitClock::synchronise(bool hard, bool driving) noexcept {
  if (quantum_ == 0) return false;  // in SYNC: no phase error
  if (hard) {
    begin_bit();
    return true;
  }
  if (quantum_ < sample_) {  // late
    if (driving) return false;
    const unsigned longer = std::min(quantum_, timing_.jump_width);
    sample_ += longer;
    end_ += longer;
    return false;
  }
  if (end_ - quantum_ > timing_.jump_width) {  // early
    end_ -= timing_.jump_width;
    return false;
  }
  begin_bit();
  return true;
}

}  // namespace canopus::sim
