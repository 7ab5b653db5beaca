#include "canopus/serve/slices/plant_slices.hpp"

#include <algorithm>
#include <csignal>
#include <utility>

#include "canopus/can/timeline.hpp"

namespace canopus::serve {

WorkerThreads::WorkerThreads(std::size_t count) {
  // Signals are for the thread that runs the plant.
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  for (std::size_t i = 1; i < count; ++i) {
    threads_.emplace_back([this] { wait_for_work(); });
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

WorkerThreads::~WorkerThreads() {
  {
    const std::scoped_lock lock(mutex_);
    is_over_ = true;
  }
  has_work_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerThreads::run(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::unique_lock lock(mutex_);
  work_ = &work;
  next_ = 0;
  count_ = unfinished_ = count;
  has_work_.notify_all();
  work_while_possible(lock);
  is_done_.wait(lock, [this] { return unfinished_ == 0; });
  if (problem_) std::rethrow_exception(std::exchange(problem_, nullptr));
}

void WorkerThreads::wait_for_work() {
  std::unique_lock lock(mutex_);
  while (true) {
    has_work_.wait(lock, [this] { return is_over_ || next_ < count_; });
    if (is_over_) return;
    work_while_possible(lock);
  }
}

void WorkerThreads::work_while_possible(std::unique_lock<std::mutex>& lock) {
  while (next_ < count_) {
    const std::size_t piece = next_++;
    lock.unlock();
    std::exception_ptr problem;
    try {
      (*work_)(piece);
    } catch (...) {
      problem = std::current_exception();
    }
    lock.lock();
    if (problem && !problem_) problem_ = problem;
    if (--unfinished_ == 0) is_done_.notify_one();
  }
}

PlantSlices::PlantSlices(plant::Plant& plant, Use use)
    : plant_(plant),
      use_(std::move(use)),
      workers_(std::min(use_.threads, plant.timeline().partition_count())) {}

void PlantSlices::run_until(can::Time end) {
  do run_slice(end);
  while (plant_.timeline().now() < end);
}

void PlantSlices::run_slice(can::Time end) {
  can::Timeline& timeline = plant_.timeline();
  const can::Time slice_end = std::min(can::later(timeline.now(), slice_), end);
  const auto start = std::chrono::steady_clock::now();
  // Participants outside all partitions may access any of them.
  if (timeline.partition_count() == 0 || timeline.outside_next() <= slice_end) {
    timeline.run_until(slice_end);
  } else {
    workers_.run(timeline.partition_count(),
                 [&](std::size_t part) { timeline.partition(part).run_partition(slice_end); });
    plant_.parts_met(slice_end);
    if (use_.met) use_.met();
  }
  follow_the_clock(std::chrono::steady_clock::now() - start);
}

void PlantSlices::follow_the_clock(std::chrono::steady_clock::duration taken) noexcept {
  using namespace std::chrono_literals;
  if (taken < 20ms) slice_ = std::min(2 * slice_, use_.most);
  if (taken > 80ms) slice_ = std::max(slice_ / 2, use_.least);
}

}  // namespace canopus::serve
