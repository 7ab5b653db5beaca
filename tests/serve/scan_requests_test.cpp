// Requests to a rack with a scan of its own wait for its END. Real sockets of the loopback interface, time of a timeline
// that the test moves; the test turns the event loop itself.

#include <memory>
#include <string>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>

#include "canopus/serve/melsec_server.hpp"
#include "canopus/serve/modbus_server.hpp"

#include "plc/conversation.hpp"

namespace canopus::serve::scan_requests_test {
namespace {

using boost::asio::ip::tcp;
using boost::asio::ip::udp;
using boost::system::error_code;
using plc::testing::bytes;
using plc::testing::shown;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;
using namespace std::chrono_literals;

constexpr const char* nothing = "";

std::string of_3e(const std::string& data) {
  const std::string body = bytes("10 00") + bytes(data);
  return bytes("50 00 00 ff ff 03 00") + static_cast<char>(body.size()) + '\0' + body;
}
const std::string read_g100 = of_3e("01 04 80 00 00 00 64 00 00 ab 00 00 00 00 f8 01 00");
std::string write_g100(const std::string& word) {
  return of_3e("01 14 80 00 00 00 64 00 00 ab 00 00 00 00 f8 01 00 " + word);
}
const std::string read_x = of_3e("01 04 00 00 00 00 00 9c 01 00");
const std::string set_y2 = of_3e("01 14 01 00 02 00 00 9d 01 00 10");
const std::string read_960 = of_3e("01 04 00 00 00 00 00 a8 c0 03");
std::string write_d0(const std::string& word) { return of_3e("01 14 00 00 00 00 00 a8 01 00 " + word); }
const std::string done = "d0 00 00 ff ff 03 00 02 00 00 00";
std::string word_reply(const std::string& word) { return "d0 00 00 ff ff 03 00 04 00 00 00 " + word; }

class TimelineClock final : public link::LoopClock {
 public:
  explicit TimelineClock(const can::Timeline& timeline) : timeline_(timeline) {}
  can::Time now() override { return timeline_.now(); }
  void touched() override { ++touches; }
  void accessed() override {}  // the END answers, and nobody else
  int touches = 0;

 private:
  const can::Timeline& timeline_;
};

/// A rack whose scan takes 10 ms, on since 0, with a module at 00H.
class ScanRequests : public ::testing::Test {
 protected:
  ScanRequests() : rack_(timeline_, plc::r04cpu(), 10ms), clock_(timeline_) {
    timeline_.add(module_);
    rack_.insert(0x00, module_);
    rack_.power_on({});
  }

