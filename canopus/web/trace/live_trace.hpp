#pragma once
// The frames of a run's buses for its page: the latest million is kept from the beginning on. They are decoded, searched and
// counted in a thread of their own: the plant hands them over and does not wait.

#include <chrono>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/can/bus.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/serve/worker.hpp"
#include "canopus/text/json.hpp"
#include "canopus/web/trace/query_engine.hpp"

namespace canopus::web {

class WebTrace {
 public:
  static constexpr std::chrono::milliseconds hand_over_every{200};
  static constexpr std::size_t most_held = 8192;   ///< frames of a bus in that time; what is more is lost
  static constexpr std::size_t most_answers = 64;  ///< views that are looked at
  /// How long the thread works for one answer before it answers how far it has come.
  static constexpr std::chrono::milliseconds turn{100};
  /// How long the end of the run waits for it.
  static constexpr std::chrono::seconds patience{1};

  /// Both must outlive this. `names`: of the nodes of the plant.
  WebTrace(boost::asio::io_context& io, plant::Plant& plant, trace::Names names);
  ~WebTrace();
  WebTrace(const WebTrace&) = delete;
  WebTrace& operator=(const WebTrace&) = delete;

  /// TraceQueryEngine::answer(), TraceQueryEngine::export_part(). `done` is called in the loop, once; the error is a
  /// sentence.
  using Done = std::function<void(std::expected<text::Json, std::string>)>;
  void query(const text::Json& wish, Done done) { ask(&TraceQueryEngine::answer, wish, std::move(done)); }
  void export_part(const text::Json& wish, Done done) {
    ask(&TraceQueryEngine::export_part, wish, std::move(done));
  }

 private:
  class Tap;
  using Question = std::expected<text::Json, std::string> (TraceQueryEngine::*)(const text::Json&);
  void ask(Question question, const text::Json& wish, Done done);
  void hold(const trace::TraceRecord& record) noexcept;
  void hand_over();
  void wait();

  boost::asio::io_context& io_;
  plant::Plant& plant_;
  std::vector<std::unique_ptr<Tap>> taps_;
  std::vector<trace::TraceRecord> held_;  // has room from the beginning: nothing is allocated for a frame
  std::uint64_t lost_ = 0;
  boost::asio::steady_timer timer_;
  std::shared_ptr<bool> is_there_ = std::make_shared<bool>(true);  // for work that comes back
  std::shared_ptr<std::chrono::steady_clock::time_point> until_ =
      std::make_shared<std::chrono::steady_clock::time_point>();  // the worker's alone
  std::shared_ptr<TraceQueryEngine> engine_;                      // the worker's alone
  std::unique_ptr<serve::Worker> worker_;
};

}  // namespace canopus::web
