#include "canopus/plant/device_script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/plant/file/process_value.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::plant {

namespace {

using canopen::Entry;

std::optional<sim::ScriptStep> step_of(const sim::Device& device, const ScriptSection& script,
                                       text::FileErrors& errors) {
  sim::ScriptStep step;
  bool good = true;
  const auto wrong = [&](text::Place place, std::string_view key, const std::string& why) {
    errors.add(place, "script: {}: {}", key, why);
    good = false;
  };
  if (script.at) {
    step.at = can::later(can::Time{}, *script.at);
  } else if (auto condition = parse_condition(device, script.when)) {
    step.when = *condition;
  } else {
    wrong(script.when_place, "when", condition.error());
  }
  if (!script.set.empty()) {
    step.action = sim::ScriptStep::Action::force;
    step.hold = script.hold;
    if (const auto entry = find_process_value(device, script.set)) {
      step.entry = *entry;
      const auto value = parse_value(text_of(script.value), *entry, *device.file().dictionary);
      if (!value) wrong(script.set_place, "set", value.error());
      if (value) step.value = *value;
    } else {
      wrong(script.set_place, "set", entry.error());
    }
  } else if (script.release == "all") {
    step.action = sim::ScriptStep::Action::release_all;
  } else {
    step.action = sim::ScriptStep::Action::release;
    const auto entry = find_process_value(device, script.release);
    if (!entry) wrong(script.release_place, "release", entry.error());
    if (entry) step.entry = *entry;
  }
  return good ? std::optional(step) : std::nullopt;
}

struct Field {
  std::string text{};
  unsigned column = 1;
};

/// A line's fields; nothing, with the column, for a quote that is not closed.
std::expected<std::vector<Field>, unsigned> fields_of(std::string_view line, char separator) {
  std::vector<Field> fields;
  std::size_t at = 0;
  while (true) {
    Field field{.column = static_cast<unsigned>(at) + 1};
    if (at < line.size() && line[at] == '"') {
      for (++at;; ++at) {
        if (at >= line.size()) return std::unexpected(field.column);
        if (line[at] != '"') {
          field.text += line[at];
        } else if (at + 1 < line.size() && line[at + 1] == '"') {
          field.text += line[at++];
        } else {
          break;
        }
      }
      const std::size_t end = std::min(line.find(separator, ++at), line.size());
      if (!ascii::trim(line.substr(at, end - at)).empty()) return std::unexpected(field.column);
      at = end;
    } else {
      const std::size_t end = std::min(line.find(separator, at), line.size());
      field.text = ascii::trim(line.substr(at, end - at));
      at = end;
    }
    fields.push_back(std::move(field));
    if (at >= line.size()) return fields;
    ++at;
  }
}

/// Seconds as a duration, to the nanosecond.
std::optional<can::Duration> seconds(std::string_view text) {
  const auto value = ascii::parse_number<double>(text);
  if (!value || !(*value >= 0) || *value > 1e9) return std::nullopt;
  return can::Duration(std::llround(*value * 1e9));
}

class CsvReader {
 public:
  CsvReader(std::string_view text, const sim::Device& device, const CsvLimits& limits)
      : text_(text), device_(device), limits_(limits) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
  }

  std::expected<sim::Playback, CsvProblem> read();

 private:
  /// The next line that is not empty.
  std::optional<std::string_view> line();
  [[nodiscard]] std::unexpected<CsvProblem> problem(unsigned column, std::string message) const {
    return std::unexpected(CsvProblem{number_, column, std::move(message)});
  }
  std::expected<std::vector<Entry>, CsvProblem> header(std::string_view line);
  std::expected<void, CsvProblem> row(std::string_view line, sim::Playback& playback);

  std::string_view text_;
  const sim::Device& device_;
  CsvLimits limits_;
  unsigned number_ = 0;
  char separator_ = ',';
  std::optional<can::Duration> last_;
};

std::optional<std::string_view> CsvReader::line() {
  while (!text_.empty()) {
    const std::size_t end = std::min(text_.find('\n'), text_.size());
    std::string_view found = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    ++number_;
    if (found.ends_with('\r')) found.remove_suffix(1);
    if (!ascii::trim(found).empty()) return found;
  }
  return std::nullopt;
}

std::expected<std::vector<Entry>, CsvProblem> CsvReader::header(std::string_view line) {
  const std::size_t first = line.find_first_of(",;\t");
  if (first != std::string_view::npos) separator_ = line[first];
  const auto fields = fields_of(line, separator_);
  if (!fields) return problem(fields.error(), "the quote is not closed, or something follows it");
  if (fields->size() < 2) {
    return problem(1, "expected a header row: the time, then objects, for example time,6000:01");
  }
  if (fields->size() - 1 > limits_.columns) {
    return problem(1, fmt::format("{} objects; expected at most {}", fields->size() - 1, limits_.columns));
  }
  std::vector<Entry> entries;
  for (std::size_t i = 1; i < fields->size(); ++i) {
    const Field& field = (*fields)[i];
    const auto entry = find_process_value(device_, field.text);
    if (!entry) return problem(field.column, entry.error());
    const bool is_there = std::ranges::any_of(
        entries, [&](const Entry& other) { return other.index == entry->index && other.sub == entry->sub; });
    if (is_there)
      return problem(field.column,
                     fmt::format("{} has a column already", canopen::object_text(entry->index, entry->sub)));
    entries.push_back(*entry);
  }
  return entries;
}

