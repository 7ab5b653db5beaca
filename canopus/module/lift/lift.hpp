#pragma once
// The words of a lift controller's virtual devices [CiA 417; FX3U-CAN 8]: call controller (virtual input and output
// mapping), car door controller and car drive controller, for up to eight lifts. What comes in goes from the object
// dictionary into the words, and what is to go out from the words into the dictionary, in a data exchange and for the
// lifts that the module is assigned to.
//
// One word has two numbers: the older one, where FROM reads what was received and TO writes what is to be sent, and one
// of its own in the areas `received` or `transmitted`.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

inline constexpr unsigned most_lifts = 8;

/// Words that show an object of each lift. Element e of lift L, both from 0: word first + L * lift_stride +
/// e * element_stride, object index + 0800H * L, sub-index sub + e. 32-bit values have their low word first.
struct LiftWords {
  BufferAddress first = 0;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t elements = 1;
  std::uint8_t element_stride = 1;
  std::uint8_t lift_stride = 1;
  std::uint16_t always_one = 0;   ///< bits of a word to be sent that no write clears
  std::uint16_t always_zero = 0;  ///< or sets
};

/// A run of the words above, and the same number of older words.
struct LiftArea {
  BufferAddress first = 0;
  BufferAddress words = 0;
};

struct LiftLayout {
  Modes modes = every_mode;       ///< function modes with lifts
  BufferAddress older_first = 0;  ///< the first word is the lift number, both ways
  LiftArea received{};
  LiftArea transmitted{};
  std::span<const LiftWords> receive{};
  std::span<const LiftWords> transmit{};
  /// RPDOs that bring virtual inputs, counted from 0.
  std::uint16_t first_input_pdo = 0;
  std::uint16_t last_input_pdo = 0;
};

class LiftData final : public BufferArea, public canopen::ObjectHandler {
 public:
  /// Messages that the ring buffer of virtual inputs holds [FX3U-CAN 8.3.1].
  static constexpr std::size_t input_messages = 252;

  /// Everything must outlive it. Without a layout there are no lifts.
  LiftData(const std::optional<LiftLayout>& layout, BufferMemory& memory, canopen::Node& node);

  /// A start in a function mode; the node has the mode's dictionary.
  void start();
  /// The function mode has lifts.
  [[nodiscard]] bool active() const noexcept { return active_; }

  /// An RPDO put its values into the dictionary: a virtual input is kept until it is exchanged.
  void rpdo_received(std::uint16_t number);
  /// The oldest virtual input into its words; 0 without one [FX3U-CAN 6.4 bit 9].
  void exchange_input();
  /// Takes what the program has written now; exchange() will use it.
  void snapshot();
  /// Words to send into the dictionary, received values into the words.
  void exchange();

  // BufferArea
  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) const override;
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

  // Objects that show nothing: virtual input mapping, and the filler of a PDO.
  canopen::AbortCode before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                 can::Time now) override;
  canopen::AbortCode before_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                  std::span<const std::uint8_t> value, can::Time now) override;

 private:
  using Input = std::array<std::uint8_t, 6>;
  /// A value of the dictionary and its word.
  struct Copy {
    std::uint32_t offset = 0;  // in the dictionary's block
    BufferAddress word = 0;
    std::uint8_t bytes = 0;
    std::uint8_t lift = 0;  // bit of the lift number
  };
  [[nodiscard]] std::vector<Copy> copies(std::span<const LiftWords> table) const;
  [[nodiscard]] std::uint8_t lifts() const noexcept;
  void show_input(const Input& input);

  std::optional<LiftLayout> layout_;
  BufferMemory* memory_;
  canopen::Node* node_;
  bool active_ = false;
  std::vector<Copy> receive_;
  std::vector<Copy> transmit_;
  std::vector<std::uint16_t> to_send_;  // the transmitted area as it was at the request
  canopen::Entry output_{};             // virtual output mapping
  canopen::Entry input_{};
  std::vector<Input> inputs_;  // a ring
  std::size_t oldest_ = 0;
  std::size_t waiting_ = 0;
};

}  // namespace canopus::module
