#include "canopus/web/trace/live_trace.hpp"

#include <utility>

#include <boost/asio/post.hpp>

#include "canopus/can/error_frame.hpp"
#include "canopus/link/linked_bus.hpp"

namespace canopus::web {

namespace {

constexpr std::size_t most_waiting = 64;

using Clock = std::chrono::steady_clock;

}  // namespace

class WebTrace::Tap final : public can::BusObserver {
 public:
  Tap(WebTrace& trace, const can::Bus& bus, std::uint16_t channel)
      : trace_(trace), linked_(dynamic_cast<const link::LinkedBus*>(&bus)), channel_(channel) {}

  void frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) override {
    trace_.hold({.time = linked_ != nullptr ? linked_->stamp() : end, .channel = channel_, .frame = frame});
  }
  void errors_reported(std::span<const can::BusErrorReport> reports, can::Time now) override {
    if (!reports.front().first) return;
    trace_.hold({.time = now,
                 .channel = channel_,
                 .error_frame = true,
                 .frame = can::error_frame(can::recorded_of(reports))});
  }
  void controller_changed(const can::ControllerReport& report, can::Time now) override {
    trace_.hold({.time = now, .channel = channel_, .error_frame = true, .frame = can::error_frame(report)});
  }

 private:
  WebTrace& trace_;
  const link::LinkedBus* linked_;
  std::uint16_t channel_;
};

WebTrace::WebTrace(boost::asio::io_context& io, plant::Plant& plant, trace::Names names)
    : io_(io), plant_(plant), timer_(io) {
  TraceQueryEngine::Use use{.names = std::move(names)};
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    use.buses.push_back(plant.bus(i).name());
    use.bit_rates.push_back(plant.bus(i).bit_rate());
    taps_.push_back(std::make_unique<Tap>(*this, plant.bus(i), static_cast<std::uint16_t>(i)));
    plant.bus(i).add_observer(*taps_.back());
  }
  held_.reserve(most_held * plant.bus_count());
  use.has_time = [until = until_] { return Clock::now() < *until; };
  engine_ = std::make_shared<TraceQueryEngine>(std::move(use));
  worker_ = std::make_unique<serve::Worker>(most_waiting, false, patience);
  wait();
}

WebTrace::~WebTrace() {
  for (std::size_t i = 0; i < taps_.size(); ++i) plant_.bus(i).remove_observer(*taps_[i]);
}

void WebTrace::hold(const trace::TraceRecord& record) noexcept {
  if (held_.size() == held_.capacity()) {
    ++lost_;
  } else {
    held_.push_back(record);
  }
}

void WebTrace::hand_over() {
  if (held_.empty()) return;
  // A copy of as many as there are: room for all that may come, given away each time, would scatter the memory.
  const auto records = std::make_shared<const std::vector<trace::TraceRecord>>(held_);
  if (worker_->add([engine = engine_, records] { engine->add(*records); })) held_.clear();
}

void WebTrace::wait() {
  timer_.expires_after(hand_over_every);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (error) return;
    hand_over();
    wait();
  });
}

void WebTrace::ask(Question question, const text::Json& wish, Done done) {
  hand_over();
  const bool is_taken = worker_->add([question, wish, done, lost = lost_, engine = engine_, until = until_,
                                      there = std::weak_ptr(is_there_), &io = io_] {
    *until = Clock::now() + turn;
    auto row = ((*engine).*question)(wish);
    if (row && lost != 0) (*row)["lost"] = lost;
    boost::asio::post(io, [done, there, row = std::move(row)]() mutable {
      if (!there.expired()) done(std::move(row));
    });
  });
  if (!is_taken) done(std::unexpected("the trace has too much to do; try again"));
}

}  // namespace canopus::web
