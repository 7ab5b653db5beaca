// The Python module canopus._core: a thin layer, the package canopus around it is what people use.

#include <cmath>
#include <exception>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "device_files.hpp"
#include "frame_conversion.hpp"
#include "master_module.hpp"
#include "pictures.hpp"
#include "plant_run.hpp"

namespace py = pybind11;

namespace canopus::python {
namespace {

can::Time time_of(std::int64_t nanoseconds) { return can::Time(can::Duration(nanoseconds)); }
std::int64_t number_of(can::Time time) { return time.time_since_epoch().count(); }

/// The frame of PlantPort.send's arguments, or many of them.
using RawFrame = std::tuple<std::uint32_t, py::bytes, bool, bool, unsigned>;
std::vector<can::Frame> frames_of(const std::vector<RawFrame>& raw) {
  std::vector<can::Frame> frames;
  for (const auto& [identifier, data, extended, remote, dlc] : raw)
    frames.push_back(frame_of(identifier, data, extended, remote, dlc));
  return frames;
}

std::vector<std::uint8_t> bits_of(const std::vector<bool>& bits) { return {bits.begin(), bits.end()}; }

/// Signals of the operating system, Ctrl-C among them, and exceptions of callbacks, end a run.
struct Interruption {
  std::optional<py::error_already_set> raised;
  void check_signals() {
    if (raised) {
      py::error_already_set error = std::move(*raised);
      raised.reset();
      throw error;
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
};

std::shared_ptr<PlantRun> open_plant(const std::string& path, const std::optional<std::string>& text,
                                     std::optional<std::uint64_t> seed) {
  auto run = PlantRun::open(path, text, seed);
  run->set_signal_check([] { Interruption().check_signals(); });
  return run;
}

void set_dispatcher(PlantRun& run, py::function dispatcher) {
  const auto interruption = std::make_shared<Interruption>();
  run.set_signal_check([interruption] { interruption->check_signals(); });
  run.set_hook([interruption, dispatcher = std::move(dispatcher)](std::size_t device, std::size_t token,
                                                                  can::Time now) {
    if (interruption->raised) return;  // the first one counts
    try {
      dispatcher(device, token, number_of(now));
    } catch (py::error_already_set& error) {
      interruption->raised.emplace(std::move(error));
    }
  });
}

}  // namespace
}  // namespace canopus::python

PYBIND11_MODULE(_core, module) {
  using namespace canopus;
  using namespace canopus::python;
  // One exception, whether the plant is in this process or in another one.
  static py::handle plant_error =
      static_cast<py::object>(py::module_::import("canopus_plc.errors").attr("PlantError")).release();
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const PlantProblem& problem) {
      PyErr_SetString(plant_error.ptr(), problem.what());
    }
  });

  py::class_<PlantRun, std::shared_ptr<PlantRun>>(module, "PlantRun")
      .def(py::init(&open_plant), py::arg("path"), py::arg("text"), py::arg("seed"))
      .def("close", &PlantRun::close)
      .def_property_readonly("closed", &PlantRun::is_closed)
      .def_property_readonly("now", [](const PlantRun& run) { return number_of(run.now()); })
      .def("ask", [](PlantRun& run, const std::string& line) { return run.ask(line); })
      .def("run_until", [](PlantRun& run, std::int64_t end) { run.run_until(time_of(end)); })
      .def("drain_events", &PlantRun::drain_events)
      .def_property_readonly("buses", &PlantRun::buses)
      .def("bit_rate", &PlantRun::bit_rate)
      .def_property_readonly("plcs", &PlantRun::plcs)
      .def("read_words", &PlantRun::read_words)
      .def("write_words",
           [](PlantRun& run, const std::string& plc, const std::string& device, std::uint32_t first,
              const std::vector<std::uint16_t>& words) { run.write_words(plc, device, first, words); })
      .def("read_bits", &PlantRun::read_bits)
      .def("write_bits",
           [](PlantRun& run, const std::string& plc, const std::string& device, std::uint32_t first,
              const std::vector<bool>& bits) { run.write_bits(plc, device, first, bits_of(bits)); })
      .def("read_buffer", &PlantRun::read_buffer)
      .def("write_buffer",
           [](PlantRun& run, const std::string& plc, unsigned unit, std::uint32_t first,
              const std::vector<std::uint16_t>& words) { run.write_buffer(plc, unit, first, words); })
      .def("set_cpu", &PlantRun::set_cpu)
      .def("cpu_name", &PlantRun::cpu_name)
      .def("sdo",
           [](PlantRun& run, const std::string& bus, unsigned node, unsigned index, unsigned sub,
              const std::optional<py::bytes>& value, std::int64_t time_out, bool block) {
             std::optional<std::string> bytes;
             if (value) bytes = static_cast<std::string>(*value);
             const SdoResult result = run.sdo(bus, node, index, sub, bytes, can::Duration(time_out), block);
             return py::make_tuple(
                 result.abort_code, result.reason,
                 py::bytes(reinterpret_cast<const char*>(result.data.data()), result.data.size()),
                 result.size_indicated);
           })
      .def("record", &PlantRun::record)
      .def("drain_frames",
           [](PlantRun& run, const std::string& bus) {
             py::list frames;
             for (const TimedFrame& frame : run.drain_frames(bus)) frames.append(tuple_of(frame));
             return frames;
           })
      .def("draw", &PlantRun::draw)
      .def_property_readonly("device_views",
                             [](const PlantRun& run) {
                               py::list views;
                               for (const DeviceView& view : run.device_views())
                                 views.append(py::make_tuple(view.bus, view.node, view.name, view.state));
                               return views;
                             })
      .def("object_views",
           [](const PlantRun& run, const std::string& device) {
             py::list views;
             for (const ObjectView& view : run.object_views(device))
               views.append(py::make_tuple(view.object, view.name, view.type, view.value));
             return views;
           })
      .def("monitor", &PlantRun::monitor)
      .def("drain_messages", &PlantRun::drain_messages)
      .def("set_dispatcher", &set_dispatcher)
      .def("set_arrival",
           [](PlantRun& run, py::function arrival) {
             run.set_arrival([arrival = std::move(arrival)] { arrival(); });
           })
      .def("watch", &PlantRun::watch)
      .def("every", [](PlantRun& run, const std::string& device,
                       std::int64_t period) { return run.every(device, can::Duration(period)); })
      .def("device_number", &PlantRun::device_number)
      .def("script", &PlantRun::script)
      .def("put", &PlantRun::put)
      .def("get", &PlantRun::get);

  py::class_<PlantPort>(module, "PlantPort")
      .def(py::init<std::shared_ptr<PlantRun>, std::string, std::string>(), py::arg("run"), py::arg("bus"),
           py::arg("name"))
      .def("send",
           [](PlantPort& port, std::uint32_t identifier, const py::bytes& data, bool extended, bool remote,
              unsigned dlc) { port.send(frame_of(identifier, data, extended, remote, dlc)); })
      .def("receive", [](PlantPort& port,
                         std::int64_t time_out) { return tuple_of(port.receive(can::Duration(time_out))); })
      .def("take", [](PlantPort& port) { return tuple_of(port.next()); })
      .def("offer",
           [](PlantPort& port, std::uint32_t identifier, const py::bytes& data, bool extended, bool remote,
              unsigned dlc) { return port.offer(frame_of(identifier, data, extended, remote, dlc)); })
      .def("repeat",
           [](PlantPort& port, const std::vector<RawFrame>& frames, std::int64_t period,
              std::int64_t duration) {
             return port.repeat(frames_of(frames), can::Duration(period), can::Duration(duration));
           })
      .def("change",
           [](PlantPort& port, std::size_t token, const std::vector<RawFrame>& frames) {
             return port.change(token, frames_of(frames));
           })
      .def("stop", &PlantPort::stop)
      .def("set_awaited", &PlantPort::await)
      .def_property_readonly("waiting", &PlantPort::waiting)
      .def_property_readonly("unsent", &PlantPort::unsent)
      .def_property_readonly("lost", &PlantPort::lost)
      .def_property_readonly("state", &PlantPort::state)
      .def("close", &PlantPort::close);

  module.def("decode_trace", &decode_trace);
  add_device_files(module);
  add_masters(module);
  add_pictures(module);
}
