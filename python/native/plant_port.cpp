#include <utility>

#include "plant_parts.hpp"
#include "plant_run.hpp"

namespace canopus::python {

PlantPort::PlantPort(std::shared_ptr<PlantRun> run, std::string_view bus, const std::string& name)
    : run_(std::move(run)) {
  PlantRun::Parts& parts = *run_->parts_;
  parts.check();
  parts.start();
  can::Bus& on = parts.bus(bus);
  attachment_ = std::make_shared<Attachment>(on, parts.timeline_of(on), name);
  parts.attachments.push_back(attachment_);
}

PlantPort::~PlantPort() { close(); }

void PlantPort::close() noexcept {
  PlantRun::Parts& parts = *run_->parts_;
  if (attachment_->port() == nullptr || parts.is_running) return;
  attachment_->leave();
  std::erase(parts.attachments, attachment_);
}

void PlantPort::send(const can::Frame& frame) {
  if (!offer(frame)) throw PlantProblem("the transmit queue is full: let time pass");
}

bool PlantPort::offer(const can::Frame& frame) {
  run_->parts_->check_between();
  if (attachment_->port() == nullptr) throw PlantProblem("the port is closed");
  return attachment_->port()->send(frame);
}

std::optional<TimedFrame> PlantPort::receive(can::Duration time_out) {
  run_->parts_->check();
  if (attachment_->port() == nullptr) throw PlantProblem("the port is closed");
  if (attachment_->frames.empty() && time_out > 0ns) {
    run_->parts_->drive(can::later(run_->now(), time_out), 0ns,
                        [this] { return !attachment_->frames.empty(); });
  }
  return next();
}

std::optional<TimedFrame> PlantPort::next() {
  if (attachment_->frames.empty()) return std::nullopt;
  const TimedFrame frame = attachment_->frames.front();
  attachment_->frames.pop_front();
  return frame;
}

std::size_t PlantPort::repeat(std::vector<can::Frame> frames, can::Duration period, can::Duration duration) {
  run_->parts_->check_between();
  if (attachment_->port() == nullptr) throw PlantProblem("the port is closed");
  if (frames.empty()) throw PlantProblem("there is no frame to repeat");
  if (period < 10us) throw PlantProblem("the period is less than 10 us");
  return attachment_->repeat(std::move(frames), period, duration);
}

bool PlantPort::change(std::size_t token, std::vector<can::Frame> frames) {
  run_->parts_->check_between();
  return attachment_->change(token, std::move(frames));
}

void PlantPort::stop(std::size_t token) {
  if (attachment_->port() == nullptr) return;
  run_->parts_->check_between();
  attachment_->stop(token);
}

void PlantPort::await(bool is_awaited) noexcept { attachment_->is_awaited = is_awaited; }
std::size_t PlantPort::waiting() const noexcept { return attachment_->frames.size(); }
std::uint64_t PlantPort::unsent() const noexcept { return attachment_->unsent; }
std::uint64_t PlantPort::lost() const noexcept { return attachment_->lost; }

std::string PlantPort::state() const {
  if (attachment_->port() == nullptr) throw PlantProblem("the port is closed");
  return std::string(can::name(attachment_->port()->error_state()));
}

}  // namespace canopus::python
