#pragma once
// One client's conversation with an ASCII gateway [CiA 309-3], without the socket. Lines, ended by LF or CR LF:
//
//   [7] 1 5 r 0x1000 0 u32      ->  [7] 983441
//   [8] 5 w 0x2000 0 u16 10     ->  [8] OK
//   [9] 5 r 0x3000 0            ->  [9] ERROR:0x06020000 #object does not exist
//   [10] 0 start                ->  [10] OK
//   set node 5                  ->  OK
//
// The number in brackets comes back with the answer and may be left out. Numbers in front of a command are the node, or
// the network and the node. `#` begins a comment. One command is answered after the other; events come between the
// answers. docs/gateway.md has all commands.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/client/gateway/gateway.hpp"
#include "canopus/client/gateway/gateway_value.hpp"

namespace canopus::client {

/// The rest of a line, word by word, and what stood in front of its command.
struct GatewayWords {
  std::string_view rest;
  std::vector<std::uint64_t> numbers{};  ///< in front: node, or network and node
  std::uint8_t node = 0;

  std::string_view next() { return next_gateway_word(rest); }
  /// None: the next word is no number, or not in these bounds.
  std::optional<std::uint64_t> number(std::uint64_t least, std::uint64_t most) {
    const auto value = gateway_number(next());
    return value && *value >= least && *value <= most ? value : std::nullopt;
  }
  [[nodiscard]] bool over() const {
    std::string_view copy = rest;
    return next_gateway_word(copy).empty();
  }
};

class GatewaySession final : public can::Ticker, private GatewayListener {
 public:
  class Peer {
   public:
    /// A line to the client, CR LF included.
    virtual void send_line(std::string_view line) = 0;
    /// Too many lines wait for the client: its next command has to wait for resume().
    [[nodiscard]] virtual bool is_full() const { return false; }

   protected:
    ~Peer() = default;
  };
  /// The longest line, and what `set command_size` can make of it: a longer one is answered with a syntax error.
  static constexpr std::size_t longest_line = 65536;
  static constexpr std::size_t least_command_size = 32;
  static constexpr can::Duration default_sdo_time_out = std::chrono::milliseconds(500);

  GatewaySession(Gateway& gateway, Peer& peer);
  ~GatewaySession() override;
  GatewaySession(const GatewaySession&) = delete;
  GatewaySession& operator=(const GatewaySession&) = delete;

  /// Bytes came from the client, cut anywhere.
  void receive(std::string_view bytes, can::Time now);
  /// The client's end has room again for answers.
  void resume(can::Time now) { read_input(now); }
  /// The client is gone: its command is called off.
  void end(can::Time now);
  /// A command is under way: further lines wait.
  [[nodiscard]] bool waiting() const noexcept { return ticket_.has_value(); }
  /// Bytes of lines that wait or have no end yet.
  [[nodiscard]] std::size_t buffered() const noexcept { return input_.size(); }

  // can::Ticker: the time-out of a command
  void tick(can::Time now) override;

 private:
  using Words = GatewayWords;

  void read_input(can::Time now);
  void line(std::string_view text, can::Time now);
  void command(Words& words, can::Time now);
  void set(Words& words, can::Time now);
  bool set_value(std::string_view what, std::uint64_t value, can::Time now);
  void init(Words& words, can::Time now);
  void nmt(Words& words, canopen::NmtCommand command);
  void supervise(Words& words, bool enable, can::Time now);
  void read_or_write(Words& words, bool write, can::Time now);
  // gateway_session_pdo.cpp
  void set_pdo(Words& words, bool received, bool extended);
  void read_pdo(Words& words, can::Time now);
  void write_pdo(Words& words, can::Time now);
  // gateway_session_lss.cpp
  void lss_command(std::string_view name, Words& words, can::Time now);
  using LssService = std::function<bool(lss::LssMaster& master, can::Time now)>;
  using LssAnswer = std::function<std::string(const lss::LssMaster& master)>;
  void lss_service(LssService service, can::Time now, LssAnswer shown = {}, std::uint8_t command = 0);
  void lss_inquire_all(can::Time now);
  void lss_activate(can::Duration delay, can::Time now);
  void lss_scan(LssService scan, can::Duration time_out, can::Time now);
  void lss_fastscan(Words& words, can::Time now);
  void lss_all_nodes(Words& words, can::Time now);
  void lss_request(GatewayLss::Request request, can::Time now, bool limited = true);
  void lss_answer(lss::LssResult result, const lss::LssMaster& master, std::uint8_t command,
                  const LssAnswer& shown, can::Time now);
  /// `limited`: the time-out of a command counts.
  void begins(can::Time now, bool limited = true);
  /// The command that was under way is over: the lines behind it.
  void goes_on(can::Time now);
  void finished(const Gateway::Answer& end, can::Time now);
  void answer_value(const Gateway::Answer& end);
  [[nodiscard]] GatewayError address(Words& words, bool all_allowed) const;
  [[nodiscard]] static GatewayError network_only(const Words& words);
  void answer(std::string_view text);
  void answer(GatewayError error, std::string_view detail = {});
  void answer(canopen::AbortCode code);
  void gateway_event(std::string_view line, bool boot_up) override;

  Gateway& gateway_;
  Peer& peer_;
  std::string input_;
  bool too_long_ = false;  // the line is, up to its end
  std::optional<std::uint64_t> sequence_;
  std::optional<Gateway::Ticket> ticket_;
  std::optional<GatewayType> type_;  // of the value that is read
  bool reading_ = false;             // lines
  bool reads_ = false;

  unsigned network_ = Gateway::network;
  std::optional<std::uint8_t> node_;
  can::Duration sdo_time_out_ = default_sdo_time_out;
  can::Duration command_time_out_{};  // 0: none
  std::size_t command_size_ = longest_line;
  std::optional<std::uint8_t> lss_rate_;  // index of table 0 that devices were given last
  bool block_ = false;
  bool boot_up_ = true;
};

}  // namespace canopus::client
