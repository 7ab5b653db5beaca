#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "canopus/can/timeline.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::serve {

/// Reports of a server about its clients, as errors of one source. Repeated connections must not flood the
/// event log: the number of lines a second of plant time is limited; the next line has the number of
/// suppressed ones.
class ClientReports {
 public:
  static constexpr unsigned most_lines = 5;

  /// Observer and timeline must outlive the reports.
  ClientReports(plant::PlantObserver& observer, const can::Timeline& timeline, std::string source)
      : observer_(observer), timeline_(timeline), source_(std::move(source)) {}

  void operator()(std::string_view sentence) {
    const can::Time now = timeline_.now();
    if (now >= next_second_) {
      next_second_ = can::later(now, std::chrono::seconds(1));
      lines_ = 0;
    }
    if (++lines_ > most_lines) {
      ++left_out_;
      return;
    }
    if (const auto left_out = std::exchange(left_out_, 0); left_out != 0) {
      observer_.on(
          {now, plant::Failure{source_, fmt::format("{} reports of clients were left out", left_out)}});
    }
    observer_.on({now, plant::Failure{source_, std::string(sentence)}});
  }

 private:
  plant::PlantObserver& observer_;
  const can::Timeline& timeline_;
  std::string source_;
  can::Time next_second_{};
  unsigned lines_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace canopus::serve
