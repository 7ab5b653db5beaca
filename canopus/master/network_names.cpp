#include "canopus/master/network_names.hpp"

#include <filesystem>
#include <memory>
#include <utility>

#include "canopus/master/network_file.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/trace/print/node_names.hpp"

namespace canopus::master {

bool add_network_names(const std::string& path, trace::Names& names, text::Output& err) {
  const auto text = text::read_file(path);
  if (!text) {
    err.line("canopus: {}", text.error());
    return false;
  }
  NetworkReading reading = read_network(*text, path);
  if (!reading.errors.empty()) {
    text::print_errors(std::move(reading.errors), path, err);
    return false;
  }
  names.add({.node_id = reading.network.node, .name = "master"});
  for (const NetworkSlave& slave : reading.network.slaves) {
    std::shared_ptr<const canopen::DictionaryDescription> dictionary;
    std::string name = slave.name;
    if (!slave.eds.empty()) {
      const auto file =
          trace::load_device_file((std::filesystem::path(path).parent_path() / slave.eds).string(), err);
      if (!file) return false;
      dictionary = file->dictionary;
      if (name.empty()) name = trace::node_name_of(*file);
    }
    names.add(trace::describe_node("", slave.node, std::move(name), std::move(dictionary)));
  }
  return true;
}

}  // namespace canopus::master
