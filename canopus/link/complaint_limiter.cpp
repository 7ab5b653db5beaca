#include "canopus/link/complaint_limiter.hpp"

#include <utility>

namespace canopus::link {

std::string printable_complaint(std::string_view text) {
  std::string shown(text.substr(0, ComplaintLimiter::longest));
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  if (text.size() > ComplaintLimiter::longest) shown += "...";
  return shown;
}

std::optional<std::string> ComplaintLimiter::complain(std::string_view text, Time now) {
  if (quiet_until_ && now < *quiet_until_) {
    last_ = printable_complaint(text);
    ++waiting_;
    return std::nullopt;
  }
  if (waiting_ > 0) {  // tick() was not called at the deadline
    last_ = printable_complaint(text);
    ++waiting_;
    return tick(now);
  }
  quiet_until_ = now + pause;
  return printable_complaint(text);
}

std::optional<ComplaintLimiter::Time> ComplaintLimiter::deadline() const noexcept {
  return waiting_ > 0 ? quiet_until_ : std::nullopt;
}

std::optional<std::string> ComplaintLimiter::tick(Time now) {
  if (waiting_ == 0 || now < *quiet_until_) return std::nullopt;
  quiet_until_ = now + pause;
  return finish();
}

std::optional<std::string> ComplaintLimiter::finish() {
  const std::uint64_t count = std::exchange(waiting_, 0);
  if (count == 0) return std::nullopt;
  std::string text = std::exchange(last_, {});
  if (count > 1) text += " (and " + std::to_string(count - 1) + " more like it)";
  return text;
}

}  // namespace canopus::link
