#include "canopus/master/network_master.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "canopus/can/little_endian.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/manager/configuration/master_dictionary.hpp"
#include "canopus/master/dcf_download.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::master {
namespace {

using manager::BootRecord;
using manager::BootStep;

std::uint32_t whole_milliseconds(can::Duration duration) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

std::uint32_t start_up_of(const NetworkFile& file) {
  using namespace manager::start_up_bit;
  std::uint32_t bits = nmt_master;
  if (file.start_together) bits |= start_all_nodes;
  if (!file.start_slaves) bits |= do_not_start_slaves;
  if (file.on_error == ErrorReaction::reset_all) bits |= reset_all_nodes;
  if (file.flying) bits |= flying_master;
  if (file.on_error == ErrorReaction::stop_all) bits |= stop_all_nodes;
  return bits;
}

}  // namespace

std::string describe(const NetworkSlave& slave) {
  return slave.name.empty() ? fmt::format("node {}", slave.node)
                            : fmt::format("node {} ({})", slave.node, slave.name);
}

NetworkMaster::NetworkMaster(const NetworkFile& file, can::Sink& sink, NetworkObserver& observer)
    : MasterNode(manager::master_dictionary(), file.node, sink, {}, file.options),
      file_(file),
      observer_(observer) {
  master().set_listener(this);
  master().set_configuration_source(this);
}

std::expected<std::unique_ptr<NetworkMaster>, std::vector<text::FileError>> NetworkMaster::build(
    const NetworkFile& file, can::Sink& sink, NetworkObserver& observer) {
  std::unique_ptr<NetworkMaster> network(new NetworkMaster(file, sink, observer));
  network->store(0x1F80, 0, start_up_of(file));
  network->store(0x1017, 0, whole_milliseconds(file.heartbeat));
  network->store(0x102A, 0,
                 static_cast<std::uint32_t>(file.nmt_inhibit_time / std::chrono::microseconds(100)));
  if (file.flying) network->store_flying(*file.flying);
  if (file.boot_time) network->store(0x1F89, 0, whole_milliseconds(*file.boot_time));
  std::vector<text::FileError> errors;
  for (const NetworkSlave& slave : network->file_.slaves) {
    std::ranges::move(network->prepare(slave), std::back_inserter(errors));
  }
  if (!errors.empty()) return std::unexpected(std::move(errors));
  return network;
}

void NetworkMaster::store_flying(const manager::FlyingMasterTiming& timing) {
  store(0x1F90, 1, whole_milliseconds(timing.time_out));
  store(0x1F90, 2, whole_milliseconds(timing.negotiation_delay));
  store(0x1F90, 3, timing.level);
  store(0x1F90, 4, whole_milliseconds(timing.priority_slot));
  store(0x1F90, 5, whole_milliseconds(timing.device_slot));
  store(0x1F90, 6, whole_milliseconds(timing.detect_cycle));
}

std::vector<text::FileError> NetworkMaster::prepare(const NetworkSlave& slave) {
  namespace bit = manager::assignment_bit;
  const std::uint32_t guard_time = whole_milliseconds(slave.guard_time);
  std::uint32_t assignment = bit::slave | bit::boot_slave;
  if (slave.mandatory) assignment |= bit::mandatory;
  if (slave.keep_alive) assignment |= bit::keep_alive;
  if (slave.software_version) assignment |= bit::check_software;
  if (!slave.program.empty()) assignment |= bit::update_software;
  if (slave.restore != 0) assignment |= bit::restore;
  if (guard_time != 0) assignment |= manager::guarding_bits(guard_time, slave.retry_factor);
  store(0x1F81, slave.node, assignment);
  if (slave.consumer_heartbeat_time != can::Duration{}) {
    store(0x1016, static_cast<std::uint8_t>(++watched_),
          std::uint32_t{slave.node} << 16 | whole_milliseconds(slave.consumer_heartbeat_time));
  }
  store(0x1F55, slave.node, slave.software_version.value_or(0));
  store(0x1F8A, slave.node, slave.restore);
  if (!slave.program.empty()) {
    auto program = read_beside(slave.program);
    if (program && program->empty()) program = std::unexpected("the file is empty");
    if (!program) {
      return {{slave.program_place, fmt::format("program = \"{}\": {}", slave.program, program.error())}};
    }
    programs_[slave.node] = std::move(*program);
  }
  eds::Identity identity;
  if (!slave.eds.empty()) {
    const auto found = prepare_device(slave);
    if (!found) return found.error();
    identity = *found;
  }
  store(0x1F84, slave.node, slave.device_type.value_or(identity.device_type.value_or(0)));
  store(0x1F85, slave.node, slave.vendor.value_or(identity.vendor_id.value_or(0)));
  store(0x1F86, slave.node, slave.product.value_or(identity.product_code.value_or(0)));
  store(0x1F87, slave.node, slave.revision.value_or(identity.revision.value_or(0)));
  store(0x1F88, slave.node, slave.serial.value_or(0));
  return {};
}

