#include "canopus/canopen/sdo_server.hpp"

#include "canopus/canopen/sdo_frame.hpp"

namespace canopus::canopen {

using sdo::ClientCommand;

void SdoServer::set_response_identifier(std::uint32_t identifier_key) noexcept {
  stop();
  response_ = identifier_key;
}

void SdoServer::stop() noexcept {
  state_ = State::idle;
  deadline_ = can::never;
}

void SdoServer::begin(State state, const can::Frame& frame, can::Time now) {
  state_ = state;
  index_ = sdo::index(frame);
  sub_ = frame.data[3];
  toggle_ = false;
  position_ = 0;
  last_heard_ = now;
  deadline_ = time_out_ != can::Duration{} ? can::later(now, time_out_) : can::never;
}

void SdoServer::abort(std::uint16_t index, std::uint8_t sub, AbortCode code) {
  stop();
  sink_->send(sdo::abort_frame(response_, index, sub, code));
}

void SdoServer::abort(AbortCode code) { abort(index_, sub_, code); }

void SdoServer::receive(const can::Frame& frame, can::Time now) {
  if (frame.dlc != 8) return;
  const auto command = static_cast<ClientCommand>(frame.data[0] >> 5);
  if (command == ClientCommand::abort) return stop();
  switch (state_) {
    case State::idle:
      if (command == ClientCommand::initiate_upload) return initiate_upload(frame, now);
      if (command == ClientCommand::initiate_download) return initiate_download(frame, now);
      return abort(0, 0, AbortCode::command_specifier);
    case State::download_segment:
      if (command == ClientCommand::download_segment) return download_segment(frame, now);
      return abort(AbortCode::command_specifier);
    case State::upload_segment:
      if (command == ClientCommand::upload_segment) return upload_segment(frame, now);
      return abort(AbortCode::command_specifier);
  }
}

std::size_t SdoServer::maximum_size(const Entry& entry) const noexcept {
  return entry.description->length != 0 ? entry.description->length : maximum_size_;
}

void SdoServer::initiate_download(const can::Frame& frame, can::Time now) {
  const std::uint16_t index = sdo::index(frame);
  const std::uint8_t sub = frame.data[3];
  const auto entry = dictionary_->find(index, sub);
  if (!entry) return abort(index, sub, entry.error());
  const std::uint8_t object_length = entry->description->length;
  const bool size_indicated = (frame.data[0] & sdo::size_bit) != 0;
  if ((frame.data[0] & sdo::expedited_bit) != 0) {
    auto data = sdo::expedited_data(frame);
    if (!size_indicated && object_length != 0 && object_length < 4) data = data.first(object_length);
    const AbortCode code = dictionary_->write(index, sub, data, now);
    if (code != AbortCode::none) return abort(index, sub, code);
    sink_->send(sdo::frame(response_, 0x60, index, sub));
    return;
  }
  size_known_ = size_indicated;
  size_ = size_indicated ? sdo::value(frame) : 0;
  // Without a size, the access right and no more can be checked now.
  const AbortCode code = dictionary_->check_write(*entry, size_indicated ? size_ : object_length);
  if (code != AbortCode::none) return abort(index, sub, code);
  if (size_ > maximum_size(*entry)) return abort(index, sub, AbortCode::out_of_memory);
  begin(State::download_segment, frame, now);
  buffer_.clear();
  buffer_.reserve(size_);
  sink_->send(sdo::frame(response_, 0x60, index, sub));
}

void SdoServer::download_segment(const can::Frame& frame, can::Time now) {
  if (((frame.data[0] & sdo::toggle_bit) != 0) != toggle_) return abort(AbortCode::toggle_bit);
  last_heard_ = now;
  const auto data = sdo::segment_data(frame);
  const auto entry = dictionary_->find(index_, sub_);
  if (!entry) return abort(entry.error());
  const bool is_fixed = entry->description->length != 0;
  if (size_known_ && buffer_.size() + data.size() > size_) return abort(AbortCode::length_too_high);
  if (buffer_.size() + data.size() > maximum_size(*entry)) {
    return abort(is_fixed ? AbortCode::length_too_high : AbortCode::out_of_memory);
  }
  buffer_.insert(buffer_.end(), data.begin(), data.end());
  if ((frame.data[0] & sdo::last_bit) != 0) {
    if (size_known_ && buffer_.size() < size_) return abort(AbortCode::length_too_low);
    const AbortCode code = dictionary_->write(index_, sub_, buffer_, now);
    if (code != AbortCode::none) return abort(code);
    stop();
  }
  const unsigned toggle = toggle_ ? sdo::toggle_bit : 0U;
  toggle_ = !toggle_;
  sink_->send(sdo::frame(response_, 0x20U | toggle));
}

void SdoServer::initiate_upload(const can::Frame& frame, can::Time now) {
  const std::uint16_t index = sdo::index(frame);
  const std::uint8_t sub = frame.data[3];
  const auto value = dictionary_->read(index, sub, now);
  if (!value) return abort(index, sub, value.error());
  const std::size_t size = value->size();
  if (size >= 1 && size <= 4) {
    std::uint32_t number = 0;
    if (size == 4) {
      std::memcpy(&number, value->data(), 4);
    } else {
      std::copy_n(value->data(), size, reinterpret_cast<std::uint8_t*>(&number));
    }
    sink_->send(sdo::frame(response_, 0x43U | static_cast<unsigned>(4 - size) << 2, index, sub, number));
    return;
  }
  buffer_.assign(value->begin(), value->end());  // the value may change while the transfer runs
  size_ = size;
  begin(State::upload_segment, frame, now);
  sink_->send(sdo::frame(response_, 0x41, index, sub, static_cast<std::uint32_t>(size)));
}

void SdoServer::upload_segment(const can::Frame& frame, can::Time now) {
  if (((frame.data[0] & sdo::toggle_bit) != 0) != toggle_) return abort(AbortCode::toggle_bit);
  last_heard_ = now;
  const std::size_t count = std::min(size_ - position_, sdo::segment_size);
  const bool last = position_ + count == size_;
  can::Frame answer = sdo::frame(response_, toggle_ ? sdo::toggle_bit : 0U);
  sdo::put_segment(answer, buffer_.data() + position_, count, last);
  position_ += count;
  toggle_ = !toggle_;
  if (last) stop();
  sink_->send(answer);
}

void SdoServer::tick(can::Time now) {
  if (state_ == State::idle) {
    deadline_ = can::never;
    return;
  }
  const can::Time due = can::later(last_heard_, time_out_);
  if (now < due) {
    deadline_ = due;  // heard since the deadline was set
    return;
  }
  abort(AbortCode::timed_out);
}

}  // namespace canopus::canopen
