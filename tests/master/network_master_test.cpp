#include "canopus/master/network_master.hpp"

#include <cstdio>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manager/scripted_slave.hpp"
#include "paths.hpp"
#include "support/device_bus.hpp"

namespace canopus::master::network_master_test {
namespace {

using canopen::NmtState;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Result = NetworkMaster::Result;
using namespace std::chrono_literals;

const std::string device_eds = CANOPUS_SOURCE_DIR "/tests/interop/interop_device.eds";

class NetworkMasterTest : public testing::Test, public NetworkObserver {
 protected:
  NetworkMasterTest() { network.boot_time = 5s; }
  NetworkSlave& slave(std::uint8_t node) {
    network.slaves.push_back({.node = node});
    return network.slaves.back();
  }
  void boot(can::Duration duration = 10s) {
    auto built = NetworkMaster::build(network, bus.port, *this);
    ASSERT_TRUE(built.has_value());
    master = std::move(*built);
    bus.join(*master);
    master->power_on(bus.now());
    const can::Time end = bus.now() + duration;
    while (bus.now() < end && !master->start_up_over()) bus.run_for(10ms);
  }
  [[nodiscard]] Result result(std::size_t number) const { return master->result(master->slaves()[number]); }

  void slave_booted(const NetworkSlave& which, can::Time) override { note("booted", which); }
  void slave_failed(const NetworkSlave& which, const manager::BootRecord&, can::Time) override {
    note("failed", which);
  }
  void boot_went_on(const NetworkSlave& which, const manager::BootRecord& record, can::Time) override {
    note(std::string(manager::facts(record.step).text), which);
  }
  void master_changed(bool is_own, std::uint8_t node_id, can::Time) override {
    events.push_back(is_own ? "this is the master" : "master is " + std::to_string(node_id));
  }
  void note(const std::string& what, const NetworkSlave& which) {
    events.push_back(master::describe(which) + " " + what);
  }

