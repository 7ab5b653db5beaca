#include "canopus/campaign/report.hpp"

#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/campaign/failure_story.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/json_fields.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::campaign {
namespace {

namespace fs = std::filesystem;

std::string escaped(std::string_view text) {
  std::string result;
  for (const char each : text) {
    switch (each) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += each >= 0 && each < ' ' && each != '\n' ? '?' : each;
    }
  }
  return result;
}

constexpr std::string_view style = R"(<style>
body { font: 15px/1.45 system-ui, sans-serif; max-width: 70em; margin: 2em auto; padding: 0 1em; color: #1c2733; background: #fff }
h1, h2, h3 { line-height: 1.2 } table { border-collapse: collapse; margin: .6em 0 } td, th { text-align: left; padding: .2em .8em .2em 0; vertical-align: top }
th { border-bottom: 1px solid #9fb0c0 } .bad { color: #b3261e } .good { color: #1b6e3c } code, pre { font: 13px/1.4 ui-monospace, monospace }
pre { background: #f3f6f9; padding: .7em; overflow-x: auto } details { margin: .4em 0 } svg { background: #f8fafc; max-width: 100% } .n { text-align: right }
</style>
)";

std::string share_row(const std::string& name, const Share& share) {
  const double failed =
      share.runs == 0 ? 0 : 100.0 * static_cast<double>(share.failed) / static_cast<double>(share.runs);
  return fmt::format("<tr><td>{}<td class=n>{}<td class=n>{}<td class=n>{:.1f} %\n", escaped(name),
                     share.runs, share.failed, failed);
}

std::string share_table(std::string_view title, const std::map<std::string, Share>& shares) {
  if (shares.empty()) return {};
  std::string html = fmt::format("<table><tr><th>{}<th>runs<th>failed<th>\n", title);
  for (const auto& [name, share] : shares) html += share_row(name, share);
  return html + "</table>\n";
}

std::string histogram(const std::string& title, const TimeHistogram& times) {
  if (times.count() == 0) return {};
  std::string html =
      fmt::format("<h3>{}</h3><p>{}, median {}, 99 % within {}, longest {}</p>\n", escaped(title),
                  ascii::counted(times.count(), "time"), text::describe_duration(times.quantile(0.5)),
                  text::describe_duration(times.quantile(0.99)), text::describe_duration(times.longest()));
  const unsigned first = times.classes().begin()->first;
  const unsigned last = times.classes().rbegin()->first;
  std::uint64_t most = 1;
  for (const auto& [number, count] : times.classes()) most = std::max(most, count);
  constexpr unsigned height = 120;
  constexpr unsigned width = 14;
  html += fmt::format("<svg width=\"{}\" height=\"{}\" role=\"img\" aria-label=\"{}\">",
                      (last - first + 1) * width + 20, height + 10, escaped(title));
  for (const auto& [number, count] : times.classes()) {
    const auto tall = static_cast<unsigned>(std::max<std::uint64_t>(count * height / most, 1));
    html += fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#3d7ea6\"><title>{} to {}: "
        "{}</title></rect>",
        (number - first) * width + 10, height + 5 - tall, width - 2, tall,
        text::describe_duration(TimeHistogram::begin_of(number)),
        text::describe_duration(TimeHistogram::begin_of(number + 1)), count);
  }
  return html + "</svg>\n";
}

/// The bus around the failure: time to the right, a line for each CAN-ID.
std::string bus_picture(const text::Json& story) {
  const text::Json& frames = field_list(story, "frames");
  if (frames.empty()) return {};
  std::map<std::string, unsigned> rows;
  for (const text::Json& frame : frames)
    rows.emplace(frame.value("bus", "") + " " + frame.value("id", ""), 0);
  unsigned next = 0;
  for (auto& [name, row] : rows) row = next++;
  const double failure = field_number(story, "t");
  const double begin = field_number(*frames.begin(), "t");
  double end = failure;
  for (const text::Json& frame : frames) end = std::max(end, field_number(frame, "t"));
  const double scale = end > begin ? 760.0 / (end - begin) : 1;
  constexpr unsigned tall = 16;
  std::string svg = fmt::format(
      "<svg width=\"960\" height=\"{}\" role=\"img\" aria-label=\"frames around the failure\" "
      "font-family=\"ui-monospace,monospace\" font-size=\"11\">",
      next * tall + 10);
  for (const auto& [name, row] : rows)
    svg += fmt::format("<text x=\"4\" y=\"{}\">{}</text>", row * tall + 14, escaped(name));
  for (const text::Json& frame : frames) {
    const unsigned row = rows[frame.value("bus", "") + " " + frame.value("id", "")];
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{}\" width=\"4\" height=\"11\" fill=\"{}\"><title>{:.6f} s {}</title></rect>",
        170 + (field_number(frame, "t") - begin) * scale, row * tall + 5,
        frame.value("id", "") == "error" ? "#b3261e" : "#3d7ea6", field_number(frame, "t"),
        escaped(frame.value("text", "")));
  }
  const double x = 170 + (std::max(failure, begin) - begin) * scale;
  return svg +
         fmt::format("<line x1=\"{0:.1f}\" y1=\"0\" x2=\"{0:.1f}\" y2=\"{1}\" stroke=\"#b3261e\"/></svg>\n",
                     x, next * tall + 10);
}

