// Signals of one node joined with those of another: the PDOs that come of it, and why some cannot be joined.

#include "canopus/network_project/pdo_link.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "canopus/network_project/network_review.hpp"

#include "network_project/project_folder.hpp"
#include "support/random_cases.hpp"

namespace canopus::network_project::pdo_link_test {
namespace {

using namespace canopus;
using network_project::NetworkProject;
using network_project::SignalEnd;
using test::ProjectFolder;

const network_project::Pdo& pdo_of(const NetworkProject& project, std::uint8_t node,
                                   const std::string& name) {
  for (const network_project::Pdo& pdo : project.find(node)->pdos) {
    if (pdo.name() == name) return pdo;
  }
  throw std::out_of_range(name);
}

/// "181H: 6000:01, 6000:02", or "-" for one that is off.
std::string shown(const NetworkProject& project, std::uint8_t node, const std::string& name) {
  const network_project::Pdo& pdo = pdo_of(project, node, name);
  return pdo.is_active()
             ? network_project::describe_can_id(pdo.cob_id) + ": " + network_project::describe_mapping(pdo)
             : "-";
}

std::string links(const NetworkProject& project) {
  std::string text;
  for (const network_project::SignalLink& link : find_links(project)) {
    text += fmt::format("{}.{} -> {}.{} {} TPDO{} RPDO{} bits {}+{}\n", link.from.node_id,
                        eds::object_text(link.from.index, link.from.sub), link.to.node_id,
                        eds::object_text(link.to.index, link.to.sub),
                        network_project::describe_can_id(link.cob_id), link.tpdo, link.rpdo, link.first_bit,
                        link.bits);
  }
  return text;
}

std::string link(NetworkProject& project, SignalEnd from, SignalEnd to) {
  const auto changes = link_signals(project, from, to);
  if (!changes) return changes.error();
  std::string text;
  for (const network_project::PdoChange& change : *changes) {
    text += fmt::format("{} {}: {}: {}\n", change.node_id, change.after.name(),
                        network_project::describe_can_id(change.after.cob_id),
                        network_project::describe_mapping(change.after));
  }
  return text;
}

/// Takes all PDOs of a node off the bus.
void switch_off(NetworkProject& project, std::uint8_t node) {
  const auto pdos = project.find(node)->pdos;
  for (network_project::Pdo pdo : pdos) {
    pdo.cob_id.raw |= canopen::CobId::invalid_bit;
    ASSERT_TRUE(project.set_pdo(node, pdo));
  }
}

TEST(PdoLink, DefaultPdos_AreReadFromTheFile) {
  ProjectFolder folder;
  const NetworkProject project = folder.with({{5, "drive"}});
  EXPECT_EQ(shown(project, 5, "RPDO1"), "205H: 6040:00");
  EXPECT_EQ(shown(project, 5, "TPDO4"), "485H: 6041:00, 606C:00");
  const network_project::Pdo& tpdo = pdo_of(project, 5, "TPDO2");
  EXPECT_EQ(tpdo.transmission_type, 255);
  EXPECT_EQ(tpdo.inhibit_time, 100);
  EXPECT_EQ(tpdo.event_timer, 0);
  EXPECT_EQ(tpdo.most_objects, 8U);
  EXPECT_EQ(tpdo.length(), 3U);
  EXPECT_TRUE(tpdo.can_change_mapping);
  EXPECT_TRUE(tpdo.can_change_cob_id);
  EXPECT_EQ(pdo_of(project, 5, "RPDO2").inhibit_time, std::nullopt);
  EXPECT_EQ(links(project), "");
}

TEST(PdoLink, ASignalThatIsSentAlready_IsTakenWhereItIs) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{2, "encoder"}, {5, "drive"}});
  // The encoder's TPDO1 has 6004H. All RPDOs of the drive are in use; that nobody sends the last one's frame.
  EXPECT_EQ(link(project, {2, 0x6004, 0}, {5, 0x60FF, 0}), "5 RPDO4: 182H: 60FF:00\n");
  EXPECT_EQ(links(project), "2.6004:00 -> 5.60FF:00 182H TPDO1 RPDO4 bits 0+32\n");
  EXPECT_EQ(shown(project, 5, "RPDO1"), "205H: 6040:00");
  EXPECT_EQ(link(project, {2, 0x6004, 0}, {5, 0x60FF, 0}), "");  // once more: nothing to do
}

TEST(PdoLink, WhatStandsBeforeTheSignal_StaysUnused) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{4, "drive"}, {5, "drive"}});
  // TPDO4: statusword, then the velocity.
  EXPECT_EQ(link(project, {4, 0x606C, 0}, {5, 0x60FF, 0}), "5 RPDO4: 484H: 16 unused bits, 60FF:00\n");
  EXPECT_EQ(links(project), "4.606C:00 -> 5.60FF:00 484H TPDO4 RPDO4 bits 16+32\n");
  EXPECT_EQ(project.find(5)->value(0x1603, 1), 0x00060010U);  // UNSIGNED16 as a dummy
}

