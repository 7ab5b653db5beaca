#pragma once
// The broadcast manager of one client: frames that are sent in a period, and filters that pass on frames of some identifiers,
// only when their content changes, and not too often. It does what SocketCAN's does [Linux Documentation/networking/can.rst, 4.2],
// but passes on no frames that its own client sent.
//
// Jobs and filters are known by their identifier: a second one of it takes the place of the first.

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/can/frame.hpp"

namespace canopus::link {

struct CanIdentifier {
  std::uint32_t number = 0;
  bool extended = false;
  friend auto operator<=>(const CanIdentifier&, const CanIdentifier&) = default;
};

class BroadcastManager final : public can::Ticker {
 public:
  /// Gets the frames that pass a filter; `time` is when they were on the bus.
  class Receiver {
   public:
    virtual void filtered_frame(const can::Frame& frame, can::Time time) = 0;

   protected:
    ~Receiver() = default;
  };

  /// Data bytes as a number, the first in bits 0 to 7.
  using Content = std::uint64_t;

  static constexpr std::size_t most_jobs = 64;
  static constexpr std::size_t most_filters = 256;
  static constexpr std::size_t most_contents = 4096;  ///< of all multiplex filters together
  /// No period is shorter: the shortest frame at 1 Mbit/s.
  static constexpr can::Duration least_period = std::chrono::microseconds(47);
  /// Until a frame that the bus refused is tried again.
  static constexpr can::Duration full_queue_retry = std::chrono::milliseconds(1);

  BroadcastManager(can::Sink& bus, Receiver& receiver) : bus_(bus), receiver_(receiver) {}

  /// Sends the frame now, then each `period`; 0: never again. False: there are most_jobs.
  bool add(const can::Frame& frame, can::Duration period, can::Time now);
  /// Another content for a job, whose times stay. False: no frame of this identifier is sent.
  bool update(const can::Frame& frame);
  /// False: no frame of this identifier is sent.
  bool remove(CanIdentifier identifier);

  /// Passes on every frame; `interval`: the least time from one to the next, of which the latest comes, 0: none. False: there are
  /// most_filters.
  bool subscribe(CanIdentifier identifier, can::Duration interval);
  /// Passes on the first frame and each that differs from the one before in these bits.
  bool filter(CanIdentifier identifier, Content mask, can::Duration interval);
  /// The bits of `selector` are the number of a multiplex message. A content has in these bits the number that it is for, in the
  /// others those that are compared; numbers without a content are not passed on. False as above, or with most_contents.
  bool filter_multiplex(CanIdentifier identifier, Content selector, const std::vector<Content>& contents,
                        can::Duration interval);
  /// Takes a subscription or filter out. False: there is none.
  bool unsubscribe(CanIdentifier identifier);

  /// Ends all jobs and filters.
  void clear();

  /// A frame of the bus. Remote frames pass no filter.
  void receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now) override;

 private:
  struct Job {
    can::Frame frame{};
    can::Duration period{};
    can::Time next = can::never;
  };
  struct Passed {
    can::Frame frame{};
    can::Time time{};
  };
  /// What is compared of the frames with one multiplex number, or of all.
  struct Compared {
    Content content = 0;
    std::optional<Content> last{};
    std::optional<Passed> waiting{};  // for the end of the interval
  };
  struct Filter {
    bool passes_all = false;
    Content selector = 0;
    std::vector<Compared> contents{};
    can::Duration interval{};
    can::Time next{};              // when a frame may be passed on again
    can::Time flush = can::never;  // when those that wait are
  };

  bool set(CanIdentifier identifier, Filter filter);
  void send(Job& job, can::Time now);
  void pass(Filter& filter, Compared& compared, const can::Frame& frame, can::Time now);
  void flush(Filter& filter, can::Time now);
  void set_alarm();

  can::Sink& bus_;
  Receiver& receiver_;
  std::map<CanIdentifier, Job> jobs_;
  std::map<CanIdentifier, Filter> filters_;
};

}  // namespace canopus::link
