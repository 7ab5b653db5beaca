#include "canopus/serve/replay_bus.hpp"

#include <algorithm>
#include <utility>

namespace canopus::serve {

/// Pause in plant time between portions of a trace with many frames at one moment.
constexpr can::Duration portion_pause = std::chrono::milliseconds(1);

std::expected<std::unique_ptr<ReplayBus>, std::string> ReplayBus::open(const std::string& path,
                                                                       std::string channel,
                                                                       can::Timeline& timeline,
                                                                       trace::KeepReading keep_reading) {
  auto reader = trace::open_trace(path, std::nullopt, std::move(keep_reading));
  if (!reader) return std::unexpected(reader.error());
  std::unique_ptr<ReplayBus> bus(new ReplayBus(std::move(*reader), std::move(channel), timeline));
  do {
    bus->read_next();
  } while (!bus->next_ && bus->at_ != can::never);
  const trace::LeftOut& left_out = bus->reader_->left_out();
  if (!bus->next_ && bus->channel_.empty() && bus->mistakes_ == 0 && left_out.frames() != 0)
    return std::unexpected(path + ": nothing of it was read; left out: " + left_out.text());
  if (!bus->next_ && !bus->mistake_.empty()) return std::unexpected(bus->mistake_);
  if (!bus->next_ && !bus->channel_.empty()) {
    std::string message = path + ": no frame of the channel \"" + bus->channel_ + "\"; expected one of";
    for (std::size_t i = 0; i < bus->reader_->channel_count(); ++i) {
      message += i == 0 ? " " : ", ";
      message += bus->reader_->channel(i);
    }
    return std::unexpected(std::move(message));
  }
  bus->set_alarm();
  timeline.add(*bus, "replay");
  return bus;
}

ReplayBus::ReplayBus(std::unique_ptr<trace::TraceReader> reader, std::string channel, can::Timeline& timeline)
    : reader_(std::move(reader)), channel_(std::move(channel)), timeline_(timeline) {}

bool ReplayBus::send(const can::Frame& frame) {
  if (sent_count_ == sent_.size()) return false;
  sent_[sent_count_++] = frame;
  set_alarm();
  return true;
}

void ReplayBus::tick(can::Time now) {
  if (!mistake_.empty()) {
    const std::string mistake = std::exchange(mistake_, {});
    if (user_ != nullptr) user_->bus_complains(mistake);
  }
  const std::size_t count = std::exchange(sent_count_, 0);
  const std::array<can::Frame, 16> sent = sent_;
  for (std::size_t i = 0; i < count && user_ != nullptr; ++i) user_->frame_sent(sent[i]);
  // More than any bus carries in a moment: an endless trace with equal times is played in portions.
  constexpr int most_at_once = 1000;
  for (int given = 0; at_ <= now; ++given) {
    if (given == most_at_once) {
      at_ = can::later(now, portion_pause);
      break;
    }
    const std::optional<trace::TraceRecord> due = next_;
    read_next();
    if (due && user_ != nullptr) user_->frame_received(due->frame);
  }
  set_alarm();
}

bool ReplayBus::wants(const trace::TraceRecord& record) const {
  return !record.error_frame && (channel_.empty() || reader_->channel(record.channel) == channel_);
}

void ReplayBus::read_next() {
  next_.reset();
  at_ = can::never;
  constexpr int most_mistakes = 1000;  // the plant waits meanwhile
  int mistakes_in_a_row = 0;
  constexpr int most_unwanted = 10'000;
  for (int unwanted = 0; unwanted < most_unwanted;) {
    auto record = reader_->next();
    if (!record) {  // the next call goes on behind it, where the format allows that
      if (++mistakes_ == 1) mistake_ = record.error();
      if (++mistakes_in_a_row < most_mistakes) continue;
      mistake_ =
          "so much of the trace cannot be read that it is no longer played back; last: " + record.error();
      return;
    }
    if (!*record) {
      const trace::LeftOut& left_out = reader_->left_out();
      if (left_out.frames() != 0) mistake_ = "left out of the trace: " + left_out.text();
      if (left_out.lost() != 0)
        mistake_ = "the recorder of the trace lost " + std::to_string(left_out.lost()) + " frames";
      if (mistakes_ > 1) mistake_ = std::to_string(mistakes_) + " parts of the trace could not be read";
      mistakes_ = 0;
      return;
    }
    if (!wants(**record)) {
      ++unwanted;
      continue;
    }
    if (!zero_) zero_ = (*record)->time;
    next_ = **record;
    // A trace whose time goes back is played back in its order.
    at_ = std::max(timeline_.now(), can::later(can::Time{}, (*record)->time - *zero_));
    return;
  }
  at_ = can::later(timeline_.now(), portion_pause);
}

}  // namespace canopus::serve
