#pragma once
// What happens in one part of a plant, on its way to the plant's observer: at once, or, while the part runs apart from the
// others, afterwards in the order of all.

#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::plant {

class DeferredEvents final : public PlantObserver {
 public:
  /// Both outlive it; the timeline is the part's.
  DeferredEvents(PlantObserver& observer, const can::Timeline& timeline)
      : observer_(observer), timeline_(timeline) {}

  /// Hands on what was held back, of all parts, as if they had run together. To be called when they have met.
  static void release(std::span<const std::unique_ptr<DeferredEvents>> parts);

  void booted(const NodeLabel& node, can::Time now) override;
  void nmt_state_changed(const NodeLabel& node, canopen::NmtState state, can::Time now) override;
  void lss_configured(const NodeLabel& node, std::uint32_t bit_rate, can::Time now) override;
  void emergency(const NodeLabel& node, const canopen::Emergency& message, can::Time now) override;
  void unacknowledged(const NodeLabel& node, can::Time now) override;
  void bus_error(const BusErrorEvent& error, can::Time now) override;
  void controller_changed(const NodeLabel& node, const can::ControllerReport& report, can::Time now) override;
  void slave_boot_went_on(const NodeLabel& slave, const NodeLabel& master, const manager::BootRecord& record,
                          can::Time now) override;
  void signal_changed(std::string_view plc, char kind, unsigned number, bool on, can::Time now) override;
  void buffer_changed(std::string_view plc, unsigned head, std::uint32_t address, std::uint16_t value,
                      bool by_cpu, can::Time now) override;
  void object_forced(const ForcedObject& object, can::Time now) override;
  void object_released(const ForcedObject& object, can::Time now) override;
  void lift_event(std::string_view bus, const sim::lift::LiftEvent& event) override;
  void load(std::string_view bus, const can::BusLoad& load, can::Time now) override;
  void warning(std::string_view source, std::string_view message, can::Time now) override;
  void module_event(std::string_view plc, std::string_view source,
                    const module::ModuleEventRecord& record) override;
  void module_error(std::string_view plc, std::string_view source,
                    const module::ModuleErrorRecord& record) override;
  void error(std::string_view source, std::string_view message, can::Time now) override;

 private:
  struct Held {
    can::TickStamp stamp;
    std::function<void(PlantObserver&)> event;
  };
  /// Nothing is copied, and no memory taken, for an event that is handed on at once.
  template <typename... Parameters, typename... Arguments>
  void pass(void (PlantObserver::*event)(Parameters...), const Arguments&... arguments);

  PlantObserver& observer_;
  const can::Timeline& timeline_;
  std::vector<Held> held_;
};

}  // namespace canopus::plant
