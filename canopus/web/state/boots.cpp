#include "canopus/web/state/boots.hpp"

namespace canopus::web {

void WebBoots::slave_boot_went_on(const plant::NodeLabel& slave, const plant::NodeLabel& master,
                                  const manager::BootRecord& record, can::Time now) {
  Slave& one = slaves_[{std::string(slave.bus), slave.node_id}];
  one.bus = slave.bus;
  one.name = slave.name;
  one.node_id = slave.node_id;
  one.master = master.node_id;
  // The same step with another object goes on; a new one begins where it is told.
  if (!one.steps.empty() && one.steps.back().record.step == record.step) {
    one.steps.back().record = record;
    return;
  }
  one.steps.push_back({now, record});
  if (one.steps.size() > most_steps) one.steps.pop_front();
}

}  // namespace canopus::web
