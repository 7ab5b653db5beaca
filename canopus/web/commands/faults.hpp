#pragma once
// Faults of a running plant's simulated buses from the page: those of the plant file, on or off, and new ones.

#include <expected>
#include <string>
#include <vector>

#include "canopus/link/loop_clock.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/json.hpp"

namespace canopus::web {

class WebFaults {
 public:
  static constexpr std::size_t most_faults = 200;
  static constexpr std::size_t longest_fault = 4000;  ///< bytes of its text
  using Json = text::Json;

  /// Both must outlive this.
  WebFaults(plant::Plant& plant, link::LoopClock& clock);

  /// {"seed": 1, "buses": [{"bus", "ports": [...], "faults": [{"text", "on", "from_file", "hits", "active"}]}]}: of simulated
  /// buses.
  [[nodiscard]] Json list() const;
  /// {"bus": "line1", "seed": 1, "faults": [{"text": "kind = ...", "on": true}]}: from now on these, and no others, counted from
  /// the beginning. The row is that of list(); on an error nothing changes.
  [[nodiscard]] std::expected<Json, std::string> run(const text::Json& wish);
  /// {"bus": "line1", "number": 0}: the fault of that place in the list ends now and leaves the list; the others go on. The row
  /// is that of list(); on an error nothing changes.
  [[nodiscard]] std::expected<Json, std::string> end(const text::Json& wish);

 private:
  struct Rule {
    plant::FaultSection section{};
    bool is_on = true;
    bool is_of_file = false;
    std::size_t number = 0;  ///< among those that the bus was given, if it is on
  };
  /// Of the simulated bus that a wish names.
  [[nodiscard]] std::expected<std::size_t, std::string> bus_of(const text::Json& wish) const;

  plant::Plant& plant_;
  link::LoopClock& clock_;
  std::vector<std::vector<Rule>> rules_;  ///< of each bus
  std::vector<std::uint64_t> seeds_;
};

}  // namespace canopus::web
