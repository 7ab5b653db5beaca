#pragma once
// Frames as Python has them.

#include <cstdint>

#include <pybind11/pybind11.h>

#include "plant_run.hpp"

namespace canopus::python {

/// A problem: the identifier or the length is beyond what a classical frame has.
can::Frame frame_of(std::uint32_t identifier, const pybind11::bytes& data, bool extended, bool remote,
                    unsigned dlc);
/// Nanoseconds, identifier, data, extended, remote, DLC, sent by oneself; None for none.
pybind11::object tuple_of(const std::optional<TimedFrame>& frame);

}  // namespace canopus::python
