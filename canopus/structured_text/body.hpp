#pragma once
// The code of one program organization unit while it is made, and its frame: variables, constants and intermediate results.

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "canopus/program/program.hpp"

namespace canopus::structured_text {

using program::Opcode;
using program::Slot;
using program::SourcePosition;

class Body {
 public:
  /// Slots at the end of the frame that stay its own.
  std::uint32_t reserve(std::uint32_t slots) {
    const auto first = static_cast<std::uint32_t>(image.size());
    if (image.size() + slots > program::most_slots) {
      is_too_large = true;
      return 0;
    }
    image.resize(image.size() + slots);
    return first;
  }
  /// A slot that always holds this value.
  std::uint32_t constant(Slot value) {
    const auto [found, is_new] = constants_.try_emplace(value, 0);
    if (is_new) {
      found->second = reserve(1);
      if (!is_too_large) image[found->second] = value;
    }
    return found->second;
  }
  /// Slots for intermediate results of a statement.
  std::uint32_t temporary(std::uint32_t slots = 1) { return take({slots, 0}); }
  /// A value of one statement alone, which nothing reads any more once it has been used.
  [[nodiscard]] bool is_temporary(std::uint32_t slot) const {
    return std::ranges::find(taken_, slot, &std::pair<Kind, std::uint32_t>::second) != taken_.end();
  }
  /// The same for a string of that capacity.
  std::uint32_t string_temporary(std::uint32_t capacity, unsigned bits) {
    const std::uint32_t first = take({program::string_slots(capacity, bits), capacity});
    if (!is_too_large) image[first] = program::string_header(0, capacity);
    return first;
  }
  /// A statement ends: what it took is free again.
  void release() {
    for (const auto& [kind, first] : taken_) free_[kind].push_back(first);
    taken_.clear();
  }

  std::size_t emit(Opcode opcode, std::uint32_t a = 0, std::uint32_t b = 0, std::uint32_t c = 0,
                   std::uint16_t extra = 0) {
    code.push_back({opcode, extra, a, b, c});
    positions.push_back(at);
    return code.size() - 1;
  }
  [[nodiscard]] std::size_t here() const noexcept { return code.size(); }
  /// The jump goes to the next instruction to come.
  void land(std::size_t jump) { land(jump, here()); }
  void land(std::size_t jump, std::size_t target) {
    code[jump].c =
        static_cast<std::uint32_t>(static_cast<std::int64_t>(target) - static_cast<std::int64_t>(jump));
  }

  std::vector<program::Instruction> code;
  std::vector<SourcePosition> positions;
  std::vector<Slot> image;  ///< of the frame, at first
  SourcePosition at{};      ///< of the instructions to come
  bool is_too_large = false;

 private:
  using Kind = std::pair<std::uint32_t, std::uint32_t>;  // slots, capacity of a string

  std::uint32_t take(Kind kind) {
    std::vector<std::uint32_t>& free = free_[kind];
    std::uint32_t first = 0;
    if (free.empty()) {
      first = reserve(kind.first);
    } else {
      first = free.back();
      free.pop_back();
    }
    taken_.emplace_back(kind, first);
    return first;
  }

  std::map<Slot, std::uint32_t> constants_;
  std::map<Kind, std::vector<std::uint32_t>> free_;
  std::vector<std::pair<Kind, std::uint32_t>> taken_;
};

}  // namespace canopus::structured_text
