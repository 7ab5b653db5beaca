#include "canopus/serve/slices/worker_threads.hpp"

#include <csignal>
#include <utility>

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

}  // namespace canopus::serve
