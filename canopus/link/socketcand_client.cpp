// A bus behind a socketcand server.

#include <optional>
#include <utility>

#include "canopus/link/controller_status.hpp"
#include "canopus/link/socketcand_dialogue.hpp"
#include "canopus/link/stream_transport.hpp"

namespace canopus::link {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

class SocketcandTransport final : public StreamTransport, private SocketcandDialogue::Peer {
 public:
  using StreamTransport::StreamTransport;

  std::string_view silence() const override { return "is it a socketcand server?"; }

 private:
  // The server ends the connection once it has put everything on its bus.
  void finish() override {
    set_closing();
    if (StreamTransport::finished()) shut_down_writing();
  }
  bool finished() const override { return false; }
  // The server reads only as far as the bus accepts frames; its answer confirms that it has read this far.
  bool is_flushed() override {
    if (flush_ == Flush::none && StreamTransport::finished()) {
      flush_ = Flush::asked;
      write_bytes("< echo >");
    }
    return flush_ == Flush::answered;
  }

  // A server of another make has this element described and not built: it answers with an error.
  std::expected<void, std::string> restart(std::uint32_t bit_rate) override {
    if (bit_rate == 0) return Transport::restart(bit_rate);
    if (!is_open()) return std::unexpected("the connection is interrupted");
    abort_transmissions();
    restarted_.reset();
    dialogue_->request_bit_rate(bit_rate);
    return {};
  }
  std::optional<std::expected<void, std::string>> restarted() const override { return restarted_; }

  void stream_opened() override {
    SocketcandDialogue::Peer& peer = *this;
    dialogue_.emplace(address().bus, peer);
  }
  void bytes_received(std::string_view bytes) override {
    dialogue_->receive(bytes);
    if (dialogue_->state() == SocketcandDialogue::State::failed) return failed(dialogue_->error());
    if (dialogue_->state() == SocketcandDialogue::State::raw && !is_open()) opened();
  }
  bool append(std::string& out, const can::Frame& frame) override {
    std::array<char, socketcand_max_send> text;
    out.append(text.data(), write_socketcand_send(text, frame));
    flush_ = Flush::none;
    return true;
  }
  std::string describe_failure(const error_code& failure) const override {
    if (failure == asio::error::eof) return "the server ended the connection";
    if (failure != asio::error::connection_refused) return failure.message();
    return failure.message() +
           ". Is `canopus run` running, without --virtual? Its plant file opens a bus with serve = "
           "\"socketcand:127.0.0.1:29536\"";
  }

  // SocketcandDialogue::Peer
  void message(std::string_view text) override { write_bytes(text); }
  void frame_received(const can::Frame& frame) override { received(frame); }
  void bit_rate_changed() override { restarted_.emplace(); }
  void bit_rate_refused(std::string_view text) override {
    restarted_ = std::unexpected("the server does not change the bit rate: " + printable_complaint(text));
  }
  void complaint(std::string_view text) override {
    if (std::exchange(state_changed_, false)) return announce(text);
    complain(text);
  }
  void echoed() override {
    if (flush_ == Flush::asked) flush_ = Flush::answered;
  }
  void controller_error(std::uint32_t error_class) override {
    ControllerStatus now = status();
    const can::ErrorState before = now.state;
    update_status(now, error_class, {});
    state_changed_ = now.state != before;
    set_status(now);
  }

  enum class Flush : std::uint8_t { none, asked, answered };

  std::optional<SocketcandDialogue> dialogue_;
  Flush flush_ = Flush::none;
  std::optional<std::expected<void, std::string>> restarted_{std::in_place};  // nothing: it was asked
  bool state_changed_ = false;                                                // and its sentence comes next
};

}  // namespace

std::shared_ptr<Transport> make_socketcand(asio::io_context& io, const BusAddress& address,
                                           const BusClientOptions& options) {
  return std::make_shared<SocketcandTransport>(io, address, options);
}

}  // namespace canopus::link
