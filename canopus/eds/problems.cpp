#include "canopus/eds/problems.hpp"

#include <algorithm>
#include <utility>

#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

constexpr std::size_t most_problems = 2000;  // of a file made to annoy; real ones have less than 300

}  // namespace

std::string_view name(Problem::Severity severity) noexcept {
  switch (severity) {
    case Problem::Severity::error: return "error";
    case Problem::Severity::loss: return "loss";
    case Problem::Severity::warning: return "warning";
    case Problem::Severity::note: return "note";
  }
  return "error";
}

void Problems::report(Severity severity, unsigned line, std::string message, unsigned column) {
  if (severity != Severity::error && list_.size() >= most_problems) {
    not_listed_loss_ = not_listed_loss_ || severity == Severity::loss;
    ++not_listed_;
    return;
  }
  list_.push_back({severity, std::max(line, 1U), column, std::move(message)});
}

void Problems::repeated(Severity severity, const std::string& kind, unsigned line, std::string message,
                        unsigned column) {
  if (severity == Severity::loss) return report(severity, line, std::move(message), column);
  const auto [place, is_new] = repeated_.try_emplace(kind, Repeated{list_.size()});
  if (!is_new) {
    ++place->second.more;
    return;
  }
  const std::size_t before = list_.size();
  report(severity, line, std::move(message), column);
  if (list_.size() == before) repeated_.erase(place);  // over the limit
}

std::vector<Problem> Problems::release() {
  for (const auto& [kind, repeated] : repeated_) {
    if (repeated.more == 0) continue;
    list_[repeated.position].message += " (and in " + counted(repeated.more, "more place") + ")";
  }
  repeated_.clear();
  if (not_listed_ != 0) {
    list_.push_back({not_listed_loss_ ? Severity::loss : Severity::note, list_.back().line, 0,
                     counted(not_listed_, "further problem") + " not listed"});
  }
  std::stable_sort(list_.begin(), list_.end(), [](const Problem& a, const Problem& b) {
    return std::pair(a.severity, a.line) < std::pair(b.severity, b.line);
  });
  const auto same = [](const Problem& a, const Problem& b) {
    return a.line == b.line && a.severity == b.severity && a.message == b.message;
  };
  list_.erase(std::unique(list_.begin(), list_.end(), same), list_.end());
  return std::exchange(list_, {});
}

std::string printable(std::string_view text) {
  constexpr std::size_t longest = 60;
  const auto is_plain = [](char c) { return c >= 0x20 && c < 0x7F; };
  if (text.size() <= longest && std::ranges::all_of(text, is_plain)) return std::string(text);
  const std::string utf8 = to_utf8(text);
  std::string shown;
  for (const char c : utf8) {
    const auto byte = static_cast<unsigned char>(c);
    if (shown.size() >= longest && (byte & 0xC0) != 0x80) return shown + "...";
    shown += byte < 0x20 || byte == 0x7F ? '?' : c;
  }
  return shown;
}

}  // namespace canopus::eds
