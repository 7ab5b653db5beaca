#pragma once
// Where a master of the Python module lives: on a bus of a plant in this process, in plant time, or on a real bus, in the
// clock's time.

#include <functional>
#include <memory>
#include <string>

#include "canopus/can/controller.hpp"
#include "canopus/can/time.hpp"

#include "plant_run.hpp"

namespace canopus::python {

class MasterPlace {
 public:
  virtual ~MasterPlace() = default;
  [[nodiscard]] virtual can::Sink& sink() = 0;
  /// The participant hears the bus and gets its ticks, until leave().
  virtual void join(can::Participant& participant) = 0;
  /// Again: nothing.
  virtual void leave() noexcept = 0;
  [[nodiscard]] virtual can::Time now() const = 0;
  /// A problem: the place has gone, or somebody else lets time pass just now.
  virtual void check() const = 0;
  /// Inside of drive(), or of another run of the plant.
  [[nodiscard]] virtual bool is_running() const noexcept = 0;
  /// Lets time pass until `is_done`, until `end` at most. True: it is done. `check_signals` is called every now and then and may throw. A
  /// problem: the bus is lost.
  virtual bool drive(const std::function<bool()>& is_done, can::Time end,
                     const std::function<void()>& check_signals) = 0;
};

/// On the bus of a plant; without a name the only one.
std::unique_ptr<MasterPlace> join_plant(std::shared_ptr<PlantRun> run, const std::string& bus);
/// On a real bus (`canopus sdo --bus`).
std::unique_ptr<MasterPlace> join_bus(const std::string& address, can::Duration time_out);

}  // namespace canopus::python
