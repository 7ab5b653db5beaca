#include "canopus/canopen/sdo_client.hpp"

#include "canopus/canopen/nmt.hpp"
#include "canopus/canopen/sdo_frame.hpp"

namespace canopus::canopen {

using sdo::ServerCommand;

void SdoClient::set_server(std::uint8_t node_id) {
  set_channel(cob_id::sdo_request + node_id, cob_id::sdo_response + node_id);
  server_ = node_id;
}

void SdoClient::set_channel(std::uint32_t request, std::uint32_t response) {
  if (busy()) return;
  constexpr std::uint32_t identifier_and_format = 0x3FFF'FFFF;
  request_cob_id_ = request & identifier_and_format;
  response_cob_id_ = response & identifier_and_format;
  server_ = 0;
}

// Everything is set before a frame goes out: on a bus that is a function call, the answer comes from inside
// send().
bool SdoClient::start(State state, const can::Frame& request, SdoClientUser& user, can::Time now,
                      can::Duration time_out) {
  state_ = state;
  user_ = &user;
  index_ = sdo::index(request);
  sub_ = request.data[3];
  toggle_ = false;
  abort_code_ = AbortCode::none;
  received_.clear();
  time_out_ = time_out;
  deadline_ = can::later(now, time_out);
  if (sink_->send(request)) return true;
  state_ = State::idle;
  deadline_ = can::never;
  return false;
}

bool SdoClient::upload(std::uint16_t index, std::uint8_t sub, SdoClientUser& user, can::Time now,
                       can::Duration time_out) {
  if (busy()) return false;
  return start(State::initiate_upload, sdo::frame(request_cob_id_, 0x40, index, sub), user, now, time_out);
}

bool SdoClient::download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data,
                         SdoClientUser& user, can::Time now, can::Duration time_out) {
  if (busy()) return false;
  can::Frame request;
  if (data.size() >= 1 && data.size() <= 4) {
    request = sdo::frame(request_cob_id_, 0x23U | static_cast<unsigned>(4 - data.size()) << 2, index, sub);
    std::copy_n(data.begin(), data.size(), &request.data[4]);
  } else {
    request = sdo::frame(request_cob_id_, 0x21, index, sub, static_cast<std::uint32_t>(data.size()));
  }
  source_ = data;
  sent_ = 0;
  return start(State::initiate_download, request, user, now, time_out);
}

void SdoClient::cancel(AbortCode code) {
  if (!busy()) return;
  state_ = State::idle;
  deadline_ = can::never;
  abort_code_ = code;
  sink_->send(sdo::abort_frame(request_cob_id_, index_, sub_, code));
}

void SdoClient::finish(AbortCode code, can::Time now) {
  state_ = State::idle;
  deadline_ = can::never;
  abort_code_ = code;
  user_->sdo_finished(*this, now);  // may start the next transfer
}

void SdoClient::give_up(AbortCode code, can::Time now) {
  sink_->send(sdo::abort_frame(request_cob_id_, index_, sub_, code));
  finish(code, now);
}

bool SdoClient::receive(const can::Frame& frame, can::Time now) {
  const std::uint32_t key = frame.identifier | (frame.extended ? 1U << 29 : 0U);
  if (frame.remote || key != response_cob_id_) return false;
  if (!busy() || frame.dlc == 0) return true;
  const auto command = static_cast<ServerCommand>(frame.data[0] >> 5);
  if (command == ServerCommand::abort) {
    finish(static_cast<AbortCode>(sdo::value(frame)), now);
    return true;
  }
  switch (state_) {
    case State::idle: break;
    case State::initiate_upload: upload_initiated(frame, now); break;
    case State::upload_segment: segment_uploaded(frame, now); break;
    case State::initiate_download: download_initiated(frame, now); break;
    case State::download_segment: segment_downloaded(frame, now); break;
  }
  return true;
}

bool SdoClient::is_about_this_object(const can::Frame& frame) const noexcept {
  return sdo::index(frame) == index_ && frame.data[3] == sub_;
}

