// LSS master, bit rate search and both scans against two LSS slaves, with frames between them lost, repeated
// and changed, and strange ones in between: every service ends in time, a search leaves the own bit rate in
// force, and what a scan finds while nothing was disturbed is one of the devices there are.

#include <deque>

#include "canopus/lss/lss_search.hpp"
#include "canopus/lss/lss_slave.hpp"

#include "input.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;
using fuzz::expect;
using fuzz::Input;
using lss::LssAddress;
using lss::LssMaster;
using lss::LssResult;

constexpr LssAddress addresses[] = {{0x1D0, 0x11223344, 0x00010002, 7},
                                    {0x1D0, 0x11223344, 0x00010002, 0x80000008}};
constexpr std::uint32_t network_bit_rate = 250'000;

class Network;

struct Sender final : can::Sink {
  explicit Sender(Network& network) : to(&network) {}
  bool send(const can::Frame& frame) override;
  Network* to;
};

class Device final : lss::LssSlaveListener {
 public:
  Device(Network& network, const LssAddress& address) : sender_(network), slave(sender_, *this, address) {}
  void node_id_assigned(std::uint8_t node_id, can::Time) override { expect(node_id >= 1 && node_id <= 127); }
  bool supports_bit_rate(std::uint32_t rate) override {
    expect(rate != 0);
    return rate != 800'000;
  }
  void change_bit_rate(std::uint32_t rate, can::Time) override {
    expect(rate != 0);
    bit_rate = rate;
  }
  Stored store(std::uint8_t node_id, std::uint32_t rate) override {
    expect(rate != 0 && (node_id == 0xFF || (node_id >= 1 && node_id <= 127)));
    return stored;
  }

 private:
  Sender sender_;

 public:
  lss::LssSlave slave;
  std::uint32_t bit_rate = network_bit_rate;
  Stored stored = Stored::done;
};

class Network final : lss::LssMasterListener, lss::LssSearchListener {
 public:
  explicit Network(Input& input) : input_(input) {
    for (unsigned i = 0; i < 2; ++i) {
      const std::uint8_t shape = input_.byte();
      Device& device = *devices_[i];
      if ((shape & 1) == 0) device.bit_rate = 125'000;
      device.stored = static_cast<lss::LssSlaveListener::Stored>(shape % 3);
      device.slave.start((shape & 8) != 0 ? static_cast<std::uint8_t>(10 + i) : lss::unconfigured,
                         device.bit_rate);
    }
  }

  void run() {
    for (unsigned steps = 0; steps < 40 && !input_.empty(); ++steps) step();
    // Whatever was begun ends by itself.
    const can::Time end = now_ + 60s;
    while (master_.busy() || search_.running()) {
      expect(now_ < end);
      advance(can::never);
    }
  }

