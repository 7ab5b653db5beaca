#include "canopus/manager/nmt/master_port.hpp"

namespace canopus::manager {

// A Stopped node sends no SDO and takes none, and nothing is reported [CiA 301 7.3.2.2.4; ME3CAN1-Q 4.8.1]: the
// start-up finds no answer and goes on asking.
bool MasterPort::send(const can::Frame& frame) {
  if (muted_) return true;
  if ((frame.identifier & canopen::cob_id::function_code) != canopen::cob_id::sdo_request)
    return wire_.send(frame);
  if (node_->state() == canopen::NmtState::stopped) return true;
  return queue_.send(frame, wire_, now_);
}

}  // namespace canopus::manager
