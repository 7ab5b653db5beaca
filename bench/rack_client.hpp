#pragma once
// A client of one of a rack's servers, which writes what nobody else writes and knows the reply to every byte.

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

namespace canopus::bench {

using Clock = std::chrono::steady_clock;
using namespace std::string_literals;

enum class Server : std::uint8_t { frame_3e, udp_4e, frame_1e, modbus, control };
inline constexpr std::size_t server_count = 5;
inline constexpr std::array<std::string_view, server_count> names = {"3e_tcp", "4e_udp", "1e_tcp", "modbus",
                                                                     "control"};
inline constexpr std::array<unsigned, server_count> clients_of = {16, 16, 12, 12, 8};
inline constexpr unsigned words = 16;

inline sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

constexpr bool is_udp(Server server) { return server == Server::udp_4e; }

inline std::string le(unsigned value, int size) {
  std::string text;
  for (int i = 0; i < size; ++i) text += static_cast<char>(value >> (8 * i));
  return text;
}
inline std::string be(unsigned value) { return {static_cast<char>(value >> 8U), static_cast<char>(value)}; }

class Client {
 public:
  /// `number`: which of all; `among`: which of its server's.
  Client(Server server, unsigned number, unsigned among, bool echoes)
      : server_(server), first_(2000 + words * number), among_(among), echoes_(echoes) {}
  ~Client() {
    if (socket_ >= 0) ::close(socket_);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool connect(std::uint16_t port) {
    const sockaddr_in address = loopback(port);
    socket_ = ::socket(AF_INET, is_udp(server_) ? SOCK_DGRAM : SOCK_STREAM, 0);
    const int on = 1;
    if (!is_udp(server_)) ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return true;
    ::close(socket_);
    socket_ = -1;
    return false;
  }

  /// Sends the next request: a write, then the read of what was written, and so on.
  void request() {
    ++turn_;
    make_request();
    got_.clear();
    requested_at_ = Clock::now();
    (void)!::send(socket_, request_.data(), request_.size(), MSG_NOSIGNAL);
  }

  enum class Reply : std::uint8_t { waits, good, wrong };
  Reply receive() {
    std::array<char, 4096> buffer;
    const ssize_t size = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return Reply::waits;
    if (size <= 0) return Reply::wrong;
    got_.append(buffer.data(), static_cast<std::size_t>(size));
    if (echoes_) return got_.size() < request_.size() ? Reply::waits : Reply::good;
    if (server_ == Server::control) {
      if (!got_.ends_with('\n')) return Reply::waits;
      return got_.starts_with(expected_) && got_.find(expected_value_) != std::string::npos ? Reply::good
                                                                                            : Reply::wrong;
    }
    if (got_.size() < expected_.size()) return Reply::waits;
    return got_ == expected_ ? Reply::good : Reply::wrong;
  }

  [[nodiscard]] Server server() const { return server_; }
  [[nodiscard]] int socket() const { return socket_; }
  [[nodiscard]] Clock::time_point requested_at() const { return requested_at_; }
  [[nodiscard]] std::string description() const {
    return std::string(names[static_cast<std::size_t>(server_)]) + ' ' + std::to_string(among_) +
           ": wrong reply of " + std::to_string(got_.size()) + " bytes";
  }

 private:
  [[nodiscard]] bool writes() const { return turn_ % 2 == 1; }
  /// Words that nobody else writes, other ones in each turn, low or high byte first.
  [[nodiscard]] std::string data(bool high_first) const {
    std::string text;
    for (unsigned i = 0; i < words; ++i) {
      const unsigned word = (first_ + i) * 2654435761U + (turn_ + 1) / 2 * 40503U;
      text += high_first ? be(word & 0xFFFFU) : le(word & 0xFFFFU, 2);
    }
    return text;
  }

  void make_request() {
    switch (server_) {
      case Server::frame_3e: return make_3e("\x50\0"s, "\xD0\0"s);
      case Server::udp_4e:
        return make_3e("\x54\0"s + le(turn_, 2) + le(0, 2), "\xD4\0"s + le(turn_, 2) + le(0, 2));
      case Server::frame_1e: {
        const std::string head = "\xFF"s + le(0, 2) + le(first_, 4) + " D" + le(words, 1) + '\0';
        request_ = (writes() ? "\x03"s : "\x01"s) + head + (writes() ? data(false) : ""s);
        expected_ = writes() ? "\x83\0"s : "\x81\0"s + data(false);
        return;
      }
      case Server::modbus: {
        const std::string bytes = le(2 * words, 1) + data(true);
        const std::string pdu = (writes() ? "\x10"s : "\x03"s) + be(first_) + be(words);
        const std::string reply = writes() ? pdu : "\x03"s + bytes;
        const std::string more = writes() ? bytes : ""s;
        request_ = be(turn_ & 0xFFFFU) + be(0) + be(static_cast<unsigned>(pdu.size() + more.size() + 1)) +
                   '\xFF' + pdu + more;
        expected_ =
            be(turn_ & 0xFFFFU) + be(0) + be(static_cast<unsigned>(reply.size() + 1)) + '\xFF' + reply;
        return;
      }
      case Server::control: {
        const std::string id = std::to_string(turn_);
        const std::string value = std::to_string(((turn_ + 1) / 2 * 7 + among_ * 1000) % 30000);
        const std::string what = R"(,"device":"io)"s + (among_ < 4 ? '2' : '3') + R"(","object":"6401:0)" +
                                 std::to_string(among_ % 4 + 1) + '"';
        request_ = R"({"id":)" + id +
                   (writes() ? R"(,"request":"set","value":)" + value : R"(,"request":"get")"s) + what +
                   "}\n";
        expected_ = R"({"id":)" + id + R"(,"ok":true,)";
        expected_value_ = R"("value":)" + value + ',';
        return;
      }
    }
  }
  void make_3e(const std::string& subheader, const std::string& reply_subheader) {
    const std::string route = "\0\xFF\xFF\x03\0"s;
    const std::string body = le(0, 2) + (writes() ? "\x01\x14"s : "\x01\x04"s) + le(0, 2) + le(first_, 3) +
                             '\xA8' + le(words, 2) + (writes() ? data(false) : ""s);
    request_ = subheader + route + le(static_cast<unsigned>(body.size()), 2) + body;
    const std::string reply = le(0, 2) + (writes() ? ""s : data(false));
    expected_ = reply_subheader + route + le(static_cast<unsigned>(reply.size()), 2) + reply;
  }

  Server server_;
  unsigned first_;
  unsigned among_;
  bool echoes_;
  int socket_ = -1;
  unsigned turn_ = 0;
  std::string request_;
  std::string expected_;
  std::string expected_value_;
  std::string got_;
  Clock::time_point requested_at_;
};

}  // namespace canopus::bench
