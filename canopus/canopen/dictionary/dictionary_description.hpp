#pragma once
// What is common to all nodes of one kind: which objects there are, their types, access rights, limits, names
// and defaults. Built once (from an EDS file, from a module's table, or in code) and shared; a node owns only
// its values (object_dictionary.hpp). Looking up an object is one multiplication and, on average, little more
// than one comparison, whatever its index. Devices of one kind whose defaults differ share everything else
// (with()).

#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/data_type.hpp"

namespace canopus::canopen {

/// One sub-index. `offset` and `length` say where its value lies in a node's value block, `offset` from the object's
/// on; for types of variable length that is the number of its slot instead and `length` is 0. Objects whose sub-indexes are
/// alike (all plain variables of a type, PDOs of a file) have the same ones.
struct EntryDescription {
  std::uint32_t offset = 0;        ///< added to ObjectDescription::offset, modulo 2^32
  std::uint32_t name = 0;          ///< in DictionaryDescription::name(); 0 = the object's
  std::uint16_t limits = 0;        ///< 0 = none, else DictionaryDescription::limits(limits)
  DataType type = DataType::none;  ///< none: this sub-index does not exist
  Access access = Access::read_only;
  std::uint8_t length = 0;  ///< bytes
  bool rpdo_mappable : 1 = false;
  bool tpdo_mappable : 1 = false;
  bool stored : 1 = false;  ///< saved by 1010H
  /// May be written by whatever is as long: a number of 1..4 bytes without limits.
  bool is_plainly_writable : 1 = false;
  bool is_plainly_readable : 1 = false;  ///< 1..4 bytes that may be read

  [[nodiscard]] bool operator==(const EntryDescription&) const noexcept = default;
};

/// Lowest and highest value, as the 64-bit pattern of the entry's type (sign-extended, or an IEEE double for
/// reals).
struct Limits {
  std::optional<std::uint64_t> low;
  std::optional<std::uint64_t> high;

  [[nodiscard]] auto operator<=>(const Limits&) const noexcept = default;
};

/// One index. A uniform object (CompactSubObj, or an array of alikes) has one description for all of its
/// sub-indexes from 01H on; their values follow each other.
struct ObjectDescription {
  std::uint16_t index = 0;
  ObjectCode code = ObjectCode::variable;
  std::uint8_t highest_sub = 0;
  std::uint32_t first_entry = 0;
  std::uint32_t offset = 0;  ///< of its first value in a node's value block; without one: of its first slot
  std::uint32_t name : 31 = 0;
  bool uniform : 1 = false;
};

/// A sub-index found: its description, and where its value lies.
struct Entry {
  const EntryDescription* description = nullptr;
  std::uint32_t offset = 0;  ///< in the value block, or slot number for types of variable length
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t unused = 0;  // no padding at the end: an Entry is copied as two words