  MelsecServer& start(MelsecServerOptions options = {}, MelsecPort port = {}) {
    melsec_.push_back(std::make_unique<MelsecServer>(
        context_, rack_, clock_, std::move(options),
        [this](std::string_view sentence) { reports_.emplace_back(sentence); }, std::move(port)));
    EXPECT_TRUE(melsec_.back()->listen("127.0.0.1", 0));
    return *melsec_.back();
  }
  tcp::socket connect(std::uint16_t port) {
    tcp::socket socket(client_context_);
    socket.connect({boost::asio::ip::address_v4::loopback(), port});
    socket.set_option(tcp::no_delay(true));
    socket.non_blocking(true);
    context_.run_one_for(1s);
    context_.poll();
    return socket;
  }
  tcp::socket connect() { return connect(melsec_.front()->port()); }
  udp::socket udp_client() {
    udp::socket socket(client_context_, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
    socket.connect({boost::asio::ip::address_v4::loopback(), melsec_.front()->port()});
    socket.non_blocking(true);
    return socket;
  }

  /// The server has got all of it when this returns, as far as it takes it.
  void send(tcp::socket& socket, const std::string& data) {
    boost::asio::write(socket, boost::asio::buffer(data));
    for (int in_flight = 1, turn = 0; in_flight != 0 && turn < 1000; ++turn) {
      ::ioctl(socket.native_handle(), SIOCOUTQ, &in_flight);
      context_.run_one_for(1ms);
    }
    context_.poll();
  }
  void send(udp::socket& socket, const std::string& data) {
    socket.send(boost::asio::buffer(data));
    context_.run_one_for(20ms);
    context_.poll();
  }
  /// What is there to read; "closed" at the end of the stream.
  template <typename Socket>
  std::string received(Socket& socket) {
    context_.poll();
    std::vector<char> memory(200'000);
    error_code error;
    const std::size_t count = socket.receive(boost::asio::buffer(memory), 0, error);
    if (error == boost::asio::error::would_block) return nothing;
    return error ? "closed" : shown(std::string_view(memory.data(), count));
  }
  /// What comes within a second of the machine's time, in which plant time stands still.
  template <typename Socket>
  std::string receive(Socket& socket) {
    for (int turn = 0; turn < 100; ++turn) {
      if (std::string some = received(socket); some != nothing) return some;
      context_.run_one_for(10ms);
    }
    return nothing;
  }
  void run_until(can::Time time) {
    timeline_.run_until(time);
    context_.poll();
  }
  std::uint16_t d0() {
    std::uint16_t value = 0xDEAD;
    EXPECT_TRUE(rack_.read_words(plc::Device::d, 0, {&value, 1}, timeline_.now()));
    return value;
  }

  boost::asio::io_context context_;
  // A port for datagrams that waits for the END has nothing to do for the loop.
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> has_more_to_do_{
      context_.get_executor()};
  boost::asio::io_context client_context_;
  can::Timeline timeline_;
  plc::testing::FakeModule module_;
  plc::Rack rack_;
  TimelineClock clock_;
  std::vector<std::string> reports_;
  std::vector<std::unique_ptr<MelsecServer>> melsec_;
};

TEST_F(ScanRequests, ReadsOfOneScan_SeeBufferMemoryAndXOfOneMoment) {
  start();
  auto client = connect();
  module_.words[100] = 1;
  run_until(can::Time{1ms});
  send(client, read_g100);
  run_until(can::Time{4ms});
  module_.words[100] = 2;
  send(client, read_g100 + read_x);
  run_until(can::Time{8ms});
  module_.words[100] = 3;
  module_.x = 0b101;
  EXPECT_EQ(received(client), nothing) << "before the END";
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(client), word_reply("03 00 ") + word_reply("03 00 ") + word_reply("05 00"));
  EXPECT_EQ(module_.last_time, can::Time{10ms});
  EXPECT_EQ(melsec_[0]->requests(), 3U);
  EXPECT_GE(clock_.touches, 1);
}

TEST_F(ScanRequests, WritesOfOneScan_ReachTheModuleAtOneMoment) {
  start();
  auto client = connect();
  run_until(can::Time{2ms});
  send(client, set_y2);
  run_until(can::Time{5ms});
  send(client, write_g100("05 00"));
  run_until(can::Time{9999us});
  EXPECT_THAT(module_.writes, IsEmpty());
  EXPECT_THAT(module_.edges, IsEmpty());
  run_until(can::Time{10ms});
  EXPECT_THAT(module_.writes, ElementsAre(Pair(100, 5)));
  EXPECT_THAT(module_.edges, ElementsAre(Pair(2, true)));
  EXPECT_EQ(module_.last_time, can::Time{10ms});
  EXPECT_EQ(receive(client), done + ' ' + done);
}

TEST_F(ScanRequests, EachScan_AnswersWhatCameInIt) {
  start();
  auto client = connect();
  for (int scan = 1; scan <= 5; ++scan) {
    run_until(can::Time{10ms * scan - 1us});
    send(client, read_g100);
    EXPECT_EQ(received(client), nothing);
    run_until(can::Time{10ms * scan});
    EXPECT_EQ(receive(client), word_reply("00 00"));
  }
  EXPECT_EQ(module_.reads, 5) << "and nothing else";
}

TEST_F(ScanRequests, RepliesOfAPipeline_ComeInTheOrderOfItsRequests) {
  start();
  auto client = connect();
  std::string expected;
  for (char serial = 0; serial < 100; ++serial) {
    std::string request = bytes("54 00 00 00 00 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00");
    request[2] = serial;
    send(client, request);
    run_until(timeline_.now() + 50us);
    std::string reply = bytes("d4 00 00 00 00 00 00 ff ff 03 00 04 00 00 00 00 00");
    reply[2] = serial;
    expected += reply;
  }
  EXPECT_EQ(received(client), nothing);
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(client), shown(expected));
}

TEST_F(ScanRequests, ClientsOfAllPorts_AreAnsweredInTheOrderInWhichTheyAsked) {
  start();
  start({}, {.udp = true});
  auto first = connect();
  udp::socket second(client_context_, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
  second.connect({boost::asio::ip::address_v4::loopback(), melsec_.back()->port()});
  send(first, write_d0("01 00"));
  send(second, write_d0("02 00"));
  run_until(can::Time{10ms});
  EXPECT_EQ(d0(), 2);
  send(second, write_d0("03 00"));
  send(first, write_d0("04 00"));
  run_until(can::Time{20ms});
  EXPECT_EQ(d0(), 4);
}

TEST_F(ScanRequests, Udp_IsAnsweredAtTheEnd_WithWordsOfOneMoment) {
  start({}, {.udp = true});
  auto first = udp_client();
  auto second = udp_client();
  run_until(can::Time{1ms});
  send(first, read_g100);
  send(first, "GET / HTTP/1.1");
  run_until(can::Time{5ms});
  module_.words[100] = 2;
  send(second, set_y2);
  send(first, read_g100);
  module_.words[100] = 3;
  EXPECT_EQ(received(first), nothing);
  EXPECT_THAT(module_.edges, IsEmpty());
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(first), word_reply("03 00"));
  EXPECT_EQ(receive(first), word_reply("03 00"));
  EXPECT_EQ(receive(second), done);
  EXPECT_THAT(module_.edges, ElementsAre(Pair(2, true)));
  run_until(can::Time{15ms});
  send(second, read_g100);
  EXPECT_EQ(received(second), nothing);
  run_until(can::Time{20ms});
  EXPECT_EQ(receive(second), word_reply("03 00"));
}

TEST_F(ScanRequests, Modbus_IsAnsweredAtTheEnd_WithWordsOfOneMoment) {
  plc::modbus::Settings settings;
  ASSERT_TRUE(settings.map.add(plc::modbus::Table::holding_registers,
                               {0, 1, {true, plc::Device::d, 0x00, 100}, false}));
  ASSERT_TRUE(
      settings.map.add(plc::modbus::Table::discrete_inputs, {0, 16, {false, plc::Device::x, 0, 0}, false}));
  ModbusServer server(context_, rack_, clock_, {.settings = settings});
  ASSERT_TRUE(server.listen("127.0.0.1", 0));
  auto client = connect(server.port());
  run_until(can::Time{1ms});
  send(client, bytes("00 01 00 00 00 06 ff 03 00 00 00 01"));
  run_until(can::Time{5ms});
  module_.words[100] = 2;
  module_.x = 1;
  send(client, bytes("00 02 00 00 00 06 ff 03 00 00 00 01 00 03 00 00 00 06 ff 02 00 00 00 02"));
  EXPECT_EQ(received(client), nothing);
  run_until(can::Time{10ms});
  EXPECT_EQ(
      receive(client),
      "00 01 00 00 00 05 ff 03 02 00 02 00 02 00 00 00 05 ff 03 02 00 02 00 03 00 00 00 04 ff 02 01 01");
  EXPECT_EQ(server.requests(), 3U);
}

TEST_F(ScanRequests, InStopAndPause_TheCpuDoesEndProcessing) {
  start();
  auto client = connect();
  rack_.pause({});
  send(client, read_g100);
  EXPECT_EQ(received(client), nothing);
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(client), word_reply("00 00"));
  rack_.set_cpu_state(module::CpuState::stop, timeline_.now());
  send(client, read_g100);
  EXPECT_EQ(received(client), nothing);
  run_until(can::Time{20ms});
  EXPECT_EQ(receive(client), word_reply("00 00"));
}

TEST_F(ScanRequests, WithoutSupply_TheyAreAnsweredAtOnce_AlsoThoseThatWaited) {
  start();
  auto client = connect();
  send(client, write_d0("01 00"));
  rack_.power_off({});
  EXPECT_EQ(receive(client), done);
  send(client, write_d0("02 00"));
  EXPECT_EQ(receive(client), done);
  EXPECT_EQ(d0(), 2);
  rack_.power_on({});
  send(client, read_g100);
  EXPECT_EQ(received(client), nothing);
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(client), word_reply("00 00"));
}