std::expected<eds::Identity, std::vector<text::FileError>> NetworkMaster::prepare_device(
    const NetworkSlave& slave) {
  const auto refuse = [&](std::string_view what) {
    return std::unexpected(
        std::vector<text::FileError>{{slave.eds_place, fmt::format("eds = \"{}\": {}", slave.eds, what)}});
  };
  const auto text = read_beside(slave.eds);
  if (!text) return refuse(text.error());
  const eds::ReadResult device = eds::read_device_file(*text);
  if (device.file == nullptr) {
    return refuse(fmt::format("line {}: {}", device.problems[0].line, device.problems[0].message));
  }
  auto concise = concise_dcf_of(*device.file, slave.objects, slave.node);
  if (!concise) return std::unexpected(concise.error());
  files_[slave.node] = std::move(*concise);
  expect_configuration(slave.node);
  return eds::identity(*device.file);
}

std::expected<std::string, std::string> NetworkMaster::read_beside(const std::string& name) const {
  return text::read_file((std::filesystem::path(file_.path).parent_path() / name).string());
}

manager::Program NetworkMaster::open_program(std::uint8_t node_id) {
  const std::string& program = programs_[node_id];
  if (program.empty()) return {};
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(program.data());
  program_readers_[node_id] = canopen::MemorySource({bytes, program.size()});
  return {.bytes = &program_readers_[node_id], .size = static_cast<std::uint32_t>(program.size())};
}

// A configuration with a date (1020H) need not be downloaded to a slave that has it.
void NetworkMaster::expect_configuration(std::uint8_t node_id) {
  manager::ConciseDcfReader reader(files_[node_id]);
  while (const auto entry = reader.next()) {
    if (entry->index != 0x1020 || entry->data.size() != 4 || entry->sub < 1 || entry->sub > 2) continue;
    store(static_cast<std::uint16_t>(0x1F25 + entry->sub), node_id, can::load_u32(entry->data));
  }
}

NetworkMaster::Result NetworkMaster::result(const NetworkSlave& slave) const {
  const BootRecord& record = master().boot_record(slave.node);
  if (file_.flying && !master().active()) return Result::left_to_the_active_master;
  if (record.step == BootStep::booted) return Result::booted;
  if (master().halted() && record.step == BootStep::idle) return Result::given_up;
  const bool silent =
      record.error == manager::BootError::no_answer || record.error == manager::BootError::none;
  return !slave.mandatory && silent && record.step != BootStep::failed ? Result::absent : Result::failed;
}

bool NetworkMaster::start_up_over() const {
  if (master().halted()) return true;
  if (!master().active()) return false;
  if (!finished_) return false;
  return std::ranges::all_of(file_.slaves, [this](const NetworkSlave& slave) {
    const BootStep step = master().boot_record(slave.node).step;
    return step == BootStep::booted || step == BootStep::failed ||
           (!slave.mandatory && step == BootStep::presence_pause);
  });
}

const NetworkSlave* NetworkMaster::find(std::uint8_t node_id) const {
  const auto found = std::ranges::find(file_.slaves, node_id, &NetworkSlave::node);
  return found == file_.slaves.end() ? nullptr : &*found;
}

void NetworkMaster::receive(const can::Frame& frame, can::Time now) {
  MasterNode::receive(frame, now);
  report_master(now);
}

void NetworkMaster::tick(can::Time now) {
  MasterNode::tick(now);
  report_master(now);
}

void NetworkMaster::report_master(can::Time now) {
  if (!file_.flying || master().active_master() == reported_master_) return;
  reported_master_ = master().active_master();
  observer_.master_changed(master().active(), reported_master_, now);
}

void NetworkMaster::configure(canopen::ObjectDictionary& objects) {
  for (const auto& [index, sub, value] : stored_) objects.set(index, sub, value);
  finished_ = false;
}

void NetworkMaster::start_up_finished(can::Time) { finished_ = true; }

void NetworkMaster::boot_went_on(std::uint8_t node_id, const BootRecord& record, can::Time now) {
  if (record.step == BootStep::booted || record.step == BootStep::failed) return;  // reported on their own
  if (const NetworkSlave* slave = find(node_id)) observer_.boot_went_on(*slave, record, now);
}

void NetworkMaster::slave_booted(std::uint8_t node_id, can::Time now) {
  if (const NetworkSlave* slave = find(node_id)) observer_.slave_booted(*slave, now);
}

void NetworkMaster::slave_failed(std::uint8_t node_id, manager::BootError, can::Time now) {
  if (const NetworkSlave* slave = find(node_id)) {
    observer_.slave_failed(*slave, master().boot_record(node_id), now);
  }
}

void NetworkMaster::error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event,
                                        can::Time now) {
  if (const NetworkSlave* slave = find(node_id)) observer_.error_control_event(*slave, event, now);
}

void NetworkMaster::error_control_resolved(std::uint8_t node_id, can::Time now) {
  if (const NetworkSlave* slave = find(node_id)) observer_.error_control_resolved(*slave, now);
}

void NetworkMaster::node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time now) {
  if (const NetworkSlave* slave = find(node_id)) observer_.state_changed(*slave, state, now);
}

}  // namespace canopus::master
