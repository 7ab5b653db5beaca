#include "canopus/trace/file/left_out.hpp"

#include <limits>
#include <numeric>

namespace canopus::trace {

void LeftOut::add_lost(std::uint64_t frames) noexcept {
  const std::uint64_t room = std::numeric_limits<std::uint64_t>::max() - lost_;
  lost_ += frames < room ? frames : room;
}

std::uint64_t LeftOut::total() const noexcept {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

std::uint64_t LeftOut::frames() const noexcept {
  std::uint64_t frames = 0;
  for (const LeftOutName& name : left_out_names) frames += name.is_frame ? of(name.kind) : 0;
  return frames;
}

std::string LeftOut::text() const {
  std::string text;
  for (const LeftOutName& name : left_out_names) {
    const std::uint64_t count = of(name.kind);
    if (count == 0) continue;
    text += text.empty() ? "" : ", ";
    text += std::to_string(count) + ' ';
    text += count == 1 ? name.one : name.many;
  }
  return text;
}

}  // namespace canopus::trace
