#pragma once
// Bit timing of one CAN controller, quantum by quantum [ISO 11898-1 bit timing and synchronisation].
//
//   SYNC | PROP | PHASE1 ^ PHASE2 |       ^ sample point
//
// The controller monitors the wire once a quantum. An edge is seen in the first quantum that has the new level, so it
// may be late by up to one quantum: that is what the SYNC segment of one quantum is for.

#include <string_view>

namespace canopus::sim {

/// Lengths in time quanta.
struct BitTiming {
  unsigned propagation = 8;      ///< PROP, 1 to 8
  unsigned phase1 = 5;           ///< PHASE1, 1 to 8
  unsigned phase2 = 2;           ///< PHASE2, 2 to 8
  unsigned jump_width = 2;       ///< SJW, 1 to 4, not above a phase segment
  bool triple_sampling = false;  ///< the majority of the sample point and the two quanta before it

  /// Of one bit, SYNC included: 8 to 25.
  [[nodiscard]] constexpr unsigned quanta() const noexcept { return 1 + propagation + phase1 + phase2; }
  /// From the start of the bit to the sample point.
  [[nodiscard]] constexpr unsigned sample_point() const noexcept { return 1 + propagation + phase1; }
};

/// What ISO 11898-1 does not allow in it: "PHASE2 is 2 to 8 quanta"; empty: nothing.
[[nodiscard]] std::string_view problem(const BitTiming& timing) noexcept;

/// How far from its nominal rate a clock may be when another is as far off on the other side, in ppm, rounded down
/// [ISO 11898-1]: the smaller of SJW / (20 bits), for ten bits between two edges, and
/// min(PHASE1, PHASE2) / (2 (13 bits - PHASE2)), for an error flag. The quantum by which an edge is seen late is not
/// counted: it matters where PHASE2 decides. 0 for a timing that has a problem().
[[nodiscard]] unsigned clock_tolerance(const BitTiming& timing) noexcept;

/// Where in its bit a controller is. begin_quantum(), then monitor(), once a quantum.
class BitClock {
 public:
  /// What a quantum is to the bit.
  struct Quantum {
    bool begins = false;    ///< synchronised: a bit begins with this quantum
    bool samples = false;   ///< the sample point
    bool dominant = false;  ///< what was sampled
  };

  /// `timing` must have no problem(). The first quantum is the SYNC segment of a bit; the wire was recessive.
  explicit BitClock(const BitTiming& timing) noexcept
      : timing_(timing), sample_(timing.sample_point()), end_(timing.quanta()), quantum_(end_ - 1) {}

  /// True: a bit begins with this quantum.
  bool begin_quantum() noexcept;
  /// The level at the start of the quantum. `hard`: an edge restarts the bit. `driving`: the controller drives the
  /// bit dominant, so late edges are taken for its own.
  Quantum monitor(bool dominant, bool hard, bool driving) noexcept;

  /// So many quanta pass, before the next sample point and the end of the bit, and the level stays as it was last seen.
  void skip(unsigned quanta) noexcept;
  /// The quanta to the next bit pass, and its first one, behind the sample point. The level stays as it was last seen.
  void skip_to_next_bit() noexcept;
  /// Quanta from the present one to the next sample point of this bit, to the next bit, and to the sample point of that.
  [[nodiscard]] unsigned to_sample_point() const noexcept { return sample_ - quantum_; }
  [[nodiscard]] unsigned to_end() const noexcept { return end_ - quantum_; }
  [[nodiscard]] unsigned to_next_sample_point() const noexcept { return to_end() + timing_.sample_point(); }

  /// From the start of the bit, 0 is SYNC.
  [[nodiscard]] unsigned quantum() const noexcept { return quantum_; }

 private:
  void begin_bit() noexcept;
  /// True: the bit begins anew with this quantum.
  bool synchronise(bool hard, bool driving) noexcept;

  BitTiming timing_;
  unsigned sample_;  // the present bit's, as synchronisation has moved it
  unsigned end_;     // likewise
  unsigned quantum_;
  unsigned seen_ = 0;  // the last three levels, the newest in bit 0; set: dominant
  bool sampled_ = false;
  bool synchronised_ = false;  // since the last sample point
};

}  // namespace canopus::sim
