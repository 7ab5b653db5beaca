#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/cli/plc/module_command.hpp"
#include "canopus/module/interface/program_interface.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/volatile_memory.hpp"

namespace canopus::cli {

namespace {

/// The controller of a module that is never switched on.
class NoController final : public can::Controller {
 public:
  bool send(const can::Frame&) override { return false; }
  [[nodiscard]] std::uint16_t transmit_error_counter() const override { return 0; }
  [[nodiscard]] std::uint16_t receive_error_counter() const override { return 0; }
  [[nodiscard]] can::ErrorState error_state() const override { return can::ErrorState::error_active; }
  [[nodiscard]] std::uint32_t bit_rate() const override { return 0; }
  void restart(std::uint32_t) override {}
  [[nodiscard]] std::uint32_t transmit_overflows() const override { return 0; }
};

/// A module with factory settings, and what it is made of.
struct Column {
  explicit Column(const plant::CatalogueEntry& of)
      : entry(of), module(of.make(controller, memory, {})), slave(of.objects()) {}

  /// Whether it has the object with its factory settings, or, where the role changes the objects, as slave.
  [[nodiscard]] bool has(std::uint16_t index) const {
    return module->node().dictionary().description().find(index) != nullptr || slave->find(index) != nullptr;
  }
  [[nodiscard]] std::size_t pdos_as_slave(std::uint16_t first) const {
    return static_cast<std::size_t>(std::ranges::count_if(slave->objects(), [&](const auto& object) {
      return object.index >= first && object.index < first + 0x200;
    }));
  }

  const plant::CatalogueEntry& entry;
  NoController controller;
  plant::VolatileMemory memory;
  std::unique_ptr<module::CommunicationModule> module;
  std::shared_ptr<const canopen::DictionaryDescription> slave;
};

std::string yes(bool there) { return there ? "yes" : "-"; }

std::string bit_rates(const Column& column) {
  std::vector<unsigned> rates;
  for (const module::BusLength& length : column.entry.data_sheet->bus_lengths) rates.push_back(length.kbps);
  std::ranges::sort(rates);
  return fmt::format("{}", fmt::join(rates, ", "));
}

std::string racks(const Column& column) {
  std::vector<std::string_view> names;
  for (const plc::CpuFamily family : column.entry.families) names.push_back(plc::family_info(family).name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string modes(const Column& column) {
  std::vector<std::string_view> names;
  for (const module::FunctionMode& mode : column.entry.data_sheet->modes) names.push_back(mode.value);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string registers(const Column& column) {
  const module::RegisterAccess* access = column.module->registers();
  if (access == nullptr) return "-";
  std::size_t count = 0;
  for (const module::RegisterRange& range : access->registers()) count += range.last - range.first + 1;
  return std::to_string(count);
}

std::string buffer_memory(const Column& column) {
  const module::BufferMemoryAccess* words = column.module->buffer_memory();
  return words == nullptr ? "-" : std::to_string(words->buffer_memory_size());
}

struct Row {
  const char* name;
  std::function<std::string(const Column&)> cell;
};

const std::vector<Row>& rows() {
  const auto object = [](std::uint16_t index) {
    return [index](const Column& column) { return yes(column.has(index)); };
  };
  static const std::vector<Row> all{
      {"Maker", [](const Column& c) { return std::string(c.entry.data_sheet->maker); }},
      {"Racks", racks},
      {"Function modes", modes},
      {"Bit rates, kbit/s", bit_rates},
      {"I/O points", [](const Column& c) { return std::to_string(c.module->points()); }},
      {"X/Y signals", [](const Column& c) { return yes(c.module->signals() != nullptr); }},
      {"Buffer memory, words", buffer_memory},
      {"Registers of the CPU", registers},
      {"PDOs each way",
       [](const Column& c) { return std::to_string(c.module->program_interface().process_data.pdos); }},
      {"PDOs each way as slave", [](const Column& c) { return std::to_string(c.pdos_as_slave(0x1800)); }},
      {"Process data words each way",
       [](const Column& c) { return std::to_string(c.module->program_interface().process_data.words); }},
      {"NMT master (1F80H)", object(0x1F80)},
      {"Flying master (1F90H)", object(0x1F90)},
      {"Configuration of slaves from 1F22H", object(0x1F22)},
      {"Configuration of slaves by download",
       [](const Column& c) { return yes(c.entry.download != nullptr); }},
      {"LSS search for slaves (1F89H)", object(0x1F89)},
      {"Heartbeat producer (1017H)", object(0x1017)},
      {"Heartbeat consumer (1016H)", object(0x1016)},
      {"Node guarding as slave (100CH)", object(0x100C)},
      {"Node guarding as master (1F83H)",
       [](const Column& c) { return yes(c.has(0x1F83) && c.entry.download == nullptr); }},
      {"SYNC producer (1006H)", object(0x1006)},
      {"TIME (1012H)", object(0x1012)},
      {"Error history (1003H)", object(0x1003)},
      {"Parameters saved by 1010H", object(0x1010)},
      {"Layer 2 (plain CAN)",
       [](const Column& c) {
         return yes(c.module->program_interface().online.kind != module::ProgramRequest::Kind::none);
       }},
      {"Lift profile CiA 417", [](const Column& c) { return yes(!c.entry.more_modes.empty()); }},
  };
  return all;
}

}  // namespace

std::string comparison_table() {
  std::vector<std::unique_ptr<Column>> columns;
  for (const plant::CatalogueEntry& entry : plant::module_catalogue())
    columns.push_back(std::make_unique<Column>(entry));
  std::string text = "| |";
  for (const auto& column : columns) text += fmt::format(" {} |", column->entry.data_sheet->model);
  text += "\n|---|";
  for (std::size_t i = 0; i < columns.size(); ++i) text += "---|";
  text += '\n';
  for (const Row& row : rows()) {
    text += fmt::format("| {} |", row.name);
    for (const auto& column : columns) text += fmt::format(" {} |", row.cell(*column));
    text += '\n';
  }
  return text;
}

int module_compare(Output& out) {
  out.content(comparison_table());
  return 0;
}

}  // namespace canopus::cli