  explicit operator bool() const noexcept { return description != nullptr; }
};

/// Roughly which part of the value block: a bit for each four bytes, from the first one on again after 64. What has no bit in
/// common with something else has no byte in common with it.
using ValueMask = std::uint16_t;
inline constexpr ValueMask all_values = 0xFFFF;
/// Of a value of up to 8 bytes.
[[nodiscard]] constexpr ValueMask value_mask_of(std::uint32_t offset, std::uint8_t length) noexcept {
  const std::uint32_t count = (offset % 4 + length + 3) / 4;
  return std::rotl(static_cast<ValueMask>((1U << count) - 1), static_cast<int>(offset / 4 % 16));
}

/// What DictionaryBuilder needs to know of one sub-index.
struct EntrySpec {
  std::string name{};
  DataType type = DataType::unsigned32;
  Access access = Access::read_write;
  std::vector<std::uint8_t>
      value{};                ///< default, as an SDO carries it; a fixed type's is filled up with zeros
  bool adds_node_id = false;  ///< the node-ID is added to the default ($NODEID+...)
  bool rpdo_mappable = false;
  bool tpdo_mappable = false;
  bool stored = false;
  Limits limits{};
};

class DictionaryDescription {
 public:
  /// The object of this index, or nullptr.
  [[nodiscard]] const ObjectDescription* find(std::uint16_t index) const noexcept {
    const std::size_t position = find_position(index);
    return position == no_position ? nullptr : &objects_[position];
  }
  /// The position() of the object of this index, or no_position.
  [[nodiscard]] std::size_t find_position(std::uint16_t index) const noexcept {
    for (const std::uint16_t* place = positions_ + first_place(index, multiplier_, places_);; ++place) {
      const std::size_t position = *place;
      if (position == no_position || objects_[position].index == index) return position;
    }
  }
  static constexpr std::uint16_t no_position = 0xFFFF;
  /// The sub-index, or an empty Entry.
  [[nodiscard]] Entry find(std::uint16_t index, std::uint8_t sub) const noexcept;
  [[nodiscard]] Entry find(const ObjectDescription& object, std::uint8_t sub) const noexcept {
    if (sub > object.highest_sub) return {};
    const Entry entry = place(object, sub);
    return entry.description->type == DataType::none ? Entry{} : entry;
  }
  /// The same for a sub-index up to the object's highest one; what is described there may be of no type.
  [[nodiscard]] Entry place(const ObjectDescription& object, std::uint8_t sub) const noexcept {
    if (!object.uniform || sub == 0) [[likely]] {
      const EntryDescription& entry = entries_[std::size_t{object.first_entry} + sub];
      return {&entry, object.offset + entry.offset, object.index, sub};
    }
    const EntryDescription& entry = entries_[object.first_entry + 1];
    const std::uint32_t step = entry.length == 0 ? 1U : entry.length;
    return {&entry, object.offset + entry.offset + (sub - 1U) * step, object.index, sub};
  }
  /// Position of the object among all (0, 1, 2 ... in order of index); the object must be one of this
  /// description's.
  [[nodiscard]] std::size_t position(const ObjectDescription& object) const noexcept {
    return static_cast<std::size_t>(&object - objects_);
  }

  [[nodiscard]] const ObjectDescription& object(std::size_t position) const noexcept {
    return objects_[position];
  }
  /// All objects in order of index.
  [[nodiscard]] std::span<const ObjectDescription> objects() const noexcept {
    return layout_->of(layout_->objects);
  }
  [[nodiscard]] std::string_view name(const ObjectDescription& object) const noexcept {
    return layout_->name(object.name);
  }
  [[nodiscard]] std::string_view name(const Entry& entry) const noexcept {
    return entry.description->name == 0 ? name(*find(entry.index)) : layout_->name(entry.description->name);
  }
  [[nodiscard]] Limits limits(const Entry& entry) const noexcept {
    return entry.description->limits == 0 ? Limits{}
                                          : layout_->of(layout_->limits)[entry.description->limits - 1U];
  }
  /// Some entries are marked as saved by 1010H: EntryDescription::stored.
  [[nodiscard]] bool marks_stored() const noexcept { return layout_->marks_stored; }
  /// The objects from index `first` to `last`, in order of index.
  [[nodiscard]] std::span<const ObjectDescription> objects(std::uint16_t first,
                                                           std::uint16_t last) const noexcept;
  /// Size of a node's value block, and of the part of it that holds 0000H-1FFFH (it comes first).
  [[nodiscard]] std::size_t block_size() const noexcept { return layout_->image.count; }
  [[nodiscard]] std::size_t communication_block_size() const noexcept {
    return layout_->communication_block_size;
  }
  /// Number of values of variable length, and of those in 0000H-1FFFH (they come first).
  [[nodiscard]] std::size_t slot_count() const noexcept { return layout_->slot_ends.count; }
  [[nodiscard]] std::size_t communication_slot_count() const noexcept {
    return layout_->communication_slot_count;
  }
  [[nodiscard]] std::span<const std::uint8_t> default_bytes(std::uint32_t slot) const noexcept;
  /// The same as a copy.
  [[nodiscard]] std::vector<std::uint8_t> default_slot(std::uint32_t slot) const {
    const auto bytes = default_bytes(slot);
    return {bytes.begin(), bytes.end()};
  }
  /// Writes the defaults for this node-ID over the first `size` bytes of `block` (block_size(), or
  /// communication_block_size() for those of the communication profile alone).
  void load_defaults(std::span<std::uint8_t> block, std::uint8_t node_id) const noexcept;
  /// The PDO parameters (1400H-1BFFH) in a node's value block are the defaults for this node-ID. False, too, where
  /// that cannot be found at once: a value of variable length among them, or more than 2 KiB up to there.
  [[nodiscard]] bool has_default_pdos(std::span<const std::uint8_t> block,
                                      std::uint8_t node_id) const noexcept;

