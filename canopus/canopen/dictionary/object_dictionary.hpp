#pragma once
// The object dictionary of one node: its values, in one contiguous block, over a shared description.
//
// Two ways in: read() and write() are what an SDO (or a local access that must obey the same rules) goes
// through; they check existence, access, length and limits, and call the object's handler. get() and set()
// are the device's own access: no checks, no handler. PDOs copy bytes straight into and out of block().

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "canopus/can/little_endian.hpp"
#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/canopen/dictionary/object_stream.hpp"

namespace canopus::canopen {

class ObjectDictionary;

/// Behaviour of an object or a range of them: asked before a read and before a write, notified after a write.
/// All functions are called from read() and write() only.
class ObjectHandler {
 public:
  /// The value is about to be read: put it up to date with set(), or refuse.
  virtual AbortCode before_read(ObjectDictionary&, const Entry&, can::Time) { return AbortCode::none; }
  /// A value of the right length and within the limits wants in: AbortCode::none lets it.
  virtual AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t> /*value*/,
                                 can::Time) {
    return AbortCode::none;
  }
  /// The value is in.
  virtual void after_write(ObjectDictionary&, const Entry&, can::Time) {}
  /// A value of variable length that an SDO shall read and write piece by piece through this stream, instead
  /// of through the functions above and the dictionary's memory; nullptr: it does not stream.
  virtual ObjectStream* stream(const Entry&) { return nullptr; }

 protected:
  ~ObjectHandler() = default;
};

/// Notified of every value that came in through write(), after its handler.
class WriteObserver {
 public:
  virtual void object_written(const Entry& entry, can::Time now) = 0;

 protected:
  ~WriteObserver() = default;
};

/// Which handlers are called for its objects: see NodeDictionary.
class ObjectDictionary {
 public:
  /// All values at their defaults for this node-ID (1..127, or 255 while unconfigured).
  ObjectDictionary(std::shared_ptr<const DictionaryDescription> description, std::uint8_t node_id);

  [[nodiscard]] const DictionaryDescription& description() const noexcept { return *description_; }
  /// The same, to be kept.
  [[nodiscard]] const std::shared_ptr<const DictionaryDescription>& shared_description() const noexcept {
    return description_;
  }
  /// The sub-index, or why there is none: no_object, no_sub_index.
  [[nodiscard]] std::expected<Entry, AbortCode> find(std::uint16_t index, std::uint8_t sub) const noexcept;

