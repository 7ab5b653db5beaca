#include "canopus/manager/configuration/configuration_manager.hpp"

#include <algorithm>

#include "canopus/manager/boot/concise_dcf.hpp"

namespace canopus::manager {

using canopen::AbortCode;

namespace {

constexpr std::uint16_t concise_dcf_index = 0x1F22;
constexpr std::uint16_t request_index = 0x1F25;
constexpr std::uint16_t program_index = 0x1F58;
constexpr std::uint8_t all = 0x80;
constexpr std::array<std::uint8_t, 4> signature{0x63, 0x6F, 0x6E, 0x66};  // "conf"

/// "Write 0 to this sub-index" [ME3CAN1-Q 4.8.12]: one byte; or a concise DCF of no entries, four bytes, which
/// says that the node has no configuration [CiA 302-3]. Announced entries, or bytes after the count, make it a
/// file.
bool is_deletion(std::span<const std::uint8_t> file) noexcept {
  constexpr std::array<std::uint8_t, 4> no_entries{};
  return file.empty() || (file.size() == 1 && file[0] == 0) || std::ranges::equal(file, no_entries);
}

}  // namespace

ConfigurationManager::ConfigurationManager(canopen::Node& node, NmtMaster& master, ConfigurationStore* store,
                                           ConfigurationOptions options)
    : master_(&master), store_(store), options_(options) {
  node.attach(concise_dcf_index, concise_dcf_index, *this);
  node.attach(request_index, request_index, *this);
  node.attach(program_index, program_index, *this);
  master.set_configuration_source(this);
}

void ConfigurationManager::load(std::uint8_t node_id, std::span<const std::uint8_t> file) {
  if (node_id == 0 || node_id >= files_.size()) return;
  files_[node_id].assign(file.begin(), file.end());
}

void ConfigurationManager::load_program(std::uint8_t node_id, std::span<const std::uint8_t> program) {
  if (node_id == 0 || node_id >= programs_.size()) return;
  programs_[node_id].assign(program.begin(), program.end());
}

Program ConfigurationManager::open_program(std::uint8_t node_id) {
  if (node_id >= programs_.size() || programs_[node_id].empty()) return {};
  readers_[node_id] = canopen::MemorySource(programs_[node_id]);
  return {.bytes = &readers_[node_id], .size = static_cast<std::uint32_t>(programs_[node_id].size())};
}

unsigned ConfigurationManager::files() const noexcept {
  return static_cast<unsigned>(
      std::count_if(files_.begin(), files_.end(), [](const auto& file) { return !file.empty(); }));
}

AbortCode ConfigurationManager::before_read(canopen::ObjectDictionary& dictionary,
                                            const canopen::Entry& entry, can::Time) {
  if ((entry.index == concise_dcf_index || entry.index == program_index) && entry.sub != 0) {
    if (entry.sub >= files_.size()) return AbortCode::no_sub_index;
    dictionary.assign(entry, entry.index == program_index ? programs_[entry.sub] : files_[entry.sub]);
  }
  return AbortCode::none;
}

AbortCode ConfigurationManager::before_write(canopen::ObjectDictionary&, const canopen::Entry& entry,
                                             std::span<const std::uint8_t> value, can::Time now) {
  if (entry.sub == 0) return AbortCode::write_of_read_only;
  if (entry.index == request_index) return request(entry.sub, value, now);
  return entry.index == program_index ? store_program(entry.sub, value, now)
                                      : store_file(entry.sub, value, now);
}

void ConfigurationManager::after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                       can::Time) {
  // The file is kept here; a second copy in the dictionary would only take room.
  if (entry.index != request_index) dictionary.assign(entry, {});
}

AbortCode ConfigurationManager::store_file(std::uint8_t node_id, std::span<const std::uint8_t> file,
                                           can::Time now) {
  if (node_id >= files_.size()) return AbortCode::no_sub_index;
  if (busy(now)) return options_.busy;
  if (master_->configuring(node_id)) return options_.in_download;
  auto& place = files_[node_id];
  if (is_deletion(file)) {
    if (place.empty()) return AbortCode::none;
    if (store_ != nullptr && !store_->store(node_id, {})) return AbortCode::hardware_error;
    place.clear();
    busy_until_ = can::later(now, options_.erase_time);
    return AbortCode::none;
  }
  if (options_.maximum_size != 0 && file.size() > options_.maximum_size) return options_.too_long;
  if (options_.delete_first && !place.empty()) return options_.in_use;
  if (place.empty() && files() >= options_.maximum_files) return options_.no_room;
  if (options_.check_files && !check_concise_dcf(file)) return AbortCode::invalid_value;
  if (store_ != nullptr && !store_->store(node_id, file)) return AbortCode::hardware_error;
  place.assign(file.begin(), file.end());
  busy_until_ = can::later(now, options_.write_time);
  return AbortCode::none;
}

// One byte 00H deletes it, as it deletes a file.
AbortCode ConfigurationManager::store_program(std::uint8_t node_id, std::span<const std::uint8_t> program,
                                              can::Time now) {
  if (node_id >= programs_.size()) return AbortCode::no_sub_index;
  if (busy(now)) return options_.busy;
  if (master_->boot_record(node_id).step == BootStep::program_download) return AbortCode::device_state;
  if (program.size() == 1 && program[0] == 0) program = {};
  if (options_.maximum_program_size != 0 && program.size() > options_.maximum_program_size) {
    return options_.too_long;
  }
  if (store_ != nullptr && !store_->store_program(node_id, program)) return AbortCode::hardware_error;
  programs_[node_id].assign(program.begin(), program.end());
  busy_until_ = can::later(now, program.empty() ? options_.erase_time : options_.write_time);
  return AbortCode::none;
}

AbortCode ConfigurationManager::request(std::uint8_t sub, std::span<const std::uint8_t> value,
                                        can::Time now) {
  if (!std::ranges::equal(value, signature)) return AbortCode::cannot_store;
  if (sub != all) return master_->request_configuration(sub, now);
  if (!master_->active()) return master_->options().not_master;
  const std::uint8_t own = master_->active_master();
  for (std::uint8_t node_id = 1; node_id < files_.size(); ++node_id) {
    if (node_id == own || files_[node_id].empty()) continue;
    static_cast<void>(master_->request_configuration(node_id, now));
  }
  return AbortCode::none;
}

}  // namespace canopus::manager
