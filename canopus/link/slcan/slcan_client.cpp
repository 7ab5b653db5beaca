// A bus behind a Lawicel adapter, at a serial device or over TCP.
//
// Opening: `C` in case a channel is open, a delay for pending output of the adapter, then the bit rate and
// `O`. Its answers come in the order of our commands. At most eight frames are without an answer; a refused
// one is sent again, from then on one at a time, which is what adapters with a queue of one frame need. An
// adapter that never answers is used blindly: its frames count as sent once they are written.

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <expected>
#include <iterator>
#include <string>
#include <utility>

#include <boost/asio/steady_timer.hpp>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "canopus/link/slcan/slcan_text.hpp"
#include "canopus/link/stream_transport.hpp"

namespace canopus::link {
namespace {

// A serial line without any processing of its bytes (termios, raw, no flow control).

struct Speed {
  std::uint32_t speed;
  speed_t code;
};
constexpr Speed speeds[] = {
    {1200, B1200},       {2400, B2400},       {4800, B4800},       {9600, B9600},       {19200, B19200},
    {38400, B38400},     {57600, B57600},     {115200, B115200},   {230400, B230400},   {460800, B460800},
    {500000, B500000},   {576000, B576000},   {921600, B921600},   {1000000, B1000000}, {1152000, B1152000},
    {1500000, B1500000}, {2000000, B2000000}, {2500000, B2500000}, {3000000, B3000000}, {3500000, B3500000},
    {4000000, B4000000},
};

std::string describe(int reason) {
  switch (reason) {
    case ENOENT: return "there is no such device; is the adapter plugged in?";
    case EACCES: return "permission denied; the user must be in the device's group (usually dialout)";
    case EBUSY: return "another program has opened it";
    default: return std::strerror(reason);
  }
}

/// Opens the device for this process alone; does not block. The descriptor is the caller's to close. The error is a
/// sentence of what to do where that is known.
std::expected<int, std::string> open_serial_device(const std::string& path, std::uint32_t speed) {
  const auto* known = std::ranges::find(speeds, speed, &Speed::speed);
  if (known == std::end(speeds)) {
    return std::unexpected(std::to_string(speed) + " bit/s is no speed of a serial line (9600 ... 4000000)");
  }
  const int file = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return std::unexpected(describe(errno));
  termios settings{};
  if (::tcgetattr(file, &settings) < 0) {
    ::close(file);
    return std::unexpected("this is not a serial device");
  }
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  ::cfsetispeed(&settings, known->code);
  ::cfsetospeed(&settings, known->code);
  if (::tcsetattr(file, TCSANOW, &settings) < 0) {
    const int reason = errno;
    ::close(file);
    return std::unexpected(std::string("its line cannot be set up: ") + std::strerror(reason));
  }
  (void)::ioctl(file, TIOCEXCL);
  (void)::tcflush(file, TCIOFLUSH);
  return file;
}

namespace asio = boost::asio;
using boost::system::error_code;
using namespace std::chrono_literals;

constexpr auto settling = 100ms;     // for pending output of the adapter
constexpr auto answer_time = 500ms;  // an answer that takes longer does not come
constexpr auto slcan_status_period = 1000ms;
constexpr auto refusal_pause = 2ms;
constexpr std::size_t most_unanswered = 8;

class SlcanTransport final : public StreamTransport {
 public:
  SlcanTransport(asio::io_context& io, const BusAddress& address, const BusClientOptions& options)
      : StreamTransport(io, address, options), timer_(io), status_timer_(io), again_(io) {
    bit_rate_ = options.bit_rate != 0 ? options.bit_rate : address.bit_rate;
  }

  std::expected<void, std::string> restart(std::uint32_t bit_rate) override {
    const std::uint32_t wanted = bit_rate != 0 ? bit_rate : bit_rate_;
    if (auto possible = check(wanted); !possible) return possible;
    bit_rate_ = wanted;
    abort_transmissions();
    if (is_open()) {
      command("C", Asked::close);
      open_channel();
    }
    return {};
  }

 private:
  enum class Asked : std::uint8_t { frame, close, bit_rate, open, flags };
  struct Question {
    Asked asked;
    can::Frame frame{};
  };

