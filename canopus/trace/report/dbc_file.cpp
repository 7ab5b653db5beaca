// DBC: the text format of Vector's CANdb++ for messages and signals.

#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/trace/decode/object_facts.hpp"
#include "canopus/trace/report/bus_model.hpp"
#include "canopus/trace/report/names_of_others.hpp"

namespace canopus::trace {
namespace {

constexpr std::string_view no_node = "Vector__XXX";

std::uint32_t dbc_identifier(FrameKey key) {
  const bool extended = (key >> 29 & 1U) != 0;
  return (key & can::max_extended_identifier) | (extended ? 1U << 31 : 0U);
}

std::string pdo_name(const ModelPdo& pdo) {
  return fmt::format("{}PDO{}", pdo.transmit ? "T" : "R", pdo.number);
}

/// "Read input 8-bit: Digital inputs 1 to 8" is longer than an identifier: the sub-index's own name is the
/// more specific part. Of "Input network variable unsigned 16 [09]" only the end differs from its neighbours.
std::string short_name(std::string_view name) {
  constexpr std::size_t room = 32;
  const std::size_t end_of_object = name.find(": ");
  if (name.size() > room && end_of_object != std::string_view::npos)
    return std::string(name.substr(end_of_object + 2));
  if (name.size() > room && name.ends_with(']') && name[name.size() - 4] == '[')
    return fmt::format("{}_{}", name.substr(0, room - 3), name.substr(name.size() - 3, 2));
  return std::string(name);
}

class DbcWriter {
 public:
  explicit DbcWriter(const BusModel& model) : model_(model) {
    for (const NodeDescription* const node : model.nodes) {
      names_[node->node_id] = node_identifiers_.make(node->name, fmt::format("node_{}", node->node_id));
    }
  }

  std::string write() {
    std::string nodes;
    for (const NodeDescription* const node : model_.nodes) nodes += " " + names_[node->node_id];
    for (const ModelPdo& pdo : model_.pdos) add_message(pdo);
    std::string comments;
    for (const NodeDescription* const node : model_.nodes) {
      comments += fmt::format("CM_ BU_ {} {};\n", names_[node->node_id],
                              dbc_string(fmt::format("node {} {}", node->node_id, node->name)));
    }
    return fmt::format("VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_:{}\n\n{}\n{}{}{}", nodes, messages_, comments,
                       comments_, types_);
  }

 private:
  void add_message(const ModelPdo& pdo) {
    const std::uint32_t id = dbc_identifier(pdo.key);
    const std::string owner = names_.contains(pdo.node) ? names_[pdo.node] : fmt::format("node_{}", pdo.node);
    const std::string name = message_identifiers_.make(fmt::format("{}_{}", owner, pdo_name(pdo)), "PDO");
    const std::string_view sender =
        pdo.producers.empty() ? no_node : std::string_view(names_[pdo.producers.front()]);
    messages_ += fmt::format("BO_ {} {}: {} {}\n", id, name, pdo.length, sender);
    comments_ += fmt::format(
        "CM_ BO_ {} {};\n", id,
        dbc_string(fmt::format("{} of node {} {}", pdo_name(pdo), pdo.node, model_.node_name(pdo.node))));
    std::vector<std::string> receivers;
    for (const std::uint8_t node : pdo.consumers) receivers.push_back(names_[node]);
    if (receivers.empty()) receivers.emplace_back(no_node);
    Identifiers signals;
    for (const Signal& signal : pdo.signals) add_signal(id, signal, signals, receivers);
    messages_ += '\n';
  }

  void add_signal(std::uint32_t id, const Signal& signal, Identifiers& identifiers,
                  const std::vector<std::string>& receivers) {
    const std::string name = identifiers.make(short_name(signal.name),
                                              fmt::format("object_{:04X}_{:02X}", signal.index, signal.sub));
    const bool real = (signal.type == canopen::DataType::real32 && signal.bits == 32) ||
                      (signal.type == canopen::DataType::real64 && signal.bits == 64);
    const bool negative = real || canopen::is_signed(signal.type);
    messages_ += fmt::format(" SG_ {} : {}|{}@1{} (1,0) [0|0] {} {}\n", name, signal.first_bit, signal.bits,
                             negative ? '-' : '+', dbc_string(object_unit(signal.index, signal.sub)),
                             fmt::join(receivers, ","));
    comments_ += fmt::format("CM_ SG_ {} {} {};\n", id, name,
                             dbc_string(canopen::object_text(signal.index, signal.sub) + ' ' + signal.name));
    if (real) types_ += fmt::format("SIG_VALTYPE_ {} {} : {};\n", id, name, signal.bits == 32 ? 1 : 2);
  }

  const BusModel& model_;
  Identifiers node_identifiers_;
  Identifiers message_identifiers_;
  std::map<std::uint8_t, std::string> names_;
  std::string messages_;
  std::string comments_;
  std::string types_;
};

}  // namespace

std::string dbc_file(const BusModel& model) { return DbcWriter(model).write(); }

}  // namespace canopus::trace