TEST(PdoLink, ADeviceWithoutDummies_CannotSkipWhatStandsBefore) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{4, "drive"}, {5, "io-block"}});
  std::string& dcf = folder.files.at("io-block.dcf");
  for (std::size_t at = 0; (at = dcf.find("Dummy000", at)) != std::string::npos; ++at) dcf[at + 10] = '0';
  project = folder.open();
  // TPDO3 has it behind the statusword; what stands in front of it cannot be left out, and no other TPDO is free.
  EXPECT_EQ(link(project, {4, 0x6061, 0}, {5, 0x6200, 1}),
            "node 5 (io-block): RPDO2 cannot leave 16 bits before the signal unused: [DummyUsage] of its "
            "file allows "
            "none that fit");
}

TEST(PdoLink, PdosThatAreOff_AreTakenFirst) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{4, "drive"}, {5, "drive"}});
  switch_off(project, 4);
  switch_off(project, 5);
  EXPECT_EQ(link(project, {4, 0x6077, 0}, {5, 0x6071, 0}),
            "4 TPDO1: 184H: 6077:00\n5 RPDO1: 184H: 6071:00\n");
  // The second signal goes along with the first one.
  EXPECT_EQ(link(project, {4, 0x606C, 0}, {5, 0x60FF, 0}),
            "4 TPDO1: 184H: 6077:00, 606C:00\n5 RPDO1: 184H: 6071:00, 60FF:00\n");
  // The frame has 16 bits left; this one needs 32.
  EXPECT_EQ(link(project, {4, 0x6064, 0}, {5, 0x607A, 0}),
            "4 TPDO2: 284H: 6064:00\n5 RPDO2: 284H: 607A:00\n");
  EXPECT_EQ(links(project),
            "4.6077:00 -> 5.6071:00 184H TPDO1 RPDO1 bits 0+16\n"
            "4.606C:00 -> 5.60FF:00 184H TPDO1 RPDO1 bits 16+32\n"
            "4.6064:00 -> 5.607A:00 284H TPDO2 RPDO2 bits 0+32\n");
  // COB-IDs of the pre-defined connection set follow the node-ID.
  folder.use(project);
  EXPECT_NE(folder.files.at("drive.dcf").find("ParameterValue=$NODEID+0x00000180"), std::string::npos);
}

TEST(PdoLink, OneSenderHasManyTakers) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{2, "encoder"}, {5, "drive"}, {6, "drive"}});
  EXPECT_EQ(link(project, {2, 0x6004, 0}, {5, 0x607A, 0}), "5 RPDO4: 182H: 607A:00\n");
  EXPECT_EQ(link(project, {2, 0x6004, 0}, {6, 0x607A, 0}), "6 RPDO4: 182H: 607A:00\n");
  EXPECT_EQ(find_links(project).size(), 2U);
}

TEST(PdoLink, ACanIdThatIsInUse_IsNotGivenAgain) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{4, "drive"}, {5, "drive"}, {6, "drive"}});
  switch_off(project, 4);
  switch_off(project, 5);
  network_project::Pdo pdo = pdo_of(project, 6, "TPDO1");
  pdo.cob_id.raw = 0x184;
  ASSERT_TRUE(project.set_pdo(6, pdo));
  EXPECT_EQ(link(project, {4, 0x6077, 0}, {5, 0x6071, 0}),
            "4 TPDO1: 204H: 6077:00\n5 RPDO1: 204H: 6071:00\n");
}

TEST(PdoLink, WhatCannotBeJoined_IsSaid) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{2, "encoder"}, {5, "drive"}, {7, "io-block"}});
  EXPECT_EQ(link(project, {2, 0x6004, 0}, {5, 0x6040, 0}),
            "node 2 (encoder): 6004:00 (Position value) has 32 bits, node 5 (drive): 6040:00 (Controlword) "
            "has 16");
  EXPECT_EQ(
      link(project, {2, 0x6004, 0}, {5, 0x6064, 0}),
      "node 5 (drive): 6064:00 (Position actual value) cannot be mapped into an RPDO by its device file");
  EXPECT_EQ(link(project, {5, 0x6081, 0}, {7, 0x6200, 1}),
            "node 5 (drive): 6081:00 (Profile velocity) cannot be mapped into a TPDO by its device file");
  EXPECT_EQ(link(project, {2, 0x1008, 0}, {5, 0x60FF, 0}),
            "node 2 (encoder): 1008:00 (Manufacturer device name) has no fixed length, so no PDO holds it");
  EXPECT_EQ(link(project, {2, 0x7777, 1}, {5, 0x60FF, 0}), "node 2 (encoder) has no 7777:01");
  EXPECT_EQ(link(project, {9, 0x6004, 0}, {5, 0x60FF, 0}), "the project has no node 9");
  EXPECT_EQ(link(project, {5, 0x6077, 0}, {5, 0x6071, 0}), "a node cannot send a signal to itself");
  EXPECT_TRUE(project.changes().empty());
}

