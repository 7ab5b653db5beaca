#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/cli/bus/lss_device.hpp"
#include "canopus/lss/lss_search.hpp"

namespace canopus::cli {
namespace {

using lss::LssAddress;
using lss::LssResult;
using Json = text::Json;
using namespace std::chrono_literals;

/// From a new bit rate to the first frame: an adapter is closed and opened for it.
constexpr can::Duration settle_time = 100ms;
/// Time limit for the transport to confirm the new bit rate.
constexpr can::Duration longest_change = 2s;
/// An answer may come too late, and frames of others may be in its way: without an answer at all bit rates
/// the search is repeated, with the time-out multiplied by this factor.
constexpr std::array rounds{1, 4};

std::string kilobits(std::uint32_t bit_rate) { return fmt::format("{:g} kbit/s", bit_rate / 1000.0); }

/// The bit rate of our controller; the network's own comes back when this goes.
class OwnRate {
 public:
  OwnRate(BusLoop& bus, std::uint32_t own) : bus_(bus), own_(own), present_(own) {}
  ~OwnRate() {
    if (failure_.empty() && present_ != own_ && bus_.restart(own_))
      (void)bus_.run([this] { return is_done(); }, bus_.now() + longest_change);
  }
  OwnRate(const OwnRate&) = delete;
  OwnRate& operator=(const OwnRate&) = delete;

  /// Begins; is_done() and failure() have the result.
  void begin(std::uint32_t bit_rate) {
    if (is_terminal(STDERR_FILENO)) show_progress(Line("looking at {}", kilobits(bit_rate)));
    if (const auto begun = bus_.restart(bit_rate); !begun) failure_ = begun.error();
    if (failure_.empty()) present_ = bit_rate;
  }
  [[nodiscard]] bool is_done() {
    if (!failure_.empty()) return true;
    const auto answer = bus_.restarted();
    if (answer && !*answer) failure_ = answer->error();
    return answer.has_value();
  }
  /// The same, and waits for it and until the bus has settled. Not done: failure() has the reason, or the
  /// bus.
  BusLoop::End change(std::uint32_t bit_rate) {
    if (bit_rate == present_) return BusLoop::End::done;
    begin(bit_rate);
    const BusLoop::End end = bus_.run([this] { return is_done(); }, bus_.now() + longest_change);
    if (end == BusLoop::End::time_over) failure_ = "no answer";
    if (end != BusLoop::End::done) return end;
    return failure_.empty() ? settle() : BusLoop::End::time_over;
  }
  /// Waits for the bus to settle: a change of the bit rate drops what was not sent yet.
  BusLoop::End settle() {
    const BusLoop::End end = bus_.run([] { return false; }, bus_.now() + settle_time);
    return end == BusLoop::End::time_over ? BusLoop::End::done : end;
  }
  /// Why the bit rate could not be changed; empty: it could.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  [[nodiscard]] std::uint32_t own() const noexcept { return own_; }

 private:
  BusLoop& bus_;
  std::uint32_t own_;
  std::uint32_t present_;
  std::string failure_;
};

/// LssSearch on a bus of the command line.
class SearchOnBus final : public can::Participant, private lss::LssSearchListener, private can::Sink {
 public:
  SearchOnBus(BusLoop& bus, OwnRate& rate)
      : bus_(bus),
        rate_(rate),
        search_(*this, *this, {.settle_time = settle_time, .to_waiting_first = true}) {
    bus_.need({link::IdentifierFilter::only(lss::from_slave)});
    alarm().add_part(search_.alarm());
    bus_.add(*this);
  }
  ~SearchOnBus() override { bus_.remove(*this); }
  SearchOnBus(const SearchOnBus&) = delete;
  SearchOnBus& operator=(const SearchOnBus&) = delete;

  /// Not done: the bit rate could not be changed, or the bus has the reason.
  BusLoop::End run(std::uint8_t node, const LssAddress& address, can::Duration time_out) {
    finished_ = false;
    search_.set_time_out(time_out);
    (void)search_.start(node, address, rate_.own(), bus_.now());
    const BusLoop::End end = bus_.run([this] {
      if (!rate_.is_done() || rate_.failure().empty()) return finished_;
      search_.cancel();
      return true;
    });
    end_progress();
    return end == BusLoop::End::done && !rate_.failure().empty() ? BusLoop::End::time_over : end;
  }
  [[nodiscard]] bool found() const noexcept { return found_; }
  /// The bit rate at which the device answered, bit/s; nothing: it did not.
  [[nodiscard]] std::optional<std::uint32_t> answered_at() const noexcept { return answered_at_; }

  void receive(const can::Frame& frame, can::Time now) override {
    const bool is_answer =
        frame.identifier == lss::from_slave && frame.dlc == 8 && frame.data[0] == lss::command::selected;
    if (is_answer && !answered_at_) answered_at_ = search_.bit_rate();
    search_.receive(frame, now);
  }
  void tick(can::Time now) override { search_.tick(now); }

 private:
  bool send(const can::Frame& frame) override { return bus_.send(frame); }
  void change_bit_rate(std::uint32_t bit_rate, can::Time) override { rate_.begin(bit_rate); }
  void lss_search_finished(std::uint8_t, bool found, can::Time) override {
    finished_ = true;
    found_ = found;
  }

