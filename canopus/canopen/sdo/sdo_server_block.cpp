// Block transfers of the SDO server.

#include "canopus/canopen/sdo/sdo_frame.hpp"
#include "canopus/canopen/sdo/sdo_server.hpp"

namespace canopus::canopen {

using sdo::ClientCommand;

void SdoServer::receive_in_block(const can::Frame& frame, can::Time now) {
  const auto command = static_cast<ClientCommand>(frame.data[0] >> 5);
  const auto subcommand = static_cast<sdo::BlockUpload>(frame.data[0] & 3U);
  switch (state_) {
    case State::block_download_end:
      if (command == ClientCommand::block_download && (frame.data[0] & 1U) != 0) {
        return end_block_download(frame, now);
      }
      break;
    case State::block_upload_start:
      if (command == ClientCommand::block_upload && subcommand == sdo::BlockUpload::start) {
        last_heard_ = now;
        state_ = State::block_upload;
        return send_block(now);
      }
      break;
    case State::block_upload:
      if (command == ClientCommand::block_upload && subcommand == sdo::BlockUpload::response) {
        return block_confirmed(frame, now);
      }
      break;
    case State::block_upload_end:
      if (command == ClientCommand::block_upload && subcommand == sdo::BlockUpload::end) {
        close(true);
        return stop();
      }
      if (command == ClientCommand::block_upload && subcommand == sdo::BlockUpload::response &&
          block_sender_.is_confirmed_again(frame)) {
        return;
      }
      break;
    default: break;
  }
  abort(AbortCode::command_specifier);
}

void SdoServer::initiate_block_download(const can::Frame& frame, can::Time now) {
  if ((frame.data[0] & 1U) != 0) return abort(0, AbortCode::command_specifier);
  const bool size_indicated = (frame.data[0] & 2U) != 0;
  const bool with_crc = (frame.data[0] & sdo::crc_bit) != 0;
  const AbortCode code = begin_download(frame, State::block_download, size_indicated, sdo::segment_size, now);
  if (code != AbortCode::none) return abort(sdo::multiplexer(frame), code);
  collector_.count_crc(with_crc);
  block_receiver_.begin(own_block_size_, with_crc, frame);
  set_deadline(can::later(now, pause()));
  sink_->send(sdo::frame(response_, 0xA0U | sdo::crc_bit, multiplexer_, own_block_size_));
}

void SdoServer::block_segment(const can::Frame& frame, can::Time now) {
  last_heard_ = now;
  auto next = BlockReceiver::Next::segment;
  if (const AbortCode code = block_receiver_.receive(frame, collector_, next); code != AbortCode::none) {
    return abort(code);
  }
  if (next == BlockReceiver::Next::confirmation) confirm_block();
}

void SdoServer::confirm_block() {
  if (block_receiver_.has_all()) state_ = State::block_download_end;
  sink_->send(block_receiver_.confirmation(response_, own_block_size_));
}

void SdoServer::end_block_download(const can::Frame& frame, can::Time now) {
  last_heard_ = now;
  AbortCode code = block_receiver_.finish(frame, collector_);
  if (code == AbortCode::none) code = store_download(now);
  if (code != AbortCode::none) return abort(code);
  stop();
  sink_->send(sdo::frame(response_, 0xA1));
}

void SdoServer::initiate_block_upload(const can::Frame& frame, can::Time now) {
  if (static_cast<sdo::BlockUpload>(frame.data[0] & 3U) != sdo::BlockUpload::initiate) {
    return abort(0, AbortCode::command_specifier);
  }
  const bool with_crc = (frame.data[0] & sdo::crc_bit) != 0;
  const std::uint8_t switch_threshold = frame.data[5];
  if (const AbortCode code = block_sender_.begin(frame.data[4], with_crc); code != AbortCode::none) {
    return abort(sdo::multiplexer(frame), code);
  }
  Entry entry;
  const AbortCode refusal = dictionary_->prepare_read(sdo::index(frame), frame.data[3], now, entry);
  if (refusal != AbortCode::none) return abort(sdo::multiplexer(frame), refusal);
  multiplexer_ = sdo::multiplexer(frame);
  if (const AbortCode code = begin_upload(entry, now); code != AbortCode::none) return abort(code);
  if (switch_threshold != 0 && size_ && *size_ <= switch_threshold) return answer_upload(now);
  enter(State::block_upload_start, multiplexer_, now);
  const unsigned size_indicated = size_ ? 2U : 0U;
  sink_->send(sdo::frame(response_, 0xC0U | sdo::crc_bit | size_indicated, multiplexer_,
                         static_cast<std::uint32_t>(size_.value_or(0))));
}

void SdoServer::send_block(can::Time now) {
  const AbortCode code = block_sender_.send(source_, *sink_, response_);
  if (code != AbortCode::none) return abort(code);
  if (state_ != State::block_upload) return;  // ended by answers that came meanwhile
  if (block_sender_.is_sending()) {
    set_deadline(can::later(now, BlockSender::full_queue_retry));
  } else if (time_out_ != can::Duration{}) {
    set_deadline(can::later(last_heard_, time_out_));
  }
}

void SdoServer::block_confirmed(const can::Frame& frame, can::Time now) {
  const AbortCode code = block_sender_.confirmed(frame, source_);
  if (code != AbortCode::none) return abort(code);
  last_heard_ = now;
  if (!block_sender_.is_complete()) return send_block(now);
  state_ = State::block_upload_end;
  sink_->send(block_sender_.end(response_));
}

}  // namespace canopus::canopen
