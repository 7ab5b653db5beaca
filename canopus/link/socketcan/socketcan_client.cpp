// A CAN interface of this machine (Linux SocketCAN).
//
// Frames that this client sends come back from the kernel when they are complete on the bus; at most `window`
// of them are with the kernel, the others wait here, where they can still be dropped. The controller's state,
// counters and bit timing are read over netlink: at error frames and four times a second. While it is bus-off
// nothing is sent.

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>
#include <utility>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <linux/can/error.h>
#include <sys/socket.h>

#include "canopus/link/controller_status.hpp"
#include "canopus/link/handler_memory.hpp"
#include "canopus/link/socketcan/can_socket.hpp"
#include "canopus/link/socketcan/netlink.hpp"
#include "canopus/link/transport.hpp"

namespace canopus::link {
namespace {

namespace asio = boost::asio;
using asio::posix::stream_descriptor;
using boost::system::error_code;
using namespace std::chrono_literals;

constexpr std::size_t window = 32;
constexpr auto socketcan_status_period = 250ms;
/// Identifiers of our own that a filter is opened for, so that their echo is received; with more there is no
/// filter.
constexpr std::size_t most_own_identifiers = 128;

class SocketcanTransport final : public Transport {
 public:
  SocketcanTransport(asio::io_context& io, std::string interface, BusClientOptions options)
      : Transport(io, options),
        interface_(std::move(interface)),
        netlink_(false),
        socket_(io),
        events_(io),
        pause_(io),
        status_timer_(io) {}

  std::expected<void, std::string> restart(std::uint32_t bit_rate) override {
    auto done = set_up(bit_rate);
    if (done && is_open()) {
      // Clears the socket's error: we took the interface down ourselves.
      (void)clear_socket_error(socket_.native_handle());
      on_bus_.clear();
      queue().clear();
      read_controller_state();
    }
    return done;
  }
  void set_filter(std::span<const IdentifierFilter> filters) override {
    filters_.assign(filters.begin(), filters.end());
    own_.clear();
    apply_filter();
  }
  bool finished() const override { return queue().empty() && on_bus_.empty(); }

