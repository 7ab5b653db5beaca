#include "canopus/canopen/sdo/sdo_server.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "canopus/canopen/sdo/sdo_frame.hpp"

namespace canopus::canopen {

using sdo::ClientCommand;

namespace {

/// The same as ObjectDictionary::entry_at(), in two stores.
Entry written_entry(ObjectDictionary::Location place, std::uint32_t multiplexer) {
  static_assert(sizeof(Entry) == 16 && offsetof(Entry, offset) == 8 && offsetof(Entry, index) == 12 &&
                offsetof(Entry, sub) == 14 && std::is_trivially_copyable_v<Entry>);
  const std::uint64_t where = place.offset | std::uint64_t{multiplexer >> 8} << 32;
  Entry entry;
  const std::uint64_t words[] = {reinterpret_cast<std::uintptr_t>(place.description), where};
  std::memcpy(static_cast<void*>(&entry), words, sizeof entry);
  return entry;
}

}  // namespace

void SdoServer::set_response_identifier(std::uint32_t identifier_key) {
  stop();
  response_ = sdo::head(identifier_key);
}

void SdoServer::close(bool complete) {
  ObjectStream* const stream = std::exchange(stream_, nullptr);
  if (stream != nullptr) static_cast<void>(stream->close(entry_, complete, last_heard_));
}

void SdoServer::stop() {
  state_ = State::idle;
  set_deadline(can::never);
  block_sender_.stop();
  close(false);
}

/// Silence within a sub-block after which the sender gets the number of the last good segment.
can::Duration SdoServer::pause() const noexcept {
  return time_out_ != can::Duration{} ? time_out_ / 4 : can::Duration(std::chrono::milliseconds(250));
}

void SdoServer::enter(State state, std::uint32_t multiplexer, can::Time now) {
  state_ = state;
  multiplexer_ = multiplexer;
  toggle_ = 0;
  last_heard_ = now;
  set_deadline(time_out_ != can::Duration{} ? can::later(now, time_out_) : can::never);
}

void SdoServer::abort(std::uint32_t multiplexer, AbortCode code) {
  stop();
  sink_->send(sdo::abort_frame(response_, multiplexer, code));
}

void SdoServer::abort(AbortCode code) { abort(multiplexer_, code); }

// What belongs to a transfer that runs well comes first.
void SdoServer::receive(const can::Frame& frame, can::Time now) {
  if (frame.dlc != 8) return receive_short(frame, now);
  const auto command = static_cast<ClientCommand>(frame.data[0] >> 5);
  if (state_ == State::idle) {
    if (command == ClientCommand::initiate_upload) return initiate_upload(frame, now);
    constexpr unsigned sized = sdo::expedited_bit | sdo::size_bit;
    constexpr unsigned expedited_download = 0x20U | sized;
    if ((frame.data[0] & (0xE0U | sized)) == expedited_download) return download_expedited(frame, now);
    return receive_other(frame, now);
  }
  switch (state_) {
    case State::download_segment:
      if (command == ClientCommand::download_segment) return download_segment(frame, now);
      break;
    case State::upload_segment:
      if (command == ClientCommand::upload_segment) return upload_segment(frame, now);
      break;
    case State::block_download:
      if (frame.data[0] != 0x80) return block_segment(frame, now);  // 81H.. is the last segment
      break;
    default: break;
  }
  receive_other(frame, now);
}

void SdoServer::receive_short(const can::Frame& frame, can::Time now) {
  if (!accepts_short_requests_ || frame.dlc == 0 || frame.dlc > 8 || frame.dlc < needed_bytes(frame)) return;
  can::Frame filled_up = frame;
  std::fill(filled_up.data.begin() + frame.dlc, filled_up.data.end(), std::uint8_t{0});
  filled_up.dlc = 8;
  receive(filled_up, now);
}

/// Bytes of a request that mean something; those after them are 0 or do not count.
std::size_t SdoServer::needed_bytes(const can::Frame& request) const noexcept {
  constexpr std::size_t all = 8;
  constexpr std::size_t command = 1;
  constexpr std::size_t command_and_object = 4;
  if (state_ == State::block_download && request.data[0] != 0x80) return all;  // a segment
  const unsigned first = request.data[0];
  switch (static_cast<ClientCommand>(first >> 5)) {
    case ClientCommand::download_segment: return command + sdo::segment_length(request);
    case ClientCommand::initiate_download:
      if ((first & sdo::size_bit) == 0) return (first & sdo::expedited_bit) != 0 ? all : command_and_object;
      return (first & sdo::expedited_bit) != 0 ? command_and_object + sdo::expedited_data(request).size()
                                               : all;
    case ClientCommand::initiate_upload: return command_and_object;
    case ClientCommand::upload_segment: return command;
    case ClientCommand::abort: return command;
    default: return all;
  }
}

void SdoServer::receive_other(const can::Frame& frame, can::Time now) {
  const auto command = static_cast<ClientCommand>(frame.data[0] >> 5);
  if (state_ == State::block_download_end && block_receiver_.is_last_segment_again(frame)) return;
  if (command == ClientCommand::abort) return stop();
  if (state_ == State::idle && command == ClientCommand::initiate_download) {
    return initiate_other_download(frame, now);
  }
  if (state_ == State::idle && command == ClientCommand::block_upload)
    return initiate_block_upload(frame, now);
  if (state_ == State::idle && command == ClientCommand::block_download) {
    return initiate_block_download(frame, now);
  }
  if (state_ == State::idle) return abort(0, AbortCode::command_specifier);
  receive_in_block(frame, now);
}

AbortCode SdoServer::begin_download(const can::Frame& frame, State state, bool size_indicated,
                                    std::size_t slack, can::Time now) {
  const auto entry = dictionary_->find(sdo::index(frame), frame.data[3]);
  if (!entry) return entry.error();
  const std::uint8_t object_length = entry->description->length;
  const std::size_t size = sdo::value(frame);
  // Without a size, the access right and no more can be checked now.
  const AbortCode code = dictionary_->check_write(*entry, size_indicated ? size : object_length);
  if (code != AbortCode::none) return code;
  const std::optional<std::size_t> announced = size_indicated ? std::optional(size) : std::nullopt;
  entry_ = *entry;
  stream_ = dictionary_->stream(*entry);
  std::size_t maximum = object_length != 0 ? object_length : maximum_size_;
  if (stream_ != nullptr) {
    maximum = std::numeric_limits<std::size_t>::max() / 2;
    const AbortCode refusal = stream_->open_write(*entry, announced, now);
    if (refusal != AbortCode::none) {
      stream_ = nullptr;
      return refusal;
    }
  } else if (announced && *announced > maximum) {
    return AbortCode::out_of_memory;
  }
  collector_.begin(stream_, maximum,
                   object_length != 0 ? AbortCode::length_too_high : AbortCode::out_of_memory, announced,
                   slack);
  enter(state, sdo::multiplexer(frame), now);
  return AbortCode::none;
}

AbortCode SdoServer::store_download(can::Time now) {
  if (stream_ != nullptr) return std::exchange(stream_, nullptr)->close(entry_, true, now);
  return dictionary_->write(static_cast<std::uint16_t>(multiplexer_ >> 8),
                            static_cast<std::uint8_t>(multiplexer_ >> 24), collector_.bytes(), now);
}

void SdoServer::expedited_download(const can::Frame& frame, const Entry& entry, can::Time now) {
  const std::uint8_t object_length = entry.description->length;
  auto data = sdo::expedited_data(frame);
  const bool size_indicated = (frame.data[0] & sdo::size_bit) != 0;
  if (!size_indicated && object_length != 0 && object_length < 4) data = data.first(object_length);
  AbortCode code = AbortCode::none;
  if (ObjectStream* stream = dictionary_->stream(entry)) {
    code = dictionary_->check_write(entry, data.size());
    if (code == AbortCode::none) code = stream->open_write(entry, data.size(), now);
    if (code != AbortCode::none) return abort(sdo::multiplexer(frame), code);
    code = stream->write(data);
    const AbortCode at_close = stream->close(entry, code == AbortCode::none, now);
    if (code == AbortCode::none) code = at_close;
  } else {
    code = dictionary_->write(entry.index, entry.sub, data, now);
  }
  if (code != AbortCode::none) return abort(sdo::multiplexer(frame), code);
  sink_->send(sdo::frame(response_, 0x60, sdo::multiplexer(frame)));
}

/// A size is indicated. In two steps: the search of the value, which calls no other function, saves few registers.
void SdoServer::download_expedited(const can::Frame& frame, can::Time now) {
  const auto place = dictionary_->find_plain(static_cast<std::uint32_t>(data_word(frame)));
  const auto length = static_cast<std::uint8_t>(4U - (frame.data[0] >> 2 & 3U));
  if (place.description == nullptr || !dictionary_->store_short(place, {sdo::value(frame), length})) {
    return initiate_other_download(frame, now);
  }
  short_written(sdo::multiplexer(frame), place, now);
}

[[gnu::noinline]] void SdoServer::short_written(std::uint32_t multiplexer, ObjectDictionary::Location place,
                                                can::Time now) {
  const Entry entry = written_entry(place, multiplexer);  // stays beside the frame, which saves a register
  dictionary_->report_written(entry, now);
  sink_->send(sdo::frame(response_, 0x60, multiplexer));
}

void SdoServer::initiate_other_download(const can::Frame& frame, can::Time now) {
  if ((frame.data[0] & sdo::expedited_bit) != 0) {
    const auto entry = dictionary_->find(sdo::index(frame), frame.data[3]);
    if (!entry) return abort(sdo::multiplexer(frame), entry.error());
    return expedited_download(frame, *entry, now);
  }
  const bool size_indicated = (frame.data[0] & sdo::size_bit) != 0;
  const AbortCode code = begin_download(frame, State::download_segment, size_indicated, 0, now);
  if (code != AbortCode::none) return abort(sdo::multiplexer(frame), code);
  sink_->send(sdo::frame(response_, 0x60, sdo::multiplexer(frame)));
}

void SdoServer::download_segment(const can::Frame& frame, can::Time now) {
  last_heard_ = now;
  // Not the last one, with the toggle bit that is due, and nothing to see to.
  const unsigned toggle = frame.data[0] & ~sdo::unused_bits;
  if (toggle != toggle_ || !collector_.add_plain(frame, sdo::segment_length(frame)))
    return receive_segment_checked(frame, now);
  toggle_ ^= sdo::toggle_bit;
  sink_->send(sdo::frame(response_, 0x20U | toggle));
}

/// The last segment, or one that is more than a copy.
void SdoServer::receive_segment_checked(const can::Frame& frame, can::Time now) {
  const unsigned toggle = frame.data[0] & sdo::toggle_bit;
  if (toggle != toggle_) return abort(AbortCode::toggle_bit);
  AbortCode code = collector_.add(frame, sdo::segment_length(frame));
  if ((frame.data[0] & sdo::last_bit) != 0) {
    if (code == AbortCode::none) code = collector_.finish(0);
    if (code == AbortCode::none) code = store_download(now);
    if (code == AbortCode::none) stop();
  }
  if (code != AbortCode::none) return abort(code);
  toggle_ ^= sdo::toggle_bit;
  sink_->send(sdo::frame(response_, 0x20U | toggle));
}

AbortCode SdoServer::begin_upload(const Entry& entry, can::Time now) {
  entry_ = entry;
  stream_ = dictionary_->stream(entry);
  if (stream_ == nullptr) {
    const auto value = dictionary_->bytes(entry);
    size_ = value.size();
    source_.begin(source_.own_copy(value));
    return AbortCode::none;
  }
  const auto size = stream_->open_read(entry, now);
  if (!size) {
    stream_ = nullptr;
    return size.error();
  }
  size_ = *size;
  source_.begin(*stream_);
  return source_.prepare(0);
}

void SdoServer::initiate_upload(const can::Frame& frame, can::Time now) {
  const auto value = dictionary_->read_short(sdo::multiplexer(frame));
  if (value.length == 0) return initiate_other_upload(frame, now);
  answer_expedited(sdo::multiplexer(frame), value);
}

inline void SdoServer::answer_expedited(std::uint32_t multiplexer, ObjectDictionary::ShortValue value) {
  sink_->send(sdo::frame(response_, 0x43U | (4U - value.length) << 2, multiplexer, value.number));
}

void SdoServer::initiate_other_upload(const can::Frame& frame, can::Time now) {
  Entry entry;
  const AbortCode refusal = dictionary_->prepare_read(sdo::index(frame), frame.data[3], now, entry);
  if (refusal != AbortCode::none) return abort(sdo::multiplexer(frame), refusal);
  const std::uint8_t length = entry.description->length;
  if (length >= 1 && length <= 4) {
    return answer_expedited(sdo::multiplexer(frame), {dictionary_->get<std::uint32_t>(entry), length});
  }
  multiplexer_ = sdo::multiplexer(frame);
  if (const AbortCode code = begin_upload(entry, now); code != AbortCode::none) return abort(code);
  answer_upload(now);
}

/// The initiate response of an upload that is not in blocks: expedited if it fits.
void SdoServer::answer_upload(can::Time now) {
  const bool fits = size_ && *size_ >= 1 && *size_ <= 4 && source_.window().size() >= *size_;
  if (fits) {
    std::uint32_t number = 0;
    std::copy_n(source_.window().data(), *size_, reinterpret_cast<std::uint8_t*>(&number));
    close(true);
    const auto unused = static_cast<unsigned>(4 - *size_);
    stop();
    sink_->send(sdo::frame(response_, 0x43U | unused << 2, multiplexer_, number));
    return;
  }
  enter(State::upload_segment, multiplexer_, now);
  sink_->send(sdo::frame(response_, size_ ? 0x41 : 0x40, multiplexer_,
                         static_cast<std::uint32_t>(size_.value_or(0))));
}

void SdoServer::upload_segment(const can::Frame& frame, can::Time now) {
  if ((frame.data[0] & sdo::toggle_bit) != toggle_) return abort(AbortCode::toggle_bit);
  last_heard_ = now;
  const auto rest = source_.window();
  if (rest.size() <= sdo::segment_size) return upload_last_segment();
  source_.advance(sdo::segment_size);
  const can::Frame answer = sdo::block_segment(response_, toggle_, rest);
  toggle_ ^= sdo::toggle_bit;
  sink_->send(answer);
}

/// The last one at hand: perhaps of all.
void SdoServer::upload_last_segment() {
  if (const AbortCode code = source_.prepare(sdo::segment_size); code != AbortCode::none) return abort(code);
  const auto window = source_.window();
  const std::size_t count = std::min(window.size(), sdo::segment_size);
  const bool last = count == window.size() && source_.ends_in_window();
  const can::Frame answer = sdo::segment(response_, toggle_, window, last);
  source_.advance(count);
  toggle_ ^= sdo::toggle_bit;
  if (last) {
    close(true);
    stop();
  }
  sink_->send(answer);
}

void SdoServer::tick(can::Time now) {
  if (state_ == State::idle) return;
  if (time_out_ != can::Duration{} && now >= can::later(last_heard_, time_out_)) {
    return abort(AbortCode::timed_out);
  }
  if (state_ == State::block_upload && block_sender_.is_sending())
    return send_block(now);  // the transmit queue was full
  const can::Time end = time_out_ != can::Duration{} ? can::later(last_heard_, time_out_) : can::never;
  if (state_ != State::block_download) return set_deadline(end);
  const bool is_silent = now >= can::later(last_heard_, pause());
  set_deadline(std::min(end, can::later(is_silent ? now : last_heard_, pause())));
  if (is_silent && block_receiver_.may_confirm_early()) {
    sink_->send(block_receiver_.early_confirmation(response_));
  }
}

}  // namespace canopus::canopen
