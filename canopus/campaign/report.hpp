#pragma once
// Reports of a campaign: one page for people, JUnit for a build server. They hold no time
// of day, folder or speed, so that the same results give the same bytes.

#include <expected>
#include <string>
#include <vector>

#include "canopus/campaign/results.hpp"
#include "canopus/campaign/summary.hpp"

namespace canopus::campaign {

/// The story of a kind of failure from the first of these folders that has one; null: none has.
[[nodiscard]] text::Json find_story(const FailureKind& kind, const std::vector<std::string>& folders);

/// A page that needs nothing else. `stories`: of each kind.
[[nodiscard]] std::string html_report(const Summary& summary, const std::vector<text::Json>& stories);
/// A test case for each variant and invariant, each canary, and each invariant that is expected sometimes.
[[nodiscard]] std::string junit_report(const Summary& summary);

/// Writes report.html and junit.xml into the folder. `folders` are searched for stories. The error is a sentence.
[[nodiscard]] std::expected<void, std::string> write_report(const Summary& summary,
                                                            const std::vector<std::string>& folders,
                                                            const std::string& output);

/// What B shows that A does not, or more of: sentences. `worse`: they say that something got worse.
struct Comparison {
  std::vector<std::string> lines{};
  bool is_worse = false;
};
[[nodiscard]] Comparison compare(const Summary& before, const Summary& after);

}  // namespace canopus::campaign