  /// Reads as the bus does. The bytes stay valid until the next call of a non-const member.
  [[nodiscard]] std::expected<std::span<const std::uint8_t>, AbortCode> read(std::uint16_t index,
                                                                             std::uint8_t sub, can::Time now);
  /// The first half of read(): existence, access, handler; bytes(found) is the second.
  [[nodiscard]] AbortCode prepare_read(std::uint16_t index, std::uint8_t sub, can::Time now, Entry& found);
  /// A value of `length` bytes.
  struct ShortValue {
    std::uint32_t number = 0;
    std::uint8_t length = 0;  ///< bytes
  };
  /// read() of what has 1..4 bytes, may be read and has no handler, as most values that are asked for; length
  /// 0: this is none of them.
  /// `multiplexer`: bits 8-23 index, bits 24-31 sub-index, as an SDO has them.
  [[nodiscard]] ShortValue read_short(std::uint32_t multiplexer) noexcept {
    if (multiplexer == last_short_.multiplexer) return load_short(last_short_.offset, last_short_.length);
    const Location location = find_plain(multiplexer);
    if (location.description == nullptr || !location.description->is_plainly_readable) return {};
    last_short_ = {multiplexer, location.offset, location.description->length};
    return load_short(location.offset, location.description->length);
  }
  /// write() of what has 1..4 bytes, as many as given, may be written, and has neither limits nor a handler, as
  /// most values that are written. False: it is none of them, and nothing was done.
  [[nodiscard]] bool write_short(std::uint32_t multiplexer, ShortValue value, can::Time now) {
    const Location location = find_plain(multiplexer);
    if (location.description == nullptr || !store_short(location, value)) return false;
    report_written(entry_at(location, multiplexer), now);
    return true;
  }
  // The steps of write_short(), for callers that do something else between them.
  /// Where a value lies.
  struct Location {
    const EntryDescription* description = nullptr;
    std::uint32_t offset = 0;
  };
  /// An entry, perhaps of no type, of an object without a handler; or none.
  [[nodiscard]] Location find_plain(std::uint32_t multiplexer) const noexcept {
    const std::size_t position = description_->find_position(static_cast<std::uint16_t>(multiplexer >> 8));
    if (position == DictionaryDescription::no_position || handler_numbers_[position] != 0) return {};
    const ObjectDescription& object = description_->object(position);
    const auto sub = static_cast<std::uint8_t>(multiplexer >> 24);
    if (sub > object.highest_sub) return {};
    const Entry entry = description_->place(object, sub);
    return {entry.description, entry.offset};
  }
  /// False: it has to be written in another way.
  [[nodiscard]] bool store_short(Location location, ShortValue value) noexcept {
    if (!location.description->is_plainly_writable || location.description->length != value.length)
      return false;
    std::uint8_t* const to = block_.data() + location.offset;
    if (value.length == 4) [[likely]] {
      std::memcpy(to, &value.number, 4);
    } else {
      can::store_value(to, value.number, value.length);
    }
    return true;
  }
  [[nodiscard]] static Entry entry_at(Location location, std::uint32_t multiplexer) noexcept {
    return {location.description, location.offset, static_cast<std::uint16_t>(multiplexer >> 8),
            static_cast<std::uint8_t>(multiplexer >> 24)};
  }
  void report_written(const Entry& entry, can::Time now) {
    if (write_observer_ != nullptr) write_observer_->object_written(entry, now);
  }
  /// The stream of a value that has one.
  [[nodiscard]] ObjectStream* stream(const Entry& entry) const;
  /// Writes as the bus does.
  [[nodiscard]] AbortCode write(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> value,
                                can::Time now);
  /// What write() would say before it asks the handler, for a value of this length (a download's announced
  /// size).
  [[nodiscard]] AbortCode check_write(const Entry& entry, std::size_t length) const noexcept {
    return DictionaryDescription::check_write(entry, length);
  }

  /// The device's own reading, zero- or sign-extended by T's signedness; T's size must not exceed 8 bytes.
  template <typename T>
  [[nodiscard]] T get(const Entry& entry) const noexcept {
    static_assert(std::is_arithmetic_v<T> && sizeof(T) <= 8);
    if constexpr (std::is_floating_point_v<T>) {
      T value{};
      std::memcpy(&value, &block_[entry.offset], std::min<std::size_t>(sizeof(T), entry.description->length));
      return value;
    } else {
      const std::uint8_t* const from = &block_[entry.offset];
      if (entry.description->length == sizeof(T)) return can::load_as<T>(from);  // nearly always
      std::uint64_t raw = can::load_value(from, entry.description->length);
      if constexpr (std::is_signed_v<T>) {
        const unsigned unused = 64U - 8U * entry.description->length;
        raw = static_cast<std::uint64_t>(static_cast<std::int64_t>(raw << unused) >> unused);
      }
      return static_cast<T>(raw);
    }
  }
  /// The same by number; `otherwise` when there is no such sub-index or it is of variable length.
  template <typename T>
  [[nodiscard]] T get(std::uint16_t index, std::uint8_t sub, T otherwise = {}) const noexcept {
    const Entry entry = description_->find(index, sub);
    return entry && entry.description->length != 0 ? get<T>(entry) : otherwise;
  }
  /// The device's own writing: no checks, no handler.
  template <typename T>
  void set(const Entry& entry, T value) noexcept {
    static_assert(std::is_arithmetic_v<T> && sizeof(T) <= 8);
    if constexpr (std::is_floating_point_v<T>) {
      std::memcpy(&block_[entry.offset], &value, std::min<std::size_t>(sizeof(T), entry.description->length));
    } else {
      std::uint8_t* const to = &block_[entry.offset];
      if (entry.description->length == sizeof(T)) {  // nearly always
        std::memcpy(to, &value, sizeof(T));
      } else {
        can::store_value(to, static_cast<std::uint64_t>(value), entry.description->length);
      }
    }
  }
  /// The same by number. False when there is no such sub-index or it is of variable length.
  template <typename T>
  bool set(std::uint16_t index, std::uint8_t sub, T value) noexcept {
    const Entry entry = description_->find(index, sub);
    if (!entry || entry.description->length == 0) return false;
    set(entry, value);
    return true;
  }
  /// The bytes of a value, of fixed or variable length.
  [[nodiscard]] std::span<const std::uint8_t> bytes(const Entry& entry) const noexcept;
  /// Replaces a value of variable length, or as many bytes of a fixed one as are given.
  void assign(const Entry& entry, std::span<const std::uint8_t> value);

