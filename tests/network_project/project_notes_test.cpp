// Notes beside a nodelist: the lines of a TOML file of anybody's hand, changed where they are told to. Judged by bytes.

#include "canopus/network_project/project_notes.hpp"

#include <gtest/gtest.h>
// rapidcheck/gtest.h wants GoogleTest before it
#include <rapidcheck/gtest.h>

#include "canopus/network_project/network_review.hpp"

#include "network_project/project_folder.hpp"

namespace canopus::network_project::project_notes_test {
namespace {

using namespace canopus;
using network_project::NetworkProject;
using network_project::ProjectNotes;
using test::ProjectFolder;

constexpr std::string_view head =
    "# Notes of the network's nodes, by node-ID: CiA 306 has no key for them.\n";

std::string error_of(const std::expected<void, std::string>& done) { return done ? "" : done.error(); }

TEST(ProjectNotes, TheFirstNote_MakesTheFile_AndTheLastOneTakesItAway) {
  ProjectNotes notes(std::nullopt, 0);
  EXPECT_EQ(notes.note(5), "");
  EXPECT_EQ(error_of(notes.set(5, "")), "");
  EXPECT_EQ(notes.text(), std::nullopt);
  EXPECT_EQ(error_of(notes.set(5, "seal is worn")), "");
  EXPECT_EQ(notes.text(), std::string(head) + "[notes]\n5 = \"seal is worn\"\n");
  EXPECT_EQ(error_of(notes.set(5, "")), "");
  EXPECT_EQ(notes.text(), std::nullopt);
}

TEST(ProjectNotes, NotesStandByNodeId) {
  ProjectNotes notes(std::nullopt, 0);
  for (const int id : {5, 12, 3, 7})
    EXPECT_EQ(error_of(notes.set(static_cast<std::uint8_t>(id), std::to_string(id))), "");
  EXPECT_EQ(notes.text(), std::string(head) + "[notes]\n3 = \"3\"\n5 = \"5\"\n7 = \"7\"\n12 = \"12\"\n");
}

TEST(ProjectNotes, FileThatIsTooDeep_IsRefusedWithItsLine) {
  std::string deep = "[notes]\n4 = \"x\"\n[a";
  for (int i = 0; i < 40'000; ++i) deep += ".a";
  ProjectNotes notes(deep + "]\n", 0);
  EXPECT_EQ(notes.line(), 3U);
  EXPECT_EQ(notes.problem(),
            "this cannot be read as TOML: tables and arrays, or the parts of a key, are nested deeper than "
            "64 levels; "
            "expected at most 64");
  EXPECT_NE(error_of(notes.set(4, "y")), "");
}

TEST(ProjectNotes, AFileOfAnotherHand_DiffersInThatLineAlone) {
  const std::string before =
      "\xEF\xBB\xBF# ours\r\ntitle = \"Halle 3\"\r\n\r\n[notes]   # by node\r\n  \"5\" = 'geh\xC3\xB6rt Max' "
      " # he said\r\n"
      "9 = \"\"\"two\nlines\"\"\" # kept\r\n[other]\r\nx = [ 1,\r\n 2 ]\r\n[notes2]\r\n5 = \"of the second "
      "network\"\r\n";
  ProjectNotes notes(before, 0);
  EXPECT_EQ(notes.problem(), "");
  EXPECT_EQ(notes.note(5), "geh\xC3\xB6rt Max");
  EXPECT_EQ(notes.note(9), "two\nlines");
  const auto expected = [&](std::string_view from, std::string_view to) {
    std::string text = before;
    return text.replace(text.find(from), from.size(), to);
  };
  ProjectNotes changed = notes;
  EXPECT_EQ(error_of(changed.set(5, "a \"b\" \\ c\n\t\x1B")), "");
  EXPECT_EQ(*changed.text(), expected("'geh\xC3\xB6rt Max'", "\"a \\\"b\\\" \\\\ c\\n\\u0009\\u001B\""));
  EXPECT_EQ(changed.note(5), "a \"b\" \\ c\n\t\x1B");
  changed = notes;
  EXPECT_EQ(error_of(changed.set(9, "one")), "");
  EXPECT_EQ(*changed.text(), expected("\"\"\"two\nlines\"\"\"", "\"one\""));
  changed = notes;
  EXPECT_EQ(error_of(changed.set(5, "")), "");
  EXPECT_EQ(*changed.text(), expected("  \"5\" = 'geh\xC3\xB6rt Max'  # he said\r\n", ""));
  changed = notes;
  EXPECT_EQ(error_of(changed.set(7, "new")), "");
  EXPECT_EQ(*changed.text(), expected("# he said\r\n", "# he said\r\n7 = \"new\"\r\n"));
  ProjectNotes second(before, 1);
  EXPECT_EQ(second.note(5), "of the second network");
  EXPECT_EQ(error_of(second.set(6, "x")), "");
  EXPECT_EQ(*second.text(), before + "6 = \"x\"\r\n");
  ProjectNotes third(before, 2);
  EXPECT_EQ(error_of(third.set(6, "x")), "");
  EXPECT_EQ(*third.text(), before + "\r\n[notes3]\r\n6 = \"x\"\r\n");
}

TEST(ProjectNotes, WhatIsNoFileOfNotes_IsSaidAndNotChanged) {
  const auto problem_of = [](const std::string& text) {
    ProjectNotes notes(text, 0);
    EXPECT_EQ(notes.note(5), "");
    EXPECT_NE(error_of(notes.set(5, "x")), "") << text;
    EXPECT_EQ(notes.text(), text);
    return std::to_string(notes.line()) + ": " + notes.problem();
  };
  EXPECT_EQ(problem_of("a = 1\nnotes = 5\n"),
            "2: notes is no table; expected [notes] and lines such as 5 = \"text\"");
  for (const char* const line : {"5 = 7", "128 = \"x\"", "0 = \"x\"", "pump = \"x\"", "05 = \"x\""}) {
    EXPECT_EQ(problem_of(std::string("[notes]\n") + line + "\n"),
              "2: [notes] has something else than notes; expected a node-ID, = and a text in quotes");
  }
  EXPECT_TRUE(problem_of("[notes]\n5 = \"x\n").starts_with("2: this cannot be read as TOML: "));
  EXPECT_TRUE(problem_of(std::string("\xFF\xFE[\0n\0", 6)).starts_with("1: this cannot be read as TOML: "));
  EXPECT_TRUE(problem_of("[notes]\n5 = \"\xFC\"\n").starts_with("2: this cannot be read as TOML: "));
}

TEST(ProjectNotes, ANoteThatCannotBeWritten_ChangesNothing) {
  ProjectNotes notes(std::nullopt, 0);
  EXPECT_EQ(error_of(notes.set(5, std::string(4001, 'x'))), "the note has 4001 bytes; 4000 at most");
  EXPECT_EQ(error_of(notes.set(5, "\xFC")),
            "the note cannot be put into the file: it is not UTF-8 text, or the file is written in another "
            "way than [notes] "
            "and lines such as 5 = \"text\"");
  EXPECT_EQ(notes.text(), std::nullopt);
  const std::string inline_table = "notes = { 5 = \"x\", 6 = \"y\" }\n";
  ProjectNotes other(inline_table, 0);
  EXPECT_EQ(other.note(6), "y");
  EXPECT_NE(error_of(other.set(7, "z")), "");
  EXPECT_NE(error_of(other.set(5, "")), "");
  EXPECT_EQ(other.text(), inline_table);
  EXPECT_EQ(error_of(other.set(5, "z")), "");
  EXPECT_EQ(other.text(), "notes = { 5 = \"z\", 6 = \"y\" }\n");
}

TEST(ProjectNotes, TheirFile_IsNamedAsTheList) {
  EXPECT_EQ(network_project::notes_path("nodelist.cpj"), "nodelist.notes.toml");
  EXPECT_EQ(network_project::notes_path("a.b/line 1.CPJ"), "a.b/line 1.notes.toml");
  EXPECT_EQ(network_project::notes_path("a.b/list"), "a.b/list.notes.toml");
}

RC_GTEST_PROP(ProjectNotes, AnySequenceOfNotes_IsReadAgain, ()) {
  ProjectNotes notes(std::nullopt, 0);
  std::map<std::uint8_t, std::string> wanted;
  for (int i = 0; i < 12; ++i) {
    const auto id = *rc::gen::inRange<std::uint8_t>(1, 5);
    const auto text = *rc::gen::container<std::string>(rc::gen::inRange<char>(1, 127));
    const auto done = notes.set(id, text);
    RC_ASSERT(done.has_value());
    if (text.empty()) {
      wanted.erase(id);
    } else {
      wanted[id] = text;
    }
    const ProjectNotes again(notes.text(), 0);
    for (std::uint8_t one = 1; one < 5; ++one)
      RC_ASSERT(again.note(one) == (wanted.contains(one) ? wanted[one] : ""));
    RC_ASSERT(notes.text().has_value() == !wanted.empty());
  }
}

TEST(ProjectNotes, ANodesNote_GoesWhereTheNodeGoes) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}, {6, "io-block"}});
  ASSERT_TRUE(project.set_note(5, "seal is worn"));
  ASSERT_TRUE(project.set_note(6, "spare in shelf 4"));
  EXPECT_EQ(project.set_note(7, "x").error(), "the project has no node 7");
  folder.use(project);
  EXPECT_EQ(folder.files.at("nodelist.notes.toml"),
            std::string(head) + "[notes]\n5 = \"seal is worn\"\n6 = \"spare in shelf 4\"\n");
  project = folder.open();
  EXPECT_TRUE(project.changes().empty());
  network_project::ListedNode node = project.find(5)->listed;
  node.node_id = 20;
  ASSERT_TRUE(project.change_node(5, node));
  EXPECT_EQ(project.notes().note(20), "seal is worn");
  EXPECT_EQ(project.notes().note(5), "");
  ASSERT_TRUE(project.remove_node(20));
  ASSERT_TRUE(project.set_note(6, ""));
  EXPECT_EQ(project.changes().at("nodelist.notes.toml"), std::nullopt);
  folder.files["nodelist.notes.toml"] = "[notes]\n5 = 1\n";
  project = folder.open();
  EXPECT_EQ(project.set_note(5, "x").error(),
            "nodelist.notes.toml: line 2: [notes] has something else than notes; expected a node-ID, = and a "
            "text in quotes");
  ASSERT_TRUE(project.remove_node(5));
  EXPECT_FALSE(project.changes().contains("nodelist.notes.toml"));
  EXPECT_TRUE(std::ranges::any_of(review(project), [](const network_project::Finding& finding) {
    return finding.path == "nodelist.notes.toml" && finding.line == 2;
  }));
}

}  // namespace
}  // namespace canopus::network_project::project_notes_test
