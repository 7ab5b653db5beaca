#include "canopus/module/storage/flash_memory.hpp"

#include <algorithm>
#include <optional>

#include "canopus/can/little_endian.hpp"

namespace canopus::module {

namespace {

using Content = NonVolatileMemory::Content;

// Kind, count (4 bytes, little-endian), content.
constexpr std::size_t header_size = 5;

std::optional<std::uint32_t> count_of(const Content& stored) {
  if (stored.state != Content::State::good || stored.bytes.size() < header_size) return std::nullopt;
  return can::load_as<std::uint32_t>(&stored.bytes[1]);
}

}  // namespace

void FlashMemory::load() {
  writes_ = 0;
  for (const std::string_view name : names_) {
    writes_ = std::max(writes_, count_of(medium_->read(name)).value_or(0));
  }
}

Content FlashMemory::read(std::string_view name) {
  Content stored = medium_->read(name);
  if (stored.state != Content::State::good) return stored;
  if (!count_of(stored)) return {.state = Content::State::damaged, .bytes = {}};
  switch (static_cast<Kind>(stored.bytes[0])) {
    case Kind::content:
      stored.bytes.erase(stored.bytes.begin(), stored.bytes.begin() + header_size);
      return stored;
    case Kind::erased: return {};
  }
  return {.state = Content::State::damaged, .bytes = {}};
}

bool FlashMemory::write(std::string_view name, std::span<const std::uint8_t> bytes) {
  return put(Kind::content, name, bytes);
}

bool FlashMemory::erase(std::string_view name) {
  return read(name).state == Content::State::missing || put(Kind::erased, name, {});
}

bool FlashMemory::put(Kind kind, std::string_view name, std::span<const std::uint8_t> bytes) {
  const std::uint32_t count = writes_ + 1;
  std::vector<std::uint8_t> stored{static_cast<std::uint8_t>(kind)};
  stored.reserve(header_size + bytes.size());
  can::append_value(stored, count, 4);
  stored.insert(stored.end(), bytes.begin(), bytes.end());
  if (!medium_->write(name, stored)) return false;
  writes_ = count;
  return true;
}

}  // namespace canopus::module
