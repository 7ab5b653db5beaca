#pragma once

#include "canopus/plant/plant.hpp"

namespace canopus::web {

/// Two observers as one; the first hears everything first.
class ObserverPair final : public plant::PlantObserver {
 public:
  /// Both must outlive the pair.
  ObserverPair(plant::PlantObserver& first, plant::PlantObserver& second) : first_(first), second_(second) {}

  void booted(const plant::NodeLabel& node, can::Time now) override {
    first_.booted(node, now);
    second_.booted(node, now);
  }
  void nmt_state_changed(const plant::NodeLabel& node, canopen::NmtState state, can::Time now) override {
    first_.nmt_state_changed(node, state, now);
    second_.nmt_state_changed(node, state, now);
  }
  void lss_configured(const plant::NodeLabel& node, std::uint32_t bit_rate, can::Time now) override {
    first_.lss_configured(node, bit_rate, now);
    second_.lss_configured(node, bit_rate, now);
  }
  void emergency(const plant::NodeLabel& node, const canopen::Emergency& message, can::Time now) override {
    first_.emergency(node, message, now);
    second_.emergency(node, message, now);
  }
  void unacknowledged(const plant::NodeLabel& node, can::Time now) override {
    first_.unacknowledged(node, now);
    second_.unacknowledged(node, now);
  }
  void bus_error(const plant::BusErrorEvent& error, can::Time now) override {
    first_.bus_error(error, now);
    second_.bus_error(error, now);
  }
  void controller_changed(const plant::NodeLabel& node, const can::ControllerReport& report,
                          can::Time now) override {
    first_.controller_changed(node, report, now);
    second_.controller_changed(node, report, now);
  }
  void slave_boot_went_on(const plant::NodeLabel& slave, const plant::NodeLabel& master,
                          const manager::BootRecord& record, can::Time now) override {
    first_.slave_boot_went_on(slave, master, record, now);
    second_.slave_boot_went_on(slave, master, record, now);
  }
  void signal_changed(std::string_view plc, char kind, unsigned number, bool on, can::Time now) override {
    first_.signal_changed(plc, kind, number, on, now);
    second_.signal_changed(plc, kind, number, on, now);
  }
  void buffer_changed(std::string_view plc, unsigned head, std::uint32_t address, std::uint16_t value,
                      bool by_cpu, can::Time now) override {
    first_.buffer_changed(plc, head, address, value, by_cpu, now);
    second_.buffer_changed(plc, head, address, value, by_cpu, now);
  }
  void object_forced(const plant::ForcedObject& object, can::Time now) override {
    first_.object_forced(object, now);
    second_.object_forced(object, now);
  }
  void object_released(const plant::ForcedObject& object, can::Time now) override {
    first_.object_released(object, now);
    second_.object_released(object, now);
  }
  void lift_event(std::string_view bus, const sim::lift::LiftEvent& event) override {
    first_.lift_event(bus, event);
    second_.lift_event(bus, event);
  }
  void load(std::string_view bus, const can::BusLoad& load, can::Time now) override {
    first_.load(bus, load, now);
    second_.load(bus, load, now);
  }
  void warning(std::string_view source, std::string_view message, can::Time now) override {
    first_.warning(source, message, now);
    second_.warning(source, message, now);
  }
  void module_event(std::string_view plc, std::string_view source,
                    const module::ModuleEventRecord& record) override {
    first_.module_event(plc, source, record);
    second_.module_event(plc, source, record);
  }
  void module_error(std::string_view plc, std::string_view source,
                    const module::ModuleErrorRecord& record) override {
    first_.module_error(plc, source, record);
    second_.module_error(plc, source, record);
  }
  void error(std::string_view source, std::string_view message, can::Time now) override {
    first_.error(source, message, now);
    second_.error(source, message, now);
  }

 private:
  plant::PlantObserver& first_;
  plant::PlantObserver& second_;
};

}  // namespace canopus::web