TEST(PdoLink, NoPdoLeft_IsSaid_AndNothingIsChanged) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{2, "encoder"}, {5, "drive"}});
  for (unsigned number = 1; number <= 4; ++number) {  // each RPDO has a sender
    network_project::Pdo pdo = pdo_of(project, 5, fmt::format("RPDO{}", number));
    pdo.cob_id.raw = pdo_of(project, 5, fmt::format("TPDO{}", number)).cob_id.key();
    ASSERT_TRUE(project.set_pdo(5, pdo));
  }
  folder.use(project);
  project = folder.open();
  EXPECT_EQ(link(project, {2, 0x6004, 0}, {5, 0x60FF, 0}),
            "node 5 (drive) has no RPDO left whose COB-ID and mapping can be changed");
  EXPECT_TRUE(project.changes().empty());
}

TEST(PdoLink, ANodeThatIsNotPresent_HasNoLinks) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{2, "encoder"}, {5, "drive"}});
  ASSERT_EQ(link(project, {2, 0x6004, 0}, {5, 0x60FF, 0}), "5 RPDO4: 182H: 60FF:00\n");
  network_project::ListedNode node = project.find(2)->listed;
  node.present = false;
  ASSERT_TRUE(project.change_node(2, node));
  EXPECT_EQ(links(project), "");
}

TEST(PdoLink, AFrameThatIsTakenAlready_HasNoRoomForAnotherSignalThere) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{4, "drive"}, {5, "drive"}});
  network_project::Pdo pdo = pdo_of(project, 5, "RPDO1");  // has the statusword as its controlword
  pdo.cob_id.raw = 0x184;
  ASSERT_TRUE(project.set_pdo(5, pdo));
  folder.use(project);
  project = folder.open();
  EXPECT_EQ(link(project, {4, 0x6041, 0}, {5, 0x6071, 0}), "5 RPDO4: 284H: 6071:00\n")
      << "TPDO2 has the statusword, too, and nobody takes it";
  for (const char* other : {"TPDO2", "TPDO3", "TPDO4"}) {
    network_project::Pdo off = pdo_of(project, 4, other);
    off.mapping = {{0x6061, 0, 8}};
    ASSERT_TRUE(project.set_pdo(4, off));
  }
  for (const char* rpdo : {"RPDO2", "RPDO3", "RPDO4"}) {
    network_project::Pdo taken = pdo_of(project, 5, rpdo);
    taken.cob_id.raw = 0x184;
    ASSERT_TRUE(project.set_pdo(5, taken));
  }
  folder.use(project);
  project = folder.open();
  EXPECT_EQ(link(project, {4, 0x6041, 0}, {5, 0x6071, 0}).substr(0, 65),
            "node 5 (drive): RPDO1 takes something else at bit 0 of 184H");
}

TEST(PdoLink, ANodeThatHearsItself_IsNoLink) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  network_project::Pdo pdo = pdo_of(project, 5, "RPDO1");
  pdo.cob_id.raw = 0x185;
  ASSERT_TRUE(project.set_pdo(5, pdo));
  EXPECT_EQ(links(project), "");
}

/// Mappable sub-indexes of a node.
std::vector<SignalEnd> signals_of(const NetworkProject& project, std::uint8_t node, bool transmit) {
  std::vector<SignalEnd> signals;
  const auto& dictionary = *project.find(node)->device->dictionary;
  for (const auto& object : dictionary.objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const auto entry = dictionary.find(object, static_cast<std::uint8_t>(sub));
      if (!entry || !(transmit ? entry.description->tpdo_mappable : entry.description->rpdo_mappable))
        continue;
      signals.push_back({node, object.index, static_cast<std::uint8_t>(sub)});
    }
  }
  return signals;
}

