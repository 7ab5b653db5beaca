#pragma once
// One CAN controller, bit by bit [ISO 11898-1]: at the start of a bit it says what it drives, at the sample
// point it gets what is on the wire. Reception, transmission, arbitration, error and overload frames,
// fault confinement, integration and bus-off recovery all happen here; bit timing, queues and delivery do
// not.
//
//   integrating -> idle -> frame -> intermission -> (suspend ->) idle
//                            | error                     ^
//                            v                           |
//            active/passive/overload flag -> superposition -> delimiter
//                            | TEC 256
//                            v
//                         bus_off -> idle

#include <cstdint>
#include <optional>

#include "canopus/can/bus_error.hpp"
#include "canopus/can/fault_confinement.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/sim/bus/controller/bit_stream.hpp"

namespace canopus::sim {

using can::BusError;

/// An error passive transmitter waits as long before its next frame [ISO 11898-1 10.9.6].
inline constexpr unsigned suspend_bits = 8;

/// The field of a bit before the CRC, by its number from SOF = 0 without stuff bits.
[[nodiscard]] can::FrameField field_of_bit(unsigned bit, bool extended) noexcept;

/// How far a controller is in what is on the wire: all that its bits have changed, but for its error counters and the frame it
/// received last.
struct BitProgress {
  enum class State : std::uint8_t {
    integrating,    // started: waits for 11 recessive bits
    idle,           // waits for a SOF or for something to send
    frame,          // SOF to the last bit of EOF
    active_flag,    // six dominant bits
    passive_flag,   // recessive, until six equal bits were seen
    overload_flag,  // six dominant bits
    superposition,  // after a flag: until the others' flags end
    delimiter,      // eight recessive bits
    intermission,
    suspend,  // a passive transmitter lets others go first
    bus_off,
  };
  enum class Field : std::uint8_t { stuffed, crc_delimiter, ack_slot, ack_delimiter, eof };

  State state_ = State::idle;
  unsigned count_ = 0;      // bits in the present state
  unsigned sequences_ = 0;  // of 11 recessive bits, in bus_off

  // The present or last frame.
  bool transmitting_ = false;
  unsigned overloads_left_ = 0;  // overload frames to ask for after this frame
  bool overload_ = false;        // the present flag is an overload flag
  bool ack_error_open_ = false;  // passive: counts only if the flag sees a dominant bit
  bool flag_last_dominant_ = false;
  unsigned position_ = 0;  // on the wire, from SOF

  // Reception.
  Field field_ = Field::stuffed;
  bool last_dominant_ = false;
  unsigned row_ = 0;
  unsigned payload_ = 0;  // destuffed bits so far
  unsigned crc_begin_ = 0;
  std::uint16_t crc_ = 0;
  std::uint16_t crc_seen_ = 0;
  unsigned field_bits_ = 0;
  can::Frame incoming_;
};

class BitController : private BitProgress {
 public:
  using BitProgress::State;

  /// What a receiver's counters did.
  enum class Counted : std::uint8_t { nothing, success, error, severe_error };

  /// What happened at a sample point.
  struct Events {
    friend bool operator==(const Events&, const Events&) = default;
    BusError error = BusError::none;     ///< an error was detected; a frame being sent has failed
    bool received = false;               ///< frame() is complete and valid
    bool transmitted = false;            ///< what was sent is complete
    bool lost = false;                   ///< arbitration lost: receiver from here on
    bool early_start = false;            ///< SOF seen in the last bit of the intermission: join() is allowed
    bool recovered = false;              ///< from bus-off
    Counted counted = Counted::nothing;  ///< unless it transmits
  };

  explicit BitController(can::FaultConfinement& faults) : faults_(faults) {}

  /// Starts anew, in bus_off when the counters say so. `integrated`: as if 11 recessive bits had been seen.
  void restart(bool integrated) noexcept;
  /// In bus_off: whether the 128 times 11 recessive bits are counted that end it.
  void set_recovering(bool recovering) noexcept { recovering_ = recovering; }
  /// Monitors only: drives nothing, counts nothing.
  void set_listen_only(bool listen_only) noexcept { listen_only_ = listen_only; }

  /// So many overload frames, 0 to 2, are asked for after each frame.
  void set_overload_frames(unsigned frames) noexcept { overload_frames_ = frames; }

