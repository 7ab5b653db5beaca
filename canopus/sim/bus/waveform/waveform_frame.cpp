// A frame that is reported as a whole, in a waveform: the same lines as if its bits had been reported one after
// the other.

#include <algorithm>
#include <string_view>
#include <vector>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/controller/bit_controller.hpp"
#include "canopus/sim/bus/waveform/waveform.hpp"
#include "canopus/sim/bus/wire/bus_port.hpp"
#include "canopus/sim/bus/wire/wire_observer.hpp"

namespace canopus::sim {
namespace {

using can::FrameField;

/// Where receivers know of the frame.
constexpr FrameField first_of_all = FrameField::identifier_28_21;

/// Which field bit `number` of the frame belongs to; `plain` bits before it are no stuff bits.
FrameField field_at(const can::Frame& frame, const BitStream& stream, unsigned number,
                    unsigned plain) noexcept {
  if (number + 1 < stream.ack_slot) {
    const unsigned crc_begin = (frame.extended ? 39U : 19U) + 8 * static_cast<unsigned>(frame.length());
    return plain >= crc_begin ? FrameField::crc : field_of_bit(plain, frame.extended);
  }
  if (number < stream.ack_slot) return FrameField::crc_delimiter;
  if (number == stream.ack_slot) return FrameField::ack_slot;
  return number == stream.ack_slot + 1 ? FrameField::ack_delimiter : FrameField::end_of_frame;
}

}  // namespace

void Waveform::frame_passed(const WireFrame& frame) {
  const BitStream stream(frame.frame);
  const std::size_t transmitter = frame.transmitter.index;
  if (frame.membership != membership_) update_members(frame);
  begin_arbitration(frame);
  bool wire = false;    // dominant
  bool driven = false;  // likewise, by the transmitter
  unsigned plain = 0;   // bits so far, without stuff bits
  FrameField entered = FrameField::idle;
  can::Time now = frame.start;
  for (unsigned number = 0; number < stream.size; ++number, now += frame.bit) {
    const BitStream::Bit bit = stream.bits[number];
    const bool acknowledged = number == stream.ack_slot;
    if (number <= 2) advance(now);  // not all are in the same field yet
    if (!contenders_.empty()) {
      const bool is_over = number >= stream.arbitration_end;
      if (bit.dominant != driven || plain >= next_lost_at_ || is_over)
        write_arbitration(bit, plain, is_over, now);
    } else if (bit.dominant != driven && transmitter < ports_.size()) {
      write_level(signal(transmitter, tx), !bit.dominant, now);
    }
    driven = bit.dominant;
    if (acknowledged || number == stream.ack_slot + 1) write_acknowledgement(frame, acknowledged, now);
    if (wire != (bit.dominant || acknowledged)) {
      wire = !wire;
      write_level(0, !wire, now);
    }
    if (!bit.stuff) {
      if (const FrameField next = field_at(frame.frame, stream, number, plain); next != entered) {
        entered = next;
        enter_field(frame, entered, now);
      }
      ++plain;
    }
    if (acknowledged && frame.counting) write_received(frame, now + frame.sample_point);
  }
  if (frame.counting && transmitter < ports_.size()) {
    can::FaultConfinement counters = frame.transmitter.faults;
    counters.transmitted();
    change_number(value(transmitter, tec), counters.transmit_errors(), now - frame.bit + frame.sample_point);
  }
  advance(now);
  if (fields_.of_bus() == first_of_all) fields_.replace(first_of_all, FrameField::intermission);
  idle_at_ = now + frame.bit * can::intermission_bits;
}

void Waveform::update_members(const WireFrame& frame) {
  membership_ = frame.membership;
  std::vector<bool> are_members(ports_.size());
  std::vector<bool> acknowledge(ports_.size());
  for (const BusPort* port : frame.members) {
    if (port->index >= ports_.size()) continue;
    are_members[port->index] = true;
    acknowledge[port->index] = !port->listen_only;
  }
  all_are_members_ = std::ranges::find(are_members, false) == are_members.end();
  for (const bool dominant : {false, true}) {
    Acknowledgement& all = acknowledged_[dominant ? 1 : 0];
    all = {};
    for (std::size_t port = 0; port < ports_.size(); ++port) {
      all.begins.push_back(all.lines.size());
      if (acknowledge[port]) WaveformText::append_level(all.lines, !dominant, codes_[signal(port, tx)]);
    }
    all.begins.push_back(all.lines.size());
  }
}

void Waveform::begin_arbitration(const WireFrame& frame) {
  contenders_.clear();
  next_lost_at_ = 0;
  for (const WireFrame::Sender& sender : frame.senders) {
    if (sender.port < ports_.size()) contenders_.push_back({.port = sender.port, .lost_at = sender.lost_at});
  }
}

/// What each of those drives that began to send, in the bit that begins; `plain` bits before it are no stuff bits.
void Waveform::write_arbitration(BitStream::Bit bit, unsigned plain, bool is_over, can::Time now) {
  const unsigned belongs_to = bit.stuff ? plain - 1 : plain;
  const bool begins = plain == 0;
  unsigned next_lost_at = WireFrame::Sender::won;
  std::size_t left = 0;
  for (Contender contender : contenders_) {
    const bool drives = bit.dominant && belongs_to < contender.lost_at;
    const bool is_out = contender.lost_at == WireFrame::Sender::won ? is_over : plain > contender.lost_at;
    if (drives != contender.drives) write_level(signal(contender.port, tx), !drives, now);
    if (begins || is_out) write_level(signal(contender.port, arbitration_part), !is_out, now);
    if (is_out) continue;
    contender.drives = drives;
    next_lost_at = std::min(next_lost_at, contender.lost_at);
    contenders_[left++] = contender;
  }
  contenders_.resize(left);
  next_lost_at_ = next_lost_at;
}

/// All but the transmitter.
void Waveform::write_acknowledgement(const WireFrame& frame, bool dominant, can::Time now) {
  const Acknowledgement& all = acknowledged_[dominant ? 1 : 0];
  const std::size_t transmitter = std::min<std::size_t>(frame.transmitter.index, ports_.size());
  const std::string_view lines = all.lines;
  const std::string_view before = lines.substr(0, all.begins[transmitter]);
  const std::string_view behind = lines.substr(all.begins[std::min(transmitter + 1, ports_.size())]);
  if (before.empty() && behind.empty()) return;
  text_.time(now);
  text_.write(before);
  text_.write(behind);
}

/// From the end of the SOF on all that take part are in the same field.
void Waveform::enter_field(const WireFrame& frame, FrameField entered, can::Time now) {
  if (entered == FrameField::start_of_frame) {
    for (const Contender& contender : contenders_) fields_.set(contender.port, entered);
  } else if (entered == first_of_all && all_are_members_) {
    fields_.set_all(entered);
  } else if (entered == first_of_all) {
    for (const BusPort* port : frame.members) {
      if (port->index < ports_.size()) fields_.set(port->index, entered);
    }
  } else if (fields_.of_bus() == first_of_all) {  // and it stays there until the frame is over
    text_.time(now);
    text_.number(static_cast<int>(entered), codes_[bus_field()]);
  }
}

void Waveform::write_received(const WireFrame& frame, can::Time now) {
  for (const BusPort* port : frame.members) {
    if (port == &frame.transmitter || port->listen_only || port->index >= ports_.size()) continue;
    can::FaultConfinement counters = port->faults;
    counters.received();
    change_number(value(port->index, rec), counters.receive_errors(), now);
  }
}

}  // namespace canopus::sim