  /// One of these defaults, zero-extended; 0 for a type of variable length.
  [[nodiscard]] std::uint64_t default_value(const Entry& entry, std::uint8_t node_id) const noexcept;

  /// What a write of `length` bytes is refused with, whatever the value.
  [[nodiscard]] static AbortCode check_write(const Entry& entry, std::size_t length) noexcept;
  /// What a write of this value is refused with before a handler is asked.
  [[nodiscard]] AbortCode check_write(const Entry& entry, std::span<const std::uint8_t> value) const noexcept;

  /// A default of one sub-index in place of the described one.
  struct Change {
    Entry entry;  ///< of this description
    std::vector<std::uint8_t> value;
  };
  /// The same description with other defaults: one device of a kind that was configured before it is switched
  /// on. Entries of one are entries of the other; it costs the changes, not a copy.
  [[nodiscard]] std::shared_ptr<const DictionaryDescription> with(std::span<const Change> changes) const;

 private:
  friend class DictionaryBuilder;
  struct Draft;  // a layout that is being made: dictionary_draft.hpp
  struct NodeIdDefault {
    std::uint32_t offset : 28;
    std::uint32_t length : 4;
  };
  /// A table within a layout's memory.
  template <typename T>
  struct Table {
    std::uint32_t begin = 0;  // bytes from the layout on
    std::uint32_t count = 0;
  };
  /// What descriptions that differ in defaults alone have in common: one piece of memory, which begins with this.
  struct Layout {
    Table<Limits> limits;
    Table<ObjectDescription> objects;
    Table<EntryDescription> entries;
    Table<NodeIdDefault> node_id_defaults;  // in order of offset
    Table<std::uint32_t> slot_ends;         // of the defaults of variable length, in slot_bytes
    Table<std::uint16_t> positions;         // a hash table over the index: positions in `objects`
    Table<std::uint8_t> image;
    Table<std::uint8_t> slot_bytes;
    Table<char> text;              // all names, each behind its length; a name's number is its place in here
    std::uint32_t multiplier = 0;  // of the hash
    std::uint32_t places = 0;      // that it leads to; some more follow
    std::uint32_t communication_block_size = 0;
    std::uint32_t communication_slot_count = 0;
    std::uint32_t pdo_values_begin = 0;  // of 1400H-1BFFH in the image
    std::uint32_t pdo_values_end = 0;    // 0: there are slots among them
    bool marks_stored = false;

    template <typename T>
    [[nodiscard]] std::span<const T> of(Table<T> table) const noexcept {
      return {reinterpret_cast<const T*>(reinterpret_cast<const std::byte*>(this) + table.begin),
              table.count};
    }
    [[nodiscard]] std::string_view name(std::uint32_t number) const noexcept;
  };
  /// Where a look-up begins: one of `places`, whatever their number.
  [[nodiscard]] static std::uint32_t first_place(std::uint16_t index, std::uint32_t multiplier,
                                                 std::uint32_t places) noexcept {
    return static_cast<std::uint32_t>(std::uint64_t{index * multiplier} * places >> 32);
  }
  [[nodiscard]] AbortCode check_limits(const Entry& entry,
                                       std::span<const std::uint8_t> value) const noexcept;
  explicit DictionaryDescription(std::shared_ptr<const Layout> layout);