  static std::expected<void, std::string> check(std::uint32_t bit_rate) {
    if (bit_rate == 0 || slcan_bit_rate(bit_rate)) return {};
    return std::unexpected(
        "an slcan adapter cannot be set to " + std::to_string(bit_rate) +
        " bit/s; it has 10, 20, 50, 100, 125, 250, 500, 800 and 1000 kbit/s, and whole parts of 8 MHz");
  }

  void connect() override {
    if (auto possible = check(bit_rate_); !possible) return failed(possible.error());
    if (address().tcp) return StreamTransport::connect();
    const auto device = open_serial_device(address().bus, address().serial_speed);
    if (!device) return failed(device.error());
    use_stream(*device);
  }
  void disconnect() override {
    if (channel_open_) write_last("C\r");
    channel_open_ = false;
    timer_.cancel();
    status_timer_.cancel();
    again_.cancel();
    questions_.clear();
    frames_asked_ = 0;
    refused_.clear();
    again_waits_ = false;
    reader_.clear();
    StreamTransport::disconnect();
  }
  void finish() override { set_closing(); }
  bool finished() const override {
    return StreamTransport::finished() && refused_.empty() && frames_asked_ == 0;
  }
  void abort_transmissions() override {
    refused_.clear();
    StreamTransport::abort_transmissions();
  }
  std::size_t under_way() const override {
    return silent_ ? StreamTransport::under_way() : frames_asked_ + refused_.size();
  }
  std::string describe_failure(const error_code& failure) const override {
    if (address().tcp) return StreamTransport::describe_failure(failure);
    return "the adapter is gone (" + (failure == asio::error::eof ? "no device" : failure.message()) + ')';
  }

  void stream_opened() override {
    settled_ = false;
    silent_ = false;
    answered_ = false;
    mute_ = false;
    one_at_a_time_ = false;
    write_bytes("\r\rC\r");
    timer_.expires_after(settling);
    timer_.async_wait([self = self(this)](const error_code& failure) {
      if (failure) return;
      self->settled_ = true;
      self->open_channel();
    });
  }
  void open_channel() {
    if (bit_rate_ != 0) command(*slcan_bit_rate(bit_rate_), Asked::bit_rate);
    command("O", Asked::open);
  }
  void command(std::string_view text, Asked asked) {
    if (!silent_) questions_.push_back({asked});
    write_bytes(std::string(text) + '\r');
    await_answer();
  }
  void channel_is_open() {
    channel_open_ = true;
    ControllerStatus now{.bit_rate = bit_rate_};
    if (!is_open()) {
      opened();
      request_status();
    }
    set_status(now);
  }

  bool append(std::string& out, const can::Frame& frame) override {
    if (!silent_ && frames_asked_ >= (one_at_a_time_ ? 1 : most_unanswered)) return false;
    if (again_waits_) return false;
    std::array<char, slcan_max_line> text;
    out.append(text.data(), write_slcan_frame(text, frame));
    if (!silent_) {
      questions_.push_back({Asked::frame, frame});
      ++frames_asked_;
      await_answer();
    }
    return true;
  }
  void frames_written(std::span<const can::Frame> frames) override {
    if (!silent_) return;
    for (const can::Frame& frame : frames) sent(frame);
  }

