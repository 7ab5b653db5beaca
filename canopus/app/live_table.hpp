#pragma once
// The live table a terminal shows while a plant runs: bus load, every node with its NMT state, PDOs per
// second and last EMCY, then every slave that a master of the plant has not booted (yet), with the reason and
// what to check, and the latest events. Redrawn in place; what it draws is a string, so a test
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

  void lss_configured(const NodePlate& node, std::uint32_t bit_rate, can::Time now) override;
  void emergency(const NodePlate& node, const canopen::Emergency& message, can::Time now) override;
  void unacknowledged(const NodePlate& node, can::Time now) override;
  void nmt_state_changed(const NodePlate& node, canopen::NmtState state, can::Time now) override;
  void slave_boot_went_on(const NodePlate& slave, const NodePlate& master, const manager::BootRecord& record,
                          can::Time now) override;
  void error(std::string_view source, std::string_view message, can::Time now) override;

 private:
  /// The slaves that are not booted, in at most `rows` lines.
  [[nodiscard]] std::vector<std::string> draw_boots(can::Time now, std::size_t rows, unsigned columns) const;
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
