#include "canopus/web/commands/bus_commands.hpp"

#include <algorithm>
#include <array>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/client/nmt_request.hpp"
#include "canopus/client/sdo_request.hpp"
#include "canopus/client/sdo_transfer.hpp"
#include "canopus/link/can_error.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/text/output.hpp"

namespace canopus::web {
namespace {

constexpr int done = 0;    // exit codes of the commands
constexpr int failed = 1;  // the bus or a node refused, or does not answer
constexpr int usage = 2;

/// A command line, of names, options and arguments: "nmt", "reset-comm", "--wait", "--timeout=5s", "--", "5".
class ArgumentList {
 public:
  explicit ArgumentList(const std::vector<std::string>& line) {
    const auto end = std::ranges::find(line, "--");
    for (auto one = line.begin(); one != end; ++one)
      (one->starts_with("--") ? options_ : names_).push_back(*one);
    if (end != line.end()) arguments_.assign(end + 1, line.end());
  }
  [[nodiscard]] std::string_view name(std::size_t number) const {
    return number < names_.size() ? std::string_view(names_[number]) : std::string_view();
  }
  [[nodiscard]] std::string argument(std::size_t number) const {
    return number < arguments_.size() ? arguments_[number] : std::string();
  }
  [[nodiscard]] bool has(std::string_view flag) const {
    return std::ranges::find(options_, flag) != options_.end();
  }
  /// `option`: with its "=". Empty: it is not there.
  [[nodiscard]] std::string value(std::string_view option) const {
    const auto found =
        std::ranges::find_if(options_, [&](const std::string& one) { return one.starts_with(option); });
    return found == options_.end() ? std::string() : found->substr(option.size());
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::string> options_;
  std::vector<std::string> arguments_;
};

/// A client on a bus: as long as its command runs, and until what it sent is on the bus.
class BusCommand : public RunningCommand,
                   public link::AttachedClient,
                   public std::enable_shared_from_this<BusCommand>,
                   protected can::Sink {
 public:
  static constexpr can::Duration usual_time_out = std::chrono::milliseconds(500);
  /// What is not on the bus by then is dropped.
  static constexpr can::Duration linger = std::chrono::seconds(1);

  BusCommand(boost::asio::io_context& io, link::LoopClock& clock, std::chrono::milliseconds standstill,
             Use use)
      : io_(io), clock_(clock), standstill_(standstill), standstill_timer_(io), use_(std::move(use)) {
    alarm().add_part(leave_at_);
  }

  void start(serve::ClientPorts& ports) {
    last_time_ = clock_.now();
    attachment_ = ports.attach(*this);
    self_ = shared_from_this();
    begin(last_time_);
    clock_.touched();
    watch_standstill();
  }

  // RunningCommand
  void interrupt() final {
    const can::Time now = clock_.now();
    if (!is_over_) give_up("interrupted", now);
    clock_.touched();
  }
  void kill() final {
    leave_soon();
    answer(failed);
  }
  void stop() noexcept final {
    use_ = {};
    standstill_timer_.cancel();
    attachment_.reset();
    self_.reset();
  }

  // link::AttachedClient
  void receive(const can::Frame& frame, can::Time now) final {
    if (!is_over_) received(frame, now);
  }
  void transmitted(const can::Frame&, can::Time) final {
    if (on_the_way_ > 0) --on_the_way_;
    if (is_over_ && on_the_way_ == 0) leave_soon();
  }
  void tick(can::Time now) final {
    if (now >= leave_at_) return leave_soon();
    if (!is_over_) ticked(now);
  }
  void unacknowledged(can::Time now) final { controller_error(link::error_class_acknowledgement, now); }
  void controller_error(std::uint32_t error_class, can::Time) final {
    const std::string_view sentence = link::describe_error_frame(error_class, {});
    if (!sentence.empty()) complain(text::Line("the bus: {}", sentence));
  }

 protected:
  virtual void begin(can::Time now) = 0;
  virtual void received(const can::Frame& frame, can::Time now) = 0;
  virtual void ticked(can::Time now) = 0;
  /// Ends without a result, and says why.
  virtual void give_up(std::string_view why, can::Time now) = 0;

  bool send(const can::Frame& frame) final {
    if (!attachment_ || !attachment_->send(frame)) return false;
    ++on_the_way_;
    return true;
  }
  void print(const text::Json& row) { out_.json(row); }
  /// Each sentence once.
  void complain(const text::Line& sentence) {
    text::TextOutput line;
    line.line("canopus: {}", sentence);
    if (!errors_.text().contains(line.text())) errors_.content(line.text());
  }
  /// Its result is there.
  void conclude(int code, can::Time now) {
    leave_at_ = can::later(now, linger);
    if (on_the_way_ == 0) leave_soon();
    answer(code);
  }

 private:
  /// In the loop: the receiver of the answer may start the next command.
  void answer(int code) {
    if (std::exchange(is_over_, true)) return;
    boost::asio::post(io_, [code, self = shared_from_this()] {
      self->standstill_timer_.cancel();
      const Use use = std::exchange(self->use_, {});
      std::string row = self->out_.text();
      if (row.ends_with('\n')) row.pop_back();
      if (use.line && !row.empty()) use.line(std::move(row));
      if (use.ended) use.ended(code, self->errors_.text());
    });
  }
  /// In the loop: nothing leaves a bus from inside of it.
  void leave_soon() {
    leave_at_ = can::never;
    if (std::exchange(is_leaving_, true)) return;
    boost::asio::post(io_, [self = shared_from_this()] {
      if (!self->attachment_) return;
      (void)self->clock_.now();
      self->attachment_.reset();
      self->clock_.touched();
      self->self_.reset();
    });
  }
  void watch_standstill() {
    standstill_timer_.expires_after(standstill_);
    standstill_timer_.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
      if (const auto self = weak.lock(); self && !error) self->check_standstill();
    });
  }
  void check_standstill() {
    const can::Time now = clock_.now();
    clock_.touched();
    if (is_over_) return;
    if (std::exchange(last_time_, now) != now) return watch_standstill();
    give_up("plant time stands still", now);
    leave_soon();  // what was not sent is not sent later
  }