  /// All fixed-length values; EntryDescription says where. The block never moves, and 8 bytes from any value's first one on
  /// may be read, and written as they are.
  [[nodiscard]] std::span<std::uint8_t> block() noexcept { return {block_.data(), block_.size() - spare}; }
  [[nodiscard]] std::span<const std::uint8_t> block() const noexcept {
    return {block_.data(), block_.size() - spare};
  }

  /// Everything at its default for this node-ID: reset node.
  void reset(std::uint8_t node_id);
  /// 0000H-1FFFH at their defaults for this node-ID: reset communication.
  void reset_communication(std::uint8_t node_id);

 protected:
  // NodeDictionary offers these.
  /// Which handlers the objects have.
  struct Attachments {
    std::vector<std::uint8_t> handler_numbers;  // by position of the object
    std::size_t handlers = 0;
  };
  void attach(std::uint16_t first, std::uint16_t last, ObjectHandler& handler);
  [[nodiscard]] Attachments attachments() const { return {handler_numbers_, handlers_.size()}; }
  void restore(const Attachments& earlier) noexcept;
  void set_write_observer(WriteObserver* observer) noexcept { write_observer_ = observer; }

 private:
  [[nodiscard]] ObjectHandler* handler(const ObjectDescription& object) const noexcept {
    return handlers_[handler_numbers_[description_->position(object)]];
  }

  [[nodiscard]] ShortValue load_short(std::uint32_t offset, std::uint8_t length) const noexcept {
    const std::uint8_t* const from = block_.data() + offset;
    if (length == 4) [[likely]]
      return {can::load_as<std::uint32_t>(from), length};
    return {static_cast<std::uint32_t>(can::load_value(from, length)), length};
  }

  static constexpr std::size_t spare = 8;  // bytes behind the values
  std::vector<std::uint8_t> block_;        // first, for the owner to have it beside what else a frame needs
  std::shared_ptr<const DictionaryDescription> description_;
  // What read_short() found last. A caller that reads one value again and again does not wait for the search in the
  // description, five loads of which each needs the one before.
  struct LastShort {
    std::uint32_t multiplexer = 0xFF;  // none has bits 0-7
    std::uint32_t offset = 0;
    std::uint8_t length = 0;
  } last_short_;
  std::vector<std::unique_ptr<std::vector<std::uint8_t>>> slots_;  // empty pointer: still the default
  std::vector<std::uint8_t> handler_numbers_;                      // by position of the object, 0 = none
  std::vector<ObjectHandler*> handlers_;
  WriteObserver* write_observer_ = nullptr;
};

/// The dictionary that a node makes for its services. Others register their handlers with the node (Node::attach()), for it makes
/// another one when it gets another description.
class NodeDictionary final : public ObjectDictionary {
 public:
  using ObjectDictionary::ObjectDictionary;

  /// Calls `handler` for the objects first..last (those that exist) from now on, in place of an earlier one. More than 255 handlers
  /// throw std::length_error.
  using ObjectDictionary::attach;
  /// What is attached now, for restore(): later handlers are called no more, and those that they took the place of are again.
  using ObjectDictionary::Attachments;
  using ObjectDictionary::attachments;
  using ObjectDictionary::restore;
  using ObjectDictionary::set_write_observer;
};

}  // namespace canopus::canopen
