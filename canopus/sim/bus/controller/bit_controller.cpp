#include "canopus/sim/bus/controller/bit_controller.hpp"

#include <algorithm>

namespace canopus::sim {

using can::FrameField;

namespace {

constexpr unsigned integration_bits = 11;
constexpr unsigned recovery_sequences = 128;
constexpr unsigned flag_bits = 6;
constexpr unsigned delimiter_bits = 8;
constexpr unsigned intermission_bits = 3;
constexpr unsigned eof_bits = 7;
constexpr unsigned crc_bits = 15;
constexpr unsigned unknown = 1'000;  // crc_begin_ before the DLC is read

}  // namespace

void BitController::restart(bool integrated) noexcept {
  transmitting_ = false;
  sequences_ = 0;
  if (faults_.state() == can::ErrorState::bus_off) {
    enter(State::bus_off);
  } else {
    enter(integrated ? State::idle : State::integrating);
  }
}

void BitController::begin_frame() noexcept {
  enter(State::frame);
  transmitting_ = false;
  overloads_left_ = overload_frames_;
  overload_ = false;
  ack_error_open_ = false;
  position_ = 0;
  field_ = Field::stuffed;
  last_dominant_ = false;  // the bus was recessive
  row_ = 0;
  payload_ = 0;
  crc_begin_ = unknown;
  crc_ = 0;
  crc_seen_ = 0;
  field_bits_ = 0;
  incoming_ = {};
}

/// A transmitter goes on to the end of its frame.
bool BitController::begins_early() const noexcept {
  if (state_ == State::intermission) return intermission_bits - count_ <= early_bits_;
  if (state_ != State::frame || field_ != Field::eof || transmitting_) return false;
  return eof_bits - field_bits_ + intermission_bits <= early_bits_;
}

void BitController::transmit(const can::Frame& frame) noexcept {
  begin_frame();
  send(frame);
}

void BitController::join(const can::Frame& frame) noexcept { send(frame); }

/// Most often it is what was sent last: a frame that met an error or lost arbitration.
void BitController::send(const can::Frame& frame) noexcept {
  if (!has_stream_ || sent_ != frame) {
    stream_ = BitStream(frame);
    sent_ = frame;
    has_stream_ = true;
  }
  transmitting_ = true;
}

bool BitController::drives_dominant() const noexcept {
  if (listen_only_) return false;
  switch (state_) {
    case State::frame:
      if (transmitting_) return stream_.bits[position_].dominant;
      return field_ == Field::ack_slot && crc_ == crc_seen_;
    case State::active_flag:
    case State::overload_flag: return true;
    default: return false;
  }
}

void BitController::sample(bool dominant, Events& events) noexcept {
  switch (state_) {
    case State::integrating:
      count_ = dominant ? 0 : count_ + 1;
      if (count_ == integration_bits) enter(State::idle);
      break;
    case State::bus_off:
      if (!recovering_) break;
      count_ = dominant ? 0 : count_ + 1;
      if (count_ == integration_bits) {
        count_ = 0;
        if (++sequences_ == recovery_sequences) {
          faults_.reset();
          restart(true);
          events.recovered = true;
        }
      }
      break;
    case State::idle:
    case State::suspend:
      if (dominant) {
        begin_frame();
        sample_frame(true, events);
      } else if (state_ == State::suspend && ++count_ == suspend_bits) {
        enter(State::idle);
      }
      break;
    case State::frame: sample_frame(dominant, events); break;
    case State::active_flag:
    case State::overload_flag:
      if (!dominant && !listen_only_) {  // a monitor's flag stays inside, where it sees it dominant
        flag_overwritten(events);
      } else if (++count_ == flag_bits) {
        enter(State::superposition);
      }
      break;
    case State::passive_flag:
      if (dominant && ack_error_open_) {
        ack_error_open_ = false;
        faults_.transmitter_error();
      }
      count_ = count_ > 0 && dominant == flag_last_dominant_ ? count_ + 1 : 1;
      flag_last_dominant_ = dominant;
      if (count_ == flag_bits) enter(State::superposition);
      enter_bus_off_if_due();
      break;
    case State::superposition:
      if (!dominant) {
        enter(State::delimiter);
        count_ = 1;
        break;
      }
      ++count_;
      // Rule b: another controller found the error later than this receiver, so it may be its own fault.
      if (count_ == 1 && !overload_ && !transmitting_ && !listen_only_) receiver_severe_error(events);
      if (count_ % 8 == 0) severe(events);  // rule f
      break;
    case State::delimiter:
      if (!dominant) {
        if (++count_ == delimiter_bits) expect_intermission();
      } else if (count_ + 1 < delimiter_bits) {
        fail(BusError::form, events);
      } else {
        overload_ = true;
        enter(State::overload_flag);
      }
      break;
    case State::intermission:
      ++count_;
      if (!dominant) {
        if (count_ == intermission_bits) after_intermission();
      } else if (count_ < intermission_bits) {
        overload_ = true;
        enter(State::overload_flag);
      } else {
        const bool may_join = !(transmitting_ && faults_.state() == can::ErrorState::error_passive);
        begin_frame();
        sample_frame(true, events);
        events.early_start = may_join;
      }
      break;
  }
}

/// An overload frame that is asked for begins with the first bit of the intermission that was expected.
void BitController::expect_intermission() noexcept {
  if (overloads_left_ == 0 || listen_only_) return enter(State::intermission);
  --overloads_left_;
  overload_ = true;
  enter(State::overload_flag);
}

void BitController::after_intermission() noexcept {
  const bool suspended = transmitting_ && faults_.state() == can::ErrorState::error_passive;
  enter(suspended ? State::suspend : State::idle);
}

void BitController::sample_frame(bool dominant, Events& events) noexcept {
  if (transmitting_) {
    const BitStream::Bit sent = stream_.bits[position_];
    if (sent.dominant && !dominant) return fail(BusError::bit, events);
    if (position_ == stream_.ack_slot) {
      if (!dominant) return fail(BusError::acknowledgement, events);
    } else if (!sent.dominant && dominant) {
      if (position_ >= stream_.arbitration_end) return fail(BusError::bit, events);
      // Rule c, exception 2.
      if (sent.stuff) return fail(BusError::stuff, events, false);
      transmitting_ = false;
      events.lost = true;
    }
  }
  const BusError error = parse(dominant, events);
  ++position_;
  if (error != BusError::none) fail(error, events);
}

BusError BitController::parse(bool dominant, Events& events) noexcept {
  switch (field_) {
    case Field::stuffed: {
      const bool stuff_bit = row_ == 5;
      if (stuff_bit && dominant == last_dominant_) return BusError::stuff;
      row_ = dominant == last_dominant_ ? row_ + 1 : 1;
      last_dominant_ = dominant;
      if (!stuff_bit) parse_payload(!dominant);
      // A fifth equal bit at the end of the CRC has its stuff bit too.
      if (payload_ == crc_begin_ + crc_bits && row_ < 5) field_ = Field::crc_delimiter;
      return BusError::none;
    }
    case Field::crc_delimiter: field_ = Field::ack_slot; return dominant ? BusError::form : BusError::none;
    case Field::ack_slot:
      if (!transmitting_ && !listen_only_ && crc_ == crc_seen_) {
        if (!dominant) return BusError::bit;
        faults_.received();
        events.counted = Counted::success;
      }
      field_ = Field::ack_delimiter;
      return BusError::none;
    case Field::ack_delimiter:
      field_ = Field::eof;
      field_bits_ = 0;
      if (crc_ != crc_seen_) return BusError::crc;
      return dominant ? BusError::form : BusError::none;
    case Field::eof:
      ++field_bits_;
      if (field_bits_ < eof_bits) return dominant ? BusError::form : BusError::none;
      break;
  }
  // The last bit of EOF. For a receiver the frame was valid one bit ago.
  if (transmitting_) {
    events.transmitted = true;
    faults_.transmitted();
  } else {
    events.received = true;
    frame_ = incoming_;
  }
  if (dominant) {
    overload_ = true;
    enter(State::overload_flag);
  } else {
    expect_intermission();
  }
  return BusError::none;
}

void BitController::parse_payload(bool recessive) noexcept {
  const unsigned bit = payload_++;
  if (bit >= crc_begin_) {
    crc_seen_ = static_cast<std::uint16_t>(crc_seen_ << 1 | (recessive ? 1 : 0));
    return;
  }
  crc_ = crc_step(crc_, recessive);
  // SOF 0, identifier 1-11, RTR or SRR 12, IDE 13, then
  //   base:     r0 14, DLC 15-18, data from 19
  //   extended: identifier 14-31, RTR 32, r1 33, r0 34, DLC 35-38, data from 39
  const std::uint32_t value = recessive ? 1 : 0;
  if (bit == 0) return;
  if (bit <= 11) {
    incoming_.identifier = incoming_.identifier << 1 | value;
    return;
  }
  if (bit == 12) {
    incoming_.remote = recessive;
    return;
  }
  if (bit == 13) {
    incoming_.extended = recessive;
    return;
  }
  const unsigned dlc_begin = incoming_.extended ? 35 : 15;
  if (bit < dlc_begin) {
    if (incoming_.extended && bit <= 31) incoming_.identifier = incoming_.identifier << 1 | value;
    if (incoming_.extended && bit == 32) incoming_.remote = recessive;
    return;
  }
  if (bit < dlc_begin + 4) {
    incoming_.dlc = static_cast<std::uint8_t>(incoming_.dlc << 1 | value);
    if (bit == dlc_begin + 3) crc_begin_ = bit + 1 + 8 * static_cast<unsigned>(incoming_.length());
    return;
  }
  std::uint8_t& byte = incoming_.data[(bit - dlc_begin - 4) / 8];
  byte = static_cast<std::uint8_t>(byte << 1 | value);
}

void BitController::begin_flag(bool passive) noexcept {
  overload_ = false;
  enter(passive ? State::passive_flag : State::active_flag);
}

void BitController::fail(BusError error, Events& events, bool counts) noexcept {
  events.error = error;
  // An error that makes the controller passive is still signalled with an active flag.
  const bool passive = faults_.state() == can::ErrorState::error_passive;
  ack_error_open_ = false;
  if (!listen_only_ && counts) {
    if (!transmitting_) {
      faults_.receiver_error();  // rule a
      events.counted = Counted::error;
    } else if (passive && error == BusError::acknowledgement) {
      ack_error_open_ = true;  // rule c, exception 1
    } else {
      faults_.transmitter_error();  // rule c
    }
  }
  begin_flag(passive);
  enter_bus_off_if_due();
}

void BitController::flag_overwritten(Events& events) noexcept {
  events.error = BusError::bit;
  const bool passive = faults_.state() == can::ErrorState::error_passive;
  begin_flag(passive);
  severe(events);  // rules d, e
}

void BitController::severe(Events& events) noexcept {
  if (listen_only_) return;
  if (transmitting_) {
    faults_.transmitter_error();
  } else {
    receiver_severe_error(events);
  }
  enter_bus_off_if_due();
}

bool BitController::is_alike(const BitController& other) const noexcept {
  if (state_ != other.state_ || listen_only_ != other.listen_only_ ||
      overload_frames_ + other.overload_frames_ != 0)
    return false;
  switch (state_) {
    case State::idle: return true;
    case State::integrating: return count_ == other.count_;
    case State::bus_off: return recovering_ == other.recovering_ && count_ == other.count_;
    case State::frame: break;
    default: return false;
  }
  return !transmitting_ && !other.transmitting_ && overloads_left_ + other.overloads_left_ == 0 &&
         has_parsed_as(other);
}

bool BitController::has_parsed_as(const BitController& other) const noexcept {
  return position_ == other.position_ && field_ == other.field_ && last_dominant_ == other.last_dominant_ &&
         row_ == other.row_ && payload_ == other.payload_ && crc_begin_ == other.crc_begin_ &&
         crc_ == other.crc_ && crc_seen_ == other.crc_seen_ && field_bits_ == other.field_bits_ &&
         incoming_ == other.incoming_;
}

bool BitController::receives_from(const BitController& transmitter) const noexcept {
  return state_ == State::frame && !transmitting_ && transmitter.transmitting() && has_parsed_as(transmitter);
}

BitController::RecessiveRuns BitController::pass_bits(unsigned bits) noexcept {
  Events events;
  RecessiveRuns runs;
  bool has_dominant = false;
  for (; bits > 0; --bits, ++position_) {
    const bool dominant = stream_.bits[position_].dominant;
    has_dominant = has_dominant || dominant;
    if (!has_dominant) ++runs.before;
    runs.after = dominant ? 0 : runs.after + 1;
    parse(dominant, events);
  }
  return runs;
}

void BitController::follow(const BitController& transmitter) noexcept {
  const unsigned overloads_left = overloads_left_;
  resume(transmitter);
  transmitting_ = false;
  overloads_left_ = overloads_left;
}

void BitController::wait(unsigned bits, RecessiveRuns runs) noexcept {
  if (state_ == State::bus_off && !recovering_) return;
  if (count_ + runs.before >= integration_bits) ++sequences_;  // the runs within a frame are shorter
  count_ = runs.before < bits ? runs.after : (count_ + bits) % integration_bits;
}

bool BitController::may_report(bool dominant) const noexcept {
  switch (state_) {
    case State::idle:
    case State::suspend: return false;
    case State::integrating:
    case State::bus_off: return bits_to_return() == 1;
    case State::active_flag:
    case State::overload_flag: return !dominant;
    case State::passive_flag: return dominant && ack_error_open_;
    case State::superposition:
    case State::delimiter:
    case State::intermission: return dominant;
    case State::frame: break;
  }
  if (transmitting_ && stream_.bits[position_].dominant != dominant) return true;
  switch (field_) {
    case Field::stuffed: return row_ == 5 && dominant == last_dominant_;
    case Field::crc_delimiter: return dominant;
    case Field::ack_slot: return true;
    case Field::ack_delimiter: return dominant || crc_ != crc_seen_;
    case Field::eof: break;
  }
  return dominant || field_bits_ + 1 == eof_bits;
}

void BitController::copy_reception(const BitController& other, int more_sequences) noexcept {
  resume(other.progress());
  sequences_ += static_cast<unsigned>(more_sequences);
  frame_ = other.frame_;
}

unsigned BitController::bits_to_return(int more_sequences) const noexcept {
  if (state_ == State::integrating) return integration_bits - count_;
  if (state_ != State::bus_off || !recovering_) return no_return;
  return integration_bits * (recovery_sequences - sequences_ - static_cast<unsigned>(more_sequences)) -
         count_;
}

std::optional<unsigned> BitController::contend(const can::Frame& frame,
                                               const BitController& winner) noexcept {
  std::optional<unsigned> lost_at;
  transmit(frame);
  const std::size_t seen = std::min<std::size_t>(winner.position_, winner.decided());
  while (position_ < seen) {
    const unsigned bit = payload_;
    if (sample(winner.stream_.bits[position_].dominant).lost) lost_at = bit;
  }
  return lost_at;
}

void BitController::enter_bus_off_if_due() noexcept {
  if (faults_.state() != can::ErrorState::bus_off || state_ == State::bus_off) return;
  transmitting_ = false;
  sequences_ = 0;
  enter(State::bus_off);
}

FrameField field_of_bit(unsigned bit, bool extended) noexcept {
  if (bit == 0) return FrameField::start_of_frame;
  if (bit <= 8) return FrameField::identifier_28_21;
  if (bit <= 11) return FrameField::identifier_20_18;
  if (bit == 12) return FrameField::rtr;
  if (bit == 13) return FrameField::ide;
  if (!extended) {
    if (bit == 14) return FrameField::r0;
    return bit <= 18 ? FrameField::dlc : FrameField::data;
  }
  if (bit <= 18) return FrameField::identifier_17_13;
  if (bit <= 26) return FrameField::identifier_12_5;
  if (bit <= 31) return FrameField::identifier_4_0;
  if (bit == 32) return FrameField::extended_rtr;
  if (bit == 33) return FrameField::r1;
  if (bit == 34) return FrameField::r0;
  return bit <= 38 ? FrameField::dlc : FrameField::data;
}

FrameField BitController::Position::field() const noexcept {
  switch (state) {
    case State::frame: break;
    case State::active_flag: return FrameField::active_error_flag;
    case State::passive_flag: return FrameField::passive_error_flag;
    case State::overload_flag: return FrameField::overload_flag;
    case State::superposition: return FrameField::superposition;
    case State::delimiter: return is_overload ? FrameField::overload_delimiter : FrameField::error_delimiter;
    case State::intermission: return FrameField::intermission;
    case State::suspend: return FrameField::suspend;
    default: return FrameField::idle;
  }
  switch (section) {
    case Field::crc_delimiter: return FrameField::crc_delimiter;
    case Field::ack_slot: return FrameField::ack_slot;
    case Field::ack_delimiter: return FrameField::ack_delimiter;
    case Field::eof: return FrameField::end_of_frame;
    case Field::stuffed: break;
  }
  const bool is_stuff_bit = row == 5;
  const unsigned bit = is_stuff_bit && payload > 0 ? payload - 1 : payload;
  return bit >= crc_begin ? FrameField::crc : field_of_bit(bit, is_extended);
}

}  // namespace canopus::sim