  boost::asio::io_context& io_;
  link::LoopClock& clock_;
  std::chrono::milliseconds standstill_;
  boost::asio::steady_timer standstill_timer_;
  Use use_;
  std::unique_ptr<link::BusAttachment> attachment_;
  std::shared_ptr<BusCommand> self_;  // as long as it is on the bus
  text::TextOutput out_;
  text::TextOutput errors_;
  can::Time last_time_{};
  can::Alarm leave_at_;
  std::size_t on_the_way_ = 0;
  bool is_over_ = false;
  bool is_leaving_ = false;
};

/// `canopus sdo read` and `canopus sdo write`
class SdoBusCommand final : public BusCommand {
 public:
  /// `value`: that is written; nothing: the object is read.
  template <typename... Rest>
  SdoBusCommand(client::SdoTarget target, std::optional<std::vector<std::uint8_t>> value, Rest&&... rest)
      : BusCommand(std::forward<Rest>(rest)...),
        target_(std::move(target)),
        value_(std::move(value)),
        transfer_(*this, target_.node, usual_time_out, false) {
    alarm().add_part(transfer_.alarm());
  }

 private:
  void begin(can::Time now) override {
    const bool started =
        value_ ? transfer_.write(target_.object, *value_, now) : transfer_.read(target_.object, now);
    if (!started) fail({.reason = "the bus takes no frame"}, now);
  }
  void received(const can::Frame& frame, can::Time now) override {
    transfer_.receive(frame, now);
    check_result(now);
  }
  void ticked(can::Time now) override {
    transfer_.tick(now);
    check_result(now);
  }
  void give_up(std::string_view why, can::Time now) override {
    transfer_.cancel();
    fail({.reason = std::string(why)}, now);
  }
  void check_result(can::Time now) {
    if (!transfer_.is_finished()) return;
    auto result = transfer_.result();
    if (!result) {
      if (result.error().code == canopen::SdoClient::buffer_too_small)
        result.error().reason += ", which --limit can raise";
      return fail(result.error(), now);
    }
    print(client::row_of(target_, value_ ? *value_ : *result, transfer_.speed()));
    conclude(done, now);
  }
  void fail(const client::SdoFailure& failure, can::Time now) {
    print(client::row_of(target_, failure));
    conclude(failed, now);
  }

  client::SdoTarget target_;
  std::optional<std::vector<std::uint8_t>> value_;
  client::SdoTransfer transfer_;
};

/// `canopus nmt`
class NmtBusCommand final : public BusCommand {
 public:
  template <typename... Rest>
  NmtBusCommand(const client::NmtRequest& request, can::Duration time_out, Rest&&... rest)
      : BusCommand(std::forward<Rest>(rest)...),
        request_(request),
        time_out_(time_out),
        bytes_{request.service->request},
        watch_(request),
        transfer_(*this, request.master, time_out, false) {
    alarm().add_part(transfer_.alarm());
    alarm().add_part(wait_until_);
  }

