#pragma once
// Faults of a simulated bus, as data: a plant file or a scenario fills a list of them and hands it to
// Bus::set_faults() with a seed. One list and one seed give one run.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/sim/bus/faults/bit_driver.hpp"

namespace canopus::sim {

enum class FaultKind : std::uint8_t {
  drop,             ///< acknowledged on the bus, then lost in the receiving controllers
  corrupt,          ///< one bit on the wire is inverted
  duplicate,        ///< the last bit of EOF is dominant: receivers keep the frame, its transmitter repeats it
  delay,            ///< waits in its controller before it takes part in arbitration
  babble,           ///< a controller sends by itself
  stuck_dominant,   ///< a controller's output is dominant
  jam,              ///< a controller's participant reads nothing from its receive queue
  cut,              ///< the wire is cut: the named ports are on the far side
  drive,            ///< the bit driver: raw levels on the wire (the near side of a cut one)
  stuck_recessive,  ///< nothing that a controller drives reaches the wire
  late,             ///< what a controller drives reaches the wire later
  noise,            ///< bits are inverted at random: on the wire, or as the named ports see it
  overload,         ///< a controller asks for overload frames after each frame [ISO 11898-1 overload frame]
  single_shot,      ///< a controller sends a frame once: after an error or lost arbitration it is dropped
  early,            ///< a controller begins its frame before the bus is idle
  termination,      ///< other than two resistors at the ends of the line; the model: termination.hpp
};

/// Of FaultKind::early: EOF and intermission.
inline constexpr unsigned max_early_bits = 7 + 3;

/// One fault. What its kind does not use is ignored.
struct Fault {
  FaultKind kind = FaultKind::drop;
  can::Time from{};              ///< in effect from here ...
  can::Time until = can::never;  ///< ... to just before here

  // drop, corrupt, duplicate, delay: which frames. Those that match are numbered from 1 in the order in which
  // they begin on the wire (delay: in which they are queued); a repeated attempt counts again.
  std::optional<std::uint32_t> identifier{};                        ///< none: every frame
  bool extended = false;                                            ///< of `identifier`
  std::string sender{};                                             ///< name of a port; empty: any
  std::uint64_t first = 1;                                          ///< number of the first frame hit, from 1
  std::uint64_t every = 1;                                          ///< after it every second, third ...
  std::uint64_t count = std::numeric_limits<std::uint64_t>::max();  ///< frames hit at most
  double probability = 1.0;                                         ///< 0..1, of each frame that is due

  std::string receiver{};         ///< drop, corrupt: the only port where it happens; empty: all
  std::optional<unsigned> bit{};  ///< corrupt: 0 = SOF, stuff bits counted; none: any bit of the frame
  can::Duration delay{};          ///< delay, late: longer than 0; late: shorter than a bit of the bus

  // drive: begins at `from`, or, with `bit` or `field`, within each frame that the rules above hit: at its `bit`, from
  // SOF or from the beginning of `field`. A frame that has no such field is not counted.
  std::vector<DrivenLevel> levels{};       ///< see bit_driver.hpp
  can::Duration bit_time{};                ///< of one level; 0: that of the bus, or of the frame's sender
  std::optional<can::FrameField> field{};  ///< up to the intermission

  /// babble, stuck_dominant, stuck_recessive, late, overload, single_shot, early, jam, cut: whose fault it is; noise: the
  /// ports that alone see it, each for itself, and empty: the wire.
  std::vector<std::string> ports{};
  can::Frame frame{};         ///< babble
  can::Duration interval{};   ///< babble: from frame to frame; 0: always one more
  std::size_t capacity = 16;  ///< jam: received frames kept; later ones are lost
  double bit_error_rate = 0;  ///< noise: above 0, up to 1, of each bit time, whether the bus is idle or not
  unsigned overload_frames = 1;  ///< overload: 1 or 2, after each frame
  unsigned early_bits = 1;       ///< early: 1 to max_early_bits, before the end of the intermission
  unsigned resistors = 0;        ///< termination: 0 to 20, of 120 ohms
  double length = 0;             ///< termination: of the line, 0 to 10000 m
};

/// What became of a fault so far.
struct FaultState {
  std::uint64_t hits =
      0;  ///< frames; of drive without a frame, and of a fault that a port has for some time, 0
  bool is_active = false;  ///< a fault that a port has for some time has it now
};

}  // namespace canopus::sim