 private:
  std::string line_to_type(std::uint32_t bit_rate) const {
    return "ip link set " + interface_ + " down; ip link set " + interface_ + " type can bitrate " +
           std::to_string(bit_rate) + " restart-ms 100; ip link set " + interface_ + " up";
  }
  /// Takes the interface down, sets its bit rate if there is one, and takes it up.
  std::expected<void, std::string> set_up(std::uint32_t bit_rate) {
    const auto link = netlink_.request(interface_);
    if (!link)
      return std::unexpected(link.error() == ENODEV ? "there is no such interface"
                                                    : std::strerror(link.error()));
    if (link->type != "can") return {};  // a virtual interface has no bit rate and needs none
    const std::uint32_t wanted = bit_rate != 0 || !link->controller ? bit_rate : link->controller->bit_rate;
    auto done = netlink_.set_up(link->index, false);
    if (done && bit_rate != 0) done = netlink_.set_bit_rate(link->index, bit_rate);
    std::expected<void, int> up = netlink_.set_up(link->index, true);
    if (done) done = up;
    if (done) return {};
    const bool may_not = done.error() == EPERM || done.error() == EACCES;
    std::string reason = may_not
                             ? "this program may not set up the interface"
                             : "the interface cannot be set up: " + std::string(std::strerror(done.error()));
    return std::unexpected(reason + "; " + line_to_type(wanted != 0 ? wanted : 250'000));
  }

  void connect() override {
    if (const std::uint32_t wanted = options().bit_rate; wanted != 0) {
      const auto link = netlink_.request(interface_);
      const bool has_it = link && link->up && link->controller && link->controller->bit_rate == wanted;
      // If the interface is down, or has another bit rate, a user did that on purpose; only an adapter that
      // is plugged in again has neither.
      const bool is_known = link && link->index == index_;
      if (is_known && !link->up) return failed("the interface is down");
      if (link && !has_it && !is_known) {
        if (auto done = set_up(wanted); !done) return failed(done.error());
      }
    }
    const auto opened_socket = open_can_socket(interface_);
    if (!opened_socket) return failed(opened_socket.error());
    socket_.assign(opened_socket->descriptor);
    index_ = opened_socket->interface;
    dropped_ = 0;
    apply_filter();
    if (Netlink events(true); events.descriptor() >= 0) {
      events_.assign(events.release());
      wait_for_events();
    }
    read();
    opened();
    read_controller_state();
    poll_controller();
  }
  void disconnect() override {
    ++generation_;
    error_code ignored;
    pause_.cancel();
    status_timer_.cancel();
    waiting_ = false;
    on_bus_.clear();
    socket_.close(ignored);
    events_.close(ignored);
  }

  // --- what comes

  void read() {
    socket_.async_wait(
        stream_descriptor::wait_read,
        reading_place_([self = self(this), generation = generation_](const error_code& failure) {
          if (!failure && generation == self->generation_) self->on_readable();
        }));
  }
  void on_readable() {
    const std::uint32_t generation = generation_;
    for (int count = 0; count < 8; ++count) {
      const auto there = receive_can_frames(socket_.native_handle(), batch_);
      if (!there && there.error() == EAGAIN) break;
      if (!there) return lose(there.error());
      for (const ReceivedFrame& frame : batch_.frames()) {
        frame_received(frame);
        if (generation != generation_) return;
      }
      if (batch_.dropped && *batch_.dropped != dropped_) {
        complain(std::to_string(*batch_.dropped - dropped_) +
                 " frames are lost: this program was too slow for the bus");
        dropped_ = *batch_.dropped;
      }
      if (generation != generation_) return;
      if (batch_.count < can_batch) break;
    }
    write();
    read();
  }
  void frame_received(const ReceivedFrame& frame) {
    switch (frame.kind) {
      case ReceivedFrame::Kind::error: return error_frame(frame);
      case ReceivedFrame::Kind::frame: reported_error_ = {}; return received(frame.frame, frame.received_at);
      case ReceivedFrame::Kind::own: {
        reported_error_ = {};
        // A controller with several mailboxes may send them in another order.
        std::size_t place = 0;
        while (place < on_bus_.size() && !(on_bus_[place] == frame.frame)) ++place;
        if (place == on_bus_.size()) return;
        const bool is_next = place == 0;
        if (is_next) {
          on_bus_.pop_front();
        } else {
          on_bus_.erase(place);
        }
        passed_over_ = is_next ? 0 : passed_over_ + 1;
        if (passed_over_ > 2 * window) {  // the first one was lost, and would keep its place for ever
          on_bus_.pop_front();
          passed_over_ = 0;
        }
        return sent(frame.frame, frame.received_at);
      }
    }
  }
  void error_frame(const ReceivedFrame& frame) {
    const std::span bytes(frame.frame.data.data(), frame.frame.dlc);
    ControllerStatus now = status();
    update_status(now, frame.error_class, bytes);
    const std::uint32_t generation = generation_;
    const ControllerStatus before = status();
    set_status(now);
    if (generation != generation_) return;
    // Single errors of a bus in trouble are many; their counters wait for the next poll.
    if ((frame.error_class & (CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED)) != 0)
      read_controller_state();
    if (generation != generation_) return;
    if ((frame.error_class & (CAN_ERR_BUSOFF | CAN_ERR_RESTARTED)) != 0)
      on_bus_.clear();  // they do not come back
    if ((frame.error_class & CAN_ERR_CRTL) != 0 && bytes.size() > 1 &&
        (bytes[1] & CAN_ERR_CRTL_RX_OVERFLOW) != 0) {
      complain("the controller lost frames: its receive buffer was full");
    }
    // Reported once, until a frame comes.
    const std::string_view sentence = describe_error_frame(frame.error_class, bytes);
    if (sentence.empty() || sentence == reported_error_) return;
    reported_error_ = sentence;
    if (status().state != before.state) return announce(sentence);
    complain(sentence);
  }
  void lose(int reason) {
    switch (reason) {
      case ENETDOWN: return failed("the interface is down");
      case ENODEV:
      case ENXIO: return failed("the interface is gone");
      default: return failed(std::strerror(reason));
    }
  }

  // --- netlink notifications of the interface

  void wait_for_events() {
    events_.async_wait(stream_descriptor::wait_read,
                       [self = self(this), generation = generation_](const error_code& failure) {
                         if (!failure && generation == self->generation_) self->on_events();
                       });
  }
  void on_events() {
    std::array<std::uint8_t, 16384> input;
    bool ours = false;
    constexpr int most_at_once = 64;  // what is left is still there for wait_for_events()
    for (int count = 0; count < most_at_once; ++count) {
      const ssize_t size = ::recv(events_.native_handle(), input.data(), input.size(), MSG_DONTWAIT);
      if (size < 0 && errno == ENOBUFS) ours = true;  // events were lost
      if (size <= 0) break;
      for (const LinkMessage& message :
           read_link_messages(std::span(input).first(static_cast<std::size_t>(size)))) {
        ours = ours || message.index == index_;
      }
    }
    const std::uint32_t generation = generation_;
    if (ours) read_controller_state();
    if (generation == generation_) wait_for_events();
  }
  void read_controller_state() {
    const auto link = netlink_.request(interface_);
    if (!link) {
      if (link.error() == ENODEV) lose(ENODEV);
      return;
    }
    if (link->index != index_) return lose(ENODEV);  // plugged in again
    if (!link->up) return lose(ENETDOWN);
    if (!link->controller) return;
    const bool was_off = status().state == can::ErrorState::bus_off;
    const bool is_off = link->controller->state == can::ErrorState::bus_off;
    if (is_off != was_off) on_bus_.clear();
    const std::uint32_t generation = generation_;
    set_status(*link->controller);
    if (generation != generation_) return;
    if (is_off && !was_off && link->restart_ms == 0) {
      announce("bus-off, and the interface does not restart by itself; ip link set " + interface_ +
               " type can restart");
    }
    if (was_off && !is_off) write();
  }
  void poll_controller() {
    status_timer_.expires_after(socketcan_status_period);
    status_timer_.async_wait([self = self(this), generation = generation_](const error_code& failure) {
      if (failure || generation != self->generation_) return;
      self->read_controller_state();
      if (generation == self->generation_) self->poll_controller();
    });
  }

  // --- what goes

  std::size_t under_way() const override { return on_bus_.size(); }
  void write() override {
    if (!is_open() || waiting_ || status().state == can::ErrorState::bus_off) return;
    while (!queue().empty() && on_bus_.size() < window) {
      const std::size_t count = std::min({queue().size(), window - on_bus_.size(), can_batch});
      std::array<can::Frame, can_batch> batch;
      for (std::size_t i = 0; i < count; ++i) batch[i] = queue()[i];
      const auto frames = std::span(batch).first(count);
      open_filter_for(frames);
      const auto taken = send_can_frames(socket_.native_handle(), frames);
      if (!taken) return hold(taken.error());
      for (std::size_t i = 0; i < *taken; ++i) on_bus_.push_back(frames[i]);
      queue().pop_front(*taken);
    }
  }
  /// ENOBUFS: the interface's queue is full, which poll() does not show; so it is tried again a little later.
  void hold(int reason) {
    if (reason != EAGAIN && reason != ENOBUFS) {
      return fail_later(reason == ENETDOWN ? "the interface is down" : std::strerror(reason));
    }
    waiting_ = true;
    pause_.expires_after(1ms);
    pause_.async_wait([self = self(this), generation = generation_](const error_code& failure) {
      if (failure || generation != self->generation_) return;
      self->waiting_ = false;
      self->write();
    });
  }
  void open_filter_for(std::span<const can::Frame> frames) {
    if (filters_.empty() || own_.size() > most_own_identifiers) return;
    bool is_new = false;
    for (const can::Frame& frame : frames) is_new |= own_.insert({frame.identifier, frame.extended}).second;
    if (is_new) apply_filter();
  }
  void apply_filter() {
    if (!socket_.is_open()) return;
    if (filters_.empty() || own_.size() > most_own_identifiers)
      return set_can_filter(socket_.native_handle(), {});
    auto filters = filters_;
    for (const auto& [identifier, extended] : own_) {
      filters.push_back(
          {.identifier = identifier, .mask = can::max_extended_identifier, .extended = extended});
    }
    set_can_filter(socket_.native_handle(), filters);
  }

  std::string interface_;
  Netlink netlink_;
  stream_descriptor socket_;
  stream_descriptor events_;
  asio::steady_timer pause_;
  asio::steady_timer status_timer_;
  std::uint32_t generation_ = 0;
  int index_ = 0;
  std::uint32_t dropped_ = 0;
  ReceivedBatch batch_;
  HandlerPlace reading_place_;
  can::Ring<can::Frame> on_bus_;  // with the kernel, not yet back
  std::size_t passed_over_ = 0;   // later frames that came back before the first one
  std::vector<IdentifierFilter> filters_;
  std::set<std::pair<std::uint32_t, bool>> own_;
  std::string_view reported_error_;
  bool waiting_ = false;
};

}  // namespace

std::shared_ptr<Transport> make_socketcan(asio::io_context& io, const BusAddress& address,
                                          const BusClientOptions& options) {
  return std::make_shared<SocketcanTransport>(io, address.bus, options);
}

}  // namespace canopus::link
