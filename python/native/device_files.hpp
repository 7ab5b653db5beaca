#pragma once
// Device files [CiA 306] for the Python module.

#include <pybind11/pybind11.h>

namespace canopus::python {

/// NativeDeviceFile: an EDS or DCF that was read.
void add_device_files(pybind11::module_& module);

}  // namespace canopus::python
