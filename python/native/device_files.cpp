#include "device_files.hpp"

#include <bit>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <pybind11/stl.h>

#include "canopus/eds/device_file.hpp"
#include "canopus/eds/writer.hpp"

#include "plant_run.hpp"

namespace py = pybind11;

namespace canopus::python {
namespace {

using canopen::Access;
using canopen::DataType;
using canopen::DictionaryDescription;
using canopen::Entry;

/// Names are in UTF-8, whatever the file is in.
py::object text_of(std::string_view text) {
  PyObject* decoded = PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(decoded);
}

std::string_view word(Access access) {
  switch (access) {
    case Access::read_only: return "ro";
    case Access::write_only: return "wo";
    case Access::read_write: return "rw";
    case Access::read_write_input: return "rwr";
    case Access::read_write_output: return "rww";
    case Access::constant: return "const";
  }
  return "ro";
}

std::string_view word(canopen::ObjectCode code) {
  switch (code) {
    case canopen::ObjectCode::domain: return "DOMAIN";
    case canopen::ObjectCode::array: return "ARRAY";
    case canopen::ObjectCode::record: return "RECORD";
    case canopen::ObjectCode::type_definition: return "DEFTYPE";
    case canopen::ObjectCode::structure_definition: return "DEFSTRUCT";
    case canopen::ObjectCode::null: return "NULL";
    case canopen::ObjectCode::variable: break;
  }
  return "VAR";
}

py::object limit_of(DataType type, const std::optional<std::uint64_t>& bits) {
  if (!bits) return py::none();
  if (type == DataType::real32 || type == DataType::real64) return py::float_(std::bit_cast<double>(*bits));
  if (canopen::is_signed(type)) return py::int_(static_cast<std::int64_t>(*bits));
  return py::int_(*bits);
}

class NativeDeviceFile {
 public:
  explicit NativeDeviceFile(const py::bytes& text) {
    eds::ReadResult result = eds::read_device_file(static_cast<std::string>(text));
    if (result.file == nullptr) {
      const eds::Problem& problem = result.problems.front();
      throw PlantProblem(std::to_string(problem.line) + ": " + problem.message);
    }
    file_ = std::move(result.file);
    for (const eds::Problem& problem : result.problems) {
      problems_.append(py::make_tuple(text_of(eds::name(problem.severity)), problem.line, problem.column,
                                      text_of(problem.message)));
    }
  }

  [[nodiscard]] py::list problems() const { return problems_; }

  [[nodiscard]] py::dict file_info() const {
    const eds::FileInfo& file = file_->file;
    py::dict info;
    info["file_name"] = text_of(file.file_name);
    info["version"] = file.version;
    info["revision"] = file.revision;
    info["eds_version"] = text_of(file.eds_version);
    info["description"] = text_of(file.description);
    info["creation_time"] = text_of(file.creation_time);
    info["creation_date"] = text_of(file.creation_date);
    info["created_by"] = text_of(file.created_by);
    info["modification_time"] = text_of(file.modification_time);
    info["modification_date"] = text_of(file.modification_date);
    info["modified_by"] = text_of(file.modified_by);
    info["last_eds"] = text_of(file.last_eds);
    return info;
  }

  [[nodiscard]] py::dict device_info() const {
    const eds::DeviceInfo& device = file_->device;
    py::dict info;
    info["vendor_name"] = text_of(device.vendor_name);
    info["product_name"] = text_of(device.product_name);
    info["order_code"] = text_of(device.order_code);
    info["vendor_number"] = device.vendor_number;
    info["product_number"] = device.product_number;
    info["revision_number"] = device.revision_number;
    info["bit_rates"] = py::tuple(py::cast(device.bit_rates));
    info["granularity"] = device.granularity;
    info["lss"] = device.lss;
    return info;
  }

  [[nodiscard]] py::object commissioning() const {
    if (!file_->commissioning) return py::none();
    const eds::Commissioning& commissioning = *file_->commissioning;
    py::dict info;
    info["node"] = commissioning.node_id;
    info["node_name"] = text_of(commissioning.node_name);
    info["bit_rate"] = commissioning.bit_rate;
    info["net_number"] = commissioning.net_number;
    info["network_name"] = text_of(commissioning.network_name);
    return info;
  }

  [[nodiscard]] py::list objects() const {
    const DictionaryDescription& dictionary = *file_->dictionary;
    py::list objects;
    for (const canopen::ObjectDescription& object : dictionary.objects()) {
      if (object.index < 0x1000) continue;  // a data type, usable as a dummy
      objects.append(py::make_tuple(object.index, text_of(dictionary.name(object)),
                                    text_of(word(object.code)), object.highest_sub));
    }
    return objects;
  }

  [[nodiscard]] py::object entry(std::uint16_t index, std::uint8_t sub) const {
    const DictionaryDescription& dictionary = *file_->dictionary;
    const Entry entry = dictionary.find(index, sub);
    if (!entry) return py::none();
    const canopen::EntryDescription& description = *entry.description;
    const canopen::Limits& limits = dictionary.limits(entry);
    const eds::EntryFacts* facts = file_->find_facts(index, sub);
    const bool adds_node_id =
        description.length != 0 && dictionary.default_value(entry, 0) != dictionary.default_value(entry, 1);
    return py::make_tuple(text_of(dictionary.name(entry)), text_of(eds::name(description.type)),
                          text_of(word(description.access)), canopen::bit_length(description.type),
                          bool{description.rpdo_mappable}, bool{description.tpdo_mappable},
                          limit_of(description.type, limits.low), limit_of(description.type, limits.high),
                          adds_node_id, facts != nullptr && facts->configured,
                          text_of(facts == nullptr ? std::string_view() : facts->denotation.text()));
  }

  /// As an SDO carries it.
  [[nodiscard]] py::bytes default_value(std::uint16_t index, std::uint8_t sub, std::uint8_t node_id) const {
    const DictionaryDescription& dictionary = *file_->dictionary;
    const Entry entry = dictionary.find(index, sub);
    if (!entry) throw PlantProblem("there is no such object");
    if (entry.description->length == 0) {
      const std::vector<std::uint8_t>& bytes = dictionary.default_slot(entry.offset);
      return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    const auto bytes =
        canopen::little_endian(dictionary.default_value(entry, node_id), entry.description->length);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  [[nodiscard]] py::bytes plain_text() const {
    return eds::write_device_file(file_->file, file_->device, *file_->dictionary);
  }

 private:
  std::shared_ptr<const eds::DeviceFile> file_;
  py::list problems_;
};

}  // namespace

void add_device_files(py::module_& module) {
  py::class_<NativeDeviceFile>(module, "NativeDeviceFile")
      .def(py::init<py::bytes>(), py::arg("text"))
      .def_property_readonly("problems", &NativeDeviceFile::problems)
      .def_property_readonly("file_info", &NativeDeviceFile::file_info)
      .def_property_readonly("device_info", &NativeDeviceFile::device_info)
      .def_property_readonly("commissioning", &NativeDeviceFile::commissioning)
      .def_property_readonly("objects", &NativeDeviceFile::objects)
      .def("entry", &NativeDeviceFile::entry)
      .def("default_value", &NativeDeviceFile::default_value)
      .def("plain_text", &NativeDeviceFile::plain_text);
}

}  // namespace canopus::python
