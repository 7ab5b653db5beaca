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

#include "canopus/client/nmt_request.hpp"
#include "canopus/client/sdo_request.hpp"
#include "canopus/client/sdo_transfer.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/text/output.hpp"
#include "canopus/web/commands/bus_command.hpp"

namespace canopus::web {
namespace {

using OnBus = WebCommand::OnBus;

constexpr can::Duration sdo_time_out = std::chrono::milliseconds(500);

/// `canopus sdo read` and `canopus sdo write`
class SdoBusCommand final : public BusCommand {
 public:
  /// `value`: that is written; nothing: the object is read.
  template <typename... Rest>
  SdoBusCommand(client::SdoTarget target, std::optional<std::vector<std::uint8_t>> value, Rest&&... rest)
      : BusCommand(std::forward<Rest>(rest)...),
        target_(std::move(target)),
        value_(std::move(value)),
        transfer_(*this, target_.node, sdo_time_out, false) {
    alarm().add_part(transfer_.alarm());
  }

 private:
  void begin(can::Time now) override {
    const bool started =
        value_ ? transfer_.write(target_.object, *value_, now) : transfer_.read(target_.object, now);
    if (!started) fail({.reason = std::string(client::bus_takes_no_frame)}, now);
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
      return fail(client::bus_takes_no_frame, now);
    }
    if (!transfer_.write(request_.object(), bytes_, now))
      fail(request_.refused(client::bus_takes_no_frame), now);
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

/// A command whose fields are wrong.
class WrongCommand final : public RunningCommand, public std::enable_shared_from_this<WrongCommand> {
 public:
  explicit WrongCommand(Use use) : use_(std::move(use)) {}
  void start(boost::asio::io_context& io, const std::string& why) {
    text::TextOutput line;
    line.line("canopus: {}", why);
    boost::asio::post(io, [self = shared_from_this(), errors = line.text()] {
      if (const auto ended = std::exchange(self->use_, {}).ended) ended(BusCommand::usage, errors);
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
MadeCommand make_sdo(const WebCommandLine& line, Rest&&... rest) {
  auto target = client::SdoTarget::parse(line.field("node"), line.field("object"), line.field("type"));
  if (!target) return std::unexpected(target.error());
  std::optional<std::vector<std::uint8_t>> value;
  if (line.on_bus.kind == OnBus::Kind::sdo_write) {
    auto bytes = client::bytes_of_value(*target, line.field("value"), false);
    if (!bytes) return std::unexpected(bytes.error());
    value = std::move(*bytes);
  }
  return std::make_shared<SdoBusCommand>(std::move(*target), std::move(value), std::forward<Rest>(rest)...);
}

template <typename... Rest>
MadeCommand make_nmt(const WebCommandLine& line, Rest&&... rest) {
  const auto services = client::nmt_services();
  const auto service = std::ranges::find(services, line.on_bus.service,
                                         [](const auto& one) { return std::string_view(one.name); });
  if (service == services.end()) return std::unexpected("there is no such NMT command");
  const auto request =
      client::NmtRequest::parse(*service, line.field("node"), line.field("master"), line.on_bus.waits);
  if (!request) return std::unexpected(request.error());
  return std::make_shared<NmtBusCommand>(*request, line.on_bus.time_out, std::forward<Rest>(rest)...);
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
  if (line.on_bus.kind == OnBus::Kind::none) return nullptr;
  serve::ClientPorts* const ports = ports_of(line.bus);
  if (ports == nullptr) return nullptr;
  const auto made = line.on_bus.kind == OnBus::Kind::nmt ? make_nmt(line, io_, clock_, standstill_, use)
                                                         : make_sdo(line, io_, clock_, standstill_, use);
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