TEST_F(ScanRequests, ARemoteReset_EndsTheConnectionOfWhoAsked_AndOthersAreAnswered) {
  start({}, {.settings = {.remote_reset = true}});
  auto asks = connect();
  auto other = connect();
  rack_.set_cpu_state(module::CpuState::stop, {});
  send(other, write_d0("01 00"));
  send(asks, of_3e("06 10 00 00 01 00") + write_d0("07 00"));
  send(other, read_g100);
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(asks), "closed");
  EXPECT_EQ(receive(other), done + ' ' + word_reply("00 00"));
  EXPECT_EQ(d0(), 0) << "cleared, and what stood behind the reset was not done";
  EXPECT_EQ(rack_.cpu_state(), module::CpuState::run);
  send(other, read_g100);
  run_until(can::Time{20ms});
  EXPECT_EQ(receive(other), word_reply("00 00"));
}

TEST_F(ScanRequests, ClientsThatCloseWhileTheyWait_HaveAskedAllTheSame_AndHarmNobody) {
  start();
  auto other = connect();
  auto leaves = connect();
  auto breaks_off = connect();
  auto half_closes = connect();
  send(leaves, write_d0("01 00"));
  send(breaks_off, write_g100("02 00"));
  send(half_closes, read_g100);
  send(other, read_g100);
  leaves.close();
  breaks_off.set_option(boost::asio::socket_base::linger(true, 0));  // a reset of the connection
  breaks_off.close();
  half_closes.shutdown(tcp::socket::shutdown_send);
  context_.run_one_for(20ms);
  context_.poll();
  EXPECT_EQ(d0(), 0);
  run_until(can::Time{10ms});
  EXPECT_EQ(d0(), 1);
  EXPECT_EQ(receive(half_closes), word_reply("02 00"));
  EXPECT_EQ(receive(half_closes), "closed");
  EXPECT_EQ(receive(other), word_reply("02 00"));
  EXPECT_EQ(melsec_[0]->clients(), 1U);
  EXPECT_THAT(reports_, IsEmpty());
}

