#pragma once
// Requests that the control server of a plant answers later: "run this number of scans" (docs/control.md).
// The other requests go to DeviceControl.

#include <string_view>

#include "canopus/plant/plant.hpp"
#include "canopus/serve/control_server.hpp"
#include "canopus/serve/plant_runs.hpp"

namespace canopus::serve {

class RunControl {
 public:
  /// Both must outlive this.
  RunControl(plant::Plant& plant, PlantRuns& runs) : plant_(plant), runs_(runs) {}

  /// As ControlServer::Answer.
  ControlServer::CallOff answer(std::string_view line, ControlServer::Reply reply);

 private:
  plant::Plant& plant_;
  PlantRuns& runs_;
};

}  // namespace canopus::serve