  NetworkFile network{.path = "network.toml"};
  std::unique_ptr<NetworkMaster> master;
  std::vector<std::string> events;
  support::DeviceBus bus;
};

TEST_F(NetworkMasterTest, Slave_IsBootedAndStarted) {
  const sim::Device& device = bus.device(5, 100);
  slave(5).name = "valve";
  boot();
  EXPECT_TRUE(master->start_up_over());
  EXPECT_EQ(result(0), Result::booted);
  EXPECT_EQ(device.node().state(), NmtState::operational);
  EXPECT_THAT(events, Contains("node 5 (valve) asking for 1000H"));
  EXPECT_THAT(events, Contains("node 5 (valve) booted"));
}

TEST_F(NetworkMasterTest, SlavesNotToBeStarted_StayPreOperational) {
  const sim::Device& device = bus.device(5, 100);
  network.start_slaves = false;
  slave(5);
  boot();
  EXPECT_EQ(result(0), Result::booted);
  EXPECT_EQ(device.node().state(), NmtState::pre_operational);
}

TEST_F(NetworkMasterTest, Settings_AreDownloaded) {
  sim::Device& device = bus.device(5, 100);
  NetworkSlave& valve = slave(5);
  valve.eds = device_eds;
  valve.objects.push_back({.place = {}, .object = {0x2003, 0}, .value = std::int64_t{123}});
  boot();
  EXPECT_EQ(result(0), Result::booted);
  EXPECT_EQ(device.node().dictionary().get<std::uint16_t>(0x2003, 0), 123);
}

TEST_F(NetworkMasterTest, ConfigurationWithDateAndTime_IsComparedBeforeItIsDownloaded) {
  const std::string dcf = testing::TempDir() + "canopus_dated.dcf";
  std::ofstream(dcf)
      << "[FileInfo]\nFileName=a.dcf\n[DeviceInfo]\nVendorName=a\nProductName=b\nGranularity=8\n"
         "[DeviceComissioning]\nNodeID=5\n"
         "[MandatoryObjects]\nSupportedObjects=2\n1=0x1000\n2=0x1001\n"
         "[1000]\nParameterName=Type\nDataType=7\nAccessType=ro\nDefaultValue=0\n"
         "[1001]\nParameterName=Register\nDataType=5\nAccessType=ro\n"
         "[OptionalObjects]\nSupportedObjects=1\n1=0x1020\n"
         "[1020]\nParameterName=Verify\nObjectType=8\nSubNumber=3\n"
         "[1020sub0]\nParameterName=N\nDataType=5\nAccessType=const\nDefaultValue=2\n"
         "[1020sub1]\nParameterName=Date\nDataType=7\nAccessType=rw\nParameterValue=11245\n"
         "[1020sub2]\nParameterName=Time\nDataType=7\nAccessType=rw\nParameterValue=6\n";
  bus.device(5, 100);  // has no 1020H, so it is asked in vain
  slave(5).eds = dcf;
  network.slaves[0].device_type = 0;
  boot();
  EXPECT_THAT(events, Contains("node 5 comparing its configuration date and time"));
  EXPECT_EQ(master->master().boot_record(5).failed_step, manager::BootStep::configuration);
  EXPECT_EQ(master->master().boot_record(5).index, 0x1020);
  std::remove(dcf.c_str());
}

TEST_F(NetworkMasterTest, IdentityOfTheDeviceFile_IsExpected) {
  bus.device(5, 100);
  slave(5).eds = device_eds;
  network.slaves[0].product = 0x501;  // instead of the file's 500H
  boot();
  EXPECT_EQ(result(0), Result::failed);
  EXPECT_EQ(master->master().boot_record(5).expected, 0x501U);
  EXPECT_EQ(master->master().boot_record(5).received, 0x500U);
}

TEST_F(NetworkMasterTest, ZeroInTheFile_IsNotCompared) {
  bus.device(5, 100);
  slave(5).eds = device_eds;
  network.slaves[0].revision = 0;
  boot();
  EXPECT_EQ(result(0), Result::booted);
}

TEST_F(NetworkMasterTest, MissingOptionalSlave_IsAbsentAndHoldsNothingUp) {
  bus.device(5, 100);
  slave(5);
  slave(9).mandatory = false;
  boot();
  EXPECT_TRUE(master->start_up_over());
  EXPECT_EQ(result(0), Result::booted);
  EXPECT_EQ(result(1), Result::absent);
}

TEST_F(NetworkMasterTest, MissingMandatorySlave_FailsWhenTheBootTimeIsOver) {
  bus.device(5, 100);
  slave(5);
  slave(9);
  boot(4s);
  EXPECT_FALSE(master->start_up_over());
  while (!master->start_up_over() && bus.now() < can::Time(20s)) bus.run_for(10ms);
  EXPECT_TRUE(master->start_up_over());
  EXPECT_EQ(result(1), Result::failed);
  EXPECT_LT(bus.now(), can::Time(6s));
}

TEST_F(NetworkMasterTest, WatchedHeartbeat_ThatDoesNotCome_Fails) {
  bus.device(5, 200);
  slave(5).consumer_heartbeat_time = 100ms;
  boot();
  EXPECT_EQ(result(0), Result::failed);
  EXPECT_EQ(master->master().boot_record(5).error, manager::BootError::no_error_control);
}

TEST_F(NetworkMasterTest, GuardedSlave_IsBooted) {
  bus.device(5, 0);
  NetworkSlave& valve = slave(5);
  valve.eds = device_eds;  // after the reset its heartbeat is 200 ms again
  valve.objects.push_back({.place = {}, .object = {0x1017, 0}, .value = std::int64_t{0}});
  valve.guard_time = 100ms;
  boot();
  EXPECT_EQ(result(0), Result::booted);
  EXPECT_TRUE(master->master().guarding(5));
}

TEST_F(NetworkMasterTest, WrongSetting_IsToldWithItsPlace) {
  NetworkSlave& valve = slave(5);
  valve.eds = device_eds;
  valve.objects.push_back({.place = {7, 3}, .object = {0x2003, 0}, .value = std::int64_t{70000}});
  valve.objects.push_back({.place = {8, 3}, .object = {0x2999, 0}, .value = std::int64_t{1}});
  valve.objects.push_back({.place = {9, 3}, .object = {0x1000, 0}, .value = std::int64_t{1}});
  const auto built = NetworkMaster::build(network, bus.port, *this);
  ASSERT_FALSE(built.has_value());
  ASSERT_EQ(built.error().size(), 3U);
  EXPECT_EQ(describe(built.error()[0], "n.toml"), "n.toml:7:3: 2003:00: 70000 does not fit UNSIGNED16");
  EXPECT_EQ(describe(built.error()[1], "n.toml"), "n.toml:8:3: 2999:00: the device file has no such object");
  EXPECT_EQ(describe(built.error()[2], "n.toml"),
            "n.toml:9:3: 1000:00: the device file says it cannot be written");
}

TEST_F(NetworkMasterTest, MissingDeviceFile_IsToldWithItsPlace) {
  slave(5).eds = "nowhere.eds";
  network.slaves[0].eds_place = {4, 7};
  const auto built = NetworkMaster::build(network, bus.port, *this);
  ASSERT_FALSE(built.has_value());
  ASSERT_EQ(built.error().size(), 1U);
  EXPECT_THAT(describe(built.error()[0], "n.toml"),
              HasSubstr("n.toml:4:7: eds = \"nowhere.eds\": cannot read "));
}

/// A slave that takes programs, written by hand, on a simulated bus.
class ProgrammableSlave final : public can::Participant {
 public:
  ProgrammableSlave(std::uint8_t node_id, can::Sink& sink)
      : script(node_id,
               [this](const can::Frame& frame, can::Duration after) {
                 answers_.emplace(now_ + after, frame);
                 alarm() = answers_.begin()->first;
               }),
        sink_(sink) {}