 private:
  void begin(can::Time now) override {
    if (request_.master == 0) {
      if (send(request_.frame())) return sent(now);
      return fail("the bus takes no frame", now);
    }
    if (!transfer_.write(request_.object(), bytes_, now))
      fail(request_.refused("the bus takes no frame"), now);
  }
  void received(const can::Frame& frame, can::Time now) override {
    watch_.receive(frame, now);
    transfer_.receive(frame, now);
    check_result(now);
  }
  void ticked(can::Time now) override {
    transfer_.tick(now);
    check_result(now);
  }
  void give_up(std::string_view why, can::Time now) override {
    transfer_.cancel();
    const bool is_asked = request_.master != 0 && !is_sent_;
    fail(is_asked ? request_.refused(why) : std::string(why), now);
  }
  void check_result(can::Time now) {
    if (!is_sent_) {
      if (!transfer_.is_finished()) return;
      if (const auto result = transfer_.result(); !result)
        return fail(request_.refused(result.error().reason), now);
      return sent(now);
    }
    if (watch_.seen()) return succeed(now);
    if (now >= wait_until_) fail(request_.not_shown(time_out_), now);
  }
  void sent(can::Time now) {
    is_sent_ = true;
    if (!request_.waits || watch_.seen()) return succeed(now);
    wait_until_ = can::later(now, time_out_);
  }
  void succeed(can::Time now) {
    wait_until_ = can::never;
    print(request_.row());
    conclude(done, now);
  }
  void fail(std::string_view why, can::Time now) {
    wait_until_ = can::never;
    complain(text::Line("{}", why));
    conclude(failed, now);
  }

  client::NmtRequest request_;
  can::Duration time_out_;
  std::array<std::uint8_t, 1> bytes_;
  client::NmtStateWatch watch_;
  client::SdoTransfer transfer_;  // to the master
  can::Alarm wait_until_;
  bool is_sent_ = false;
};

/// A command line that is wrong.
class WrongCommand final : public RunningCommand, public std::enable_shared_from_this<WrongCommand> {
 public:
  explicit WrongCommand(Use use) : use_(std::move(use)) {}
  void start(boost::asio::io_context& io, const std::string& why) {
    text::TextOutput line;
    line.line("canopus: {}", why);
    boost::asio::post(io, [self = shared_from_this(), errors = line.text()] {
      if (const auto ended = std::exchange(self->use_, {}).ended) ended(usage, errors);
    });
  }
  void interrupt() override {}
  void kill() override {}
  void stop() noexcept override { use_ = {}; }

 private:
  Use use_;
};

using MadeCommand = std::expected<std::shared_ptr<BusCommand>, std::string>;

/// The error is a sentence.
template <typename... Rest>
MadeCommand make_sdo(const ArgumentList& arguments, Rest&&... rest) {
  auto target =
      client::SdoTarget::parse(arguments.argument(0), arguments.argument(1), arguments.value("--type="));
  if (!target) return std::unexpected(target.error());
  std::optional<std::vector<std::uint8_t>> value;
  if (arguments.name(1) == "write") {
    auto bytes = client::bytes_of_value(*target, arguments.argument(2), false);
    if (!bytes) return std::unexpected(bytes.error());
    value = std::move(*bytes);
  }
  return std::make_shared<SdoBusCommand>(std::move(*target), std::move(value), std::forward<Rest>(rest)...);
}

template <typename... Rest>
MadeCommand make_nmt(const ArgumentList& arguments, Rest&&... rest) {
  const auto services = client::nmt_services();
  const auto service = std::ranges::find(services, arguments.name(1),
                                         [](const auto& one) { return std::string_view(one.name); });
  if (service == services.end()) return std::unexpected("there is no such NMT command");
  const auto request = client::NmtRequest::parse(*service, arguments.argument(0),
                                                 arguments.value("--master="), arguments.has("--wait"));
  if (!request) return std::unexpected(request.error());
  const auto time_out = text::parse_duration(arguments.value("--timeout="));
  return std::make_shared<NmtBusCommand>(*request, time_out.value_or(BusCommand::usual_time_out),
                                         std::forward<Rest>(rest)...);
}

}  // namespace

BusCommands::~BusCommands() {
  for (const auto& one : started_)
    if (const auto command = one.lock()) command->stop();
}

serve::ClientPorts* BusCommands::ports_of(const std::string& bus) {
  for (std::size_t i = 0; i < plant_.bus_count(); ++i) {
    if (plant_.bus(i).name() != bus) continue;
    sim::Bus* const simulated = plant_.simulated_bus(i);
    if (simulated == nullptr) return nullptr;
    return &ports_.try_emplace(i, *simulated, plant_.timeline_of_bus(i), true).first->second;
  }
  return nullptr;
}

std::shared_ptr<RunningCommand> BusCommands::start(const WebCommandLine& line, RunningCommand::Use use) {
  const ArgumentList arguments(line.arguments);
  const bool is_sdo = arguments.name(0) == "sdo";
  if (!is_sdo && arguments.name(0) != "nmt") return nullptr;
  serve::ClientPorts* const ports = ports_of(line.bus);
  if (ports == nullptr) return nullptr;
  const auto made = is_sdo ? make_sdo(arguments, io_, clock_, standstill_, use)
                           : make_nmt(arguments, io_, clock_, standstill_, use);
  if (!made) {
    const auto wrong = std::make_shared<WrongCommand>(std::move(use));
    wrong->start(io_, made.error());
    return wrong;
  }
  std::erase_if(started_, [](const auto& one) { return one.expired(); });
  started_.push_back(*made);
  (*made)->start(*ports);
  return *made;
}

}  // namespace canopus::web
