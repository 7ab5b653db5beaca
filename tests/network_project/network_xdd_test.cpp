// Projects whose nodes have XDCs: the same commands, the same bytes where nothing was changed, one line where one value was.

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "canopus/ascii/words.hpp"
#include "canopus/eds/files/xdd_writer.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/eds/xdd.hpp"
#include "canopus/network_project/network_load.hpp"
#include "canopus/network_project/network_project.hpp"
#include "canopus/network_project/network_review.hpp"
#include "canopus/network_project/pdo_link.hpp"
#include "canopus/network_project/project_members.hpp"

#include "network_project/project_folder.hpp"
#include "paths.hpp"

namespace canopus::network_project::network_xdd_test {
namespace {

using namespace canopus;
using network_project::NetworkProject;
using network_project::ProjectNode;
using test::ProjectFolder;

std::string as_xdd(const std::string& device_file) {
  const eds::ReadResult read = eds::read_device_file(device_file);
  return read.file == nullptr ? "" : eds::write_xdd(*read.file).text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The lines of `after` that are not those of `before`, which has as many.
std::string changed_lines(const std::string& before, const std::string& after) {
  const auto a = lines_of(before);
  const auto b = lines_of(after);
  if (a.size() != b.size()) return "lines were added or taken out\n";
  std::string lines;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != b[i]) lines += b[i].substr(std::min(b[i].find('<'), b[i].size())) + '\n';
  }
  return lines;
}

/// Node 1 has an XDC, node 2 a DCF; both are of example devices.
NetworkProject mixed(ProjectFolder& folder, const std::string& first, const std::string& second) {
  NetworkProject project = folder.make("Line 1");
  EXPECT_EQ(project.add_node({.name = "First",
                              .eds = as_xdd(test::device_file(first)),
                              .eds_name = first + ".xdd",
                              .bit_rate = 250'000}),
            1);
  EXPECT_EQ(
      project.add_node({.name = "Second", .eds = test::device_file(second), .eds_name = second + ".eds"}), 2);
  folder.use(project);
  return folder.open();
}

TEST(NetworkXdd, ANodeFromAnXdd_HasAnXdc) {
  ProjectFolder folder;
  const NetworkProject project = mixed(folder, "encoder", "drive");
  EXPECT_NE(folder.files.at("nodelist.cpj").find("Node1DCFName=first.xdc\r\n"), std::string::npos);
  EXPECT_TRUE(folder.files.contains("second.dcf"));
  EXPECT_TRUE(eds::is_xml(folder.files.at("first.xdc")));
  ASSERT_NE(project.nodes()[0].device, nullptr) << project.nodes()[0].unreadable;
  const eds::Commissioning& own = *project.nodes()[0].device->commissioning;
  EXPECT_EQ(own.node_id, 1);
  EXPECT_EQ(own.node_name, "First");
  EXPECT_EQ(own.network_name, "Line 1");
  EXPECT_EQ(project.bit_rate(), 250'000U);
  EXPECT_TRUE(project.changes().empty());
  for (const network_project::Finding& finding : review(project)) {
    EXPECT_NE(finding.severity, eds::Problem::Severity::error) << finding.path << ": " << finding.message;
  }
}

TEST(NetworkXdd, AValue_IsOneLine_AndTakenOutTheSameBytes) {
  ProjectFolder folder;
  NetworkProject project = mixed(folder, "drive", "drive");
  const std::string before = folder.files.at("first.xdc");
  ASSERT_TRUE(project.set_value(1, 0x1017, 0, "500"));
  EXPECT_EQ(project.find(1)->value(0x1017), 500U);
  folder.use(project);
  const std::string line = changed_lines(before, folder.files.at("first.xdc"));
  EXPECT_TRUE(line.starts_with("<CANopenObject index=\"1017\"")) << line;
  EXPECT_NE(line.find(" actualValue=\"500\""), std::string::npos) << line;
  EXPECT_EQ(std::ranges::count(line, '\n'), 1);
  project = folder.open();
  ASSERT_TRUE(project.remove_value(1, 0x1017, 0));
  folder.use(project);
  EXPECT_EQ(folder.files.at("first.xdc"), before);
  EXPECT_EQ(project.set_value(1, 0x1017, 0, "70000").error(),
            "actualValue=70000 of 1017:00 does not fit UNSIGNED16; expected 0 to 65535");
  EXPECT_TRUE(folder.open().changes().empty());
}

TEST(NetworkXdd, ASignal_GoesBetweenFilesOfBothKinds) {
  for (const bool to_xdc : {false, true}) {
    ProjectFolder folder;
    NetworkProject project = to_xdc ? mixed(folder, "drive", "encoder") : mixed(folder, "encoder", "drive");
    const network_project::SignalEnd from{static_cast<std::uint8_t>(to_xdc ? 2 : 1), 0x6004, 0};
    const network_project::SignalEnd to{static_cast<std::uint8_t>(to_xdc ? 1 : 2), 0x607A, 0};
    const auto made = link_signals(project, from, to);
    ASSERT_TRUE(made) << made.error();
    folder.use(project);
    const auto links = find_links(folder.open());
    EXPECT_TRUE(
        std::ranges::any_of(links, [&](const auto& link) { return link.from == from && link.to == to; }));
  }
}

TEST(NetworkXdd, ANodeThatMoves_TakesItsCobIdsAlong) {
  ProjectFolder folder;
  NetworkProject project = mixed(folder, "drive", "encoder");
  const std::string before = folder.files.at("first.xdc");
  network_project::ListedNode node = project.find(1)->listed;
  node.node_id = 20;
  node.name = "Conveyor <1> & \"2\"";
  ASSERT_TRUE(project.change_node(1, node));
  EXPECT_EQ(project.find(20)->pdos.back().cob_id.identifier(), 0x494U);
  folder.use(project);
  EXPECT_TRUE(changed_lines(before, folder.files.at("first.xdc"))
                  .starts_with("<deviceCommissioning nodeID=\"20\" nodeName=\"Conveyor &lt;1"));
  ASSERT_TRUE(project.set_bit_rate(500'000));
  EXPECT_EQ(project.bit_rate(), 500'000U);
  EXPECT_EQ(project.set_bit_rate(100'000).error(),
            "node 2 (Second) does not have 100 kbit/s: its file says 10, 20, 50, 125, 250, 500, 800, 1000");
}

TEST(NetworkXdd, ANodeThatIsRemoved_TakesItsXdcAlong) {
  ProjectFolder folder;
  NetworkProject project = mixed(folder, "drive", "encoder");
  ASSERT_TRUE(project.remove_node(1));
  folder.use(project);
  EXPECT_FALSE(folder.files.contains("first.xdc"));
}

TEST(NetworkXdd, Members_HaveTheBitRateAndTheManagerOfTheirXdc) {
  ProjectFolder folder;
  mixed(folder, "drive", "encoder");
  const auto members = [&] {
    return network_project::read_members(
        "nodelist.cpj", folder.files.at("nodelist.cpj"), 0,
        [&](const std::string& below, const std::string& name) -> std::expected<std::string, std::string> {
          return folder.files.at(below + name);
        });
  };
  ASSERT_EQ(members().members.size(), 2U);
  EXPECT_EQ(members().bit_rate, 250'000U);
  EXPECT_FALSE(members().members[0].is_manager);
  std::string& xdc = folder.files.at("first.xdc");
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(xdc.find(from), std::string::npos);
    xdc.replace(xdc.find(from), from.size(), to);
  };
  replace("CANopenManager=\"false\"", "CANopenManager=\"true\"");
  EXPECT_TRUE(members().members[0].is_manager);
  replace("actualBaudRate=\"250 Kbps\"", "actualBaudRate=\"125 Kbps\"");
  EXPECT_EQ(members().bit_rate, 0U) << "they differ";
  xdc = "<?xml version=\"1.0\"?><broken";
  EXPECT_FALSE(members().members[0].is_manager);
  EXPECT_EQ(members().bit_rate, 250'000U);
}

TEST(NetworkXdd, AnXdcThatIsNone_IsSaidAndLeftAlone) {
  ProjectFolder folder;
  mixed(folder, "drive", "encoder");
  for (const std::string& text : {std::string("<a><b></a>"), std::string("\xFF\xFE<\0a\0", 6),
                                  folder.files.at("first.xdc").substr(0, 3000)}) {
    folder.files["first.xdc"] = text;
    NetworkProject project = folder.open();
    EXPECT_EQ(project.nodes()[0].device, nullptr);
    EXPECT_FALSE(project.nodes()[0].unreadable.empty());
    EXPECT_FALSE(project.set_value(1, 0x1017, 0, "5"));
    EXPECT_TRUE(project.changes().empty());
  }
}

// The files of other makers, each as it is and converted, as one project.
class NetworkXddCorpus : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no device files in " << folder;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::string extension = ascii::lower(entry.path().extension().string());
      if (extension == ".eds" || extension == ".dcf" || extension == ".xdd" || extension == ".xdc")
        paths.push_back(entry.path());
    }
    std::ranges::sort(paths);
  }

  static std::string read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  const std::filesystem::path folder = CANOPUS_SOURCE_DIR "/../shared/data/eds";
  std::vector<std::filesystem::path> paths{};
};

/// The first sub-index of a node that has a place for a value, and one that fits.
struct Place {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::string value;
};
std::optional<Place> place_for_a_value(const ProjectNode& node) {
  for (const canopen::ObjectDescription& object : node.device->dictionary->objects()) {
    if (object.index == 0x1000 || object.index == 0x1018) continue;  // made where a file has none
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const canopen::Entry entry = node.device->dictionary->find(object, static_cast<std::uint8_t>(sub));
      const auto* facts = node.device->find_facts(object.index, static_cast<std::uint8_t>(sub));
      if (!entry || facts == nullptr || facts->line == 0 || facts->configured ||
          canopen::is_variable_length(entry.description->type))
        continue;
      const bool is_number = entry.description->type == canopen::DataType::unsigned16 ||
                             entry.description->type == canopen::DataType::unsigned32;
      const canopen::Limits limits = node.device->dictionary->limits(entry);
      if (!is_number || limits.low || limits.high) continue;
      return Place{object.index, static_cast<std::uint8_t>(sub), "4321"};
    }
  }
  return std::nullopt;
}

TEST_F(NetworkXddCorpus, AllFilesAsTheyAreAndConverted_AreOneProject) {
  ProjectFolder project_folder;
  NetworkProject project = project_folder.make("All");
  std::size_t xdcs = 0;
  for (const auto& path : paths) {
    const std::string text = read(path);
    const eds::ReadResult device = eds::read_device_file(text);
    if (device.file == nullptr) continue;
    const auto before = project.changes();
    std::vector<std::string> kinds{text};
    if (!eds::is_xml(text)) kinds.push_back(as_xdd(text));
    for (const std::string& kind : kinds) {
      const auto added =
          project.add_node({.name = path.stem().string(), .eds = kind, .eds_name = path.filename().string()});
      ASSERT_TRUE(added) << path << ": " << added.error();
      const ProjectNode& node = *project.find(*added);
      ASSERT_NE(node.device, nullptr) << path << ": " << node.unreadable;
      if (node.path.ends_with(".xdc")) ++xdcs;
    }
  }
  ASSERT_GE(xdcs, 38U);
  project_folder.use(project);
  project = project_folder.open();
  EXPECT_TRUE(project.changes().empty());
  static_cast<void>(reckon_load(project));
  EXPECT_FALSE(review(project).empty());
  std::size_t changed = 0;
  for (const ProjectNode& node : std::vector<ProjectNode>(project.nodes())) {
    const auto place = place_for_a_value(node);
    if (!place) continue;
    const std::string before = project_folder.files.at(node.path);
    const auto done = project.set_value(node.id(), place->index, place->sub, place->value);
    ASSERT_TRUE(done) << node.path << ": " << done.error();
    EXPECT_EQ(project.find(node.id())->value(place->index, place->sub), 4321U) << node.path;
    const std::string after = project.changes().at(node.path).value();
    if (node.path.ends_with(".xdc")) {
      const std::string lines = changed_lines(before, after);
      EXPECT_EQ(std::ranges::count(lines, '\n'), 1) << node.path << lines;
    }
    const auto undone = project.remove_value(node.id(), place->index, place->sub);
    ASSERT_TRUE(undone) << node.path << ": " << undone.error();
    // A DCF may have had ParameterValue= without a value, which goes, too.
    const bool had_empty_value = node.path == "lely_pilz-master.dcf";
    EXPECT_EQ(project.changes().contains(node.path), had_empty_value) << node.path;
    EXPECT_EQ(project.find(node.id())->value(place->index, place->sub), node.value(place->index, place->sub));
    ++changed;
  }
  EXPECT_GE(changed, 60U);
}

}  // namespace
}  // namespace canopus::network_project::network_xdd_test
