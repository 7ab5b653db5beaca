#include "pictures.hpp"

#include <utility>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/trace/print/node_names.hpp"
#include "canopus/trace/print/trace_walk.hpp"

#include "node_names.hpp"
#include "plant_run.hpp"

namespace py = pybind11;

namespace canopus::python {
namespace {

trace::PictureOptions options_of(const std::vector<std::string>& signals, const trace::Names& names,
                                 std::uint32_t bit_rate) {
  trace::PictureOptions options{.bit_rate = bit_rate};
  for (const std::string& text : signals) {
    const auto signal = trace::parse_picture_signal(text, names);
    if (!signal) {
      throw PlantProblem(fmt::format(
          "signal {}: expected a node's name or node-ID, a dot and an object, as 3.6000:01", text));
    }
    options.signals.push_back(*signal);
  }
  return options;
}

std::vector<std::string> texts_of(const std::vector<trace::PictureSignal>& signals) {
  std::vector<std::string> texts;
  for (const trace::PictureSignal& signal : signals)
    texts.push_back(fmt::format("{}.{}", signal.node, canopen::object_text(signal.index, signal.sub)));
  return texts;
}

py::tuple draw_trace(const std::string& path, const std::string& plant, const std::string& network,
                     const std::vector<std::string>& nodes, const std::vector<std::string>& signals,
                     std::uint32_t bit_rate, const std::string& title) {
  text::TextOutput errors;
  auto names = node_names(plant, network, nodes);
  trace::TracePicture picture(options_of(signals, names, bit_rate));
  trace::Decoder decoder(std::move(names), {.frames = true, .transfers = false});
  const int code =
      trace::walk_trace(path, errors, [&](const trace::TraceRecord& record, std::string_view channel) {
        decoder.receive(record, channel, [&](const trace::Message& message) { picture.message(message); });
        return true;
      });
  if (code != 0) refuse(errors);
  return py::make_tuple(picture.svg(title), texts_of(picture.missing()));
}

}  // namespace

PlantPicture::PlantPicture(const trace::Names& names, const can::Bus& bus,
                           const std::vector<std::string>& signals)
    : bus_(bus.name()),
      decoder_(names, {.frames = true, .transfers = false}),
      picture_(options_of(signals, names, bus.bit_rate())) {}

void PlantPicture::frame_completed(const can::Frame& frame, can::Time, can::Time end) {
  decoder_.receive({.time = end, .channel = 0, .frame = frame}, bus_,
                   [this](const trace::Message& message) { picture_.message(message); });
}

std::vector<std::string> PlantPicture::missing() const { return texts_of(picture_.missing()); }

void add_pictures(py::module_& module) {
  py::class_<PlantPicture, std::shared_ptr<PlantPicture>>(module, "PlantPicture")
      .def("svg", &PlantPicture::svg)
      .def_property_readonly("missing", &PlantPicture::missing);
  module.def("draw_trace", &draw_trace);
}

}  // namespace canopus::python
