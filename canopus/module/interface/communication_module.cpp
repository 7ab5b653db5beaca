#include "canopus/module/interface/communication_module.hpp"

#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/module/interface/event_records.hpp"
#include "canopus/module/interface/slave_boot_record.hpp"

namespace canopus::module {

std::vector<SlaveBootRecord> CommunicationModule::boots() const { return {}; }
std::vector<ModuleEventRecord> CommunicationModule::event_history() const { return {}; }
std::vector<ModuleErrorRecord> CommunicationModule::module_errors() const { return {}; }
std::vector<canopen::Emergency> CommunicationModule::emergency_history() const { return {}; }

}  // namespace canopus::module