void SdoClient::upload_initiated(const can::Frame& frame, can::Time now) {
  if (static_cast<ServerCommand>(frame.data[0] >> 5) != ServerCommand::initiate_upload) {
    return give_up(AbortCode::command_specifier, now);
  }
  if (!is_about_this_object(frame)) return;  // a late answer to a transfer given up
  if ((frame.data[0] & sdo::expedited_bit) != 0) {
    const auto data = sdo::expedited_data(frame);
    if (maximum_size_ != 0 && data.size() > maximum_size_) return too_long(now);
    received_.assign(data.begin(), data.end());
    return finish(AbortCode::none, now);
  }
  size_known_ = (frame.data[0] & sdo::size_bit) != 0;
  size_ = size_known_ ? sdo::value(frame) : 0;
  if (maximum_size_ != 0 && size_ > maximum_size_) return too_long(now);
  received_.reserve(std::min<std::size_t>(size_, largest_reservation));
  state_ = State::upload_segment;
  request_segment(now);
}

void SdoClient::request_segment(can::Time now) {
  deadline_ = can::later(now, time_out_);
  sink_->send(sdo::frame(request_cob_id_, 0x60U | (toggle_ ? sdo::toggle_bit : 0U)));
}

void SdoClient::segment_uploaded(const can::Frame& frame, can::Time now) {
  if (static_cast<ServerCommand>(frame.data[0] >> 5) != ServerCommand::upload_segment) {
    return give_up(AbortCode::command_specifier, now);
  }
  if (((frame.data[0] & sdo::toggle_bit) != 0) != toggle_) return give_up(AbortCode::toggle_bit, now);
  const auto data = sdo::segment_data(frame);
  const std::size_t total = received_.size() + data.size();
  if (size_known_ && total > size_) return give_up(AbortCode::length_too_high, now);
  if (maximum_size_ != 0 && total > maximum_size_) return too_long(now);
  received_.insert(received_.end(), data.begin(), data.end());
  if ((frame.data[0] & sdo::last_bit) != 0) {
    if (size_known_ && total < size_) return give_up(AbortCode::length_too_low, now);
    return finish(AbortCode::none, now);
  }
  toggle_ = !toggle_;
  request_segment(now);
}

void SdoClient::too_long(can::Time now) {
  sink_->send(sdo::abort_frame(request_cob_id_, index_, sub_, AbortCode::out_of_memory));
  finish(buffer_too_small, now);
}

void SdoClient::download_initiated(const can::Frame& frame, can::Time now) {
  if (static_cast<ServerCommand>(frame.data[0] >> 5) != ServerCommand::initiate_download) {
    return give_up(AbortCode::command_specifier, now);
  }
  if (!is_about_this_object(frame)) return;
  if (source_.size() >= 1 && source_.size() <= 4) return finish(AbortCode::none, now);
  state_ = State::download_segment;
  send_segment(now);
}

void SdoClient::send_segment(can::Time now) {
  const std::size_t count = std::min(source_.size() - sent_, sdo::segment_size);
  can::Frame segment = sdo::frame(request_cob_id_, toggle_ ? sdo::toggle_bit : 0U);
  sdo::put_segment(segment, source_.data() + sent_, count, sent_ + count == source_.size());
  sent_ += count;
  deadline_ = can::later(now, time_out_);
  sink_->send(segment);
}

void SdoClient::segment_downloaded(const can::Frame& frame, can::Time now) {
  if (static_cast<ServerCommand>(frame.data[0] >> 5) != ServerCommand::download_segment) {
    return give_up(AbortCode::command_specifier, now);
  }
  if (((frame.data[0] & sdo::toggle_bit) != 0) != toggle_) return give_up(AbortCode::toggle_bit, now);
  if (sent_ == source_.size()) return finish(AbortCode::none, now);
  toggle_ = !toggle_;
  send_segment(now);
}

void SdoClient::tick(can::Time now) {
  if (busy() && now >= deadline_) give_up(AbortCode::timed_out, now);
}

}  // namespace canopus::canopen
