#pragma once
// Collects the live table's data from a plant and its events. table_layout.hpp formats them as lines,
// run_screen.hpp draws them on the terminal.

#include <deque>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/cli/output/print.hpp"
#include "canopus/cli/run/run_messages.hpp"
#include "canopus/cli/run/table_state.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::cli {

class LiveTable final : public plant::PlantObserver {
 public:
  /// `plant` is set once the plant is built. `errors`: errors and warnings are printed there as they come, as
  /// well; nullptr: they are only kept.
  explicit LiveTable(plant::Plant*& plant, Output* errors = nullptr) : plant_(plant), error_output_(errors) {}
  /// "MC protocol 127.0.0.1:5007": where clients connect.
  void add_server(std::string text) { servers_.push_back(std::move(text)); }

  /// The state to show now.
  [[nodiscard]] TableState state(can::Time now, can::Duration lag);
  /// All errors and warnings since the start.
  [[nodiscard]] const RunMessages& messages() const noexcept { return messages_; }

  void on(const plant::Event& event) override;

 private:
  template <typename Other>
  void add(const Other&, can::Time) {}  // it shows nothing of the other kinds
  void add(const plant::LssSetting& event, can::Time now);
  void add(const plant::EmergencySent& event, can::Time now);
  void add(const plant::MissingAck& event, can::Time now);
  void add(const plant::BusErrorEvent& event, can::Time now);
  void add(const plant::ControllerChange& event, can::Time now);
  void add(const plant::NmtStateChange& event, can::Time now);
  void add(const plant::SlaveBootStep& event, can::Time now);
  void add(const plant::Warning& event, can::Time now);
  void add(const plant::ModuleError& event, can::Time now);
  void add(const plant::Failure& event, can::Time now);
  void note(can::Time now, std::string_view text);
  void add_message(RunMessage message);

  plant::Plant*& plant_;
  Output* error_output_;
  std::vector<std::string> servers_;
  struct Note {
    can::Time last;
    std::string text;
    std::uint64_t count = 1;
  };
  std::deque<Note> events_;  // the latest ones, newest last
  RunMessages messages_;
  std::map<std::string, std::string, std::less<>> bus_errors_;  // the latest of each bus, by its name
  struct Count {
    std::uint64_t pdos = 0;
    double rate = 0;
  };
  std::vector<Count> counts_;
  can::Time counted_at_{};
};

}  // namespace canopus::cli