std::string lines_html(std::string_view title, const std::vector<std::string>& lines) {
  if (lines.empty()) return {};
  std::string html = fmt::format("<details><summary>{}</summary><pre>", title);
  for (const std::string& line : lines) html += escaped(line) + "\n";
  return html + "</pre></details>\n";
}

std::vector<std::string> texts_in(const text::Json& object, std::string_view key) {
  std::vector<std::string> texts;
  for (const text::Json& each : field_list(object, key)) {
    if (each.is_string()) texts.push_back(each.string());
  }
  return texts;
}

std::string story_html(const FailureKind& kind, const text::Json& story) {
  if (!story.is_object())
    return "<p>Its first run was not made smaller: the campaign was ended before.</p>\n";
  std::string html = fmt::format(
      "<p>Again: <code>{}</code>, or the smallest run alone: <code>canopus campaign "
      "{}/campaign.toml</code></p>\n",
      escaped(story.value("reproduce", "")), escaped(story_folder(kind)));
  html += "<table><tr><th>smallest run<th>\n<tr><td>rules<td>";
  if (field_list(story, "rules").empty()) html += "none: the plant fails by itself";
  for (const text::Json& rule : field_list(story, "rules")) {
    html += "<b>" + escaped(rule.value("name", "")) + "</b>";
    if (const auto knobs = rule.find("knobs"); knobs != rule.end()) {
      for (const text::JsonMember& knob : knobs->items()) {
        html += fmt::format(" {} = {}", escaped(knob.key),
                            escaped(knob.value.is_string() ? knob.value.string() : ""));
      }
    }
    html += "<br>";
  }
  html += fmt::format("\n<tr><td>time<td>{:.6f} s, the failure at {:.6f} s\n",
                      field_number(story, "duration"), field_number(story, "t"));
  const auto without = texts_in(story, "without_devices");
  if (!without.empty())
    html += fmt::format("<tr><td>without<td>{}\n", escaped(fmt::format("{}", fmt::join(without, ", "))));
  // A number that 64 bits have no room for must not be converted.
  const double runs = std::clamp(field_number(story, "shrinking_runs"), 0.0, 1e9);
  html += fmt::format("<tr><td>found in<td>{}\n</table>\n",
                      ascii::counted(static_cast<std::uint64_t>(runs), "run"));
  html += bus_picture(story);
  html += lines_html("Traceback", texts_in(story, "traceback"));
  html += lines_html("Slaves that are not booted", texts_in(story, "boots"));
  html += lines_html("Last events", texts_in(story, "events"));
  std::vector<std::string> frames;
  for (const text::Json& frame : field_list(story, "frames")) {
    frames.push_back(fmt::format("{:.6f}  {}  {:<8}  {}", field_number(frame, "t"), frame.value("bus", ""),
                                 frame.value("id", ""), frame.value("text", "")));
  }
  return html + lines_html("Frames around it", frames);
}

std::string test_case(const std::string& group, const std::string& name, const std::string& failure) {
  const std::string begin =
      fmt::format("  <testcase classname=\"{}\" name=\"{}\"", escaped(group), escaped(name));
  return failure.empty() ? begin + "/>\n" : begin + ">\n" + failure + "  </testcase>\n";
}

