#pragma once
// END processing, as far as clients observe it. A CPU with a scan processes requests between two runs of its
// program; so all requests of one scan read and write the same moment of X, Y, devices and buffer memory.
//
// A server calls wait() for a received request, and its requests are processed at the next END, in the order
// of wait(). While plant time stands still (a plant that is driven in step) END processing stays open:
// requests are processed at once.

#include <algorithm>
#include <vector>

#include "canopus/can/time.hpp"

namespace canopus::plc {

class EndProcessing {
 public:
  /// A source of requests: a client's connection, or a port for datagrams.
  class Requests {
   public:
    /// Answers what has been received. It may wait() again, for the END after this one, and leave others out. The timeline
    /// runs meanwhile, and another client may be answered: no asynchronous read may be filling the session's buffer.
    virtual void answer_requests(can::Time now) = 0;

   protected:
    ~Requests() = default;
  };

  /// Is answered at the next END; again before that changes nothing. It must live until then, or leave().
  void wait(Requests& requests) {
    if (std::ranges::find(waiting_, &requests) == waiting_.end()) waiting_.push_back(&requests);
  }
  /// Removes it from the waiting ones.
  void leave(Requests& requests) noexcept {
    std::erase(waiting_, &requests);
    std::ranges::replace(present_, &requests, nullptr);
  }

  /// The END of a scan: answers all waiting requests. A consequence (a reset of the CPU) is no further END.
  void answer(can::Time now) {
    if (!present_.empty()) return;
    present_.swap(waiting_);
    for (std::size_t i = 0; i < present_.size(); ++i)
      if (present_[i] != nullptr) present_[i]->answer_requests(now);
    present_.clear();
  }

  /// true: requests are processed at once from now on, waiting ones now; false: they wait for END again.
  void stay_open(bool open, can::Time now) {
    is_open_ = open;
    if (open) answer(now);
  }
  [[nodiscard]] bool is_open() const noexcept { return is_open_; }

 private:
  std::vector<Requests*> waiting_;
  std::vector<Requests*> present_;  // of the END that goes on; nullptr: has left
  bool is_open_ = false;
};

}  // namespace canopus::plc
