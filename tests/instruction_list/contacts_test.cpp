// Contacts against a slow literal model: an evaluator with a row of results, and a row of what MPS stores.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/ascii/words.hpp"

#include "list_plc.hpp"

namespace canopus::list_contacts_test {
namespace {

using list_plc::Family;
using list_plc::ListPlc;

constexpr int inputs = 4;

/// What the instructions up to OUT make of M0 to M3.
bool result_of(const std::vector<std::string>& lines, unsigned bits) {
  std::vector<bool> results;
  std::vector<bool> stored;
  for (const std::string& line : lines) {
    const std::vector<std::string_view> words = ascii::words(line);
    const std::string_view name = words[0];
    const bool input = words.size() > 1 && (bits >> (words[1][1] - '0') & 1U) != 0;
    if (name == "LD") results.push_back(input);
    if (name == "LDI") results.push_back(!input);
    if (name == "AND") results.back() = results.back() && input;
    if (name == "ANI") results.back() = results.back() && !input;
    if (name == "OR") results.back() = results.back() || input;
    if (name == "ORI") results.back() = results.back() || !input;
    if (name == "INV") results.back() = !results.back();
    if (name == "MPS") stored.push_back(results.back());
    if (name == "MRD" || name == "MPP") results.back() = stored.back();
    if (name == "MPP") stored.pop_back();
    if (name == "ANB" || name == "ORB") {
      const bool top = results.back();
      results.pop_back();
      results.back() = name == "ANB" ? results.back() && top : results.back() || top;
    }
  }
  return results.back();
}

const std::vector<std::string> first = {"LD M0", "LDI M0"};
const std::vector<std::string> second = {"AND M1", "ANI M1", "OR M1", "ORI M1"};

std::vector<std::vector<std::string>> all_shapes() {
  std::vector<std::vector<std::string>> shapes;
  for (const std::string& a : first) {
    shapes.push_back({a});
    for (const std::string& b : second) {
      shapes.push_back({a, b});
      shapes.push_back({a, b, "INV"});
      for (const std::string c : {"AND M2", "ANI M2", "OR M2", "ORI M2"}) shapes.push_back({a, b, c});
      for (const std::string c : {"LD M2", "LDI M2"})
        for (const std::string d : {"AND M3", "ANI M3", "OR M3", "ORI M3"})
          for (const std::string e : {"ANB", "ORB"}) shapes.push_back({a, b, c, d, e});
      shapes.push_back({a, "MPS", b, "MRD", "AND M2", "MPP", "ANI M3"});
      shapes.push_back({a, "MPS", "LD M1", b, "ANB", "MPP", "LD M2", "OR M3", "ANB"});
    }
  }
  return shapes;
}

TEST(ListContacts, EveryShape_HasTheTruthTableOfTheModel) {
  const auto shapes = all_shapes();
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    lines.insert(lines.end(), shapes[i].begin(), shapes[i].end());
    lines.push_back("OUT M" + std::to_string(100 + i));
  }
  for (const Family family : {Family::q, Family::iqr, Family::fx3, Family::fx5}) {
    ListPlc plc(family, lines);
    for (unsigned bits = 0; bits < 1U << inputs; ++bits) {
      for (int i = 0; i < inputs; ++i) plc.set("M" + std::to_string(i), static_cast<int>(bits >> i & 1U));
      ASSERT_EQ(plc.run(), "");
      for (std::size_t i = 0; i < shapes.size(); ++i)
        ASSERT_EQ(plc.get("M" + std::to_string(100 + i)) != 0, result_of(shapes[i], bits))
            << testing::PrintToString(shapes[i]) << " with " << bits;
    }
  }
}

/// A block of contacts: LD, then contacts and blocks that are joined to it.
void add_block(std::vector<std::string>& lines, int depth) {
  const auto pick = [](const std::vector<std::string>& names) {
    return names[*rc::gen::inRange<std::size_t>(0, names.size())] + " M" +
           std::to_string(*rc::gen::inRange(0, inputs));
  };
  lines.push_back(pick({"LD", "LDI"}));
  const int parts = *rc::gen::inRange(0, 4);
  for (int i = 0; i < parts; ++i) {
    const int kind = depth == 0 ? 0 : *rc::gen::inRange(0, 4);
    if (kind < 2) {
      lines.push_back(pick({"AND", "ANI", "OR", "ORI"}));
    } else if (kind == 2) {
      lines.emplace_back("INV");
    } else {
      add_block(lines, depth - 1);
      lines.emplace_back(*rc::gen::arbitrary<bool>() ? "ANB" : "ORB");
    }
  }
}

RC_GTEST_PROP(ListContacts, AnyBlocks_HaveTheResultsOfTheModel, ()) {
  std::vector<std::vector<std::string>> rungs(*rc::gen::inRange<std::size_t>(1, 6));
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < rungs.size(); ++i) {
    add_block(rungs[i], 3);
    lines.insert(lines.end(), rungs[i].begin(), rungs[i].end());
    lines.push_back("OUT M" + std::to_string(100 + i));
  }
  ListPlc plc(Family::q, lines);
  for (unsigned bits = 0; bits < 1U << inputs; ++bits) {
    for (int i = 0; i < inputs; ++i) plc.set("M" + std::to_string(i), static_cast<int>(bits >> i & 1U));
    RC_ASSERT(plc.run().empty());
    for (std::size_t i = 0; i < rungs.size(); ++i)
      RC_ASSERT((plc.get("M" + std::to_string(100 + i)) != 0) == result_of(rungs[i], bits));
  }
}

// X0 --+-- (Y0), and behind it [X1 or X2] -- (Y1): the block is joined to what OUT has used.
TEST(ListContacts, ABlockBehindAnOutput_IsJoinedToTheSameRung) {
  ListPlc plc(Family::q, {"LD M0", "OUT M10", "LD M1", "OR M2", "ANB", "OUT M11"});
  plc.set("M2", 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("M11"), 0);
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("M11"), 1);
}

TEST(ListContacts, ASubroutine_LeavesTheResultOfItsCaller) {
  ListPlc plc(Family::q, {"LD M0", "MPS", "CALL P0", "MPP", "OUT M10", "FEND", "P0", "LD M1", "MPS",
                          "OUT M11", "MPP", "OUT M12", "RET"});
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("M10"), 1);
  EXPECT_EQ(plc.get("M11"), 0);
}

TEST(ListContacts, EdgesAfterRun_BeginWithOff) {
  ListPlc plc(Family::q, {"LDP M0", "OUT M1"});
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.get("M1"), 0);
  plc.machine->warm_start();
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("M1"), 1);
}

TEST(ListContacts, OnlineChange_KeepsEdgesAndTimers) {
  ListPlc plc(Family::q, {"LDP M0", "OUT M1"});
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(), "");
  const std::vector<instruction_list::Source> sources = {
      {"MAIN.csv", list_plc::csv({"LD M5", "OUT M6", "LDP M0", "OUT M1", "END"})}};
  auto made = instruction_list::compile(sources, Family::q, plc.names);
  ASSERT_TRUE(made.program);
  plc.machine->change(std::move(made.program));
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("M1"), 0);
}

}  // namespace
}  // namespace canopus::list_contacts_test
