#include "canopus/module/lift/lift.hpp"

#include <algorithm>

#include "canopus/can/little_endian.hpp"

namespace canopus::module {

namespace {

constexpr std::uint16_t lift_number = 0x6001;
constexpr std::uint16_t virtual_input = 0x6010;
constexpr std::uint16_t virtual_output = 0x6011;
constexpr std::uint16_t filler = 0x67FE;
constexpr unsigned lift_shift = 0x0800;

// From the first word of either area [FX3U-CAN 8.1].
constexpr BufferAddress mapping_word = 1;  // three words: virtual input, virtual output
constexpr BufferAddress count_word = 4;    // messages that wait

}  // namespace

LiftData::LiftData(const std::optional<LiftLayout>& layout, BufferMemory& memory, canopen::Node& node)
    : layout_(layout), memory_(&memory), node_(&node) {
  if (!layout) return;
  memory.attach(layout->older_first, layout->older_first + layout->received.words - 1, *this);
  memory.attach(layout->received.first, layout->received.first + layout->received.words - 1, *this);
  memory.attach(layout->transmitted.first, layout->transmitted.first + layout->transmitted.words - 1, *this);
  inputs_.resize(input_messages);
}

std::vector<LiftData::Copy> LiftData::copies(std::span<const LiftWords> table) const {
  std::vector<Copy> found;
  const canopen::DictionaryDescription& objects = node_->dictionary().description();
  for (const LiftWords& row : table) {
    for (unsigned lift = 0; lift < most_lifts; ++lift) {
      for (unsigned element = 0; element < row.elements; ++element) {
        const canopen::Entry entry = objects.find(static_cast<std::uint16_t>(row.index + lift_shift * lift),
                                                  static_cast<std::uint8_t>(row.sub + element));
        if (!entry) continue;
        found.push_back({entry.offset, row.first + lift * row.lift_stride + element * row.element_stride,
                         entry.description->length, static_cast<std::uint8_t>(1U << lift)});
      }
    }
  }
  return found;
}

void LiftData::start() {
  oldest_ = waiting_ = 0;
  active_ = layout_ && (layout_->modes & memory_->mode()) != 0;
  if (!active_) return;
  const canopen::DictionaryDescription& objects = node_->dictionary().description();
  receive_ = copies(layout_->receive);
  transmit_ = copies(layout_->transmit);
  output_ = objects.find(virtual_output, 0);
  input_ = objects.find(virtual_input, 0);
  node_->attach(virtual_input, virtual_input, *this);
  node_->attach(filler, filler, *this);
  snapshot();
}

std::uint8_t LiftData::lifts() const noexcept {
  return node_->dictionary().get<std::uint8_t>(lift_number, 0);
}

// The oldest one gives way: what happens to the 253rd message is not printed [FX3U-CAN 8.3.1].
void LiftData::rpdo_received(std::uint16_t number) {
  if (number < layout_->first_input_pdo || number > layout_->last_input_pdo) return;
  Input input{};
  std::ranges::copy(node_->dictionary().bytes(input_), input.begin());
  constexpr std::size_t lift_byte = 2;
  if ((input[lift_byte] & lifts()) == 0) return;
  inputs_[(oldest_ + waiting_) % input_messages] = input;
  if (waiting_ == input_messages) {
    oldest_ = (oldest_ + 1) % input_messages;
  } else {
    ++waiting_;
  }
}

void LiftData::show_input(const Input& input) {
  for (unsigned word = 0; word < input.size() / 2; ++word) {
    memory_->set_word(layout_->received.first + mapping_word + word,
                      can::load_as<std::uint16_t>(&input[2 * std::size_t{word}]));
  }
}

void LiftData::exchange_input() {
  if (waiting_ == 0) return show_input({});
  show_input(inputs_[oldest_]);
  oldest_ = (oldest_ + 1) % input_messages;
  --waiting_;
}

void LiftData::snapshot() {
  const auto words = memory_->written(layout_->transmitted.first, layout_->transmitted.words);
  to_send_.assign(words.begin(), words.end());
}

void LiftData::exchange() {
  const std::span<std::uint8_t> block = node_->dictionary().block();
  const std::uint8_t assigned = lifts();
  for (const Copy& copy : transmit_) {
    if ((copy.lift & assigned) == 0) continue;
    const BufferAddress word = copy.word - layout_->transmitted.first;
    const std::uint32_t high = copy.bytes > 2 ? to_send_[word + 1] : 0U;
    can::store_value(&block[copy.offset], to_send_[word] | high << 16, copy.bytes);
  }
  for (unsigned word = 0; word < 3; ++word)
    can::store_value(&block[output_.offset + 2 * std::size_t{word}], to_send_[mapping_word + word], 2);
  for (const Copy& copy : receive_) {
    if ((copy.lift & assigned) == 0) continue;
    const std::uint64_t value = can::load_value(&block[copy.offset], copy.bytes);
    memory_->set_word(copy.word, static_cast<std::uint16_t>(value));
    if (copy.bytes > 2) memory_->set_word(copy.word + 1, static_cast<std::uint16_t>(value >> 16));
  }
}

std::uint16_t LiftData::read_word(BufferAddress address, can::Time) const {
  const bool older = address < layout_->older_first + layout_->received.words;
  if (address == layout_->older_first || address == layout_->transmitted.first) return lifts();
  const BufferAddress word = older ? address - layout_->older_first + layout_->received.first : address;
  if (word == layout_->received.first + count_word) return static_cast<std::uint16_t>(waiting_);
  return memory_->word(word);
}

// The lift number is the object at once [FX3U-CAN 8.2].
WriteResult LiftData::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  const bool older = address < layout_->older_first + layout_->received.words;
  const BufferAddress word = older ? address - layout_->older_first + layout_->transmitted.first : address;
  if (word == layout_->transmitted.first) {
    const std::array<std::uint8_t, 1> number{static_cast<std::uint8_t>(value)};
    (void)node_->dictionary().write(lift_number, 0, number, now);
    return WriteResult::done;
  }
  for (const LiftWords& row : layout_->transmit) {
    if (word < row.first || word >= row.first + row.lift_stride * most_lifts) continue;
    value = static_cast<std::uint16_t>((value | row.always_one) & ~row.always_zero);
  }
  memory_->set_word(word, value);
  return WriteResult::done;
}

canopen::AbortCode LiftData::before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                         can::Time) {
  if (entry.index == filler) return canopen::AbortCode::no_object;
  dictionary.assign(entry, Input{});  // an SDO neither sees nor takes what waits [FX3U-CAN 5.10]
  return canopen::AbortCode::none;
}

canopen::AbortCode LiftData::before_write(canopen::ObjectDictionary&, const canopen::Entry& entry,
                                          std::span<const std::uint8_t>, can::Time) {
  return entry.index == filler ? canopen::AbortCode::no_object : canopen::AbortCode::none;
}

}  // namespace canopus::module
