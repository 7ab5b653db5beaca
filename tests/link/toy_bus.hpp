#pragma once
// A bus for the tests of this room: frames are delivered in the order they were queued when run() is called,
// in no time, to everyone but the sender. It stands in for the simulated bus, which this room does not know.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "canopus/link/loop_clock.hpp"
#include "canopus/link/socketcand_server.hpp"

namespace canopus::link {

class ToyBus final : public LoopClock {
 public:
  /// Frames that may wait to be delivered before send() refuses.
  std::size_t room = 1000;
  /// Attachments given out; 0 = attach() refuses.
  std::size_t places = 1000;
  can::Time time{};
  /// The present: now() brings the bus up to it.
  can::Time wall{};
  can::Time joined{};  ///< when somebody joined last
  AttachedClient* newest = nullptr;
  can::Time left{};  ///< when somebody left last
  int touches = 0;
  std::vector<can::Frame> delivered;
  /// Whether clients may have bit rates of their own, and those they asked for.
  bool own_bit_rates = true;
  std::vector<std::uint32_t> bit_rates;

  AttachToBus attach() {
    return [this](AttachedClient& participant) -> std::unique_ptr<BusAttachment> {
      if (participants_.size() >= places) return nullptr;
      participants_.push_back(&participant);
      joined = time;
      newest = &participant;
      return std::make_unique<Place>(*this, participant);
    };
  }

  can::Time now() override {
    time = std::max(time, wall);
    return time;
  }
  void touched() override { ++touches; }

  [[nodiscard]] std::size_t participants() const { return participants_.size(); }
  [[nodiscard]] std::size_t waiting() const { return queue_.size(); }

  /// A frame of a node that is not in the test.
  void inject(const can::Frame& frame) { deliver(nullptr, frame); }

  /// Delivers everything that waits.
  void run() {
    while (!queue_.empty()) run_one();
  }
  /// Delivers the frame that waits longest, if there is one.
  void run_one() {
    if (queue_.empty()) return;
    const auto [sender, frame] = queue_.front();
    queue_.pop_front();
    deliver(sender, frame);
    if (is_here(sender)) sender->transmitted(frame, time);
  }

  /// Moves time on and ticks whose deadline has come.
  void advance(can::Duration duration) {
    time += duration;
    const auto here = participants_;
    for (can::Participant* participant : here) {
      if (is_here(participant) && participant->deadline() <= time) participant->tick(time);
    }
  }

 private:
  class Place final : public BusAttachment {
   public:
    Place(ToyBus& bus, can::Participant& participant) : bus_(bus), participant_(participant) {}
    ~Place() override {
      bus_.left = bus_.time;
      std::erase(bus_.participants_, &participant_);
      std::erase_if(bus_.queue_, [this](const auto& entry) { return entry.first == &participant_; });
    }
    bool send(const can::Frame& frame) override {
      if (bus_.queue_.size() >= bus_.room) return false;
      bus_.queue_.emplace_back(&participant_, frame);
      return true;
    }
    bool restart(std::uint32_t bit_rate) override {
      bus_.bit_rates.push_back(bit_rate);
      std::erase_if(bus_.queue_, [this](const auto& entry) { return entry.first == &participant_; });
      return bus_.own_bit_rates;
    }

   private:
    ToyBus& bus_;
    can::Participant& participant_;
  };

  [[nodiscard]] bool is_here(const can::Participant* participant) const {
    return std::ranges::find(participants_, participant) != participants_.end();
  }
  void deliver(const can::Participant* sender, const can::Frame& frame) {
    delivered.push_back(frame);
    const auto here = participants_;
    for (can::Participant* participant : here) {
      if (participant != sender) participant->receive(frame, time);
    }
  }

  std::vector<can::Participant*> participants_;
  std::deque<std::pair<can::Participant*, can::Frame>> queue_;
};

}  // namespace canopus::link
