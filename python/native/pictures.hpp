#pragma once
// Pictures of a bus over time for the Python module: load, values of PDOs, states of the nodes.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "canopus/can/bus.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/report/trace_picture.hpp"

namespace canopus::python {

/// What a bus of a plant does, from the moment on that it observes it. It stays when the plant has gone.
class PlantPicture final : public can::BusObserver {
 public:
  /// Signals: "encoder.6004", "3.6004:00"; without one the first eight that come. A problem: none of the plant's nodes.
  PlantPicture(const trace::Names& names, const can::Bus& bus, const std::vector<std::string>& signals);
  void frame_completed(const can::Frame& frame, can::Time start, can::Time end) override;
  /// Both: `title` any text. What was asked for and has not come: "3.6004:00".
  [[nodiscard]] std::string svg(const std::string& title) const { return picture_.svg(title); }
  [[nodiscard]] std::vector<std::string> missing() const;

 private:
  std::string bus_;
  trace::Decoder decoder_;
  trace::TracePicture picture_;
};

/// PlantPicture, and draw_trace(): `canopus trace plot`.
void add_pictures(pybind11::module_& module);

}  // namespace canopus::python