TEST_F(ScanRequests, AServerThatStopsWhileTheyWait_IsNotTouchedByTheEnd) {
  start();
  start({}, {.udp = true});
  auto client = connect();
  udp::socket other(client_context_, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
  other.connect({boost::asio::ip::address_v4::loopback(), melsec_.back()->port()});
  send(client, write_d0("01 00"));
  send(other, write_d0("02 00"));
  melsec_.clear();
  run_until(can::Time{10ms});
  EXPECT_EQ(d0(), 0);
  EXPECT_EQ(receive(client), "closed");
}

TEST_F(ScanRequests, WhatIsNoRequest_EndsTheConnectionBehindTheRepliesBeforeIt) {
  start();
  auto client = connect();
  send(client, write_d0("01 00") + "GET / HTTP/1.1\r\n\r\n" + write_d0("02 00"));
  EXPECT_EQ(received(client), nothing);
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(client), done);
  EXPECT_EQ(receive(client), "closed");
  EXPECT_EQ(d0(), 1);
  EXPECT_EQ(reports_.size(), 1U);
}

TEST_F(ScanRequests, HalfARequestThatStaysHalf_LosesItsConnection_ACompleteOneMayWait) {
  start({.half_request_timeout = 20ms});
  auto half = connect();
  auto behind = connect();
  auto complete = connect();
  send(half, read_g100.substr(0, 10));
  send(complete, read_g100.substr(0, 10));
  send(complete, read_g100.substr(10));
  send(behind, read_g100 + read_g100.substr(0, 10));
  EXPECT_EQ(receive(half), "closed");
  context_.run_for(40ms);
  EXPECT_EQ(melsec_[0]->clients(), 2U);
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(complete), word_reply("00 00"));
  EXPECT_EQ(receive(behind), word_reply("00 00"));
  EXPECT_EQ(receive(behind), "closed") << "its rest is half a request from now on";
}

TEST_F(ScanRequests, MoreThanAConnectionKeeps_IsAnsweredScanByScan_AndNothingIsLost) {
  start();
  auto client = connect();
  constexpr std::size_t count = 3000;  // 63000 bytes
  std::string flood;
  for (std::size_t i = 0; i < count; ++i) flood += write_d0("01 00");
  send(client, flood);
  run_until(can::Time{10ms});
  EXPECT_EQ(melsec_[0]->requests(), 16384 / write_d0("01 00").size());
  std::size_t replies = 0;
  for (int scan = 2; scan < 20; ++scan) {
    for (std::string some = receive(client); some != nothing; some = received(client))
      replies += (some.size() + 1) / 3;
    if (melsec_[0]->requests() == count) break;
    run_until(can::Time{10ms * scan});
  }
  EXPECT_EQ(replies, count * 11);
}

