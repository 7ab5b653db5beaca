#pragma once
// Masters without a PLC for the Python module.

#include <pybind11/pybind11.h>

namespace canopus::python {

/// MasterRun: on a bus of a PlantRun, or on a real bus.
void add_masters(pybind11::module_& module);

}  // namespace canopus::python