  /// It does not wait for so many bits, 0 to max_early_bits, of the intermission and the EOF before it.
  void set_early_bits(unsigned bits) noexcept { early_bits_ = bits; }

  /// Begins to send; only when may_begin(), at the start of a bit.
  void transmit(const can::Frame& frame) noexcept;
  /// Begins to send after early_start: the SOF of another counts as its own.
  void join(const can::Frame& frame) noexcept;

  /// At the end of a frame that was computed as a whole: the intermission begins.
  void begin_intermission(bool transmitter) noexcept {
    transmitting_ = transmitter;
    enter(State::intermission);
  }

  /// Whether it drives the bit that begins now dominant.
  [[nodiscard]] bool drives_dominant() const noexcept;
  /// The sample point of the bit.
  Events sample(bool dominant) noexcept {
    Events events;
    sample(dominant, events);
    return events;
  }
  /// Adds what happens to `events`. (Seven flags as a result are slow to put into a register.)
  void sample(bool dominant, Events& events) noexcept;

  /// In a frame that was computed as a whole: it had sampled so many bits of its suspension when that began.
  void resume_suspension(unsigned bits) noexcept {
    if (bits >= suspend_bits) return;
    enter(State::suspend);
    count_ = bits;
  }

  /// Is idle, integrates or is bus-off as the other one, or receives the same frame and has seen the same of it: what comes finds
  /// both alike as long as both have the same error state, but that sequences() may differ. Neither asks for overload frames.
  [[nodiscard]] bool is_alike(const BitController& other) const noexcept;
  /// Comes to the state of `other`, which is_alike(), with so many more sequences().
  void copy_reception(const BitController& other, int more_sequences) noexcept;
  /// Of 11 recessive bits, since it is bus-off.
  [[nodiscard]] unsigned sequences() const noexcept { return sequences_; }

  /// Where it is, to resume() there.
  [[nodiscard]] const BitProgress& progress() const noexcept { return *this; }
  void resume(const BitProgress& progress) noexcept { BitProgress::operator=(progress); }

  /// How many bits it takes at least until it takes part again, while it integrates or is bus-off; else, and if it does not
  /// recover, no_return. `more_sequences`: if it had so many more.
  static constexpr unsigned no_return = ~0U;
  [[nodiscard]] unsigned bits_to_return(int more_sequences = 0) const noexcept;

  /// Whether anything may come of the next bit, if it has this level, but that the controller goes on: an event, or other counters.
  [[nodiscard]] bool may_report(bool dominant) const noexcept;
  /// Bits of its frame that pass before its ACK slot, if it and those that receive them see what it sends.
  [[nodiscard]] unsigned bits_to_acknowledgement() const noexcept {
    return transmitting() && position_ < stream_.ack_slot
               ? static_cast<unsigned>(stream_.ack_slot) - position_
               : 0;
  }
  /// Receives the frame that `transmitter` sends, and has seen the same of it.
  [[nodiscard]] bool receives_from(const BitController& transmitter) const noexcept;
  /// Of bits that pass: how many recessive ones come before the first dominant one, and after the last.
  struct RecessiveRuns {
    unsigned before = 0;
    unsigned after = 0;
  };
  /// It sees so many bits as it sends them, bits_to_acknowledgement() at most.
  RecessiveRuns pass_bits(unsigned bits) noexcept;
  /// Comes to where `transmitter`, which it receives_from(), is after pass_bits().
  void follow(const BitController& transmitter) noexcept;
  /// While it integrates or is bus-off: so many bits of another one's frame pass, less than bits_to_return().
  void wait(unsigned bits, RecessiveRuns runs) noexcept;

  /// Begins to send as if it had done so with the SOF of `winner`, whose bits have been on the wire since. Returns the bit, from
  /// SOF = 0 and without stuff bits, where it has lost arbitration to it; none: both still send.
  std::optional<unsigned> contend(const can::Frame& frame, const BitController& winner) noexcept;
  /// The bit, from SOF = 0, is behind the arbitration field of the frame that it sends.
  [[nodiscard]] bool is_behind_arbitration(unsigned bit) const noexcept { return bit >= decided(); }