std::string failure_element(const std::string& message, const std::string& text) {
  return fmt::format("    <failure message=\"{}\">{}</failure>\n", escaped(message), escaped(text));
}

/// Runs that show a failure, in all variants.
struct Shown {
  std::uint64_t runs = 0;
  std::uint64_t seed = 0;  ///< of the first one
};
std::map<std::string, Shown> shown_in(const Summary& summary) {
  std::map<std::string, Shown> all;
  for (const FailureKind& kind : summary.kinds) {
    Shown& shown = all[kind.fingerprint];
    shown.seed = shown.runs == 0 ? kind.seed : std::min(shown.seed, kind.seed);
    shown.runs += kind.runs;
  }
  return all;
}

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

void compare_times(const std::string& what, const TimeHistogram& before, const TimeHistogram& after,
                   Comparison& result) {
  if (before.count() == 0 || after.count() == 0) return;
  for (const auto& [name, share] : {std::pair{"median", 0.5}, std::pair{"99 %", 0.99}}) {
    const can::Duration was = before.quantile(share);
    const can::Duration is = after.quantile(share);
    // A class is a quarter wide: less than two of them is no difference.
    if (is * 2 > was * 3) {
      result.lines.push_back(fmt::format("WORSE: {}, {}: {} instead of {}", what, name,
                                         text::describe_duration(is), text::describe_duration(was)));
      result.is_worse = true;
    } else if (is * 3 < was * 2) {
      result.lines.push_back(fmt::format("better: {}, {}: {} instead of {}", what, name,
                                         text::describe_duration(is), text::describe_duration(was)));
    }
  }
}

}  // namespace

text::Json find_story(const FailureKind& kind, const std::vector<std::string>& folders) {
  for (const std::string& folder : folders) {
    const std::string path = (fs::path(folder) / story_folder(kind) / "story.json").string();
    if (!fs::exists(path)) continue;
    const auto text = text::read_file(path);
    if (!text) continue;
    if (auto story = text::parse_json(*text); story && story->is_object()) return std::move(*story);
  }
  return {};
}

std::string html_report(const Summary& summary, const std::vector<text::Json>& stories) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta "
      "charset=\"utf-8\"><title>{0}</title>\n{1}</head><body>\n<h1>{0}</h1>\n",
      escaped(summary.head.campaign), style);
  html += fmt::format("<p class={}><b>{}</b>, {} failed, {} of failure</p>\n",
                      summary.is_good() ? "good" : "bad", ascii::counted(summary.runs, "run"), summary.failed,
                      ascii::counted(summary.kinds.size(), "kind"));
  const auto list = [&](std::string_view title, const std::vector<std::string>& names) {
    if (names.empty()) return;
    html += fmt::format("<h2 class=bad>{}</h2><ul>\n", title);
    for (const std::string& name : names) html += "<li>" + escaped(name) + "\n";
    html += "</ul>\n";
  };
  list("Canaries that no invariant saw", summary.missed_canaries);
  list("Holes: expected sometimes, reached by no run", summary.holes);
  list("Missing runs", summary.missing);
  if (!summary.kinds.empty()) html += "<h2>Failures</h2>\n";
  if (summary.runs_of_other_kinds != 0)
    html += fmt::format("<p class=bad>{}</p>\n", escaped(other_kinds_text(summary)));
  for (std::size_t i = 0; i < summary.kinds.size(); ++i) {
    const FailureKind& kind = summary.kinds[i];
    html += fmt::format("<h3 class=bad>{}</h3>\n<p>In {}; first in variant {}, seed {}, at {}: {}</p>\n",
                        escaped(kind.fingerprint), ascii::counted(kind.runs, "run"), escaped(kind.variant),
                        kind.seed, text::describe_duration(kind.first.at.time_since_epoch()),
                        escaped(kind.first.detail));
    html += story_html(kind, i < stories.size() ? stories[i] : text::Json());
  }
  html +=
      "<h2>Outcomes</h2>\n" + share_table("variant", summary.variants) + share_table("rule", summary.rules);
  html += "<h2>Times</h2>\n" + histogram("Boot: until all nodes are operational", summary.boots);
  for (const auto& [name, times] : summary.reactions) html += histogram("Reaction: " + name, times);
  return html + "</body></html>\n";
}

