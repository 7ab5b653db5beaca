#include "canopus/serve/real_time_thread.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>

namespace canopus::serve {

std::vector<std::string> request_real_time(const RealTimeThread& wanted) {
  constexpr std::string_view rights =
      "run it as root, or give it the rights once: sudo setcap cap_sys_nice,cap_ipc_lock=ep $(which canopus)";
  std::vector<std::string> refused;
  if (wanted.processor) {
    cpu_set_t processors;
    CPU_ZERO(&processors);
    if (*wanted.processor < CPU_SETSIZE) CPU_SET(*wanted.processor, &processors);
    if (::sched_setaffinity(0, sizeof processors, &processors) != 0) {
      refused.push_back(
          fmt::format("processor {} cannot be had ({})", *wanted.processor, std::strerror(errno)));
    }
  }
  sched_param parameters{};
  parameters.sched_priority = wanted.priority;
  // Threads and processes that are started later do not inherit it: they would keep the others waiting.
  if (::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) != 0) {
    refused.push_back(fmt::format("scheduling in real time (SCHED_FIFO) is refused ({}); {}",
                                  std::strerror(errno), rights));
  }
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    refused.push_back(fmt::format("locked memory is refused ({}); {}", std::strerror(errno), rights));
  }
  return refused;
}

}  // namespace canopus::serve
