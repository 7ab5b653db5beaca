#include "canopus/module/storage/concise_dcf_store.hpp"

#include <vector>

#include "canopus/module/storage/stored_settings.hpp"

namespace canopus::module {

namespace {

constexpr std::uint16_t files_index = 0x1F22;
constexpr std::uint8_t nodes = 127;

}  // namespace

ConciseDcfStore::ConciseDcfStore(canopen::Node& node, manager::NmtMaster& master, NonVolatileMemory& memory,
                                 std::string_view name, const manager::ConfigurationOptions& options)
    : memory_(&memory), name_(name), configurations_(node, master, this, options) {}

bool ConciseDcfStore::load() {
  forget_all();
  const NonVolatileMemory::Content content = memory_->read(name_);
  switch (content.state) {
    case NonVolatileMemory::Content::State::missing: return true;
    case NonVolatileMemory::Content::State::damaged: return false;
    case NonVolatileMemory::Content::State::good: break;
  }
  if (!canopen::are_stored_values(content.bytes, stored_length)) return false;
  canopen::StoredValueReader reader(content.bytes, stored_length);
  while (const auto value = reader.next()) {
    if (value->index == files_index) configurations_.load(value->sub, value->bytes);
  }
  return true;
}

std::vector<std::uint8_t> ConciseDcfStore::stored_nodes() {
  std::vector<std::uint8_t> found;
  const NonVolatileMemory::Content content = memory_->read(name_);
  if (!canopen::are_stored_values(content.bytes, stored_length)) return found;
  canopen::StoredValueReader reader(content.bytes, stored_length);
  while (const auto value = reader.next()) {
    if (value->index == files_index) found.push_back(value->sub);
  }
  return found;
}

bool ConciseDcfStore::merge(const std::map<std::uint8_t, std::vector<std::uint8_t>>& files, bool& changed) {
  changed = false;
  std::map<std::uint8_t, std::vector<std::uint8_t>> all;
  const NonVolatileMemory::Content content = memory_->read(name_);
  if (content.state == NonVolatileMemory::Content::State::good &&
      canopen::are_stored_values(content.bytes, stored_length)) {
    canopen::StoredValueReader reader(content.bytes, stored_length);
    while (const auto value = reader.next()) {
      if (value->index == files_index) all[value->sub].assign(value->bytes.begin(), value->bytes.end());
    }
  }
  const auto before = all;
  for (const auto& [node_id, file] : files) all[node_id] = file;
  if (all == before) return true;
  const manager::ConfigurationOptions& options = configurations_.options();
  if (all.size() > options.maximum_files) return false;
  std::vector<std::uint8_t> bytes;
  for (const auto& [node_id, file] : all) {
    if (options.maximum_size != 0 && file.size() > options.maximum_size) return false;
    canopen::append_stored_value(bytes, stored_length, files_index, node_id, file);
  }
  changed = memory_->write(name_, bytes);
  return changed;
}

void ConciseDcfStore::clear() {
  memory_->erase(name_);
  forget_all();
}

void ConciseDcfStore::forget_all() {
  for (std::uint8_t n = 1; n <= nodes; ++n) configurations_.load(n, {});
}

// All files as they will be when `file` is the one of this node.
bool ConciseDcfStore::store(std::uint8_t node_id, std::span<const std::uint8_t> file) {
  std::vector<std::uint8_t> bytes;
  for (std::uint8_t n = 1; n <= nodes; ++n) {
    const std::span<const std::uint8_t> content = n == node_id ? file : configurations_.concise_dcf(n);
    if (!content.empty()) canopen::append_stored_value(bytes, stored_length, files_index, n, content);
  }
  return memory_->write(name_, bytes);
}

}  // namespace canopus::module
