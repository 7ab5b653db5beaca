#include "canopus/sim/bus/waveform/waveform_text.hpp"

namespace canopus::sim {

WaveformText::Code WaveformText::code(std::size_t signal) noexcept {
  constexpr std::size_t digits = '~' - '!' + 1;
  Code code{};
  do {
    code.text[code.size++] = static_cast<char>('!' + signal % digits);
    signal /= digits;
  } while (signal > 0);
  code.text[code.size++] = '\n';
  return code;
}

void WaveformText::write(std::string_view text) {
  if (capacity - size_ < text.size()) hand_over();
  if (text.size() > capacity) return sink_(text);
  std::memcpy(buffer_.data() + size_, text.data(), text.size());
  size_ += text.size();
}

void WaveformText::hand_over() {
  if (size_ > 0) sink_({buffer_.data(), size_});
  size_ = 0;
}

}  // namespace canopus::sim
