#pragma once
// END processing, as far as clients see it. A CPU with a scan looks at what has been asked of it between two runs of its
// program; so what the requests of one scan read and write is of one moment, X, Y, devices and buffer memory alike.
//
// Who has received a request says so with wait(), and is asked for its answers at the next END, in the order in which
// they said so. While plant time stands still (a plant that is driven in step) END processing stays open: whoever would
// wait is answered at once.

#include <algorithm>
#include <vector>

#include "canopus/can/time.hpp"

namespace canopus::plc {

class EndProcessing {
 public:
  /// Who has requests: a client's connection, or a port for datagrams.
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
  /// What waited does not any more.
  void leave(Requests& requests) noexcept {
    std::erase(waiting_, &requests);
    std::ranges::replace(present_, &requests, nullptr);
  }

  /// The END of a scan: all that wait are answered. What comes of it (a reset of the CPU) is no further END.
  void answer(can::Time now) {
    if (!present_.empty()) return;
    present_.swap(waiting_);
    for (std::size_t i = 0; i < present_.size(); ++i)
      if (present_[i] != nullptr) present_[i]->answer_requests(now);
    present_.clear();
  }

  /// From now on nobody has to wait, and who waited is answered; or they do again.
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
