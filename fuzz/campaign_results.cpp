// Any text as a file of a campaign's results: read in order, each run once, summed within bounds, and reported.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include <unistd.h>

#include "canopus/campaign/report.hpp"
#include "canopus/campaign/results.hpp"
#include "canopus/campaign/summary.hpp"

#include "input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  using fuzz::expect;
  if (size == 0) return 0;
  static const std::string folder =
      (std::filesystem::temp_directory_path() / ("canopus-fuzz-results-" + std::to_string(::getpid())))
          .string();
  std::filesystem::create_directories(folder);
  const bool is_sorted = (data[0] & 1U) != 0;
  const std::string path = folder + (is_sorted ? "/results.jsonl" : "/results.part.jsonl");
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  const auto stored = campaign::read_results(folder);
  if (stored) {
    std::optional<std::uint64_t> last;
    const auto read =
        campaign::each_run({*stored}, stored->head, [&](std::uint64_t number, const std::string&) {
          expect(number < stored->head.runs() && (!last || number > *last));
          last = number;
        });
    const auto summary = campaign::summarize({*stored});
    expect(summary.has_value() == read.has_value());
    if (summary) {
      expect(summary->kinds.size() <= campaign::most_kinds && summary->failed <= summary->runs);
      expect(campaign::html_report(*summary, {}).ends_with("</html>\n"));
      expect(campaign::junit_report(*summary).ends_with("</testsuites>\n"));
    }
  } else {
    expect(!stored.error().empty());
  }
  std::filesystem::remove(path);
  return 0;
}