  void bytes_received(std::string_view bytes) override {
    const auto alive = shared_from_this();
    reader_.receive(bytes, [this](const SlcanLine& line) {
      if (settled_ && state() != State::ended) line_received(line);
    });
    if (state() == State::ended || state() == State::interrupted) return;
    if (reader_.is_endless()) return failed("this is no slcan adapter: what it says has no end of a line");
    if (is_open()) write();
  }
  void line_received(const SlcanLine& line) {
    using Kind = SlcanLine::Kind;
    switch (line.kind) {
      case Kind::frame:
        if (is_open()) received(line.frame);
        return;
      case Kind::done: return answer(false);
      case Kind::taken:
        while (!questions_.empty() && questions_.front().asked != Asked::frame) answer(false);
        return answer(false);
      case Kind::refused: return answer(true);
      case Kind::flags:
        flags(line.flags);
        while (!questions_.empty() && questions_.front().asked != Asked::flags) answer(false);
        return answer(false);
      case Kind::other:
        // An unsolicited version or serial number is no fault either.
        if (is_open() && !line.text.empty() && line.text.front() != 'V' && line.text.front() != 'N') {
          complain("what the adapter says is not understood: \"" + std::string(line.text) + '"');
        }
        return;
    }
  }
  void answer(bool refused) {
    answered_ = true;
    mute_ = false;
    if (questions_.empty()) return;
    const Question question = questions_.front();
    questions_.pop_front();
    await_answer();
    switch (question.asked) {
      case Asked::frame:
        --frames_asked_;
        if (!refused) {
          complained_ = false;
          return sent(question.frame);
        }
        return send_again(question.frame);
      case Asked::bit_rate:
        if (refused) failed("the adapter refuses the bit rate " + std::to_string(bit_rate_) + " bit/s");
        return;
      case Asked::open:
        if (refused) return failed("the adapter does not open its channel");
        return channel_is_open();
      case Asked::flags:
        if (refused) no_flags_ = true;
        return;
      case Asked::close: return;
    }
  }
  void send_again(const can::Frame& frame) {
    refused_.push_back(frame);
    one_at_a_time_ = true;
    if (!std::exchange(complained_, true)) {
      complain(
          "the adapter refuses a frame; it is sent again (its queue is full, or its frames are not "
          "acknowledged)");
    }
    if (std::exchange(again_waits_, true)) return;
    again_.expires_after(refusal_pause);
    again_.async_wait([self = self(this)](const error_code& failure) {
      self->again_waits_ = false;
      if (failure) return;
      while (!self->refused_.empty()) {
        self->queue().push_front(self->refused_.back());
        self->refused_.pop_back();
      }
      self->write();
    });
  }

  void await_answer() {
    timer_.cancel();
    if (questions_.empty()) return;
    timer_.expires_after(answer_time);
    timer_.async_wait([self = self(this)](const error_code& failure) {
      if (!failure) self->no_answer();
    });
  }
  void no_answer() {
    auto questions = std::exchange(questions_, {});
    frames_asked_ = 0;
    if (!answered_ && !silent_) {
      silent_ = true;
      complain("the adapter does not answer; what becomes of frames is not known");
    } else if (!silent_ && !std::exchange(mute_, true)) {
      complain("the adapter answers no more; what becomes of frames is not known");
    }
    for (std::size_t i = 0; i < questions.size(); ++i) {
      const Question& question = questions[i];
      if (question.asked == Asked::frame) sent(question.frame);
      if (question.asked == Asked::open) channel_is_open();
    }
    if (is_open()) write();
  }

  void request_status() {
    status_timer_.expires_after(slcan_status_period);
    status_timer_.async_wait([self = self(this)](const error_code& failure) {
      if (failure || self->silent_ || self->no_flags_ || !self->is_open()) return;
      self->command("F", Asked::flags);
      self->request_status();
    });
  }
  void flags(std::uint8_t flags) {
    ControllerStatus now = status();
    now.state =
        (flags & slcan_error_passive) != 0 ? can::ErrorState::error_passive : can::ErrorState::error_active;
    set_status(now);
    const bool lost = (flags & (slcan_overrun | slcan_receive_queue_full)) != 0;
    if (lost && !std::exchange(lost_, lost))
      complain("the adapter lost frames: it receives more than it can pass on");
    lost_ = lost;
  }

  asio::steady_timer timer_;
  asio::steady_timer status_timer_;
  asio::steady_timer again_;
  SlcanReader reader_;
  can::Ring<Question> questions_;    // commands without an answer
  std::size_t frames_asked_ = 0;     // of them, frames
  std::vector<can::Frame> refused_;  // to send again
  std::uint32_t bit_rate_ = 0;
  bool settled_ = false;
  bool channel_open_ = false;
  bool silent_ = false;    // never answers
  bool answered_ = false;  // has answered at least once
  bool mute_ = false;      // it has answered, but not to what it was asked last
  bool no_flags_ = false;  // does not support F
  bool one_at_a_time_ = false;
  bool again_waits_ = false;
  bool complained_ = false;
  bool lost_ = false;
};

}  // namespace

std::shared_ptr<Transport> make_slcan(asio::io_context& io, const BusAddress& address,
                                      const BusClientOptions& options) {
  return std::make_shared<SlcanTransport>(io, address, options);
}

}  // namespace canopus::link
