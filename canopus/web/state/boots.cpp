#include "canopus/web/state/boots.hpp"

namespace canopus::web {

void WebBoots::on(const plant::Event& event) {
  const auto* const boot = std::get_if<plant::SlaveBootStep>(&event.what);
  if (boot == nullptr) return;
  Slave& one = slaves_[{std::string(boot->slave.bus), boot->slave.node_id}];
  one.bus = boot->slave.bus;
  one.name = boot->slave.name;
  one.node_id = boot->slave.node_id;
  one.master = boot->master.node_id;
  // The same step with another object goes on; a new one begins where it is reported.
  if (!one.steps.empty() && one.steps.back().record.step == boot->record.step) {
    one.steps.back().record = boot->record;
    return;
  }
  one.steps.push_back({event.time, boot->record});
  if (one.steps.size() > most_steps) one.steps.pop_front();
}

}  // namespace canopus::web
