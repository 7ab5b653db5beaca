#include "canopus/text/nearest_word.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"

namespace canopus::text {
namespace {

constexpr std::size_t longest_word = 64;  // what is longer is no mistyped command

/// Letters to be inserted, deleted, replaced or exchanged with their neighbour to make one word of the other.
std::size_t distance(std::string_view a, std::string_view b) {
  // Rows of the table of all beginnings of a and b: the last but one, the last, this one.
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = ascii::lower(a[i - 1]) == ascii::lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      const bool exchanged = i > 1 && j > 1 && ascii::lower(a[i - 1]) == ascii::lower(b[j - 2]) &&
                             ascii::lower(a[i - 2]) == ascii::lower(b[j - 1]);
      if (exchanged) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

bool begins(std::string_view word, std::string_view with) {
  return ascii::equal_ignoring_case(word.substr(0, with.size()), with);
}

}  // namespace

std::string_view nearest(std::string_view word, std::span<const std::string_view> known) {
  if (word.empty() || word.size() > longest_word) return {};
  const std::size_t allowed = word.size() <= 4 ? 1 : 2;
  std::string_view best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string_view candidate : known) {
    const std::size_t mistakes = distance(word, candidate);
    if (mistakes <= allowed && mistakes < candidate.size() && mistakes < least) {
      best = candidate;
      least = mistakes;
    }
  }
  if (!best.empty()) return best;
  const auto begun = [&](std::string_view candidate) { return begins(candidate, word); };
  if (std::ranges::count_if(known, begun) == 1) return *std::ranges::find_if(known, begun);
  return {};
}

std::string one_of(std::span<const std::string_view> known) {
  std::string text;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (i != 0) text += i + 1 == known.size() ? " or " : ", ";
    text += known[i];
  }
  return text;
}

std::string suggestion(std::string_view word, std::span<const std::string_view> known) {
  const std::string_view meant = nearest(word, known);
  return meant.empty() ? "; expected " + one_of(known) : fmt::format("; did you mean \"{}\"?", meant);
}

}  // namespace canopus::text
