#pragma once
// A gateway, one client's session, and both of their ends: the bus and the client.

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/client/gateway/gateway.hpp"
#include "canopus/client/gateway/gateway_session.hpp"

namespace canopus::client {

struct WireAndClient : can::Sink, GatewaySession::Peer {
  bool send(const can::Frame& frame) override {
    if (full) return false;
    frames.push_back(frame);
    return true;
  }
  void send_line(std::string_view line) override { lines.emplace_back(line); }
  bool is_full() const override { return lines.size() >= clients_room; }

  std::vector<can::Frame> frames;
  std::vector<std::string> lines;
  bool full = false;
  std::size_t clients_room = ~std::size_t{0};
};

class GatewaySetup : public testing::Test {
 protected:
  void send(const std::string& text) { session.receive(text + "\r\n", now); }
  /// The answer to one line.
  std::string answer_to(const std::string& text) {
    ends.lines.clear();
    send(text);
    return ends.lines.empty() ? "(nothing)" : ends.lines.back().substr(0, ends.lines.back().find("\r\n"));
  }
  void receive(const can::Frame& frame) {
    ends.lines.clear();
    gateway.receive(frame, now);
  }
  void pass(can::Duration time) {
    const can::Time end = now + time;
    while (std::min(gateway.deadline(), session.deadline()) <= end) {
      now = std::max(now, std::min(gateway.deadline(), session.deadline()));
      if (gateway.deadline() <= now) gateway.tick(now);
      if (session.deadline() <= now) session.tick(now);
    }
    now = end;
  }
  can::Time now{};
  WireAndClient ends;
  Gateway gateway{ends, 0, "1.2"};
  GatewaySession session{gateway, ends};
};

}  // namespace canopus::client