  [[nodiscard]] State state() const noexcept { return state_; }
  [[nodiscard]] bool idle() const noexcept { return state_ == State::idle; }
  /// It is idle, or by set_early_bits() treats the bus as idle.
  [[nodiscard]] bool may_begin() const noexcept { return idle() || (early_bits_ > 0 && begins_early()); }
  /// Neither in a frame nor in anything that belongs to one.
  [[nodiscard]] bool quiet() const noexcept {
    return state_ == State::idle || state_ == State::suspend || state_ == State::integrating ||
           state_ == State::bus_off;
  }
  /// An edge restarts its bit; in a frame and in what belongs to one it only moves it.
  [[nodiscard]] bool synchronises_hard() const noexcept {
    return quiet() || (state_ == State::intermission && count_ > 0);
  }
  [[nodiscard]] bool transmitting() const noexcept { return transmitting_ && state_ == State::frame; }
  [[nodiscard]] bool arbitrating() const noexcept {
    return transmitting() && position_ < stream_.arbitration_end;
  }
  [[nodiscard]] bool flagging() const noexcept {
    return state_ == State::active_flag || state_ == State::passive_flag || state_ == State::overload_flag;
  }
  struct Position;
  /// Of the bit that is sampled next.
  [[nodiscard]] Position position() const noexcept;
  /// Which field it belongs to.
  [[nodiscard]] can::FrameField field() const noexcept;
  /// Sends, or sent, the frame that an error or overload frame belongs to.
  [[nodiscard]] bool is_transmitter() const noexcept { return transmitting_; }
  /// The frame that it sends, or sent last.
  [[nodiscard]] const can::Frame& sent() const noexcept { return sent_; }
  /// The frame last received.
  [[nodiscard]] const can::Frame& frame() const noexcept { return frame_; }

 private:
  /// All contenders have lost to its frame before this bit: by RTR, or an extended frame to a base one by IDE, which may have a
  /// stuff bit before it.
  [[nodiscard]] std::size_t decided() const noexcept { return stream_.arbitration_end + 2; }
  [[nodiscard]] bool begins_early() const noexcept;
  [[nodiscard]] bool has_parsed_as(const BitController& other) const noexcept;
  void begin_frame() noexcept;
  void send(const can::Frame& frame) noexcept;
  void sample_frame(bool dominant, Events& events) noexcept;
  /// Returns what a receiver finds wrong with the bit.
  BusError parse(bool dominant, Events& events) noexcept;
  void parse_payload(bool recessive) noexcept;
  void fail(BusError error, Events& events, bool counts = true) noexcept;
  void flag_overwritten(Events& events) noexcept;
  void begin_flag(bool passive) noexcept;
  void enter(State state) noexcept {
    state_ = state;
    count_ = 0;
  }
  void expect_intermission() noexcept;
  void after_intermission() noexcept;
  void enter_bus_off_if_due() noexcept;
  void severe(Events& events) noexcept;
  void receiver_severe_error(Events& events) noexcept {
    faults_.receiver_severe_error();
    events.counted = Counted::severe_error;
  }

  can::FaultConfinement& faults_;
  bool listen_only_ = false;
  bool recovering_ = false;
  unsigned overload_frames_ = 0;
  unsigned early_bits_ = 0;
  bool has_stream_ = false;
  can::Frame sent_;
  BitStream stream_;  // of sent_
  can::Frame frame_;
};

/// Which bit of a frame, or of what belongs to it. Cheap to keep, for the few bits that are asked for.
struct BitController::Position {
  State state = State::idle;
  Field section = Field::stuffed;
  bool is_overload = false;
  bool is_extended = false;
  unsigned row = 0;
  unsigned payload = 0;
  unsigned crc_begin = 0;
  unsigned number = 0;  ///< from SOF = 0 with stuff bits counted, after the frame within the field

  [[nodiscard]] can::FrameField field() const noexcept;
};

inline BitController::Position BitController::position() const noexcept {
  return {.state = state_,
          .section = field_,
          .is_overload = overload_,
          .is_extended = incoming_.extended,
          .row = row_,
          .payload = payload_,
          .crc_begin = crc_begin_,
          .number = state_ == State::frame ? position_ : count_};
}
inline can::FrameField BitController::field() const noexcept { return position().field(); }

}  // namespace canopus::sim
