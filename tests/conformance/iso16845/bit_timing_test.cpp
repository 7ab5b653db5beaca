// ISO 16845-1 classes 7.7 and 8.7: bit timing. The lower tester drives waves of 40 steps a bit. The IUT samples at 87.5 %, which is
// step 35, and an edge moves its bit by an eighth, 5 steps, at most.
//
// Where the IUT samples is found by a probe: a level of one bit lasts so many steps into the next one, whose true level begins
// only then. What is seen at the sample point is what counts.

#include "conformance/iso16845/lower_tester.hpp"

namespace canopus::sim::iso16845::bit_timing_test {
namespace {

constexpr int steps = 40;
constexpr can::Duration step = can::Duration(LowerTester::bit) / steps;
constexpr int sample_point = 35;
constexpr int jump_width = 5;

/// frame_of_53_bits in steps. In it an edge to dominant begins bit 4, bit 5 is dominant and bit 6 recessive.
class Wave {
 public:
  explicit Wave(const std::string& wire = wire_of_53_bits) {
    for (const char level : wire) bits_.push_back(std::string(steps, level));
  }
  /// Bit 4 and all after it begin later, or earlier.
  Wave& shift(int by) {
    if (by >= 0) {
      bits_[3].append(static_cast<std::size_t>(by), '1');
    } else {
      bits_[3].resize(static_cast<std::size_t>(steps + by));
    }
    return *this;
  }
  /// The bit begins with another level.
  Wave& begin(std::size_t bit, char level, int count) {
    return put(bit, 0, std::string(static_cast<std::size_t>(count), level));
  }
  Wave& put(std::size_t bit, int at, const std::string& levels) {
    bits_[bit].replace(static_cast<std::size_t>(at), levels.size(), levels);
    return *this;
  }
  [[nodiscard]] std::string levels() const {
    std::string all;
    for (const std::string& bit : bits_) all += bit;
    return all;
  }

