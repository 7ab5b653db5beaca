#include <fmt/format.h>

#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

namespace {

/// A number, true, false, or a string that holds one.
std::optional<text::Scalar> read_value(text::TableReader& table, std::string_view key) {
  const toml::node* node = table.find(key);
  if (node == nullptr) {
    table.error(key, "expected a number, true or false");
    return std::nullopt;
  }
  if (const auto* flag = node->as_boolean()) return flag->get();
  if (const auto* whole = node->as_integer()) return whole->get();
  if (const auto* real = node->as_floating_point()) return real->get();
  if (const auto* text = node->as_string()) return text->get();
  table.error(key, "expected a number, true or false");
  return std::nullopt;
}

}  // namespace

ScriptSection read_script(text::TableReader& table) {
  constexpr std::string_view moment_expected = "expected at = \"5s\" or when = \"6000:01 >= 3\", one of them";
  ScriptSection script{.place = table.place(),
                       .when_place = table.place("when"),
                       .set_place = table.place("set"),
                       .release_place = table.place("release")};
  script.at = table.parsed("at", text::parse_duration);
  script.when = table.text("when").value_or("");
  const bool has_at = table.find("at") != nullptr;
  const bool has_when = table.find("when") != nullptr;
  if (has_at == has_when) table.error(has_when ? "when" : "at", moment_expected);
  if (has_when && script.when.empty() && !table.is_wrong("when")) table.error("when", "expected a condition");
  script.hold = table.parsed("for", text::parse_duration);
  if (script.hold && *script.hold == can::Duration::zero()) table.error("for", "expected more than 0");
  script.release = table.text("release").value_or("");
  const bool releases = table.find("release") != nullptr;
  if (releases && script.release.empty() && !table.is_wrong("release")) {
    table.error("release", "expected an object, or \"all\"");
  }
  const toml::node* set = table.find("set");
  if ((set != nullptr) == releases) {
    table.error(releases ? "release" : "set",
                "expected set = { object = \"6000:01\", value = 3 } or release = \"6000:01\", one of them");
  }
  if (releases && script.hold) table.error("for", "expected with set alone");
  if (set == nullptr) return script;
  table.table("set", "set", "expected { object = \"6000:01\", value = 3 }", [&](text::TableReader& inner) {
    script.set = inner.text("object", true).value_or("");
    if (auto value = read_value(inner, "value")) script.value = std::move(*value);
  });
  return script;
}

PlaybackSection read_playback(text::TableReader& table) {
  PlaybackSection playback{.place = table.place(), .file_place = table.place("file")};
  playback.file = table.text("file", true).value_or("");
  playback.repeat = table.boolean("repeat").value_or(false);
  return playback;
}

}  // namespace canopus::plant
