#include "canopus/module/concise_dcf_store.hpp"

#include <algorithm>
#include <array>

#include "canopus/module/stored_settings.hpp"

namespace canopus::module {

namespace {

using canopen::AbortCode;

constexpr std::uint16_t files_index = 0x1F22;
constexpr std::uint16_t request_index = 0x1F25;
constexpr std::uint8_t nodes = 127;
constexpr std::uint8_t all_nodes = 0x80;
constexpr std::array<std::uint8_t, 4> signature{'c', 'o', 'n', 'f'};

bool is_deletion(std::span<const std::uint8_t> value) {
  return value.empty() || (value.size() == 1 && value[0] == 0);
}

}  // namespace

ConciseDcfStore::ConciseDcfStore(canopen::Node& node, manager::NmtMaster& master, NonVolatileMemory& memory,
                                 std::string_view name, const ConciseDcfLimits& limits)
    : node_(&node), master_(&master), memory_(&memory), name_(name), limits_(limits) {
  node.dictionary().attach(files_index, files_index, *this);
  node.dictionary().attach(request_index, request_index, *this);
  master.set_configuration_source(this);
}

std::span<const std::uint8_t> ConciseDcfStore::file(std::uint8_t node_id) const {
  const canopen::ObjectDictionary& objects = node_->dictionary();
  const canopen::Entry entry = objects.description().find(files_index, node_id);
  return entry ? objects.bytes(entry) : std::span<const std::uint8_t>{};
}

std::span<const std::uint8_t> ConciseDcfStore::concise_dcf(std::uint8_t node_id) { return file(node_id); }

std::size_t ConciseDcfStore::count() const {
  std::size_t files = 0;
  for (std::uint8_t n = 1; n <= nodes; ++n) files += file(n).empty() ? 0U : 1U;
  return files;
}

bool ConciseDcfStore::load() {
  const NonVolatileMemory::Content content = memory_->read(name_);
  switch (content.state) {
    case NonVolatileMemory::Content::State::missing: return true;
    case NonVolatileMemory::Content::State::damaged: return false;
    case NonVolatileMemory::Content::State::good: return apply_objects(content.bytes, node_->dictionary());
  }
  return false;
}

void ConciseDcfStore::clear() {
  memory_->erase(name_);
  canopen::ObjectDictionary& objects = node_->dictionary();
  for (std::uint8_t n = 1; n <= nodes; ++n) objects.assign(objects.description().find(files_index, n), {});
}

AbortCode ConciseDcfStore::before_write(canopen::ObjectDictionary&, const canopen::Entry& entry,
                                        std::span<const std::uint8_t> value, can::Time now) {
  return entry.index == files_index ? check_file(entry.sub, value, now) : request(entry.sub, value, now);
}

void ConciseDcfStore::after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                  can::Time) {
  if (entry.index == files_index && is_deletion(dictionary.bytes(entry))) dictionary.assign(entry, {});
}

AbortCode ConciseDcfStore::check_file(std::uint8_t node_id, std::span<const std::uint8_t> value,
                                      can::Time now) {
  if (now < busy_until_ || master_->configuring(node_id)) return AbortCode::hardware_error;
  const bool used = !file(node_id).empty();
  if (is_deletion(value)) {
    if (!used) return AbortCode::none;
    if (!save(node_id, {})) return AbortCode::hardware_error;
    busy_until_ = can::later(now, limits_.erase_time);
    return AbortCode::none;
  }
  if (value.size() > limits_.bytes) return AbortCode::length_mismatch;
  if (used) return AbortCode::write_of_read_only;
  if (count() >= limits_.files) return AbortCode::cannot_store;
  return save(node_id, value) ? AbortCode::none : AbortCode::hardware_error;
}

AbortCode ConciseDcfStore::request(std::uint8_t sub, std::span<const std::uint8_t> value, can::Time now) {
  if (!std::ranges::equal(value, signature)) return AbortCode::cannot_store;
  if (sub != all_nodes) {
    if (sub == node_->node_id()) return AbortCode::none;  // accepted, does nothing [ME3CAN1-Q 4.8.12]
    return master_->request_configuration(sub, now);
  }
  if (!master_->active()) return master_->options().not_master;
  bool any = false;
  for (std::uint8_t n = 1; n <= nodes; ++n) {
    if (n == node_->node_id() || file(n).empty()) continue;
    any = true;
    if (const AbortCode code = master_->request_configuration(n, now); code != AbortCode::none) return code;
  }
  return any ? AbortCode::none : AbortCode::no_data;
}

// All files as they will be when `value` is the one of node `changed`.
bool ConciseDcfStore::save(std::uint8_t changed, std::span<const std::uint8_t> value) {
  std::vector<std::uint8_t> bytes;
  for (std::uint8_t n = 1; n <= nodes; ++n) {
    const std::span<const std::uint8_t> content = n == changed ? value : file(n);
    if (!content.empty()) append_object(bytes, files_index, n, content);
  }
  return memory_->write(name_, bytes);
}

}  // namespace canopus::module