std::expected<void, CsvProblem> CsvReader::row(std::string_view line, sim::Playback& playback) {
  const auto fields = fields_of(line, separator_);
  if (!fields) return problem(fields.error(), "the quote is not closed, or something follows it");
  const std::size_t wanted = playback.entries().size() + 1;
  if (fields->size() != wanted) {
    const unsigned column =
        fields->size() > wanted ? (*fields)[wanted].column : static_cast<unsigned>(line.size()) + 1;
    return problem(column,
                   fmt::format("{} fields; expected {}, as the header row has", fields->size(), wanted));
  }
  const Field& when = fields->front();
  const auto time = seconds(when.text);
  if (!time) {
    return problem(when.column,
                   fmt::format("\"{}\" is no time; expected seconds, 0 to 1000000000", when.text));
  }
  if (last_ && *time <= *last_) {
    return problem(when.column, fmt::format("{} s is not later than the row before", when.text));
  }
  last_ = time;
  std::vector<sim::Playback::Value> values;
  for (std::size_t i = 1; i < fields->size(); ++i) {
    const Field& field = (*fields)[i];
    if (field.text.empty()) {
      values.emplace_back();
      continue;
    }
    const auto value = parse_value(field.text, playback.entries()[i - 1], *device_.file().dictionary);
    if (!value) return problem(field.column, value.error());
    values.emplace_back(*value);
  }
  playback.add(*time, values);
  return {};
}

std::expected<sim::Playback, CsvProblem> CsvReader::read() {
  if (text_.size() > limits_.bytes) {
    return problem(0, fmt::format("the file has {} bytes; expected at most {}", text_.size(), limits_.bytes));
  }
  const auto first = line();
  if (!first) {
    number_ = 1;
    return problem(1, "the file is empty; expected a header row, for example time,6000:01");
  }
  auto entries = header(*first);
  if (!entries) return std::unexpected(std::move(entries.error()));
  sim::Playback playback(std::move(*entries));
  while (const auto next = line()) {
    if ((playback.rows() + 1) * playback.entries().size() > limits_.values) {
      return problem(1, fmt::format("expected at most {} values", limits_.values));
    }
    if (auto good = row(*next, playback); !good) return std::unexpected(std::move(good.error()));
  }
  if (playback.rows() == 0) return problem(1, "there is no row behind the header row");
  return playback;
}

}  // namespace

std::expected<sim::Condition, std::string> parse_condition(const sim::Device& device, std::string_view text) {
  // The last one: a parameter's name may have such characters, too.
  const std::size_t end = text.find_last_of("=<>");
  if (end == std::string_view::npos) {
    return std::unexpected(fmt::format(
        "\"{}\" is no condition; expected for example \"6000:01 >= 3\" with == != < <= > or >=", text));
  }
  const bool two = end > 0 && std::string_view("=<>!").find(text[end - 1]) != std::string_view::npos;
  const std::string_view sign = text.substr(two ? end - 1 : end, two ? 2 : 1);
  using enum sim::Comparison;
  constexpr std::array all{equal, not_equal, less, less_or_equal, greater, greater_or_equal};
  const auto comparison = std::ranges::find(all, sign, [](sim::Comparison one) { return sim::name(one); });
  if (comparison == all.end()) {
    return std::unexpected(fmt::format("\"{}\" compares nothing; expected == != < <= > or >=", sign));
  }
  const auto entry = find_process_value(device, ascii::trim(text.substr(0, two ? end - 1 : end)));
  if (!entry) return std::unexpected(entry.error());
  const auto value = parse_value(ascii::trim(text.substr(end + 1)), *entry, *device.file().dictionary);
  if (!value) return std::unexpected(value.error());
  return sim::Condition{*entry, *comparison, *value};
}

std::vector<text::FileError> add_scripts(sim::Device& device, const std::vector<ScriptSection>& scripts) {
  text::FileErrors errors;
  for (const ScriptSection& script : scripts) {
    if (const auto step = step_of(device, script, errors)) device.add_script_step(*step);
  }
  return errors.release();
}

std::expected<sim::Playback, CsvProblem> read_playback_csv(std::string_view text, const sim::Device& device,
                                                           const CsvLimits& limits) {
  return CsvReader(text, device, limits).read();
}

}  // namespace canopus::plant