  // Of the layout, what a look-up needs.
  const std::uint16_t* positions_;
  const ObjectDescription* objects_;
  const EntryDescription* entries_;
  std::uint32_t multiplier_;
  std::uint32_t places_;
  std::shared_ptr<const Layout> layout_;
  /// Defaults in place of the layout's: of fixed length, and of variable length.
  struct Value {
    std::uint32_t offset = 0;
    std::uint8_t length = 0;
    std::uint64_t value = 0;
  };
  struct Slot {
    std::uint32_t number = 0;
    std::vector<std::uint8_t> bytes;
  };
  struct Changes {
    std::vector<Value> values;
    std::vector<Slot> slots;
  };
  std::unique_ptr<const Changes> changes_;  // mostly there are none
};

/// Collects objects in any order and lays them out. A later add of the same sub-index replaces the earlier
/// one.
class DictionaryBuilder {
 public:
  /// A VAR (or DOMAIN): one value at sub-index 00H.
  DictionaryBuilder& variable(std::uint16_t index, EntrySpec spec);
  /// Names an ARRAY or RECORD; its sub-indexes follow with sub(). Sub-index 00H is made if it is not added:
  /// U8, constant, the highest sub-index.
  DictionaryBuilder& object(std::uint16_t index, ObjectCode code, std::string name);
  /// Adds a sub-index to an object() named before (or, unnamed, to a new RECORD).
  DictionaryBuilder& sub(std::uint16_t index, std::uint8_t sub, EntrySpec spec);
  /// An object whose sub-indexes 01H..count (1..254) are all alike, described once.
  DictionaryBuilder& uniform(std::uint16_t index, ObjectCode code, std::string name, std::uint8_t count,
                             EntrySpec spec);
  /// True when an object of this index was added.
  [[nodiscard]] bool contains(std::uint16_t index) const { return objects_.contains(index); }
  /// Lays everything out. The builder may be used on; what was built stays as it is.
  [[nodiscard]] std::shared_ptr<const DictionaryDescription> build() const;

 private:
  /// An EntrySpec in few bytes: a module has thousands of sub-indexes.
  struct EntryPlan {
    std::uint64_t value = 0;         // of a type of fixed length; else 0, or a number in texts_ and 1
    std::uint32_t name = 0;          // in known_names_
    std::uint32_t limits = 0;        // 0, or a number in limits_ and 1
    EntryDescription description{};  // but for its name, limits and place
    bool adds_node_id = false;
    std::uint8_t sub = 0;
  };
  struct ObjectPlan {
    ObjectCode code = ObjectCode::record;
    std::uint8_t uniform_count = 0;  // 0 = not uniform
    std::uint32_t name = 0;
    std::vector<EntryPlan> subs;  // in order of sub-index

    [[nodiscard]] const EntryPlan* find(std::uint8_t sub) const noexcept;
    void put(EntryPlan plan);
  };
  [[nodiscard]] EntryPlan plan(std::uint8_t sub, const EntrySpec& spec);
  [[nodiscard]] std::uint32_t name_number(std::string_view name);

  std::map<std::uint16_t, ObjectPlan> objects_;
  std::map<std::string, std::uint32_t, std::less<>> known_names_;
  std::vector<std::vector<std::uint8_t>> texts_;  // defaults of types of variable length
  std::vector<Limits> limits_;
};

/// Defaults as bytes: little_endian(0x195, 4) = 95 01 00 00.
using can::little_endian;
/// A string's default.
[[nodiscard]] std::vector<std::uint8_t> text(std::string_view value);

}  // namespace canopus::canopen
