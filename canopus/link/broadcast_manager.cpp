#include "canopus/link/broadcast_manager.hpp"

#include <algorithm>
#include <utility>

#include "canopus/can/little_endian.hpp"

namespace canopus::link {
namespace {

CanIdentifier identifier_of(const can::Frame& frame) noexcept { return {frame.identifier, frame.extended}; }

BroadcastManager::Content content_of(const can::Frame& frame) noexcept {
  return can::load_value(frame.bytes());
}

}  // namespace

bool BroadcastManager::add(const can::Frame& frame, can::Duration period, can::Time now) {
  const CanIdentifier identifier = identifier_of(frame);
  if (jobs_.size() >= most_jobs && !jobs_.contains(identifier)) return false;
  Job& job = jobs_[identifier];
  job = {.frame = frame, .period = period};
  if (period != can::Duration{}) job.period = std::max(period, least_period);
  job.next = now;
  send(job, now);
  set_alarm();
  return true;
}

bool BroadcastManager::update(const can::Frame& frame) {
  const auto job = jobs_.find(identifier_of(frame));
  if (job == jobs_.end()) return false;
  job->second.frame = frame;
  return true;
}

bool BroadcastManager::remove(CanIdentifier identifier) {
  const bool was_there = jobs_.erase(identifier) != 0;
  set_alarm();
  return was_there;
}

void BroadcastManager::send(Job& job, can::Time now) {
  if (!bus_.send(job.frame)) {
    job.next = can::later(now, std::max(job.period, full_queue_retry));
  } else if (job.period == can::Duration{}) {
    job.next = can::never;
  } else {
    job.next = can::later(job.next, job.period);
    if (job.next <= now) job.next = can::later(now, job.period);  // periods that were missed are not sent
  }
}

bool BroadcastManager::subscribe(CanIdentifier identifier, can::Duration interval) {
  return set(identifier, {.passes_all = true, .contents = {Compared{}}, .interval = interval});
}

bool BroadcastManager::filter(CanIdentifier identifier, Content mask, can::Duration interval) {
  return set(identifier, {.contents = {Compared{.content = mask}}, .interval = interval});
}

bool BroadcastManager::filter_multiplex(CanIdentifier identifier, Content selector,
                                        const std::vector<Content>& contents, can::Duration interval) {
  Filter filter{.selector = selector, .interval = interval};
  for (const Content content : contents) filter.contents.push_back({.content = content});
  return set(identifier, std::move(filter));
}

bool BroadcastManager::set(CanIdentifier identifier, Filter filter) {
  std::size_t contents = filter.contents.size();
  for (const auto& [key, other] : filters_) {
    if (key != identifier) contents += other.contents.size();
  }
  const bool is_full = filters_.size() >= most_filters && !filters_.contains(identifier);
  if (is_full || contents > most_contents) return false;
  filters_[identifier] = std::move(filter);
  set_alarm();
  return true;
}

bool BroadcastManager::unsubscribe(CanIdentifier identifier) {
  const bool was_there = filters_.erase(identifier) != 0;
  set_alarm();
  return was_there;
}

void BroadcastManager::clear() {
  jobs_.clear();
  filters_.clear();
  set_alarm();
}

void BroadcastManager::receive(const can::Frame& frame, can::Time now) {
  if (frame.remote || filters_.empty()) return;
  const auto found = filters_.find(identifier_of(frame));
  if (found == filters_.end()) return;
  Filter& filter = found->second;
  const Content content = content_of(frame);
  for (Compared& compared : filter.contents) {
    const bool is_its_number = (content & filter.selector) == (compared.content & filter.selector);
    if (!is_its_number) continue;
    const bool is_new =
        filter.passes_all || !compared.last || ((*compared.last ^ content) & compared.content) != 0;
    if (!is_new) continue;
    compared.last = content;
    pass(filter, compared, frame, now);
  }
  set_alarm();
}

void BroadcastManager::pass(Filter& filter, Compared& compared, const can::Frame& frame, can::Time now) {
  if (now < filter.next) {
    compared.waiting = {frame, now};
    filter.flush = filter.next;
    return;
  }
  if (filter.interval != can::Duration{}) filter.next = can::later(now, filter.interval);
  receiver_.filtered_frame(frame, now);
}

void BroadcastManager::flush(Filter& filter, can::Time now) {
  filter.flush = can::never;
  filter.next = can::later(now, filter.interval);
  for (Compared& compared : filter.contents) {
    if (const auto waiting = std::exchange(compared.waiting, std::nullopt))
      receiver_.filtered_frame(waiting->frame, waiting->time);
  }
}

void BroadcastManager::tick(can::Time now) {
  for (auto& [identifier, job] : jobs_) {
    if (job.next <= now) send(job, now);
  }
  for (auto& [identifier, filter] : filters_) {
    if (filter.flush <= now) flush(filter, now);
  }
  set_alarm();
}

void BroadcastManager::set_alarm() {
  can::Time next = can::never;
  for (const auto& [identifier, job] : jobs_) next = std::min(next, job.next);
  for (const auto& [identifier, filter] : filters_) next = std::min(next, filter.flush);
  alarm() = next;
}

}  // namespace canopus::link
