#pragma once
// Common to the lss commands: their options, LSS services on the bus of the command line, the selection of a device, and the result
// of a service.

#include <algorithm>
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/lss/lss_master.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {

/// One service at a time, waited for.
class LssOnBus final : public can::Participant, private lss::LssMasterListener, private can::Sink {
 public:
  /// `time_out`: without an answer for this long there is no slave.
  LssOnBus(BusLoop& bus, can::Duration time_out)
      : bus_(bus), time_out_(time_out), master_(*this, *this, {.time_out = time_out}) {
    bus_.need({link::IdentifierFilter::only(lss::from_slave)});
    alarm().add_part(master_.alarm());
    bus_.add(*this);
  }
  ~LssOnBus() override { bus_.remove(*this); }
  LssOnBus(const LssOnBus&) = delete;
  LssOnBus& operator=(const LssOnBus&) = delete;

  /// Begins a service and waits for its end; nothing when the bus or the person ended it.
  template <typename Service>
  std::optional<lss::LssResult> service(Service begin) {
    result_.reset();
    frames_ = 0;
    if (!begin(master_, bus_.now())) return std::nullopt;
    end_ = BusLoop::End::time_over;
    while (end_ == BusLoop::End::time_over) {
      end_ = bus_.run([this] { return result_.has_value(); },
                      progress_ ? bus_.now() + std::chrono::milliseconds(100) : can::never);
      if (progress_) progress_(frames_);
    }
    return result_;
  }
  /// The same for a service that a device found before must answer: it may be busy with its flash memory, so
  /// the time-out is long.
  template <typename Service>
  std::optional<lss::LssResult> service_of_found(Service begin) {
    master_.set_time_out(std::max<can::Duration>(time_out_, std::chrono::seconds(1)));
    const auto result = service(begin);
    master_.set_time_out(time_out_);
    return result;
  }
  [[nodiscard]] can::Duration time_out() const noexcept { return time_out_; }
  void set_time_out(can::Duration time_out) {
    time_out_ = time_out;
    master_.set_time_out(time_out);
  }
  void set_progress(std::function<void(unsigned frames)> progress) { progress_ = std::move(progress); }
  [[nodiscard]] const lss::LssMaster& master() const noexcept { return master_; }
  /// Why service() gave nothing.
  [[nodiscard]] BusLoop::End end() const noexcept { return end_; }

  void receive(const can::Frame& frame, can::Time now) override { master_.receive(frame, now); }
  void tick(can::Time now) override { master_.tick(now); }

 private:
  void lss_finished(lss::LssMaster&, lss::LssResult result, can::Time) override { result_ = result; }
  bool send(const can::Frame& frame) override {
    ++frames_;
    return bus_.send(frame);
  }

  BusLoop& bus_;
  can::Duration time_out_;
  lss::LssMaster master_;
  std::function<void(unsigned)> progress_;
  std::optional<lss::LssResult> result_;
  unsigned frames_ = 0;
  BusLoop::End end_ = BusLoop::End::done;
};

struct LssArguments {
  BusOptions bus;
  std::string node, rate, state, delay;
  std::string vendor, product, revision, serial;
  std::string assign, activate;
  bool slow = false;
  bool store = false;
};

/// A line for people, or the JSON.
void show(const LssArguments& arguments, const text::Json& line, const std::string& text);
[[nodiscard]] text::Json json(const lss::LssAddress& address);
[[nodiscard]] std::string describe(const lss::LssAddress& address);

/// The exit code for the result of a service that had to succeed.
int judge(const LssOnBus& on_bus, const BusLoop& bus, std::optional<lss::LssResult> result,
          std::string_view what);
void all_to_waiting(LssOnBus& on_bus);
/// The selected device keeps what it was given. An exit code.
int store(LssOnBus& on_bus, const BusLoop& bus);
/// The selected device gets its node-ID and keeps it if asked to. An exit code.
int set_node_id(LssOnBus& on_bus, const BusLoop& bus, std::uint8_t node, bool stored);

/// "250k", "1M", "250000": one of LSS, in bit/s.
[[nodiscard]] std::expected<std::uint32_t, std::string> parse_lss_bit_rate(std::string_view text);
/// The value of option --`name`; nothing when it was not given.
[[nodiscard]] std::expected<std::optional<std::uint32_t>, std::string> u32(const std::string& word,
                                                                           std::string_view name);
/// Nothing when no part was given.
[[nodiscard]] std::expected<std::optional<lss::LssAddress>, std::string> address_of(
    const LssArguments& arguments);

/// `lss scan`: finds every device without a node-ID and assigns node-IDs on request. An exit code.
int lss_scan(const LssArguments& arguments);
/// `lss search`: finds one device at every bit rate of LSS, and assigns a node-ID and the bit rate of this
/// network. An exit code.
int lss_rate_search(const LssArguments& arguments);

}  // namespace canopus::cli
