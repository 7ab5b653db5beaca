#pragma once
// Runs a plant ahead of any clock. Partitions, which share nothing (can::Timeline::add_partition), run
// independently in slices of plant time: one after the other, which keeps what they touch in the processor's
// caches, or on several threads. Their events are sorted at the end of each slice, so the output does not
// depend on slices or threads.

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::serve {

/// Threads that do pieces of work beside the one that has it done.
class WorkerThreads {
 public:
  /// The number of threads, including the caller of run(): 1 starts no others.
  explicit WorkerThreads(std::size_t count);
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  /// Calls `work` with 0 to count - 1, each once, and returns when all are done: what any of the threads has written is
  /// seen then. What `work` threw first is thrown here.
  void run(std::size_t count, const std::function<void(std::size_t)>& work);

 private:
  void wait_for_work();
  /// Takes pieces until none is left.
  void work_while_possible(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable has_work_;
  std::condition_variable is_done_;
  const std::function<void(std::size_t)>* work_ = nullptr;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::size_t unfinished_ = 0;
  std::exception_ptr problem_;
  bool is_over_ = false;
  std::vector<std::thread> threads_;
};

class PlantSlices {
 public:
  struct Use {
    std::size_t threads = 1;  ///< at most; never more than parts
    /// Plant time, > 0: of the first slice, and of the longest one. A slice is twice as long as the one before as long as that
    /// takes less than 20 ms of real time: the longer a part runs, the less often its memory has to come into the caches.
    can::Duration least = std::chrono::milliseconds(100);
    can::Duration most = std::chrono::milliseconds(3'200);
    /// Called when the partitions have joined, to deliver deferred events.
    std::function<void()> met{};
  };
  /// The plant must outlive it. The plant must not be accessed from outside while it runs.
  PlantSlices(plant::Plant& plant, Use use);

  /// As can::Timeline::run_until().
  void run_until(can::Time end);
  /// The same for one slice, which ends at `end` at the latest: for callers with periodic checks.
  void run_slice(can::Time end);

 private:
  void follow_the_clock(std::chrono::steady_clock::duration taken) noexcept;

  plant::Plant& plant_;
  Use use_;
  can::Duration slice_ = use_.least;
  WorkerThreads workers_;
};

}  // namespace canopus::serve