  BusLoop& bus_;
  OwnRate& rate_;
  lss::LssSearch search_;
  std::optional<std::uint32_t> answered_at_;
  bool finished_ = false;
  bool found_ = false;
};

/// Prints the reason of an incomplete change; returns an exit code.
int complain_of_rate(const OwnRate& rate, BusLoop::End end, const BusLoop& bus) {
  end_progress();
  if (rate.failure().empty()) return complain_of(end, bus, "");
  return complain(exit_code::failed, rate.failure());
}

/// The first device without a node-ID that answers to a fastscan at the present bit rate; `end` is the reason
/// if the scan ended without answer or silence. A late answer makes a scan fail: it is repeated with twice
/// the time.
std::optional<LssAddress> find_at_present_rate(BusLoop& bus, can::Duration time_out, BusLoop::End& end) {
  constexpr int most_attempts = 3;
  LssOnBus on_bus(bus, time_out);
  std::optional<LssResult> result = LssResult::lost;
  for (int attempt = 0; result == LssResult::lost && attempt < most_attempts; ++attempt) {
    if (attempt != 0) on_bus.set_time_out(2 * on_bus.time_out());
    all_to_waiting(on_bus);
    result = on_bus.service([](auto& master, can::Time now) { return master.fastscan(now); });
  }
  if (!result) end = on_bus.end();
  if (result == LssResult::silence) return std::nullopt;  // no slave in configuration state
  all_to_waiting(on_bus);
  return result == LssResult::done ? std::optional(on_bus.master().address()) : std::nullopt;
}

/// The first device without a node-ID, at the network's bit rate or another one; nothing: `code` has the
/// reason.
std::optional<LssAddress> find_unconfigured(BusLoop& bus, OwnRate& rate, can::Duration time_out, int& code) {
  std::vector<std::uint32_t> rates{rate.own()};
  for (const std::uint32_t one : lss::bit_rates) {
    if (one != 0 && one != rate.own()) rates.push_back(one);
  }
  for (const int times : rounds) {
    for (const std::uint32_t one : rates) {
      BusLoop::End end = rate.change(one);
      std::optional<LssAddress> address;
      if (end == BusLoop::End::done) {
        address = find_at_present_rate(bus, times * time_out, end);
        if (address) end = rate.settle();
      }
      if (end != BusLoop::End::done) {
        code = complain_of_rate(rate, end, bus);
        return std::nullopt;
      }
      if (address) {
        end_progress();
        return address;
      }
    }
  }
  end_progress();
  code = complain(exit_code::failed, "no device without a node-ID answers at any bit rate of LSS");
  return std::nullopt;
}

int search(const LssArguments& arguments, BusLoop& bus, std::uint8_t node,
           const std::optional<LssAddress>& given, std::uint32_t own, can::Duration time_out) {
  bus.set_complaint([](std::string_view) {});  // a missing acknowledge at a wrong bit rate is expected
  OwnRate rate(bus, own);
  int code = exit_code::done;
  const auto address = given ? given : find_unconfigured(bus, rate, time_out, code);
  if (!address) return code;
  if (const BusLoop::End end = rate.change(own); end != BusLoop::End::done)
    return complain_of_rate(rate, end, bus);
  SearchOnBus on_bus(bus, rate);
  BusLoop::End end = BusLoop::End::done;
  for (const int times : rounds) {
    end = on_bus.run(node, *address, times * time_out);
    if (end != BusLoop::End::done || on_bus.answered_at()) break;
  }
  if (end != BusLoop::End::done) return complain_of_rate(rate, end, bus);
  if (!on_bus.answered_at())
    return complain(exit_code::failed,
                    fmt::format("{}: no answer at any bit rate of LSS", describe(*address)));
  const std::string where = kilobits(*on_bus.answered_at());
  if (!on_bus.found()) {
    return complain(exit_code::failed, fmt::format("{}: answers at {}, and does not take node-ID {} and {}",
                                                   describe(*address), where, node, kilobits(own)));
  }
  Json line = json(*address);
  line["node"] = node;
  line["bit_rate"] = own;
  line["found_at"] = *on_bus.answered_at();
  show(arguments, line,
       fmt::format("{}  found at {}, is node {} at {} now", describe(*address), where, node, kilobits(own)));
  return exit_code::done;
}

}  // namespace

int lss_rate_search(const LssArguments& arguments) {
  const auto node = static_cast<std::uint8_t>(parse_node(arguments.node));
  if (node == 0) {
    return complain(exit_code::usage,
                    fmt::format("\"{}\" is not a node-ID; expected 1 to 127", arguments.node));
  }
  const auto address = address_of(arguments);
  if (!address) return complain(exit_code::usage, address.error());
  std::uint32_t own = 0;
  if (!arguments.rate.empty()) {
    const auto rate = parse_lss_bit_rate(arguments.rate);
    if (!rate) return complain(exit_code::usage, "--bit-rate: " + rate.error());
    own = *rate;
  }
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    const std::uint32_t told = bus.status().bit_rate;
    if (own == 0 && told == 0)
      return complain(exit_code::usage,
                      "this bus does not tell its bit rate: give --bit-rate, for example 125k");
    if (told != 0 && own != 0 && own != told)
      return complain(exit_code::usage, fmt::format("--bit-rate: the bus has {}", kilobits(told)));
    if (own == 0 && !lss::bit_rate_index(told)) {
      return complain(exit_code::failed,
                      fmt::format("LSS does not know the bit rate of this bus, {}", kilobits(told)));
    }
    return search(arguments, bus, node, *address, own == 0 ? told : own, time_out);
  });
}

}  // namespace canopus::cli
