// Synchronisation of one controller, rule by rule [ISO 11898-1]. A bit is 16 quanta: SYNC 0, sample point 14, end 16;
// the quanta expected are worked out by hand.

#include "canopus/sim/bus/controller/bit_timing.hpp"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::sim::bit_timing_test {
namespace {

struct Wave {
  std::vector<unsigned> begins;   // quanta, from 0
  std::vector<unsigned> samples;  // likewise
  std::vector<bool> levels;
};

struct Pulse {
  unsigned begin;
  unsigned end;
};

/// What a controller makes of dominant pulses within `quanta`.
Wave watch(std::vector<Pulse> pulses, unsigned quanta, BitTiming timing = {}, bool hard = false,
           bool driving = false) {
  BitClock clock(timing);
  Wave wave;
  for (unsigned quantum = 0; quantum < quanta; ++quantum) {
    bool dominant = false;
    for (const Pulse& pulse : pulses) dominant = dominant || (quantum >= pulse.begin && quantum < pulse.end);
    const bool natural = clock.begin_quantum();
    const BitClock::Quantum seen = clock.monitor(dominant, hard, driving);
    if (natural) wave.begins.push_back(quantum);
    if (seen.begins) wave.begins.push_back(quantum);
    if (!seen.samples) continue;
    wave.samples.push_back(quantum);
    wave.levels.push_back(seen.dominant);
  }
  return wave;
}

using Quanta = std::vector<unsigned>;
using Levels = std::vector<bool>;

TEST(BitClock, WithoutEdges_KeepsItsBits) {
  const Wave wave = watch({}, 48);
  EXPECT_EQ(wave.begins, (Quanta{0, 16, 32}));
  EXPECT_EQ(wave.samples, (Quanta{14, 30, 46}));
}

TEST(BitClock, EdgeInSync_MovesNothing) {
  const Wave wave = watch({{16, 32}}, 48);
  EXPECT_EQ(wave.begins, (Quanta{0, 16, 32}));
  EXPECT_EQ(wave.levels, (Levels{false, true, false}));
}

TEST(BitClock, LateEdgeWithinTheJumpWidth_IsFollowed) {
  const Wave wave = watch({{17, 33}}, 50);
  EXPECT_EQ(wave.begins, (Quanta{0, 16, 33, 49}));
  EXPECT_EQ(wave.samples, (Quanta{14, 31, 47}));
}

TEST(BitClock, LateEdgeBeyondTheJumpWidth_MovesByTheJumpWidth) {
  const Wave wave = watch({{21, 37}}, 50);
  EXPECT_EQ(wave.begins, (Quanta{0, 16, 34}));
  EXPECT_EQ(wave.samples, (Quanta{14, 32, 48}));
}

TEST(BitClock, EarlyEdgeWithinTheJumpWidth_BeginsTheBit) {
  const Wave wave = watch({{15, 31}}, 48);
  EXPECT_EQ(wave.begins, (Quanta{0, 15, 31, 47}));
  EXPECT_EQ(wave.samples, (Quanta{14, 29, 45}));
}

TEST(BitClock, EarlyEdgeBeyondTheJumpWidth_MovesByTheJumpWidth) {
  // PHASE2 6, so the sample point is 10: four quanta early, one is made up for.
  const BitTiming timing{.propagation = 3, .phase1 = 6, .phase2 = 6, .jump_width = 1};
  const Wave wave = watch({{12, 28}}, 42, timing);
  EXPECT_EQ(wave.begins, (Quanta{0, 15, 31}));
  EXPECT_EQ(wave.samples, (Quanta{10, 25, 41}));
}

TEST(BitClock, OfTwoEdgesBetweenSamples_TheFirstCounts) {
  const Wave wave = watch({{17, 18}, {20, 33}}, 50);
  EXPECT_EQ(wave.begins, (Quanta{0, 16, 33, 49}));
  const Wave in_sync = watch({{16, 17}, {20, 33}}, 50);
  EXPECT_EQ(in_sync.begins, (Quanta{0, 16, 32, 48}));
}

TEST(BitClock, EdgeBehindADominantSample_DoesNotCount) {
  const Wave wave = watch({{16, 31}, {34, 48}}, 50);  // bit 2 begins late, behind a dominant bit 1
  EXPECT_EQ(wave.begins, (Quanta{0, 16, 32, 48}));
}

TEST(BitClock, LateEdgeOfOneThatDrivesDominant_IsItsOwn) {
  EXPECT_EQ(watch({{18, 34}}, 48, {}, false, true).begins, (Quanta{0, 16, 32}));
  EXPECT_EQ(watch({{15, 31}}, 40, {}, false, true).begins, (Quanta{0, 15, 31}));  // an early one is not
}

TEST(BitClock, HardSynchronisation_BeginsTheBitWhereverTheEdgeIs) {
  EXPECT_EQ(watch({{23, 39}}, 48, {}, true).begins, (Quanta{0, 16, 23, 39}));
  EXPECT_EQ(watch({{23, 39}}, 48, {}, true).samples, (Quanta{14, 37}));
  EXPECT_EQ(watch({{16, 32}}, 48, {}, true).begins, (Quanta{0, 16, 32}));  // once only
}

TEST(BitClock, TripleSampling_FiltersAGlitchOfOneQuantum) {
  const auto sampled = [](std::vector<Pulse> pulses, bool triple) {  // driving: its late edges move nothing
    return watch(std::move(pulses), 16, {.triple_sampling = triple}, false, true).levels;
  };
  EXPECT_EQ(sampled({{14, 15}}, false), (Levels{true}));
  EXPECT_EQ(sampled({{14, 15}}, true), (Levels{false}));
  EXPECT_EQ(sampled({{13, 15}}, true), (Levels{true}));
  EXPECT_EQ(sampled({{10, 12}}, true), (Levels{false}));
  // Recessive for a quantum at the sample point.
  EXPECT_EQ(sampled({{2, 14}}, false), (Levels{false}));
  EXPECT_EQ(sampled({{2, 14}}, true), (Levels{true}));
}

TEST(BitTiming, WhatTheStandardForbids_IsNamed) {
  EXPECT_EQ(problem({}), "");
  EXPECT_EQ(problem({.propagation = 9}), "PROP is 1 to 8 quanta");
  EXPECT_EQ(problem({.phase1 = 0}), "PHASE1 is 1 to 8 quanta");
  EXPECT_EQ(problem({.phase2 = 1}), "PHASE2 is 2 to 8 quanta");
  EXPECT_EQ(problem({.jump_width = 5}), "SJW is 1 to 4 quanta");
  EXPECT_EQ(problem({.jump_width = 3}), "SJW is not above PHASE1 or PHASE2");
  EXPECT_EQ(problem({.propagation = 1, .phase1 = 2, .phase2 = 2}), "a bit has 8 to 25 quanta");
}

TEST(BitTiming, ClockTolerance_IsTheSmallerOfTheTwoConditions) {
  EXPECT_EQ(clock_tolerance({.jump_width = 1}), 3'125U);  // 1 / (20 * 16)
  EXPECT_EQ(clock_tolerance({.jump_width = 2}), 4'854U);  // 2 / (2 * (13 * 16 - 2))
  EXPECT_EQ(clock_tolerance({.phase2 = 1}), 0U);
}

}  // namespace
}  // namespace canopus::sim::bit_timing_test