  void pass(const can::Frame& frame) {
    fuzz::expect_well_formed(frame);
    expect(frame.length() == 8 && ++sent_ < 20'000);
    if (quiet_ != 0) {
      --quiet_;
      wire_.push_back(frame);
      return;
    }
    quiet_ = input_.empty() ? ~0U : input_.byte();
    if (input_.empty()) {
      wire_.push_back(frame);
      return;
    }
    ++disturbances_;
    switch (input_.choice(4)) {
      case 0: return;
      case 1:
        wire_.push_back(frame);
        wire_.push_back(frame);
        return;
      case 2: {
        can::Frame changed = frame;
        const unsigned bit = input_.choice(64);
        changed.data[bit / 8] = static_cast<std::uint8_t>(changed.data[bit / 8] ^ 1U << bit % 8);
        wire_.push_back(changed);
        return;
      }
      default: wire_.push_back(input_.frame(frame.identifier));
    }
  }

 private:
  void lss_finished(LssMaster& master, LssResult result, can::Time) override {
    expect(&master == &master_ && !master.busy());
    if (!scans_) return;
    scans_ = false;
    if (result != LssResult::done || disturbances_ != 0) return;
    expect(master.address() == addresses[0] || master.address() == addresses[1]);
  }
  void change_bit_rate(std::uint32_t rate, can::Time) override {
    expect(lss::bit_rate_index(rate).has_value());
    own_bit_rate_ = rate;
  }
  void lss_search_finished(std::uint8_t node_id, bool, can::Time) override {
    expect(!search_.running() && own_bit_rate_ == network_bit_rate && node_id == 20);
  }

  void step() {
    switch (input_.choice(8)) {
      case 0: return receive(input_.frame(input_.flag() ? lss::from_master : lss::from_slave));
      case 1: return begin_service();
      case 2:
        if (!master_.busy() && !search_.running())
          search_.start(20, addresses[input_.choice(2)], network_bit_rate, now_);
        return;
      case 3: return begin_service();
      case 4: return advance(now_ + std::chrono::milliseconds(input_.byte()));
      case 5: return advance(now_ + 20s);
      case 6: {
        constexpr std::uint8_t commands[] = {0x04, 0x11, 0x13, 0x15, 0x17, 0x40, 0x41, 0x42,
                                             0x43, 0x46, 0x47, 0x48, 0x49, 0x4A, 0x4B, 0x4C,
                                             0x51, 0x5A, 0x5D, 0x5E, 0x44, 0x4F, 0x50};
        const std::uint8_t command = input_.one_of(commands);
        const std::uint32_t part = addresses[0].part(command);
        return receive(lss::frame(lss::from_master, command,
                                  input_.flag() ? part : static_cast<std::uint32_t>(input_.number(3))));
      }
      default:
        if (search_.running()) {
          search_.cancel();
          own_bit_rate_ = network_bit_rate;
        }
        master_.cancel();
        scans_ = false;
    }
  }

  void begin_service() {
    if (search_.running() || master_.busy()) return;
    const LssAddress& address = addresses[input_.choice(2)];
    bool begun = true;
    switch (input_.choice(12)) {
      case 0: begun = master_.switch_global(input_.flag(), now_); break;
      case 1: begun = master_.select(address, now_); break;
      case 2: begun = master_.configure_node_id(input_.byte(), now_); break;
      case 3: begun = master_.configure_bit_timing(input_.byte(), now_); break;
      case 4: begun = master_.activate_bit_timing(std::chrono::milliseconds(input_.byte()), now_); break;
      case 5: begun = master_.store(now_); break;
      case 6: begun = master_.inquire(input_.choice(4), now_); break;
      case 7: begun = master_.inquire_node_id(now_); break;
      case 8: begun = master_.identify_unconfigured(now_); break;
      case 9: begun = master_.identify(addresses[0], addresses[1], now_); break;
      case 10:
        disturbances_ = 0;
        scans_ = begun = master_.slow_scan({address.vendor, address.product, 0, 0},
                                           {address.vendor, address.product, 0xFFFF'FFFF, 0xFFFF'FFFF}, now_);
        break;
      default: disturbances_ = 0; scans_ = begun = master_.fastscan(now_);
    }
    expect(begun && master_.busy() && master_.deadline() != can::never);
  }

  void receive(const can::Frame& frame) {
    if (scans_) ++disturbances_;
    master_.receive(frame, now_);
    search_.receive(frame, now_);
    for (Device* device : devices_) device->slave.receive(frame, now_);
  }

  /// To the next deadline, or to `end` if that is sooner.
  void advance(can::Time end) {
    for (unsigned rounds = 0; rounds < 400; ++rounds) {
      deliver();
      can::Time next = std::min(master_.deadline(), search_.deadline());
      for (const Device* device : devices_) next = std::min(next, device->slave.deadline());
      if (next > end || next == can::never) break;
      const can::Time before = now_;
      now_ = std::max(now_, next);
      master_.tick(now_);
      search_.tick(now_);
      for (Device* device : devices_) device->slave.tick(now_);
      at_one_moment_ = now_ > before ? 0 : at_one_moment_ + 1;
      expect(at_one_moment_ < 32);
      if (end == can::never) return;
    }
    deliver();
    if (end != can::never) now_ = std::max(now_, end);
  }

  void deliver() {
    while (!wire_.empty()) {
      const can::Frame frame = wire_.front();
      wire_.pop_front();
      if (frame.identifier == lss::from_slave) {
        master_.receive(frame, now_);
        search_.receive(frame, now_);
        continue;
      }
      for (Device* device : devices_) {
        if (device->bit_rate == own_bit_rate_) device->slave.receive(frame, now_);
      }
    }
  }

  Input& input_;
  can::Time now_{};
  std::deque<can::Frame> wire_;
  Sender sender_{*this};
  LssMaster master_{sender_, *this};
  lss::LssSearch search_{sender_, *this};
  Device first_{*this, addresses[0]};
  Device second_{*this, addresses[1]};
  Device* devices_[2] = {&first_, &second_};
  std::uint32_t own_bit_rate_ = network_bit_rate;
  bool scans_ = false;
  unsigned quiet_ = 0;
  unsigned sent_ = 0;
  unsigned disturbances_ = 0;
  unsigned at_one_moment_ = 0;
};

bool Sender::send(const can::Frame& frame) {
  to->pass(frame);
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  Network(input).run();
  return 0;
}
