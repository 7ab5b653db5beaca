// Where in a frame a controller is.

#include "canopus/sim/bus/controller/bit_controller.hpp"

namespace canopus::sim {

using can::FrameField;

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

FrameField BitController::Place::field() const noexcept {
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
  switch (part) {
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
