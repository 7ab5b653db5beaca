#include "canopus/campaign/failure_story.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canopus/campaign/random_stream.hpp"
#include "canopus/text/file_name.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/file/trace_file.hpp"
#include "canopus/trace/print/message_printer.hpp"

namespace canopus::campaign {
namespace {

namespace fs = std::filesystem;
using Result = std::expected<void, std::string>;

constexpr can::Duration after_failure = std::chrono::milliseconds(50);
constexpr std::size_t frames_before = 40;
constexpr std::size_t frames_after = 15;
constexpr std::size_t events_shown = 30;

/// Copies the files that the plant names into the folder, so that it can be sent elsewhere.
Result copy_files(toml::table& plant, const std::string& plant_path, const fs::path& folder) {
  std::map<std::string, std::string> copies;  // by the path in the plant
  std::map<std::string, std::string> originals;
  std::string problem;
  each_path(plant, [&](std::string& path) {
    const auto known = copies.find(path);
    if (known != copies.end()) {
      path = known->second;
      return;
    }
    const fs::path original = fs::absolute(fs::path(plant_path).parent_path() / path).lexically_normal();
    if (original.extension() == ".cpj") {  // a project is a folder of files: it stays where it is
      path = copies[path] = original.string();
      return;
    }
    std::string copy = "files/" + original.filename().string();
    for (int number = 2; originals.contains(copy); ++number) {
      copy = fmt::format("files/{}-{}{}", original.stem().string(), number, original.extension().string());
    }
    originals.emplace(copy, original.string());
    std::error_code error;
    fs::create_directories(folder / "files", error);
    if (!error) fs::copy_file(original, folder / copy, fs::copy_options::overwrite_existing, error);
    if (error && problem.empty())
      problem = fmt::format("cannot copy {}: {}", original.string(), error.message());
    copies.emplace(path, copy);
    path = copy;
  });
  if (!problem.empty()) return std::unexpected(problem);
  return {};
}

Result write_plant(const Campaign& campaign, const RunPlan& plan, const fs::path& folder) {
  const PlantTemplate& base = campaign.plants[plan.variant];
  auto plant = base.with(plan.rules, plan.without_devices);
  if (!plant) return std::unexpected(plant.error());
  if (Result copied = copy_files(*plant, base.path(), folder); !copied) return copied;
  if ((*plant)["plant"].as_table() == nullptr) plant->insert_or_assign("plant", toml::table{});
  (*plant)["plant"].as_table()->insert_or_assign("seed", static_cast<std::int64_t>(plan.seed));
  return write_whole((folder / "plant.toml").string(), text_of(*plant));
}

/// The file of an invariant in Python; others have none.
Result copy_python_file(const Campaign& campaign, toml::table& invariant, const fs::path& folder) {
  const auto file = invariant["file"].value<std::string>();
  if (!file) return {};
  const fs::path original = fs::path(campaign.file.path).parent_path() / *file;
  const std::string copy = "files/" + original.filename().string();
  std::error_code error;
  fs::create_directories(folder / "files", error);
  if (!error) fs::copy_file(original, folder / copy, fs::copy_options::overwrite_existing, error);
  if (error) return std::unexpected(fmt::format("cannot copy {}: {}", original.string(), error.message()));
  invariant.insert_or_assign("file", copy);
  return {};
}

/// The invariant alone, and the rules that no plant file has keys for.
Result write_campaign(const Campaign& campaign, const ShrunkFailure& shrunk, const fs::path& folder) {
  toml::table file;
  toml::table head;
  const RunPlan& plan = shrunk.plan;
  head.insert("name", campaign.file.name);
  head.insert("plant", "plant.toml");
  head.insert("first_seed", static_cast<std::int64_t>(plan.seed));
  head.insert("seeds", 1);
  head.insert("duration", fmt::format("{}us", plan.duration / std::chrono::microseconds(1)));
  head.insert("sample_interval",
              fmt::format("{}us", campaign.file.sample_interval / std::chrono::microseconds(1)));
  file.insert("campaign", std::move(head));
  toml::array invariants;
  if (const toml::array* const all = campaign.source["invariant"].as_array()) {
    for (const toml::node& node : *all) {
      const toml::table* const table = node.as_table();
      if (table == nullptr || (*table)["name"].value_or(std::string_view{}) != shrunk.failure.invariant)
        continue;
      invariants.push_back(*table);
      if (auto copied = copy_python_file(campaign, *invariants.back().as_table(), folder); !copied)
        return copied;
    }
  }
  file.insert("invariant", std::move(invariants));
  toml::array rules;
  for (const ChosenRule& chosen : plan.rules) {
    const Rule& rule = *chosen.rule;
    if (rule.kind != RuleKind::power_cut && rule.kind != RuleKind::cpu_stop && rule.kind != RuleKind::write)
      continue;
    toml::table table;
    table.insert("name", rule.name);
    table.insert("chance", 1);
    if (!rule.target.device.empty()) table.insert("device", rule.target.device);
    if (!rule.target.plc.empty()) table.insert("plc", rule.target.plc);
    table.insert(key_of(rule.kind), chosen.values);
    rules.push_back(std::move(table));
  }
  if (!rules.empty()) file.insert("rule", std::move(rules));
  return write_whole((folder / "campaign.toml").string(), text_of(file));
}

Result write_trace(const RunRecord& record, const fs::path& folder) {
  const std::string path = (folder / "trace.log").string();
  const auto format = trace::trace_format_of(path);
  if (!format) return std::unexpected(format.error());
  auto file = trace::TraceFile::create(path, *format);
  if (!file) return std::unexpected(file.error());
  for (const RunRecord::Frame& frame : record.frames) file->write(frame.bus, frame.record);
  return file->close();
}

/// The frames around a moment, decoded.
text::Json frames_around(const RunRecord& record, can::Time at) {
  const auto is_before = [&](const RunRecord::Frame& frame) { return frame.record.time <= at; };
  const auto middle = std::ranges::partition_point(record.frames, is_before) - record.frames.begin();
  const std::size_t failure = static_cast<std::size_t>(middle);
  const std::size_t first = failure - std::min(failure, frames_before);
  const std::size_t last = std::min(failure + frames_after, record.frames.size());
  text::Json frames = text::Json::array();
  trace::Decoder decoder(record.names, {.frames = true, .transfers = false});
  for (std::size_t i = 0; i < last; ++i) {
    const RunRecord::Frame& frame = record.frames[i];
    decoder.receive(frame.record, frame.bus, [&](const trace::Message& message) {
      if (i < first) return;
      const double seconds =
          static_cast<double>(message.time.time_since_epoch() / std::chrono::microseconds(1)) / 1e6;
      const bool is_extended = message.frame.extended;
      frames.push_back({{"t", seconds},
                        {"bus", frame.bus},
                        {"id", frame.record.error_frame
                                   ? "error"
                                   : fmt::format("{:0{}X}", message.frame.identifier, is_extended ? 8 : 3)},
                        {"text", searched_text(message, "")}});
    });
  }
  return frames;
}

text::Json last_events(const RunRecord& record, can::Time at) {
  std::vector<std::string> lines;
  std::istringstream text(record.events);
  const double seconds = static_cast<double>(at.time_since_epoch() / std::chrono::microseconds(1)) / 1e6;
  for (std::string line; std::getline(text, line);) {
    const auto event = text::parse_json(line);
    const std::string kind = event ? event->value("event", "") : "load";
    if (kind == "load" || kind == "bus error") continue;  // the frames show them
    const auto time = event->find("t");
    if (time != event->end() && time->is_number() && time->get<double>() > seconds) break;
    lines.push_back(std::move(line));
  }
  if (lines.size() > events_shown)
    lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(events_shown));
  return text::Json(lines);
}

text::Json lines_of(const std::string& text) {
  text::Json lines = text::Json::array();
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string reproduction(const Campaign& campaign, const FailureKind& kind) {
  std::string command = fmt::format("canopus campaign {} --seed {}",
                                    fs::path(campaign.file.path).filename().string(), kind.seed);
  if (campaign.file.variants.size() > 1) command += fmt::format(" --variant \"{}\"", kind.variant);
  return command;
}

text::Json story_of(const Campaign& campaign, const FailureKind& kind, const ShrunkFailure& shrunk,
                    const RunRecord& record) {
  text::Json rules = text::Json::array();
  for (const ChosenRule& chosen : shrunk.plan.rules) {
    text::Json knobs = text::Json::object();
    for (const Knob& knob : chosen.knobs) knobs[knob.name] = knob.value;
    rules.push_back({{"name", chosen.rule->name}, {"knobs", std::move(knobs)}});
  }
  const auto seconds = [](can::Duration time) {
    return static_cast<double>(time / std::chrono::microseconds(1)) / 1e6;
  };
  return {{"fingerprint", kind.fingerprint},
          {"detail", shrunk.failure.detail},
          {"variant", kind.variant},
          {"seed", kind.seed},
          {"reproduce", reproduction(campaign, kind)},
          {"t", seconds(shrunk.failure.at.time_since_epoch())},
          {"rules", std::move(rules)},
          {"traceback", lines_of(shrunk.failure.traceback)},
          {"duration", seconds(shrunk.plan.duration)},
          {"without_devices", text::Json(shrunk.plan.without_devices)},
          {"shrinking_runs", shrunk.runs},
          {"boots", text::Json(record.boots)},
          {"events", last_events(record, shrunk.failure.at)},
          {"frames", frames_around(record, shrunk.failure.at)}};
}

Result write_story(const Campaign& campaign, const FailureKind& kind, const fs::path& folder,
                   const std::function<bool()>& is_over) {
  const auto variant = std::ranges::find(campaign.file.variants, kind.variant, &Variant::name);
  if (variant == campaign.file.variants.end()) return {};
  const RunPlan plan =
      plan_of(campaign, static_cast<std::size_t>(variant - campaign.file.variants.begin()), kind.seed);
  const auto shrunk = shrink(campaign, plan, kind.fingerprint, is_over);
  if (!shrunk) return {};  // no such plant can be built, or there was no time
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return std::unexpected(fmt::format("cannot create {}: {}", folder.string(), error.message()));
  RunPlan recorded = shrunk->plan;
  recorded.duration = shrunk->failure.at.time_since_epoch() + after_failure;
  RunRecord record;
  if (const auto again = run(campaign, recorded, {}, &record); !again)
    return std::unexpected(again.error().message);
  for (const Result& written :
       {write_plant(campaign, shrunk->plan, folder), write_campaign(campaign, *shrunk, folder),
        write_trace(record, folder), write_whole((folder / "events.jsonl").string(), record.events)}) {
    if (!written) return written;
  }
  // The last one: a folder without it is not complete.
  return write_whole((folder / "story.json").string(),
                     story_of(campaign, kind, *shrunk, record).dump() + '\n');
}

}  // namespace

std::string story_folder(const FailureKind& kind) {
  Checksum checksum;
  checksum.add(kind.fingerprint);
  return fmt::format("failures/seed-{}-{}-{:08x}", kind.seed, text::file_name_of(kind.variant),
                     checksum.value() >> 32U);
}

Result write_stories(const Campaign& campaign, const Summary& summary, const std::string& results_folder,
                     const std::function<bool()>& is_over) {
  std::size_t count = 0;
  for (const FailureKind& kind : summary.kinds) {
    if (is_over() || ++count > most_stories) break;
    const fs::path folder = fs::path(results_folder) / story_folder(kind);
    if (fs::exists(folder / "story.json")) continue;
    if (Result written = write_story(campaign, kind, folder, is_over); !written) return written;
  }
  return {};
}

}  // namespace canopus::campaign