void check_links() {
  ProjectFolder folder;
  NetworkProject project = folder.with({{2, "encoder"}, {5, "drive"}, {20, "io-block"}});
  const std::vector<std::uint8_t> nodes = {2, 5, 20};
  for (const std::uint8_t node : nodes) {
    if (*rc::gen::arbitrary<bool>()) switch_off(project, node);
  }
  std::vector<std::pair<SignalEnd, SignalEnd>> made;
  const auto steps = *rc::gen::inRange(1, 8);
  for (int step = 0; step < steps; ++step) {
    const auto senders = signals_of(project, *rc::gen::elementOf(nodes), true);
    const auto takers = signals_of(project, *rc::gen::elementOf(std::vector<std::uint8_t>{5, 20}), false);
    const SignalEnd from = *rc::gen::elementOf(senders);
    const SignalEnd to = *rc::gen::elementOf(takers);
    if (link_signals(project, from, to)) made.emplace_back(from, to);
    const auto found = find_links(project);
    for (const auto& [sent, taken] : made) {
      RC_ASSERT(std::ranges::any_of(found, [&](const network_project::SignalLink& one) {
        return one.from == sent && one.to == taken;
      }));
    }
    for (const network_project::Finding& finding : review(project)) {
      RC_ASSERT(finding.severity != eds::Problem::Severity::error);
    }
  }
  // What was written is read again.
  folder.use(project);
  RC_ASSERT(links(folder.open()) == links(project));
}

TEST(PdoLinkProperty, LinksThatAreMade_Stay_AndNothingElseBreaks) {
  support::expect_property(check_links, 30, 100);
}

TEST(SetPdo, RefusesWhatTheDeviceCannot) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  network_project::Pdo pdo = pdo_of(project, 5, "TPDO1");
  pdo.mapping.assign(9, {0x6041, 0, 16});
  EXPECT_EQ(project.set_pdo(5, pdo).error(), "node 5 (drive): TPDO1 maps at most 8 objects");
  pdo.mapping.assign(5, {0x6041, 0, 16});
  EXPECT_EQ(project.set_pdo(5, pdo).error(), "node 5 (drive): TPDO1 would have 80 bits; 64 at most");
  pdo.number = 5;
  EXPECT_EQ(project.set_pdo(5, pdo).error(), "node 5 (drive) has no TPDO5");
  EXPECT_EQ(project.set_pdo(6, pdo).error(), "the project has no node 6");
  EXPECT_TRUE(project.changes().empty());
}

/// The DCF with another access for this section.
void make_constant(ProjectFolder& folder, const std::string& section) {
  std::string& dcf = folder.files.at("drive.dcf");
  const std::size_t place = dcf.find("AccessType=rw", dcf.find("[" + section + "]"));
  dcf.replace(place, 13, "AccessType=ro");
}

TEST(SetPdo, WhatTheDeviceHasFixed_StaysSo) {
  ProjectFolder folder;
  static_cast<void>(folder.with({{5, "drive"}}));
  make_constant(folder, "1800sub1");
  make_constant(folder, "1A01sub0");
  NetworkProject project = folder.open();
  network_project::Pdo pdo = pdo_of(project, 5, "TPDO1");
  pdo.cob_id.raw = 0x1AB;
  EXPECT_EQ(project.set_pdo(5, pdo).error(), "node 5 (drive): TPDO1 has a fixed COB-ID");
  pdo = pdo_of(project, 5, "TPDO2");
  pdo.mapping.pop_back();
  EXPECT_EQ(project.set_pdo(5, pdo).error(), "node 5 (drive): TPDO2 has a fixed mapping");
}

TEST(SetPdo, TheNumberOfObjects_IsWrittenWhenItChanges) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  network_project::Pdo pdo = pdo_of(project, 5, "TPDO2");
  pdo.mapping[1] = {0x6077, 0, 16};
  ASSERT_TRUE(project.set_pdo(5, pdo));
  const eds::EntryFacts* count = project.find(5)->device->find_facts(0x1A01, 0);
  EXPECT_FALSE(count->configured);
  pdo.mapping.pop_back();
  ASSERT_TRUE(project.set_pdo(5, pdo));
  count = project.find(5)->device->find_facts(0x1A01, 0);
  EXPECT_TRUE(count->configured);
}

TEST(SetPdo, WritesWhatDiffers) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  network_project::Pdo pdo = pdo_of(project, 5, "TPDO2");
  pdo.transmission_type = 1;
  pdo.inhibit_time = 50;
  pdo.event_timer = 200;
  pdo.cob_id.raw = 0x1AB;
  pdo.mapping.push_back({0x6077, 0, 16});
  const std::string before = folder.files.at("drive.dcf");
  ASSERT_TRUE(project.set_pdo(5, pdo));
  folder.use(project);
  const std::string& after = folder.files.at("drive.dcf");
  const auto count = [](const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  EXPECT_EQ(count(before, "ParameterValue"), 0U);
  EXPECT_EQ(count(after, "ParameterValue"), 6U);  // COB-ID, type, two times, the third object, and how many
  EXPECT_NE(after.find("ParameterValue=0x60770010"), std::string::npos);
  EXPECT_EQ(shown(folder.open(), 5, "TPDO2"), "1ABH: 6041:00, 6061:00, 6077:00");
}

}  // namespace
}  // namespace canopus::network_project::pdo_link_test
