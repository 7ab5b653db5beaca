// A bus behind a cannelloni: over UDP as its equal, over TCP as its client.

#include <array>
#include <utility>

#include "canopus/link/cannelloni/cannelloni_records.hpp"
#include "canopus/link/controller_status.hpp"
#include "canopus/link/datagram_transport.hpp"
#include "canopus/link/stream_transport.hpp"

namespace canopus::link {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

std::span<const std::uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Reports the number of skipped CAN FD frames: at the first one, and at each thousand.
class LeftOut {
 public:
  /// A sentence now and then, mostly nothing.
  std::string count() {
    ++number_;
    if (number_ == 1) return "CAN FD frames of this bus are left out";
    return number_ % 1000 == 0 ? std::to_string(number_) + " CAN FD frames were left out so far"
                               : std::string();
  }

 private:
  std::uint64_t number_ = 0;
};

class CannelloniDatagrams final : public DatagramTransport {
 public:
  CannelloniDatagrams(asio::io_context& io, const BusAddress& address, const BusClientOptions& options)
      : DatagramTransport(io, address, options), resolver_(io) {}

 private:
  void connect() override {
    resolver_.async_resolve(
        address().host, std::to_string(address().port),
        [self = self(this)](const error_code& failure, const udp::resolver::results_type& found) {
          if (self->state() == State::ended) return;
          if (failure) return self->failed(failure.message());
          self->bind(found.begin()->endpoint());
        });
  }
  void bind(const Endpoint& peer) {
    peer_ = peer;
    error_code failure;
    udp::socket socket(io());
    socket.open(peer.protocol(), failure);
    const bool is_here = peer.address().is_loopback();
    const Endpoint here = is_here ? Endpoint(peer.address(), address().local_port)
                                  : Endpoint(peer.protocol(), address().local_port);
    if (!failure) socket.bind(here, failure);
    if (failure) return failed("our port " + std::to_string(address().local_port) + ": " + failure.message());
    theirs_.restart();
    sequence_ = 0;
    use_socket(std::move(socket));
    opened();
  }
  void disconnect() override {
    resolver_.cancel();
    DatagramTransport::disconnect();
  }

  void write_frames() override {
    while (!queue().empty()) {
      const std::size_t count = std::min(queue().size(), cannelloni_max_count);
      std::array<can::Frame, cannelloni_max_count> batch;
      for (std::size_t i = 0; i < count; ++i) batch[i] = queue()[i];
      const auto frames = std::span(batch).first(count);
      write_cannelloni_datagram(output_, sequence_, frames);
      if (!write_datagram(socket(), as_bytes(output_), peer_)) return;
      ++sequence_;
      queue().pop_front(count);
      for (const can::Frame& frame : frames) sent(frame);
    }
  }
  void datagram_received(std::span<const std::uint8_t> bytes, const Endpoint& sender) override {
    if (sender.address() != peer_.address()) return;  // a stranger
    if (!read_cannelloni_datagram(bytes, input_)) return complain("a datagram that is none of cannelloni");
    check_sequence(input_.sequence);
    for (const CannelloniRecord& record : input_.records) {
      if (!is_open()) return;
      record_received(record);
    }
    if (!input_.mistake.empty()) complain("a datagram of cannelloni: " + std::string(input_.mistake));
  }
  void check_sequence(std::uint8_t sequence) {
    using Finding = CannelloniSequence::Finding;
    switch (theirs_.classify(sequence)) {
      case Finding::in_order: return;
      case Finding::another_order: return complain("datagrams of cannelloni came in another order");
      case Finding::started_anew: return complain("the other cannelloni counts its datagrams anew");
      case Finding::lost: break;
    }
    complain(std::to_string(theirs_.lost()) +
             (theirs_.lost() == 1 ? " datagram of cannelloni is lost" : " datagrams of cannelloni are lost"));
  }
  void record_received(const CannelloniRecord& record) {
    switch (record.kind) {
      case CannelloniRecord::Kind::frame: return received(record.frame);
      case CannelloniRecord::Kind::error_frame: {
        ControllerStatus now = status();
        update_status(now, record.frame.identifier, record.frame.bytes());
        return set_status(now);
      }
      case CannelloniRecord::Kind::fd_frame:
        if (const auto text = left_out_.count(); !text.empty()) complain(text);
        return;
      case CannelloniRecord::Kind::wrong: return;
    }
  }

  udp::resolver resolver_;
  Endpoint peer_;
  std::uint8_t sequence_ = 0;  // of our next datagram
  CannelloniSequence theirs_;
  CannelloniDatagram input_;
  std::string output_;
  LeftOut left_out_;
};

class CannelloniStream final : public StreamTransport {
 public:
  using StreamTransport::StreamTransport;

  std::string_view silence() const override { return "is it a cannelloni server?"; }

 private:
  void stream_opened() override {
    greeted_ = false;
    input_.clear();
    write_bytes(cannelloni_greeting);
  }
  bool append(std::string& out, const can::Frame& frame) override {
    append_cannelloni_record(out, frame);
    return true;
  }
  void bytes_received(std::string_view bytes) override {
    input_.append(bytes);
    if (!greeted_) {
      const std::size_t size = std::min(input_.size(), cannelloni_greeting.size());
      if (std::string_view(input_).substr(0, size) != cannelloni_greeting.substr(0, size)) {
        return failed("this is no cannelloni: it does not say " + std::string(cannelloni_greeting));
      }
      if (size < cannelloni_greeting.size()) return;
      input_.erase(0, size);
      greeted_ = true;
      opened();
    }
    auto rest = as_bytes(input_);
    while (const auto record = next_cannelloni_record(rest)) {
      if (!is_open()) return;
      switch (record->kind) {
        case CannelloniRecord::Kind::frame: received(record->frame); break;
        case CannelloniRecord::Kind::error_frame: error_frame(record->frame); break;
        case CannelloniRecord::Kind::fd_frame:
          if (const auto text = left_out_.count(); !text.empty()) complain(text);
          break;
        case CannelloniRecord::Kind::wrong: return failed("what cannelloni sends is no CAN frame");
      }
    }
    if (is_open()) input_.erase(0, input_.size() - rest.size());
  }
  void error_frame(const can::Frame& frame) {
    ControllerStatus now = status();
    update_status(now, frame.identifier, frame.bytes());
    set_status(now);
  }

  std::string input_;  // not yet a whole record
  LeftOut left_out_;
  bool greeted_ = false;
};

}  // namespace

std::shared_ptr<Transport> make_cannelloni(asio::io_context& io, const BusAddress& address,
                                           const BusClientOptions& options) {
  if (address.tcp) return std::make_shared<CannelloniStream>(io, address, options);
  return std::make_shared<CannelloniDatagrams>(io, address, options);
}

}  // namespace canopus::link
