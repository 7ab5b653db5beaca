// The socketcand server with clients of its protocol: frames, answers, ends of connections.

#include "link/socketcand_client.hpp"

namespace canopus::link::socketcand_server_test {
namespace {

TEST_F(SocketcandServerTest, MissingAcknowledgement_IsAnErrorFrameToTheClient) {
  const auto client = connect_raw();
  bus.newest->unacknowledged(can::Time(12s + 345us));
  until([&] { return client->all().ends_with("< error 020 12.000345 >"); });
}

TEST_F(SocketcandServerTest, Connect_IsGreetedInASegmentOfItsOwn) {
  const auto client = connect();
  EXPECT_THAT(client->received, ElementsAre("< hi >"));
}

TEST_F(SocketcandServerTest, CommandsInOneSegment_AreAnsweredInSegmentsOfTheirOwn) {
  const auto client = connect();
  client->send("< open line1 >< rawmode >");
  until([&] { return client->all() == "< hi >< ok >< ok >"; });
  EXPECT_EQ(bus.participants(), 1U);
}

TEST_F(SocketcandServerTest, FramesOfTheBus_ReachTheClientWithTheirTime) {
  const auto client = connect_raw();
  bus.time = can::Time(12s + 345us);
  bus.inject(can::data_frame(0x581, {0x43, 0x18, 0x10, 0x01, 0xEF, 0xBE, 0xAD, 0xDE}));
  until([&] { return !client->received.empty(); });
  EXPECT_THAT(client->received, ElementsAre("< frame 581 12.000345 43181001EFBEADDE >"));
}

TEST_F(SocketcandServerTest, RemoteFramesOfTheBus_AreNotPassedOn) {
  const auto client = connect_raw();
  bus.inject(can::remote_frame(0x705, 1));
  bus.inject(can::data_frame(0x705, {0x05}));
  until([&] { return !client->received.empty(); });
  EXPECT_THAT(client->received, ElementsAre("< frame 705 0.020000 05 >"));
}

TEST_F(SocketcandServerTest, SubscribedFrames_ReachTheClient_OthersDoNot) {
  const auto client = connect();
  client->send("< open line1 >< subscribe 0 0 581 >< echo >");
  until([&] { return client->all() == "< hi >< ok >< echo >"; });
  bus.time = can::Time(12s + 345us);
  bus.inject(can::data_frame(0x582, {1}));
  bus.inject(can::data_frame(0x581, {0x43, 0x18}));
  until([&] { return client->all().ends_with("43 18 >"); });
  EXPECT_EQ(client->all(), "< hi >< ok >< echo >< frame 581 12.000345 43 18 >");
}

TEST_F(SocketcandServerTest, JobsOfAClient_EndWithItsConnection) {
  const auto client = connect();
  client->send("< open line1 >< add 0 20000 123 1 42 >< echo >");
  until([&] { return client->all().ends_with("< echo >"); });
  bus.run();
  bus.advance(20ms);
  bus.run();
  EXPECT_THAT(bus.delivered, ElementsAre(can::data_frame(0x123, {0x42}), can::data_frame(0x123, {0x42})));
  client->reset();
  until([&] { return bus.participants() == 0; });
  bus.advance(1s);
  bus.run();
  EXPECT_EQ(bus.delivered.size(), 2U);
}

TEST_F(SocketcandServerTest, FramesBeforeRawmode_AreNotForTheClient) {
  const auto client = connect();
  client->send("< open line1 >");
  until([&] { return client->all() == "< hi >< ok >"; });
  bus.inject(can::data_frame(0x701, {0x05}));
  client->send("< echo >");
  until([&] { return client->all().ends_with("< echo >"); });
  EXPECT_EQ(client->all(), "< hi >< ok >< echo >");
}

TEST_F(SocketcandServerTest, FramesSoonAfterRawmode_WaitForTheSettlingTime) {
  const auto client = connect();
  client->send("< open line1 >< rawmode >");
  until([&] { return client->all() == "< hi >< ok >< ok >"; });
  bus.inject(can::data_frame(0x701, {0x05}));
  bus.advance(19'999us);
  io.poll();
  EXPECT_EQ(client->all(), "< hi >< ok >< ok >");
  bus.advance(1us);
  until([&] { return client->all() == "< hi >< ok >< ok >< frame 701 0.000000 05 >"; });
}

TEST_F(SocketcandServerTest, FramesOfTheClient_GoOnTheBusAndTheLoopIsTold) {
  const auto client = connect_raw();
  const int before = bus.touches;
  client->send("< send 0 2 1 5 >");
  until([&] { return bus.waiting() == 1; });
  until([&] { return bus.touches > before; });
  bus.run();
  EXPECT_THAT(bus.delivered, ElementsAre(can::data_frame(0x000, {0x01, 0x05})));
}

TEST_F(SocketcandServerTest, FrameOfOneClient_ReachesTheOtherAndNotItself) {
  const auto one = connect_raw();
  const auto other = connect_raw();
  one->send("< send 123 1 1 >");
  until([&] { return bus.waiting() == 1; });
  bus.run();
  one->send("< echo >");
  until([&] { return !one->received.empty() && !other->received.empty(); });
  EXPECT_THAT(other->received, ElementsAre("< frame 123 0.040000 01 >"));
  EXPECT_THAT(one->received, ElementsAre("< echo >"));
}

TEST_F(SocketcandServerTest, ClientFasterThanTheBus_LosesNothing) {
  bus.room = 4;
  const auto client = connect_raw();
  std::string text;
  for (int i = 0; i < 500; ++i) text += "< send 123 2 " + std::to_string(i % 100) + " 0 >";
  client->send(text);
  until([&] {
    if (bus.waiting() == 4) bus.run();
    return bus.delivered.size() + bus.waiting() == 500;
  });
  EXPECT_EQ(server->statistics().frames_from_clients, 500U);
}

TEST_F(SocketcandServerTest, WrongBusName_IsToldAndTheConnectionEnds) {
  const auto client = connect();
  client->send("< open can0 >");
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(client->all(), "< hi >< error could not open bus >");
  client->close();
  until([&] { return bus.participants() == 0; });
}

TEST_F(SocketcandServerTest, WrongBusNameWithCommandsBehindIt_IsStillTold) {
  const auto client = connect();
  client->send("< open can0 >< rawmode >< send 1 0 >" + std::string(10'000, 'x'));
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(client->all(), "< hi >< error could not open bus >");
}

TEST_F(SocketcandServerTest, ClientThatStaysAfterTheEnd_IsClosedAfterASecond) {
  const auto client = connect();
  client->send("< open can0 >");
  until([&] { return client->closed_by_server; });
  bus.advance(999'999us);
  io.poll();
  EXPECT_EQ(bus.participants(), 1U);
  bus.advance(1us);
  until([&] { return bus.participants() == 0; });
}

TEST_F(SocketcandServerTest, ClientThatCloses_LeavesTheBus) {
  const auto client = connect_raw();
  ASSERT_EQ(bus.participants(), 1U);
  client->close();
  until([&] { return bus.participants() == 0; });
  EXPECT_EQ(server->statistics().clients, 0U);
}

TEST_F(SocketcandServerTest, ClientThatSendsAndCloses_StaysUntilItsFramesAreOut) {
  const auto client = connect_raw();
  client->send("< send 0 2 1 5 >");
  client->close();
  until([&] { return bus.waiting() == 1; });
  io.poll();
  bus.run();
  until([&] { return bus.participants() == 0; });
  EXPECT_THAT(bus.delivered, ElementsAre(can::data_frame(0x000, {0x01, 0x05})));
}

TEST_F(SocketcandServerTest, ClosedClientOnADeadBus_IsTakenOffAfterASecond) {
  const auto client = connect_raw();
  client->send("< send 0 2 1 5 >");
  until([&] { return bus.waiting() == 1; });
  const int before = bus.touches;
  client->close();
  until([&] { return bus.touches > before; });
  bus.advance(1s);
  until([&] { return bus.participants() == 0; });
  EXPECT_EQ(bus.waiting(), 0U);
  EXPECT_THAT(reports, ElementsAre(HasSubstr(" left: 1 frame that it had sent was dropped")));
}

TEST_F(SocketcandServerTest, ClientThatComesAndGoes_JoinsAndLeavesAtThePresent) {
  bus.wall = can::Time(5s);
  const auto client = connect();
  EXPECT_EQ(bus.joined, can::Time(5s));
  EXPECT_EQ(bus.touches, 1);
  bus.wall = can::Time(7s);
  client->close();
  until([&] { return bus.participants() == 0; });
  EXPECT_EQ(bus.left, can::Time(7s));
}

TEST_F(SocketcandServerTest, ClientThatIsGone_HasASecondForWhatItLeft) {
  bus.room = 4;
  const auto client = connect_raw();
  std::string text;
  for (int i = 0; i < 90; ++i) text += "< send 123 1 5 >";
  client->send(text);
  client->close();
  run_slow_bus_until([&] { return bus.participants() == 0; });
  EXPECT_EQ(bus.delivered.size(), 90U);
  EXPECT_EQ(server->statistics().frames_dropped, 0U);
  EXPECT_THAT(reports, ElementsAre());
}

TEST_F(SocketcandServerTest, ClientThatFloodsAndCloses_DoesNotKeepTheBusBusy) {
  bus.room = 4;
  const auto client = connect_raw();
  const std::size_t sent = client->flood("< send 123 8 1 2 3 4 5 6 7 8 >");
  const can::Time closed = bus.time;
  client->close();
  run_slow_bus_until([&] { return bus.participants() == 0; });
  EXPECT_LT(bus.time - closed, 60s);
  EXPECT_EQ(bus.delivered.size() + server->statistics().frames_dropped, sent);
}

TEST_F(SocketcandServerTest, ClientThatFloodsAndResets_IsOffAfterASecond) {
  bus.room = 4;
  const auto client = connect_raw();
  (void)client->flood("< send 123 8 1 2 3 4 5 6 7 8 >");
  until([&] { return bus.waiting() == 4; });
  const can::Time reset = bus.time;
  client->reset();
  run_dead_bus_until([&] { return bus.participants() == 0; });
  EXPECT_LE(bus.time - reset, 1100ms);
  EXPECT_GT(server->statistics().frames_dropped, 4U);
  EXPECT_THAT(reports, ElementsAre("127.0.0.1:" + std::to_string(client->port) +
                                   " left: " + std::to_string(server->statistics().frames_dropped) +
                                   " frames that it had sent were dropped"));
}

TEST_F(SocketcandServerTest, ClientThatSendsAndResets_HasItsFramesSentNevertheless) {
  const auto client = connect_raw();
  client->send("< send 1 0 >< send 2 0 >< send 3 0 >");
  client->reset();
  run_slow_bus_until([&] { return bus.participants() == 0; });
  EXPECT_EQ(bus.delivered.size(), 3U);
}

TEST_F(SocketcandServerTest, BusThatTakesNothingForASecond_HoldsNobodyUp) {
  bus.room = 4;
  const auto client = connect_raw();
  std::string text;
  for (int i = 0; i < 30; ++i) text += "< send 123 0 >";
  client->send(text + "< echo >");
  run_dead_bus_until([&] { return client->all().ends_with("< echo >"); });
  EXPECT_EQ(client->all(), "< error the bus takes no frames, they are dropped >< echo >");
  EXPECT_GE(bus.time, can::Time(1s));
  EXPECT_EQ(bus.waiting(), 4U);
  bus.run();
  client->send("< send 7 0 >");
  until([&] { return bus.waiting() == 1; });
}

TEST_F(SocketcandServerTest, ClientThatFloodsADeadBusAndCloses_IsTakenOffIt) {
  bus.room = 4;
  const auto client = connect_raw();
  (void)client->flood("< send 123 8 1 2 3 4 5 6 7 8 >");
  client->close();
  run_dead_bus_until([&] { return bus.participants() == 0; });
  EXPECT_GT(server->statistics().frames_dropped, 4U);
}

TEST_F(SocketcandServerTest, MoreClientsThanAllowed_AreToldSoAndClosed) {
  start({.clients = 1});
  const auto first = connect();
  const auto second = connect();
  until([&] { return second->closed_by_server; });
  EXPECT_EQ(second->all(), "< error too many clients >");
  EXPECT_EQ(server->statistics().clients, 1U);
}

TEST_F(SocketcandServerTest, BusThatTakesNoMore_IsToldTheSameWay) {
  bus.places = 0;
  const auto client = connect();
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(client->all(), "< error too many clients >");
}

TEST_F(SocketcandServerTest, Close_EndsEveryConnectionAndStopsListening) {
  const auto client = connect_raw();
  const std::uint16_t port = server->port();
  server->close();
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(bus.participants(), 0U);
  tcp::socket late(io);
  error_code failure;
  late.connect({asio::ip::address_v4::loopback(), port}, failure);
  EXPECT_EQ(failure, asio::error::connection_refused);
}

TEST_F(SocketcandServerTest, DestroyedWithMessagesUnderWay_LeavesNothingBehind) {
  const auto client = connect_raw();
  bus.inject(can::data_frame(0x701, {0x05}));
  server.reset();
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(bus.participants(), 0U);
}

TEST_F(SocketcandServerTest, PortInUse_IsAnErrorThatNamesIt) {
  SocketcandServer second(io, {asio::ip::address_v4::loopback(), server->port()}, "line1", bus.attach(), bus);
  const auto listening = second.listen();
  ASSERT_FALSE(listening);
  EXPECT_EQ(listening.error(),
            "cannot listen on 127.0.0.1:" + std::to_string(server->port()) + ": Address already in use");
  EXPECT_EQ(second.port(), 0U);
}

}  // namespace
}  // namespace canopus::link::socketcand_server_test
