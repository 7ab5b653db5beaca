#pragma once
// A thread for long jobs that must not delay the plant: one job after the other, with a bounded queue.

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <thread>

namespace canopus::serve {

class Worker {
 public:
  using Work = std::function<void()>;

  /// At the end the work that waits is dropped or, with `finishes`, done; after `patience` the thread is left alone with
  /// what it hangs in. Work owns what it uses.
  Worker(std::size_t most_waiting, bool finishes, std::chrono::milliseconds patience);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// False: too much waits already. Never blocks.
  [[nodiscard]] bool add(Work work);

 private:
  struct State;
  std::shared_ptr<State> state_;
  std::chrono::milliseconds patience_;
  std::thread thread_;
};

}  // namespace canopus::serve
