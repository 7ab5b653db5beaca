#include "canopus/cli/run/run_messages.hpp"

#include <algorithm>
#include <utility>

namespace canopus::cli {

void RunMessages::add(RunMessage message) {
  ++(message.is_error ? errors_ : warnings_);
  if (!message.is_printed) ++unprinted_;
  if (first_.size() < first_kept) {
    first_.push_back(std::move(message));
    return;
  }
  latest_.push_back(std::move(message));
  if (latest_.size() > latest_kept) latest_.pop_front();
}

std::vector<RunMessage> RunMessages::latest(std::size_t count) const {
  const std::size_t of_latest = std::min(count, latest_.size());
  const std::size_t of_first = std::min(count - of_latest, first_.size());
  std::vector<RunMessage> some(first_.end() - static_cast<std::ptrdiff_t>(of_first), first_.end());
  some.insert(some.end(), latest_.end() - static_cast<std::ptrdiff_t>(of_latest), latest_.end());
  return some;
}

void RunMessages::print(const RunMessage& message, Output& out) {
  out.line("{:>12.6f}  {}", can::seconds(message.time), message.text);
}

void RunMessages::print(Output& out) const {
  const auto waits = [](const RunMessage& message) { return !message.is_printed; };
  const auto kept = std::ranges::count_if(first_, waits) + std::ranges::count_if(latest_, waits);
  for (const RunMessage& message : first_) {
    if (waits(message)) print(message, out);
  }
  const std::uint64_t lost = unprinted_ - static_cast<std::uint64_t>(kept);
  if (lost != 0) out.line("              ... {} more here, which were not kept", lost);
  for (const RunMessage& message : latest_) {
    if (waits(message)) print(message, out);
  }
}

}  // namespace canopus::cli
