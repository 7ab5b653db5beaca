#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

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

}  // namespace canopus::serve
