#include "master_module.hpp"

#include <cstdint>
#include <optional>
#include <string>

#include <pybind11/stl.h>

#include "frame_conversion.hpp"
#include "master_run.hpp"

namespace py = pybind11;

namespace canopus::python {
namespace {

void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

std::shared_ptr<MasterRun> made(const std::function<std::unique_ptr<MasterPlace>()>& join,
                                const master::NetworkFile& file) {
  auto master = std::make_shared<MasterRun>(join, file);
  master->set_signal_check(check_signals);
  return master;
}

}  // namespace

void add_masters(py::module_& module) {
  py::class_<MasterRun, std::shared_ptr<MasterRun>>(module, "MasterRun")
      .def_static("on_plant",
                  [](const std::shared_ptr<PlantRun>& run, const std::string& bus,
                     const std::optional<std::string>& text, const std::string& path, unsigned node) {
                    return made([&] { return join_plant(run, bus); }, network_of(text, path, node));
                  })
      .def_static("on_bus",
                  [](const std::string& address, std::int64_t time_out,
                     const std::optional<std::string>& text, const std::string& path, unsigned node) {
                    return made([&] { return join_bus(address, can::Duration(time_out)); },
                                network_of(text, path, node));
                  })
      .def("close", &MasterRun::close)
      .def_property_readonly("now",
                             [](const MasterRun& master) { return master.now().time_since_epoch().count(); })
      .def("run_for",
           [](MasterRun& master, std::int64_t duration) { master.run_for(can::Duration(duration)); })
      .def("boot",
           [](MasterRun& master, std::int64_t time_out) { return master.boot(can::Duration(time_out)); })
      .def("results", &MasterRun::results)
      .def("drain_events", &MasterRun::drain_events)
      .def("state", &MasterRun::state)
      .def("command", &MasterRun::command)
      .def("sdo",
           [](MasterRun& master, unsigned node, unsigned index, unsigned sub,
              const std::optional<py::bytes>& value, std::int64_t time_out, bool block) {
             std::optional<std::string> bytes;
             if (value) bytes = static_cast<std::string>(*value);
             const SdoResult result = master.sdo(node, index, sub, bytes, can::Duration(time_out), block);
             return py::make_tuple(
                 result.abort_code, result.reason,
                 py::bytes(reinterpret_cast<const char*>(result.data.data()), result.data.size()),
                 result.size_indicated);
           })
      .def("send", [](MasterRun& master, std::uint32_t identifier, const py::bytes& data,
                      bool extended) { master.send(frame_of(identifier, data, extended, false, 0)); })
      .def("subscribe", &MasterRun::subscribe)
      .def("unsubscribe", &MasterRun::unsubscribe)
      .def("receive", [](MasterRun& master, std::size_t token, std::int64_t time_out) {
        return tuple_of(master.receive_next(token, can::Duration(time_out)));
      });
}

}  // namespace canopus::python
