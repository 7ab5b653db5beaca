// Block transfers of the SDO server.

#include "canopus/canopen/sdo_crc.hpp"
#include "canopus/canopen/sdo_frame.hpp"
#include "canopus/canopen/sdo_server.hpp"

namespace canopus::canopen {

using sdo::ClientCommand;

namespace {

constexpr can::Duration full_queue_retry = std::chrono::microseconds(500);

}  // namespace

void SdoServer::receive_in_block(const can::Frame& frame, can::Time now) {
  const auto command = static_cast<ClientCommand>(frame.data[0] >> 5);
  const auto subcommand = static_cast<sdo::BlockUpload>(frame.data[0] & 3U);
  switch (state_) {
    case State::block_download: return block_segment(frame, now);
    case State::block_download_end:
      if (command == ClientCommand::block_download && (frame.data[0] & 1U) != 0) {
        return end_block_download(frame, now);
      }
      break;
    case State::block_upload_start:
      if (command == ClientCommand::block_upload && subcommand == sdo::BlockUpload::start) {
        last_heard_ = now;
        state_ = State::block_upload;
        sequence_ = 0;
        return send_block(now);
      }
      break;
    case State::block_upload:
    case State::block_upload_confirm:
      if (command == ClientCommand::block_upload && subcommand == sdo::BlockUpload::response) {
        return block_confirmed(frame, now);
      }
      break;
    case State::block_upload_end:
      if (command == ClientCommand::block_upload && subcommand == sdo::BlockUpload::end) {
        close(true);
        return stop();
      }
      break;
    default: break;
  }
  abort(AbortCode::command_specifier);
}

void SdoServer::initiate_block_download(const can::Frame& frame, can::Time now) {
  const std::uint16_t index = sdo::index(frame);
  const std::uint8_t sub = frame.data[3];
  if ((frame.data[0] & 1U) != 0) return abort(0, 0, AbortCode::command_specifier);
  const bool size_indicated = (frame.data[0] & 2U) != 0;
  crc_is_used_ = (frame.data[0] & sdo::crc_bit) != 0;
  const AbortCode code = begin_download(frame, State::block_download, size_indicated, sdo::segment_size, now);
  if (code != AbortCode::none) return abort(index, sub, code);
  collector_.count_crc(crc_is_used_);
  sequence_ = 0;
  last_sequence_ = 0;
  confirmed_early_ = false;
  block_size_ = own_block_size_;
  deadline_ = can::later(now, pause());
  sink_->send(sdo::frame(response_, 0xA0U | sdo::crc_bit, index, sub, block_size_));
}

void SdoServer::block_segment(const can::Frame& frame, can::Time now) {
  const std::uint8_t sequence = frame.data[0] & 0x7F;
  const bool last = (frame.data[0] & 0x80) != 0;
  if (sequence == 0 || sequence > block_size_) return abort(AbortCode::sequence_number);
  last_heard_ = now;
  confirmed_early_ = false;
  if (sequence == sequence_ + 1) {
    const AbortCode code = collector_.add({&frame.data[1], sdo::segment_size});
    if (code != AbortCode::none) return abort(code);
    sequence_ = sequence;
    if (last) last_sequence_ = sequence;
  }
  if (last || sequence == block_size_) confirm_block();
}

void SdoServer::confirm_block() {
  can::Frame answer = sdo::frame(response_, 0xA2);
  answer.data[1] = sequence_;
  answer.data[2] = block_size_ = own_block_size_;
  if (last_sequence_ != 0) state_ = State::block_download_end;
  sequence_ = 0;
  sink_->send(answer);
}

void SdoServer::end_block_download(const can::Frame& frame, can::Time now) {
  last_heard_ = now;
  crc_ = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
  const AbortCode code = finish_download(frame.data[0] >> 2 & 7U, now);
  if (code != AbortCode::none) return abort(code);
  stop();
  sink_->send(sdo::frame(response_, 0xA1));
}

void SdoServer::initiate_block_upload(const can::Frame& frame, can::Time now) {
  const std::uint16_t index = sdo::index(frame);
  const std::uint8_t sub = frame.data[3];
  if (static_cast<sdo::BlockUpload>(frame.data[0] & 3U) != sdo::BlockUpload::initiate) {
    return abort(0, 0, AbortCode::command_specifier);
  }
  const std::uint8_t block_size = frame.data[4];
  const std::uint8_t switch_threshold = frame.data[5];
  if (block_size < 1 || block_size > 127) return abort(index, sub, AbortCode::block_size);
  Entry entry;
  if (const AbortCode code = dictionary_->prepare_read(index, sub, now, entry); code != AbortCode::none) {
    return abort(index, sub, code);
  }
  index_ = index;
  sub_ = sub;
  if (const AbortCode code = begin_upload(entry, now); code != AbortCode::none) return abort(code);
  if (switch_threshold != 0 && size_ && *size_ <= switch_threshold) return answer_upload(now);
  enter(State::block_upload_start, index, sub, now);
  block_size_ = block_size;
  crc_is_used_ = (frame.data[0] & sdo::crc_bit) != 0;
  crc_ = 0;
  last_sequence_ = 0;
  const unsigned size_indicated = size_ ? 2U : 0U;
  sink_->send(sdo::frame(response_, 0xC0U | sdo::crc_bit | size_indicated, index, sub,
                         static_cast<std::uint32_t>(size_.value_or(0))));
}

// A confirmation may come from inside send(), when the bus is a function call: it is then block_confirmed()
// that says where this loop goes on.
void SdoServer::send_block(can::Time now) {
  if (sending_) return;
  sending_ = true;
  while (state_ == State::block_upload) {
    const AbortCode code = source_.prepare(block_size_ * sdo::segment_size);
    if (code != AbortCode::none) {
      abort(code);
      break;
    }
    const auto rest = source_.window().subspan(sequence_ * sdo::segment_size);
    const std::size_t count = std::min(rest.size(), sdo::segment_size);
    const bool last = count == rest.size() && source_.ends_in_window();
    const auto sequence = static_cast<std::uint8_t>(sequence_ + 1);
    can::Frame segment = sdo::frame(response_, sequence | (last ? 0x80U : 0U));
    std::copy_n(rest.data(), count, &segment.data[1]);
    sequence_ = sequence;
    if (last) {
      last_sequence_ = sequence;
      unused_ = static_cast<std::uint8_t>(sdo::segment_size - count);
    }
    if (last || sequence == block_size_) state_ = State::block_upload_confirm;
    if (!sink_->send(segment)) {  // not out: again later
      if (sequence_ != sequence) break;
      --sequence_;
      if (last) last_sequence_ = 0;
      state_ = State::block_upload;
      deadline_ = can::later(now, full_queue_retry);
      break;
    }
  }
  sending_ = false;
  if (state_ == State::block_upload_confirm && time_out_ != can::Duration{}) {
    deadline_ = can::later(last_heard_, time_out_);
  }
}

void SdoServer::block_confirmed(const can::Frame& frame, can::Time now) {
  const std::uint8_t confirmed = frame.data[1];
  const std::uint8_t block_size = frame.data[2];
  if (confirmed > sequence_) return abort(AbortCode::sequence_number);
  if (block_size < 1 || block_size > 127) return abort(AbortCode::block_size);
  last_heard_ = now;
  const bool complete = last_sequence_ != 0 && confirmed == last_sequence_;
  const std::size_t bytes = confirmed * sdo::segment_size - (complete ? unused_ : 0U);
  if (crc_is_used_) crc_ = sdo::crc16(crc_, source_.window().first(bytes));
  source_.advance(bytes);
  block_size_ = block_size;
  sequence_ = 0;
  last_sequence_ = 0;
  if (!complete) {
    state_ = State::block_upload;
    return send_block(now);
  }
  state_ = State::block_upload_end;
  can::Frame end = sdo::frame(response_, 0xC1U | static_cast<unsigned>(unused_) << 2);
  end.data[1] = static_cast<std::uint8_t>(crc_);
  end.data[2] = static_cast<std::uint8_t>(crc_ >> 8);
  sink_->send(end);
}

}  // namespace canopus::canopen
