#include "canopus/client/gateway/gateway_lss.hpp"

#include <algorithm>
#include <utility>

namespace canopus::client {

void GatewayLss::request(Ticket ticket, Request request, can::Time now) {
  jobs_.push_back({ticket, std::move(request)});
  start(now);
}

void GatewayLss::start(can::Time now) {
  if (running_ || jobs_.empty()) return;
  running_ = true;
  master_.set_time_out(jobs_.front().request.time_out);
  begin(jobs_.front().request.first, now);
}

void GatewayLss::begin(const Step& step, can::Time now) {
  if (!step.begin) {
    pause_ = can::later(now, step.pause);
    return;
  }
  const auto service = step.begin;
  (void)service(master_, now);
}

void GatewayLss::step_over(lss::LssResult result, can::Time now) {
  if (jobs_.empty()) return;
  auto& next = jobs_.front().request.next;
  if (const auto more = next ? next(result, master_, now) : std::nullopt) return begin(*more, now);
  // A client may make another request in the callback of its answer.
  const Job job = std::move(jobs_.front());
  jobs_.pop_front();
  if (job.request.done) job.request.done(result, master_, now);
  running_ = false;
  start(now);
}

void GatewayLss::lss_finished(lss::LssMaster&, lss::LssResult result, can::Time now) {
  step_over(result, now);
}

void GatewayLss::tick(can::Time now) {
  master_.tick(now);
  if (pause_ > now) return;
  pause_ = can::never;
  step_over(lss::LssResult::done, now);
}

void GatewayLss::call_off(Ticket ticket, can::Time now) {
  const auto job = std::ranges::find(jobs_, ticket, &Job::ticket);
  if (job == jobs_.end()) return;
  if (job->request.goes_on) {
    job->request.done = {};
    return;
  }
  const bool runs = running_ && job == jobs_.begin();
  jobs_.erase(job);
  if (!runs) return;
  master_.cancel();
  pause_ = can::never;
  running_ = false;
  start(now);
}

void GatewayLss::clear(can::Time now) {
  master_.cancel();
  pause_ = can::never;
  running_ = false;
  const auto jobs = std::exchange(jobs_, {});
  for (const Job& job : jobs) {
    if (job.request.done) job.request.done(lss::LssResult::refused, master_, now);
  }
}

}  // namespace canopus::client