  void receive(const can::Frame& frame, can::Time now) override {
    now_ = now;
    script.receive(frame);
  }
  void tick(can::Time now) override {
    now_ = now;
    while (!answers_.empty() && answers_.begin()->first <= now) {
      sink_.send(answers_.begin()->second);
      answers_.erase(answers_.begin());
    }
    alarm() = answers_.empty() ? can::never : answers_.begin()->first;
  }

  manager::test::ScriptedSlave script;

 private:
  can::Sink& sink_;
  can::Time now_{};
  std::multimap<can::Time, can::Frame> answers_;
};

class NetworkMasterProgram : public NetworkMasterTest {
 protected:
  NetworkMasterProgram() {
    sim::Port& place = bus.bus.add_port("programmable");
    device = std::make_unique<ProgrammableSlave>(std::uint8_t{5}, place);
    bus.timeline.add(*device);
    place.connect(*device);
    place.plug(true);
    auto& objects = device->script.objects;
    objects[{0x1F51, 1}] = {1};
    objects[{0x1F56, 1}] = {0x11, 0, 0, 0};
    objects[{0x1F57, 1}] = {0, 0, 0, 0};
    device->script.on_write = [this](const manager::test::ScriptedSlave::Key& key) {
      auto& values = device->script.objects;
      if (key == std::pair<std::uint16_t, std::uint8_t>{0x1F50, 1}) values[{0x1F56, 1}] = {0x22, 0, 0, 0};
      if (key == std::pair<std::uint16_t, std::uint8_t>{0x1F51, 1} && values[key][0] == 3) values[key] = {2};
      return 0U;
    };
    slave(5).software_version = 0x22;
  }
  std::unique_ptr<ProgrammableSlave> device;
};

TEST_F(NetworkMasterProgram, OldVersion_IsReplacedByTheFile) {
  const std::string path = testing::TempDir() + "canopus_program.bin";
  std::ofstream(path, std::ios::binary) << std::string(1000, 'p') << '\0' << "end";
  network.slaves[0].program = path;
  boot();
  EXPECT_EQ(result(0), Result::booted);
  const std::vector<std::uint8_t>& taken = device->script.objects[{0x1F50, 1}];
  EXPECT_EQ(std::string(taken.begin(), taken.end()), std::string(1000, 'p') + '\0' + "end");
  std::remove(path.c_str());
}

TEST_F(NetworkMasterProgram, WithoutAFile_AnotherVersionIsAFailure) {
  boot();
  EXPECT_EQ(result(0), Result::failed);
  EXPECT_EQ(master->master().boot_record(5).error, manager::BootError::software_not_allowed);
}

TEST_F(NetworkMasterProgram, FileThatCannotBeRead_OrIsEmpty_IsToldWithItsPlace) {
  const std::string path = testing::TempDir() + "canopus_empty.bin";
  std::ofstream(path).flush();
  for (const auto& [name, error] :
       {std::pair<std::string, std::string>{"nowhere.bin", "cannot read "}, {path, "the file is empty"}}) {
    network.slaves[0].program = name;
    network.slaves[0].program_place = {4, 7};
    const auto built = NetworkMaster::build(network, bus.port, *this);
    ASSERT_FALSE(built.has_value());
    EXPECT_THAT(describe(built.error()[0], "n.toml"),
                HasSubstr("n.toml:4:7: program = \"" + name + "\": " + error));
  }
  std::remove(path.c_str());
}

TEST_F(NetworkMasterTest, Restore_IsWrittenBeforeTheConfiguration) {
  bus.device(5, 100);
  slave(5).restore = 1;
  boot();
  EXPECT_THAT(events, Contains("node 5 restoring its defaults"));
  EXPECT_EQ(master->master().boot_record(5).index, 0x1011);  // which this device does not have
  EXPECT_EQ(master->master().boot_record(5).sub, 1);
  EXPECT_EQ(result(0), Result::failed);
}

// 1F80H, one bit after the other.
TEST_F(NetworkMasterTest, StartUpBits_AreThoseOfTheFile) {
  const auto start_up = [this] {
    auto built = NetworkMaster::build(network, bus.port, *this);
    (*built)->power_on(bus.now());
    return (*built)->node().dictionary().get<std::uint32_t>(0x1F80, 0);
  };
  EXPECT_EQ(start_up(), 0x01U);
  network.start_together = true;
  EXPECT_EQ(start_up(), 0x03U);
  network.start_slaves = false;
  EXPECT_EQ(start_up(), 0x0BU);
  network.on_error = ErrorReaction::reset_all;
  EXPECT_EQ(start_up(), 0x1BU);
  network.on_error = ErrorReaction::stop_all;
  EXPECT_EQ(start_up(), 0x4BU);
  network.flying.emplace();
  EXPECT_EQ(start_up(), 0x6BU);
}

// Two of them on one bus: the one with the better priority boots the slave, the other stands by, and takes
// over.
TEST_F(NetworkMasterTest, FlyingMasters_OneIsActiveTheOtherStandsBy) {
  bus.device(5, 100);
  slave(5);
  network.node = 2;
  network.flying.emplace();
  network.flying->level = 2;
  NetworkFile better = network;
  better.node = 3;
  better.flying->level = 0;
  struct : NetworkObserver {
  } nobody;
  sim::Port& place = bus.bus.add_port("better");
  auto other = NetworkMaster::build(better, place, nobody);
  ASSERT_TRUE(other.has_value());
  bus.timeline.add(**other);
  place.connect(**other);
  place.plug(true);
  (*other)->power_on(bus.now());

  boot(12s);
  EXPECT_FALSE(master->start_up_over());
  EXPECT_EQ(result(0), Result::left_to_the_active_master);
  EXPECT_EQ((*other)->result((*other)->slaves()[0]), Result::booted);
  EXPECT_THAT(events, Contains("master is 3"));
  EXPECT_THAT(events, Not(Contains("this is the master")));

  place.plug(false);  // the active one is lost
  for (int i = 0; i < 1200 && !master->start_up_over(); ++i) bus.run_for(10ms);
  EXPECT_TRUE(master->master().active());
  EXPECT_EQ(result(0), Result::booted);
  EXPECT_THAT(events, Contains("this is the master"));
}

}  // namespace
}  // namespace canopus::master::network_master_test
