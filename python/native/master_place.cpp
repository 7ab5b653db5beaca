#include "master_place.hpp"

#include <algorithm>
#include <utility>

#include <pybind11/pybind11.h>

#include "canopus/link/bus_address.hpp"
#include "canopus/link/bus_loop.hpp"

#include "plant_parts.hpp"

namespace canopus::python {

class PlantPlace final : public MasterPlace, private PlantGuest {
 public:
  PlantPlace(std::shared_ptr<PlantRun> run, const std::string& bus) : run_(std::move(run)) {
    PlantRun::Parts& parts = *run_->parts_;
    parts.check();
    parts.start();
    can::Bus& on = parts.bus(bus);
    timeline_ = &parts.timeline_of(on);
    port_ = &on.add_port("master");
    parts.guests.push_back(this);
  }
  ~PlantPlace() override {
    leave();
    PlantGuest* const own = this;
    std::erase(run_->parts_->guests, own);
  }
  PlantPlace(const PlantPlace&) = delete;
  PlantPlace& operator=(const PlantPlace&) = delete;

  can::Sink& sink() override { return *port_; }
  void join(can::Participant& participant) override {
    handle_ = timeline_->add(participant, "master");
    port_->connect(participant);
  }
  void leave() noexcept override {
    if (port_ == nullptr) return;
    port_->plug(false);
    if (handle_) {
      port_->disconnect();
      timeline_->remove(*handle_);
    }
    handle_.reset();
    port_ = nullptr;
  }
  [[nodiscard]] can::Time now() const override { return run_->now(); }
  void check() const override { run_->parts_->check(); }
  [[nodiscard]] bool is_running() const noexcept override { return run_->parts_->is_running; }
  bool drive(const std::function<bool()>& is_done, can::Time end, const std::function<void()>&) override {
    run_->parts_->drive(end, 0ns, is_done);
    return is_done();
  }

 private:
  void plant_ends() noexcept override { leave(); }

  std::shared_ptr<PlantRun> run_;
  can::Timeline* timeline_ = nullptr;
  can::Port* port_ = nullptr;
  std::optional<can::Timeline::Handle> handle_;
};

namespace {

/// Others may run in Python while this one waits for the clock.
class BusPlace final : public MasterPlace {
 public:
  explicit BusPlace(std::unique_ptr<link::BusLoop> loop) : loop_(std::move(loop)) {}
  ~BusPlace() override { leave(); }
  BusPlace(const BusPlace&) = delete;
  BusPlace& operator=(const BusPlace&) = delete;

  can::Sink& sink() override { return *loop_; }
  void join(can::Participant& participant) override {
    participant_ = &participant;
    loop_->add(participant);
  }
  void leave() noexcept override {
    if (participant_ != nullptr) loop_->remove(*participant_);
    participant_ = nullptr;
  }
  [[nodiscard]] can::Time now() const override { return loop_->now(); }
  void check() const override {
    if (is_running_) throw PlantProblem("the master runs just now, in another thread");
    if (!loop_->failure().empty()) throw PlantProblem(loop_->failure());
  }
  [[nodiscard]] bool is_running() const noexcept override { return is_running_; }
  bool drive(const std::function<bool()>& is_done, can::Time end,
             const std::function<void()>& check_signals) override {
    constexpr can::Duration often = 50ms;
    is_running_ = true;
    link::BusLoop::End how = link::BusLoop::End::time_over;
    try {
      while (how == link::BusLoop::End::time_over) {
        {
          const pybind11::gil_scoped_release others;
          how = loop_->run(is_done, std::min(end, can::later(loop_->now(), often)));
        }
        check_signals();
        if (loop_->now() >= end) break;
      }
    } catch (...) {
      is_running_ = false;
      throw;
    }
    is_running_ = false;
    if (how == link::BusLoop::End::lost) throw PlantProblem(loop_->failure());
    return how == link::BusLoop::End::done;
  }

 private:
  std::unique_ptr<link::BusLoop> loop_;
  can::Participant* participant_ = nullptr;
  bool is_running_ = false;
};

}  // namespace

std::unique_ptr<MasterPlace> join_plant(std::shared_ptr<PlantRun> run, const std::string& bus) {
  return std::make_unique<PlantPlace>(std::move(run), bus);
}

std::unique_ptr<MasterPlace> join_bus(const std::string& address, can::Duration time_out) {
  const auto parsed = link::parse_bus_address(address);
  if (!parsed) throw PlantProblem(parsed.error());
  auto loop = link::BusLoop::open(*parsed, time_out, link::BusLoop::Signals::left_alone);
  if (!loop) throw PlantProblem(loop.error());
  return std::make_unique<BusPlace>(std::move(*loop));
}

}  // namespace canopus::python
