#pragma once
// PDO mapping [CiA 301 7.4.8.2]: sub-index 00H of 16xxH/1AxxH is the number of mapped objects, the entries
// are index (16 bits), sub-index (8), length in bits (8). The objects follow each other in the frame bit by
// bit, least significant first. A mapping is compiled once, when it is switched on, into a copy plan between
// frame and value block; a frame then costs a few copies and no look-up. Neighbours in both frame and block
// are copied as one.
//
// Dummy entries 0001H-0007H (:00, length of the type; 0008H where the dictionary has it) leave bits of an
// RPDO unused.

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"

namespace canopus::canopen {

/// Of the index of a communication or mapping object: which PDO, from 0.
inline constexpr std::uint16_t pdo_number_mask = 0x01FF;

enum class PdoDirection : std::uint8_t { receive, transmit };

class CopyPlan {
 public:
  struct Step {
    std::uint32_t offset = 0;  // in the value block
    std::uint8_t bit = 0;      // first bit in the frame
    std::uint8_t bits = 0;     // in the frame
    std::uint8_t bytes = 0;    // of the value
  };

  /// Takes the mapping of `index` (16xxH/1AxxH) as it stands. It is lenient, since device files are: an
  /// object that does not exist leaves its bits unused, one of another length is cut or filled with zeros,
  /// and what goes beyond 64 bits is left out. An absent or switched-off mapping gives an empty plan.
  void compile(const ObjectDictionary& dictionary, std::uint16_t index);
  void clear();

  /// Length of the frame, 0..8.
  [[nodiscard]] std::uint8_t length() const noexcept { return length_; }
  /// Copies that a frame costs.
  [[nodiscard]] std::size_t step_count() const noexcept {
    return (first_.bytes != 0 ? 1U : 0U) + rest_count_;
  }
  /// True when some of the bytes offset..offset+length of the block are mapped.
  [[nodiscard]] bool holds(std::uint32_t offset, std::uint8_t length) const noexcept;

  /// Where the mapped values lie; all_values with one that nodes write by themselves, below 2000H, or without any.
  [[nodiscard]] ValueMask places() const noexcept { return places_; }
  /// The bytes of the block that are mapped lie within these: offset of the first, and behind the last. Nothing
  /// mapped: 0, 0.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> extent() const noexcept;

  /// The data bytes of a frame, little endian; those beyond length() are 0. `block`: as ObjectDictionary::block().
  [[nodiscard]] std::uint64_t gather(const std::uint8_t* block) const noexcept {
    if (!is_single_) return gather_steps(block);
    return can::load_masked(block + first_.offset, mask(first_.bits)) << first_.bit;
  }
  /// Puts the data bytes of a frame into the block.
  void scatter(std::uint64_t frame, std::uint8_t* block) const noexcept {
    is_single_ ? scatter_single(frame, block) : scatter_steps(frame, block);
  }
  /// The mapping is but one copy of whole bytes, as most are.
  [[nodiscard]] bool is_single() const noexcept { return is_single_; }
  /// scatter() if is_single().
  void scatter_single(std::uint64_t frame, std::uint8_t* block) const noexcept {
    can::store_masked(block + first_.offset, frame >> first_.bit, mask(first_.bits));
  }

 private:
  [[nodiscard]] std::uint64_t gather_steps(const std::uint8_t* block) const noexcept;
  void scatter_steps(std::uint64_t frame, std::uint8_t* block) const noexcept;
  // Frames and values stay in registers on the way: a frame written in pieces and then read as a whole would
  // make the processor wait.
  static std::uint64_t gather(const Step& step, const std::uint8_t* block) noexcept {
    return (can::load_value(block + step.offset, step.bytes) & mask(step.bits)) << step.bit;
  }
  static void scatter(const Step& step, std::uint64_t frame, std::uint8_t* block) noexcept {
    can::store_value(block + step.offset, frame >> step.bit & mask(step.bits), step.bytes);
  }
  /// `bits`: 1..64.
  [[nodiscard]] static constexpr std::uint64_t mask(unsigned bits) noexcept {
    return ~std::uint64_t{0} >> (64 - bits);
  }

  [[nodiscard]] std::span<const Step> rest() const noexcept { return {rest_.get(), rest_count_}; }

  // Most mappings are one copy: it lies in the plan itself, which saves a way through memory.
  static constexpr Step no_step{.offset = 0, .bit = 0, .bits = 1, .bytes = 0};
  Step first_ = no_step;
  std::unique_ptr<Step[]> rest_;
  std::uint8_t rest_count_ = 0;
  std::uint8_t length_ = 0;
  ValueMask places_ = 0;
  bool is_single_ = false;
};

/// May this value be mapped: does the object exist (06020000H, 06090011H), is it mappable in this direction
/// and of this length (06040041H)?
[[nodiscard]] AbortCode check_mapping_entry(const ObjectDictionary& dictionary, std::uint32_t mapping,
                                            PdoDirection direction) noexcept;

/// May the mapping object be written so? `valid`: the PDO is (08000022H then; an entry while sub-index 00H is
/// not 0: 06010000H). Switching on checks every entry, their number and the sum of lengths (06040042H).
[[nodiscard]] AbortCode check_mapping_write(const ObjectDictionary& dictionary, const Entry& entry,
                                            std::span<const std::uint8_t> value, bool valid,
                                            PdoDirection direction) noexcept;

}  // namespace canopus::canopen
