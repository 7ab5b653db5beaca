#include "frame_conversion.hpp"

#include <string>

namespace py = pybind11;

namespace canopus::python {

can::Frame frame_of(std::uint32_t identifier, const py::bytes& data, bool extended, bool remote,
                    unsigned dlc) {
  const std::string bytes = data;
  if (identifier > (extended ? can::max_extended_identifier : can::max_base_identifier)) {
    throw PlantProblem("the identifier is beyond " + std::string(extended ? "1FFFFFFFH" : "7FFH"));
  }
  if (bytes.size() > 8 || dlc > 15) throw PlantProblem("a frame has 8 bytes at most");
  can::Frame frame{.identifier = identifier, .extended = extended, .remote = remote};
  frame.dlc = static_cast<std::uint8_t>(remote ? dlc : bytes.size());
  for (std::size_t i = 0; i < bytes.size() && !remote; ++i)
    frame.data[i] = static_cast<std::uint8_t>(bytes[i]);
  return frame;
}

py::object tuple_of(const std::optional<TimedFrame>& heard) {
  if (!heard) return py::none();
  const auto bytes = heard->frame.bytes();
  return py::make_tuple(heard->time.time_since_epoch().count(), heard->frame.identifier,
                        py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
                        heard->frame.extended, heard->frame.remote, unsigned{heard->frame.dlc}, heard->sent);
}

}  // namespace canopus::python
