#pragma once
// The live table a terminal shows while a plant runs: bus load, every node with its NMT state, PDOs per
// second and last EMCY, and the latest events below. Redrawn in place; what it draws is a string, so a test
// can look at it.

#include <cstdio>
#include <deque>
#include <string>
#include <vector>

#include "canopus/app/plant.hpp"

namespace canopus::app {

struct TableSize {
  unsigned rows = 24;
  unsigned columns = 80;
};

class LiveTable final : public PlantObserver {
 public:
  /// `doors`: where clients connect, shown in the last line. `colour`: states and errors in colour.
  LiveTable(Plant*& plant, bool colour) : plant_(plant), colour_(colour) {}
  void add_door(std::string text) { doors_.push_back(std::move(text)); }

  /// The whole picture for a terminal of this size.
  [[nodiscard]] std::string draw(can::Time now, can::Duration lag, TableSize size);

  void emergency(const NodePlate& node, const canopen::Emergency& message, can::Time now) override;
  void nmt_state_changed(const NodePlate& node, canopen::NmtState state, can::Time now) override;
  void error(std::string_view source, std::string_view message, can::Time now) override;

 private:
  void note(can::Time now, std::string text);
  [[nodiscard]] std::string paint(std::string_view text, std::string_view code) const;

  Plant*& plant_;  // set once the plant is built
  bool colour_;
  std::vector<std::string> doors_;
  std::deque<std::string> latest_;  // newest last
  struct Count {
    std::uint64_t pdos = 0;
    double rate = 0;
  };
  std::vector<Count> counts_;
  can::Time counted_at_{};
};

}  // namespace canopus::app