std::string junit_report(const Summary& summary) {
  std::string cases;
  std::size_t count = 0;
  std::size_t failures = 0;
  const auto add = [&](const std::string& group, const std::string& name, const std::string& failure) {
    ++count;
    if (!failure.empty()) ++failures;
    cases += test_case(group, name, failure);
  };
  std::vector<std::string> invariants = summary.head.invariants;
  invariants.emplace_back("plant file");
  for (const std::string& variant : summary.head.variants) {
    for (const std::string& invariant : invariants) {
      std::string failure;
      for (const FailureKind& kind : summary.kinds) {
        if (kind.first.invariant == invariant && kind.variant == variant)
          failure += failure_element(
              kind.fingerprint, fmt::format("{}; first with seed {}: {}", ascii::counted(kind.runs, "run"),
                                            kind.seed, kind.first.detail));
      }
      if (invariant != "plant file" || !failure.empty()) add(variant, invariant, failure);
    }
  }
  for (const std::string& canary : summary.head.canaries) {
    const bool is_missed = std::ranges::count(summary.missed_canaries, canary) != 0;
    add("canary", canary,
        is_missed ? failure_element("not found", "no invariant sees what this rule does") : "");
  }
  for (const std::string& name : summary.head.sometimes) {
    const bool is_hole = std::ranges::count(summary.holes, name) != 0;
    add("sometimes", name, is_hole ? failure_element("not reached", "no run reached it") : "");
  }
  for (const std::string& missing : summary.missing)
    add("missing", missing, failure_element("missing", missing));
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n <testsuite name=\"{}\" tests=\"{}\" "
      "failures=\"{}\">\n{} </testsuite>\n</testsuites>\n",
      escaped(summary.head.campaign), count, failures, cases);
}

std::expected<void, std::string> write_report(const Summary& summary, const std::vector<std::string>& folders,
                                              const std::string& output) {
  std::vector<text::Json> stories;
  for (const FailureKind& kind : summary.kinds) {
    if (stories.size() == most_stories) break;
    stories.push_back(find_story(kind, folders));
  }
  const auto in = [&](std::string_view name) { return (fs::path(output) / name).string(); };
  if (auto written = write_whole(in("junit.xml"), junit_report(summary)); !written) return written;
  return write_whole(in("report.html"), html_report(summary, stories));
}

Comparison compare(const Summary& before, const Summary& after) {
  Comparison result;
  const auto known = shown_in(before);
  const auto now = shown_in(after);
  for (const auto& [fingerprint, shown] : now) {
    const auto was = known.find(fingerprint);
    const double share = percent(shown.runs, after.runs);
    if (was == known.end()) {
      result.lines.push_back(fmt::format("WORSE: new failure, {} of {}, first seed {}: {}", shown.runs,
                                         ascii::counted(after.runs, "run"), shown.seed, fingerprint));
      result.is_worse = true;
    } else if (const double before_share = percent(was->second.runs, before.runs);
               share > 1.5 * before_share && shown.runs > was->second.runs + 2) {
      result.lines.push_back(fmt::format("WORSE: in {:.1f} % of the runs instead of {:.1f} %: {}", share,
                                         before_share, fingerprint));
      result.is_worse = true;
    }
  }
  for (const auto& [fingerprint, shown] : known) {
    if (!now.contains(fingerprint)) result.lines.push_back("better: no longer: " + fingerprint);
  }
  for (const auto& [what, was, is] :
       {std::tuple{"hole", &before.holes, &after.holes},
        std::tuple{"missed canary", &before.missed_canaries, &after.missed_canaries}}) {
    for (const std::string& name : *is) {
      if (std::ranges::count(*was, name) != 0) continue;
      result.lines.push_back(fmt::format("WORSE: new {}: {}", what, name));
      result.is_worse = true;
    }
  }
  compare_times("boot", before.boots, after.boots, result);
  for (const auto& [name, times] : after.reactions) {
    const auto was = before.reactions.find(name);
    if (was != before.reactions.end()) compare_times("reaction " + name, was->second, times, result);
  }
  return result;
}

}  // namespace canopus::campaign
