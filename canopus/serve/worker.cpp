#include "canopus/serve/worker.hpp"

#include <condition_variable>
#include <csignal>
#include <deque>
#include <mutex>
#include <utility>

#include <pthread.h>

namespace canopus::serve {

struct Worker::State {
  std::size_t most_waiting = 0;
  bool finishes = false;
  std::mutex mutex;
  std::condition_variable has_work;
  std::condition_variable has_ended;
  std::deque<Work> waiting;
  bool is_over = false;
  bool is_done = false;

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      has_work.wait(lock, [this] { return is_over || !waiting.empty(); });
      if (waiting.empty() || (is_over && !finishes)) break;
      Work work = std::move(waiting.front());
      waiting.pop_front();
      lock.unlock();
      work();
      work = nullptr;
      lock.lock();
    }
    is_done = true;
    has_ended.notify_all();
  }
};

Worker::Worker(std::size_t most_waiting, bool finishes, std::chrono::milliseconds patience)
    : state_(std::make_shared<State>()), patience_(patience) {
  state_->most_waiting = most_waiting;
  state_->finishes = finishes;
  // Signals are for the thread that runs the plant.
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([state = state_] { state->run(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Worker::~Worker() {
  std::unique_lock lock(state_->mutex);
  state_->is_over = true;
  state_->has_work.notify_all();
  const bool is_done = state_->has_ended.wait_for(lock, patience_, [this] { return state_->is_done; });
  lock.unlock();
  if (is_done) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

bool Worker::add(Work work) {
  const std::scoped_lock lock(state_->mutex);
  if (state_->waiting.size() >= state_->most_waiting) return false;
  state_->waiting.push_back(std::move(work));
  state_->has_work.notify_one();
  return true;
}

}  // namespace canopus::serve