TEST_F(ScanRequests, RepliesOfAScan_AreLimited_AndTheRestComesLater) {
  start();
  auto client = connect();
  constexpr std::size_t count = 60;
  constexpr std::size_t reply = 11 + 2 * 960;
  std::string requests;
  for (std::size_t i = 0; i < count; ++i) requests += read_960;
  send(client, requests);
  run_until(can::Time{10ms});
  const std::size_t first = melsec_[0]->requests();
  EXPECT_GE(first, 30U);
  EXPECT_LE(first * reply, 65536U);
  run_until(can::Time{20ms});
  EXPECT_EQ(melsec_[0]->requests(), count);
  std::size_t size = 0;
  for (std::string some = receive(client); some != nothing; some = received(client))
    size += (some.size() + 1) / 3;
  EXPECT_EQ(size, count * reply);
}

TEST_F(ScanRequests, AClientThatTakesNoReplies_LosesItsConnection_AndTheScansGoOn) {
  start({.send_timeout = 300ms});
  auto deaf = connect();
  auto other = connect();
  std::string flood;
  for (int i = 0; i < 500; ++i) flood += read_960;
  error_code error;
  int quiet = 0;
  for (int turn = 0; quiet < 10 && turn < 10'000; ++turn) {
    const std::size_t sent = deaf.write_some(boost::asio::buffer(flood), error);
    quiet = sent == 0 ? quiet + 1 : 0;
    context_.poll();
    run_until(timeline_.now() + 10ms);
  }
  EXPECT_EQ(error, boost::asio::error::would_block);
  send(other, read_g100);
  run_until(timeline_.now() + 10ms);
  EXPECT_EQ(receive(other), word_reply("00 00"));
  context_.run_for(400ms);
  EXPECT_EQ(melsec_[0]->clients(), 1U);
}

TEST_F(ScanRequests, DatagramsOfAnEnd_AreLimited_AndTheRestComesLater) {
  class Echo final : public DatagramConversation {
    std::span<const std::uint8_t> answer(std::span<const std::uint8_t> request, can::Time /*now*/) override {
      return request;
    }
  };
  UdpServer server(context_, rack_, clock_, [](const auto& /*client*/) { return std::make_unique<Echo>(); },
                   {.turn_at_end = 2});
  ASSERT_TRUE(server.listen("127.0.0.1", 0));
  udp::socket client(client_context_, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
  client.connect({boost::asio::ip::address_v4::loopback(), server.port()});
  client.non_blocking(true);
  for (const char* each : {"1", "2", "3"}) send(client, each);
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(client), "31");
  EXPECT_EQ(receive(client), "32");
  EXPECT_EQ(server.requests(), 2U);
  context_.run_one_for(20ms);
  run_until(can::Time{20ms});
  EXPECT_EQ(receive(client), "33");
}

TEST_F(ScanRequests, WhilePlantTimeStandsStill_EverybodyIsAnsweredAtOnce_AlsoWhoWaited) {
  start();
  start({}, {.udp = true});
  auto client = connect();
  udp::socket other(client_context_, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
  other.connect({boost::asio::ip::address_v4::loopback(), melsec_.back()->port()});
  other.non_blocking(true);
  run_until(can::Time{3ms});
  send(client, set_y2 + write_g100("01 00"));
  send(other, read_g100);
  EXPECT_EQ(received(client), nothing);
  rack_.end_processing().stay_open(true, timeline_.now());
  EXPECT_EQ(receive(client), done + ' ' + done);
  EXPECT_EQ(receive(other), word_reply("01 00"));
  EXPECT_THAT(module_.edges, IsEmpty()) << "Y at the end of the scan, as before";
  send(client, read_g100);
  EXPECT_EQ(receive(client), word_reply("01 00"));
  rack_.end_processing().stay_open(false, timeline_.now());
  send(client, read_g100);
  EXPECT_EQ(received(client), nothing);
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(client), word_reply("01 00"));
  EXPECT_THAT(module_.edges, ElementsAre(Pair(2, true)));
}

TEST_F(ScanRequests, ConnectionsThatWait_CountAndAreNotPutOut) {
  start({.maximum_clients = 2});
  auto first = connect();
  auto second = connect();
  send(first, read_g100);
  send(second, read_g100);
  auto third = connect();
  EXPECT_EQ(receive(third), "closed");
  run_until(can::Time{10ms});
  EXPECT_EQ(receive(first), word_reply("00 00"));
  EXPECT_EQ(receive(second), word_reply("00 00"));
}

}  // namespace
}  // namespace canopus::serve::scan_requests_test