 private:
  std::vector<std::string> bits_;
};

/// The IUT gets the frame.
bool is_received(const Wave& wave) {
  LowerTester lt;
  lt.run(wave.levels(), {}, 40, step);
  const bool received = lt.iut.frames() == std::vector<Frame>{frame_of_53_bits};
  EXPECT_EQ(received, lt.rec() == 0);
  return received;
}

/// Step of bit 6 at which the IUT samples it.
int sampled_at(const Wave& wave) {
  for (int probe = 1; probe < steps; ++probe) {
    if (!is_received(Wave(wave).begin(6, '0', probe))) return probe - 1;
  }
  return steps;
}

// --- 7.7

TEST(Iso16845_7_7_BitTiming, SamplePoint_TheLevelThereCounts) { EXPECT_EQ(sampled_at(Wave()), sample_point); }

TEST(Iso16845_7_7_BitTiming, HardSynchronisation_OnASofAtAnyMoment) {
  const std::string wave = Wave().levels();
  for (std::size_t late = 0; late < steps; late += 3) {
    LowerTester lt;
    lt.run(std::string(late, '1') + wave, {}, 40, step);
    ASSERT_EQ(lt.iut.heard.size(), 1U);
    EXPECT_EQ(lt.iut.heard[0].at, LowerTester::begin + step * static_cast<int>(late) + 53 * LowerTester::bit);
  }
}

TEST(Iso16845_7_7_BitTiming, HardSynchronisation_OnASofInTheThirdBitOfTheIntermission) {
  for (int early = 6; early < steps; early += 3) {  // before its sample point
    LowerTester lt;
    const std::string intermission(static_cast<std::size_t>(3 * steps - early), '1');
    lt.run(Wave().levels() + intermission + Wave().levels(), {}, 40, step);
    ASSERT_EQ(lt.iut.heard.size(), 2U) << early;
    EXPECT_EQ(lt.iut.heard[1].at - lt.iut.heard[0].at, 56 * LowerTester::bit - step * early);
    EXPECT_EQ(lt.rec(), 0);
  }
}

TEST(Iso16845_7_7_BitTiming, LateEdge_WithinTheJumpWidth_IsFollowed) {
  for (int late = 1; late <= jump_width; ++late) EXPECT_EQ(sampled_at(Wave().shift(late)), sample_point);
}

TEST(Iso16845_7_7_BitTiming, LateEdge_BeyondTheJumpWidth_MovesByTheJumpWidth) {
  for (int late = jump_width + 1; late <= 30; late += 4) {
    EXPECT_EQ(sampled_at(Wave().shift(late)), sample_point - (late - jump_width)) << late;
  }
}

TEST(Iso16845_7_7_BitTiming, EarlyEdge_WithinTheJumpWidth_IsFollowed) {
  for (int early = 1; early < jump_width; ++early) EXPECT_EQ(sampled_at(Wave().shift(-early)), sample_point);
}

TEST(Iso16845_7_7_BitTiming, OfTwoEdgesBetweenSamplePoints_TheFirstCounts) {
  // Bit 4: dominant from step 2 on, recessive from 10 on, dominant again from 20 on.
  const Wave wave = Wave().put(4, 0, "11").put(4, 10, "1111111111");
  EXPECT_EQ(sampled_at(wave), sample_point + 2);
}

TEST(Iso16845_7_7_BitTiming, EdgeBehindADominantSample_DoesNotCount) {
  EXPECT_EQ(sampled_at(Wave().put(4, 36, "11")), sample_point);  // an edge at step 38 of bit 4
}

TEST(Iso16845_7_7_BitTiming, EdgeFromDominantToRecessive_DoesNotCount) {
  EXPECT_EQ(sampled_at(Wave().begin(3, '0', 20)), sample_point);
}

TEST(Iso16845_7_7_BitTiming, GlitchOnAnIdleBus_IsNoFrame) {
  for (const int length : {1, 10, 34}) {  // gone before the sample point
    LowerTester lt;
    lt.run(
        std::string(static_cast<std::size_t>(length), '0') + std::string(steps * 20, '1') + Wave().levels(),
        {}, 40, step);
    EXPECT_THAT(lt.iut.frames(), ElementsAre(frame_of_53_bits)) << length;
    EXPECT_EQ(lt.rec(), 0);
  }
}

// --- 8.7

/// What the IUT finds wrong when it sends frame_of_53_bits and the lower tester drives this; it acknowledges.
struct Sent {
  bool good = false;
  int tec = 0;
  Time end{};
};
Sent sent(const Wave& wave) {
  LowerTester lt;
  lt.run(Wave(wave).begin(44, '0', steps).levels(), {frame_of_53_bits}, 1, step);
  Sent result{.good = !lt.iut.sent.empty(), .tec = lt.tec()};
  if (result.good) result.end = lt.iut.sent[0].at;
  return result;
}
const Wave released(std::string(53, '1'));

/// Step of bit 5, which it sends dominant, at which the IUT samples it.
int sent_sampled_at(const Wave& wave) {
  for (int probe = 1; probe < steps; ++probe) {
    if (!sent(Wave(wave).begin(5, 'R', probe)).good) return probe - 1;
  }
  return steps;
}

TEST(Iso16845_8_7_BitTiming, SamplePoint_ItSeesItsOwnBitThere) {
  EXPECT_TRUE(sent(released).good);
  EXPECT_EQ(sent_sampled_at(released), sample_point);
}

TEST(Iso16845_8_7_BitTiming, LateEdgeOfItsOwn_MovesNothing) {
  for (int late = 1; late < sample_point; late += 3) {
    const Wave wave = Wave(released).begin(4, 'R', late);
    EXPECT_EQ(sent_sampled_at(wave), sample_point) << late;
    EXPECT_EQ(sent(wave).end, LowerTester::begin + 53 * LowerTester::bit) << late;
  }
}

TEST(Iso16845_8_7_BitTiming, EarlyEdgeOfAnother_BeginsItsBit) {
  for (int early = 1; early < jump_width; ++early) {
    const Wave wave = Wave(released).put(3, steps - early, std::string(static_cast<std::size_t>(early), '0'));
    EXPECT_EQ(sent_sampled_at(wave), sample_point - early) << early;  // in steps of the lower tester
    // The acknowledgement, late by as much now, moves it back.
    EXPECT_EQ(sent(wave).end, LowerTester::begin + 53 * LowerTester::bit) << early;
  }
}

TEST(Iso16845_8_7_BitTiming, LateAcknowledgement_IsFollowedByTheJumpWidthAtMost) {
  for (const int late : {1, 3, 5, 8, 20, 34}) {
    LowerTester lt;
    Wave wave = released;
    wave.put(44, late, std::string(static_cast<std::size_t>(steps - late), '0')).begin(45, '0', jump_width);
    lt.run(wave.levels(), {frame_of_53_bits}, 1, step);
    ASSERT_EQ(lt.iut.sent.size(), 1U) << late;
    EXPECT_EQ(lt.iut.sent[0].at,
              LowerTester::begin + 53 * LowerTester::bit + step * std::min(late, jump_width));
  }
}

TEST(Iso16845_8_7_BitTiming, AcknowledgementBehindTheSamplePoint_IsNone) {
  LowerTester lt;
  lt.run(Wave(released).put(44, 36, "0000").levels(), {frame_of_53_bits}, 1, step);
  EXPECT_TRUE(lt.iut.sent.empty());
  EXPECT_EQ(lt.tec(), 8);
}

TEST(Iso16845_8_7_BitTiming, HardSynchronisation_OnASofBeforeItsOwn) {
  // The IUT gets a frame to send within the SOF of another: it goes on by the other's bits, loses, and receives.
  for (const int late : {0, 5, 17, 39}) {
    LowerTester lt;
    lt.iut.send_at(LowerTester::begin + step * late, data_frame(0x7FF));
    lt.run(Wave().levels(), {}, 0, step);
    EXPECT_THAT(lt.iut.frames(), ElementsAre(frame_of_53_bits)) << late;
    EXPECT_EQ(lt.iut.heard[0].at, LowerTester::begin + 53 * LowerTester::bit) << late;
  }
}

}  // namespace
}  // namespace canopus::sim::iso16845::bit_timing_test
