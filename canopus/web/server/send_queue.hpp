#pragma once
// What waits for one watcher of the page, as JSON: events in their order, of too many the newest, the newest messages of the
// buses, the newest state and views, replies to its commands. No socket: the server asks for the next message when the last one has gone out.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace canopus::web {

/// The newest events, as many as have room by number and by size.
class WebEventList {
 public:
  using Text = std::shared_ptr<const std::string>;  ///< shared by all watchers
  static constexpr std::size_t most_bytes = 1U << 20;

  explicit WebEventList(std::size_t most) : most_(most) {}

  /// How many, the oldest first, have no room any more.
  std::size_t add(Text event) {
    bytes_ += event->size();
    events_.push_back(std::move(event));
    std::size_t gone = 0;
    for (; events_.size() > most_ || bytes_ > most_bytes; ++gone) {
      bytes_ -= events_.front()->size();
      events_.pop_front();
    }
    return gone;
  }
  void clear() noexcept {
    events_.clear();
    bytes_ = 0;
  }
  [[nodiscard]] bool empty() const noexcept { return events_.empty(); }
  [[nodiscard]] auto begin() const noexcept { return events_.begin(); }
  [[nodiscard]] auto end() const noexcept { return events_.end(); }

 private:
  std::size_t most_;
  std::deque<Text> events_;
  std::size_t bytes_ = 0;
};

class SendQueue {
 public:
  using Text = WebEventList::Text;
  static constexpr std::size_t most_reply_bytes = 32U << 20;  ///< that wait
  using LostEvent = std::function<std::string(std::uint64_t)>;

  /// `lost` makes the event for so many events that did not find room.
  SendQueue(std::size_t most_events, LostEvent lost) : events_(most_events), lost_(std::move(lost)) {}

  void add_event(Text event) { lost_events_ += events_.add(std::move(event)); }
  /// In place of one that has not gone out.
  void set_state(Text state) { state_ = std::move(state); }

  void set_messages(Text messages) { messages_ = std::move(messages); }

  /// Of its views the one of this number, in place of one that has not gone out.
  void set_view(std::size_t number, Text view) { views_.insert_or_assign(number, std::move(view)); }

  /// A reply to a command, none of which is lost. False: so many bytes wait that its watcher does not take them.
  [[nodiscard]] bool add_reply(std::string reply) {
    reply_bytes_ += reply.size();
    replies_.push_back(std::move(reply));
    return reply_bytes_ <= most_reply_bytes;
  }

  [[nodiscard]] std::size_t reply_bytes() const noexcept { return reply_bytes_; }
  [[nodiscard]] bool empty() const noexcept {
    return lost_events_ == 0 && events_.empty() && replies_.empty() && !messages_ && !state_ &&
           views_.empty();
  }
  /// A JSON array of all that waits.
  [[nodiscard]] std::string pop_all() {
    std::string message = "[";
    const auto add = [&](const std::string& event) {
      if (message.size() > 1) message += ",\n";
      message += event;
    };
    if (lost_events_ != 0) add(lost_(std::exchange(lost_events_, 0)));
    for (const Text& event : events_) add(*event);
    events_.clear();
    for (const std::string& reply : replies_) add(reply);
    replies_.clear();
    reply_bytes_ = 0;
    if (messages_) add(*std::exchange(messages_, nullptr));
    if (state_) add(*std::exchange(state_, nullptr));
    for (const auto& [number, view] : views_) add(*view);
    views_.clear();
    return message + "]";
  }

 private:
  WebEventList events_;
  LostEvent lost_;
  std::uint64_t lost_events_ = 0;
  std::deque<std::string> replies_;
  std::size_t reply_bytes_ = 0;
  Text messages_;
  Text state_;
  std::map<std::size_t, Text> views_;
};

}  // namespace canopus::web
