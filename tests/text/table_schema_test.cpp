// The JSON Schema of a file is what its reader reads.

#include "canopus/text/table_schema.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/text/table_reader.hpp"

namespace canopus::text::table_schema_test {
namespace {

using testing::HasSubstr;

/// [machine] with a kind, which decides about its other keys, and [[machine.axis]].
std::vector<FileError> read(const std::string& text) {
  std::vector<FileError> errors;
  const auto root = parse_toml(text);
  if (!root) return {root.error()};
  TableReader top(*root, "file", errors);
  top.table("machine", "machine", "expected a table", [](TableReader& machine) {
    const auto kind = machine.text("kind", true);
    if (kind && *kind != "press" && *kind != "robot")
      machine.error("kind", "expected \"press\" or \"robot\"");
    if (kind == "press") (void)machine.integer("force", 1, 500, "a force is 1 to 500 kN");
    (void)machine.integer_of("speed", {{100, 100}, {200, 200}}, "expected a speed");
    (void)machine.integer_of("type", {{0, 240}, {254, 255}}, "a type is 0 to 240, 254 or 255");
    (void)machine.parsed("cycle", parse_duration);
    (void)machine.find("mode");
    machine.tables("axis", "machine.axis", [](TableReader& axis) {
      (void)axis.number("length");
      (void)axis.boolean("braked");
      (void)axis.parsed("object", parse_object);
    });
  });
  top.finish();
  return errors;
}

Json machine() { return json_schema(schema_of(read), "Machines")["properties"]["machine"]; }

TEST(TableSchema, KeysOfATable_HaveTypesLimitsAndTheMessagesOfTheChecks) {
  const Json keys = machine()["properties"];
  EXPECT_EQ(
      keys["kind"].dump(),
      R"x({"type":"string","enum":["press","robot"],"description":"expected \"press\" or \"robot\""})x");
  EXPECT_EQ(keys["cycle"]["type"].get<std::string>(), "string");
  EXPECT_THAT(keys["cycle"]["description"].get<std::string>(), HasSubstr("expected a number and a unit"));
  EXPECT_EQ(machine()["required"].dump(), R"(["kind"])");
  EXPECT_EQ(machine()["additionalProperties"].dump(), "false");
}

TEST(TableSchema, IntegersOfAClosedSet_AreAListOrRanges) {
  EXPECT_EQ(machine()["properties"]["speed"].dump(),
            R"({"type":"integer","enum":[100,200],"description":"expected a speed"})");
  EXPECT_EQ(
      machine()["properties"]["type"].dump(),
      R"({"type":"integer","anyOf":[{"minimum":0,"maximum":240},{"minimum":254,"maximum":255}],"description":"a type is 0 to 240, 254 or 255"})");
  const auto refused = [](const std::string& line) {
    const auto errors = read("[machine]\nkind = \"robot\"\n" + line + "\n");
    return errors.empty() ? std::string() : errors.front().message;
  };
  EXPECT_EQ(refused("speed = 200"), "");
  EXPECT_EQ(refused("speed = 150"), "speed = 150: expected a speed");
  EXPECT_EQ(refused("type = 254"), "");
  EXPECT_EQ(refused("type = 252"), "type = 252: a type is 0 to 240, 254 or 255");
}

TEST(TableSchema, AKeyThatOneChoiceAloneHas_IsInIt) {
  EXPECT_EQ(machine()["properties"]["force"].dump(),
            R"({"type":"integer","minimum":1,"maximum":500,"description":"a force is 1 to 500 kN"})");
}

TEST(TableSchema, ArraysOfTables_HaveTheSchemaOfOne) {
  const Json axis = machine()["properties"]["axis"];
  EXPECT_EQ(axis["type"].get<std::string>(), "array");
  EXPECT_EQ(axis["items"]["properties"]["length"].dump(), R"({"type":"number"})");
  EXPECT_EQ(axis["items"]["properties"]["braked"].dump(), R"({"type":"boolean"})");
}

TEST(TableSchema, AKeyThatIsReadAsItStands_TakesEveryType) {
  EXPECT_EQ(machine()["properties"]["mode"].dump(), "{}");
}

TEST(TableSchema, WithoutARecording_NothingIsNoted) {
  EXPECT_EQ(SchemaRecording::current(), nullptr);
  TableSchema schema;
  {
    const SchemaRecording recording(schema);
    (void)read("[machine]\nkind = \"robot\"\n");
  }
  EXPECT_EQ(SchemaRecording::current(), nullptr);
  EXPECT_TRUE(schema.keys.contains("machine"));
}

}  // namespace
}  // namespace canopus::text::table_schema_test
