// An NMT master (or flying master) with its node and configuration manager, among three slaves that mostly
// answer, take configurations and programs (also in blocks), and arbitrary frames; an application that makes
// SDO requests of its own. Callbacks and stop() send nothing, a node that is no master is silent,
// deadlines lead somewhere, and what the master tells of its slaves is in range.

#include <array>
#include <deque>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/manager/configuration/configuration_manager.hpp"
#include "canopus/manager/nmt/nmt_master.hpp"

#include "input.hpp"
#include "master_network.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;
using namespace canopus::fuzz;
using canopen::NmtState;

struct Store final : manager::ConfigurationStore {
  bool store(std::uint8_t node_id, std::span<const std::uint8_t>) override {
    expect(node_id >= 1 && node_id <= 127);
    return works;
  }
  bool works = true;
};

class Run final : canopen::NodeListener, manager::MasterListener, public can::Participant {
 public:
  explicit Run(Input& input)
      : input_(input),
        node_(master_objects(), own_id, node_sink_),
        master_(node_, master_sink_, options(input.byte())),
        configurations_(node_, master_, &store_, configuration_options(input.byte())) {
    alarm().add_part(node_.alarm());
    alarm().add_part(master_.alarm());
    node_.set_listener(this);
    master_.set_listener(this);
    start_up_ = input.byte() & 0x7F;
    for (std::uint8_t& byte : settings_) byte = input.byte();
    const std::uint8_t value[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    manager::ConciseDcfWriter file;
    file.add(0x1017, 0, 100, 2).add(0x2000, 1, 7, 4).add(0x2001, 0, value);
    const std::vector<std::uint8_t> table(60, 0x5A);
    file.add(0x2002, 0, table);
    configurations_.load(2, file.file());
    configurations_.load(3, file.file());
    configurations_.load_program(2, table);
    configurations_.load_program(127, value);
    slaves_.version.fill(4);
    configurations_.load(127, std::span(file.file()).first(file.file().size() - 3));  // damaged
    node_.power_on(now_);
    check();
  }

  void run() {
    for (unsigned steps = 0; steps < 300 && !input_.empty(); ++steps) {
      frames_ = 0;
      step();
      check();
    }
  }

  // --- node and master as one participant
  void receive(const can::Frame& frame, can::Time now) override {
    node_.receive(frame, now);
    master_.receive(frame, now);
  }
  void tick(can::Time now) override {
    node_.tick(now);
    master_.tick(now);
  }

  bool send(const can::Frame& frame, bool by_master) {
    fuzz::expect_well_formed(frame);
    expect(++frames_ < 5000);
    if (by_master) {
      expect(!silent_);
      was_master_ = was_master_ || (node_.dictionary().get<std::uint32_t>(0x1F80, 0) & 1) != 0;
      const bool is_request = frame.identifier > 0x600 && frame.identifier < 0x680;
      expect(was_master_ || (asked_ && is_request));
    } else {
      expect(!frame.remote);
    }
    slaves_.receive(frame);
    return !full_;
  }

 private:
  struct Frames final : can::Sink {
    Frames(Run& run, bool of_master) : to(&run), by_master(of_master) {}
    bool send(const can::Frame& frame) override { return to->send(frame, by_master); }
    Run* to;
    bool by_master;
  };

  /// While it lives, the master must send nothing.
  class Silence {
   public:
    explicit Silence(bool& flag) : flag_(&flag), before_(flag) { flag = true; }
    ~Silence() { *flag_ = before_; }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;

   private:
    bool* flag_;
    bool before_;
  };

  static manager::MasterOptions options(std::uint8_t shape) {
    manager::MasterOptions o;
    if ((shape & 1) != 0) o.start_all_delay = 0ms;
    if ((shape & 2) != 0) o.sdo_time_out = 10ms;
    if ((shape & 4) != 0) o.wait_after_reset = 0ms;
    if ((shape & 8) != 0) o.presence_retry = 5ms;
    if ((shape & 16) != 0) o.error_reset = canopen::NmtCommand::reset_node;
    if ((shape & 64) != 0) o.program_time_out = 50ms, o.program_poll = 5ms;
    if ((shape & 128) != 0) o.program_flash_limit = o.program_start_limit = 300ms, o.program_attempts = 1;
    if ((shape & 32) != 0) o.revision_rule = manager::RevisionRule::same_major_newer_minor;
    return o;
  }
  static manager::ConfigurationOptions configuration_options(std::uint8_t shape) {
    manager::ConfigurationOptions o;
    if ((shape & 1) != 0) o.maximum_files = 2;
    if ((shape & 2) != 0) o.maximum_size = 30;
    o.delete_first = (shape & 4) != 0;
    o.check_files = (shape & 8) == 0;
    if ((shape & 16) != 0) o.write_time = 100ms;
    if ((shape & 64) != 0) o.erase_time = 2s;
    if ((shape & 128) != 0) o.in_download = canopen::AbortCode::hardware_error;
    return o;
  }

  // --- NodeListener
  void reset_requested(canopen::NmtCommand, can::Time now) override {
    const Silence silence(silent_);
    master_.stop(now);
    expect(!master_.active() && !master_.starting());
  }
  void reset_done(canopen::NmtCommand, can::Time now) override {
    auto& d = node_.dictionary();
    d.set<std::uint32_t>(0x1F80, 0, start_up_);
    was_master_ =
        was_master_ || (start_up_ & 1) != 0;  // a negotiation goes on when the bit is taken away meanwhile
    for (unsigned i = 0; i < 3; ++i) {
      const std::uint8_t id = slave_ids[i];
      const std::uint8_t shape = settings_[i];
      constexpr std::uint32_t assignments[] = {0x05,       0x6D,       0x1D,       0x00,
                                               0x0A'03'ED, 0x0F'02'65, 0x05'01'3D, 0x85};
      d.set(0x1F81, id, assignments[shape % 8]);
      d.set(0x1F55, id, new_version);
      if ((shape & 0x08) != 0) d.set(0x1016, static_cast<std::uint8_t>(i + 1), std::uint32_t{id} << 16 | 60U);
      if ((shape & 0x10) != 0) d.set(0x1F84, id, 0x191U);
      if ((shape & 0x20) != 0) d.set(0x1F26, id, 5U), d.set(0x1F27, id, 6U);
      if ((shape & 0x40) != 0) d.set<std::uint8_t>(0x1F8A, id, 1);
      if ((shape & 0x80) != 0) d.set(0x1F87, id, 0x1'0002U);
    }
    if ((settings_[3] & 1) != 0) d.set<std::uint32_t>(0x1F89, 0, 2000);
    if ((settings_[3] & 2) != 0) d.set<std::uint16_t>(0x102A, 0, 20);
    if ((settings_[3] & 4) != 0) d.set<std::uint16_t>(0x1017, 0, 100);
    if ((settings_[3] & 8) != 0) d.set<std::uint16_t>(0x1F90, 3, 0);
    const Silence silence(silent_);
    master_.start(now);
  }
  void nmt_state_changed(NmtState state, can::Time now) override {
    const Silence silence(silent_);
    master_.own_state_changed(state, now);
  }
  void heartbeat_received(std::uint8_t id, NmtState state, can::Time now) override {
    const Silence silence(silent_);
    master_.heartbeat_received(id, state, now);
  }
  void heartbeat_lost(std::uint8_t id, can::Time now) override {
    const Silence silence(silent_);
    master_.heartbeat_lost(id, now);
  }
  bool may_become_operational() override { return may_start_; }

  // --- MasterListener
  void active_changed(bool active, can::Time) override { expect(master_.active() == active); }
  void slave_booted(std::uint8_t id, can::Time) override { expect(id >= 1 && id <= 127); }
  void slave_failed(std::uint8_t id, manager::BootError error, can::Time now) override {
    expect(id >= 1 && id <= 127 && error != manager::BootError::none);
    expect(!manager::explain(master_.boot_record(id), id, now).empty());
    if (reacts_) static_cast<void>(master_.request_nmt(id, 0x06, now));
  }
  void error_control_event(std::uint8_t id, manager::ErrorControlEvent, can::Time now) override {
    expect(id >= 1 && id <= 127);
    if (reacts_) master_.clear_error_control(0, now);
  }
  void start_up_halted(std::uint8_t, manager::BootError, can::Time) override { expect(master_.halted()); }
  bool sdo_channel_free(std::uint8_t id) override {
    expect(id >= 1 && id <= 127);
    return channel_free_;
  }

  void check() {
    if (!master_.active()) expect(master_.active_master() != own_id);
    if (master_.halted()) expect(master_.active());
    for (const std::uint8_t id : slave_ids) {
      const std::uint8_t state = master_.node_state(id);
      expect(state == 0 || state == 1 || state == 4 || state == 5 || state == 0x7F || state == 7);
      expect((master_.error_control(id) & 0xFF00) == 0);
      if (master_.guarding(id)) expect(master_.active());
    }
    expect(master_.deadline() >= now_ - 1s);
  }

  // --- the application
  void request_object() {
    const std::uint8_t id = input_.one_of(slave_ids);
    const std::uint8_t what = input_.byte();
    const auto done = [this, id](const manager::SdoResult& result, can::Time now) {
      expect(result.node_id == id && requests_ > 0);
      --requests_;
      if (reacts_ && requests_ < 50 &&
          master_.read_object(
              id, 0x1000, 0, [this](const auto&, can::Time) { --requests_; }, now) ==
              canopen::AbortCode::none) {
        ++requests_;
      }
    };
    const manager::SdoRequestOptions options{
        .time_out = (what & 1) != 0 ? can::Duration(20ms) : can::Duration(500ms),
        .mode = (what & 2) != 0 ? canopen::SdoClient::Mode::block : canopen::SdoClient::Mode::segmented};
    if (requests_ > 100) return;
    ++requests_;
    asked_ = true;
    const std::vector<std::uint8_t> value((what >> 3) * 3U, what);
    const auto code = (what & 4) != 0 ? master_.write_object(id, 0x2000, what, value, done, now_, options)
                                      : master_.read_object(id, 0x1018, what & 3, done, now_, options);
    if (code != canopen::AbortCode::none) --requests_;
  }

  // --- what happens
  void step() {
    switch (input_.choice(17)) {
      case 16: return request_object();
      case 0: return receive(input_.frame(some_identifier()), now_);
      case 1: return receive(input_.frame(static_cast<std::uint32_t>(input_.number(2)) & 0x7FF), now_);
      case 2: {
        constexpr std::uint8_t states[] = {0x00, 0x05, 0x7F, 0x04, 0x85, 0xFF, 0x84, 0x01};
        return receive(can::data_frame(0x700U + input_.one_of(slave_ids), {input_.one_of(states)}), now_);
      }
      case 3:
      case 4:
      case 5: return deliver(1 + input_.choice(16));
      case 6:
      case 7:
      case 8: {
        constexpr can::Duration spans[] = {0us, 1ms, 5ms, 10ms, 50ms, 100ms, 500ms, 1s, 2s, 5s, 30s};
        return fuzz::pass_time(*this, now_, now_ + input_.one_of(spans), 200);
      }
      case 9: {
        constexpr std::uint8_t values[] = {0x04, 0x05, 0x06, 0x07, 0x7F, 0x84,
                                           0x85, 0x86, 0x87, 0x8F, 0x00, 0x01};
        constexpr std::uint8_t ids[] = {1, 2, 3, 127, 0x80, 0, 0x81, 4};
        const std::uint8_t id = input_.one_of(ids);
        const std::uint8_t value = input_.one_of(values);
        if (input_.flag()) return static_cast<void>(master_.request_guarding(id, value, now_));
        return static_cast<void>(master_.request_nmt(id, value, now_));
      }
      case 10: return static_cast<void>(master_.request_configuration(input_.one_of(slave_ids), now_));
      case 11: {  // flying master's frames
        const auto identifier = 0x071U + input_.choice(6);
        const std::uint8_t bytes[] = {input_.byte(), input_.byte()};
        return receive(can::data_frame(identifier, std::span(bytes).first(identifier == 0x071 ? 2 : 0)),
                       now_);
      }
      case 12: return write();
      case 13: return slaves_.answers.clear();  // all lost
      case 14: return surroundings();
      default: {
        constexpr std::uint8_t commands[] = {0x01, 0x02, 0x80, 0x81, 0x82};
        return receive(
            can::data_frame(0x000, {input_.one_of(commands), input_.flag() ? own_id : std::uint8_t{0}}),
            now_);
      }
    }
  }

  std::uint32_t some_identifier() {
    constexpr std::uint32_t bases[] = {0x580, 0x700, 0x080, 0x600};
    constexpr std::uint8_t ids[] = {1, 2, 3, 127};
    return input_.one_of(bases) + input_.one_of(ids);
  }

  void deliver(unsigned count) {
    for (unsigned i = 0; i < count && !slaves_.answers.empty(); ++i) {
      const can::Frame frame = slaves_.answers.front();
      slaves_.answers.pop_front();
      now_ += 200us;
      receive(frame, now_);
      for (unsigned ticks = 0; deadline() <= now_; ++ticks) {
        expect(ticks <= 32);
        tick(now_);
      }
    }
  }

  void write() {
    constexpr std::uint16_t objects[] = {0x1F80, 0x1F81, 0x1F82, 0x1F83, 0x1F22, 0x1F25, 0x1F84, 0x1F89,
                                         0x1F90, 0x1016, 0x1017, 0x102A, 0x1F26, 0x1F8A, 0x1F55, 0x1F58};
    constexpr std::uint8_t subs[] = {0, 1, 2, 3, 4, 5, 6, 127, 128};
    const std::uint16_t index = input_.one_of(objects);
    const std::uint8_t sub = input_.one_of(subs);
    const canopen::Entry entry = node_.dictionary().description().find(index, sub);
    if (!entry) return;
    if (index == 0x1F25) {
      static_cast<void>(node_.dictionary().write(index, sub, canopen::little_endian(0x666E6F63, 4), now_));
      return;
    }
    const auto value = input_.bytes(entry.description->length != 0 ? entry.description->length : 40);
    static_cast<void>(node_.dictionary().write(index, sub, value, now_));
    static_cast<void>(node_.dictionary().read(index, sub, now_));
  }

  void surroundings() {
    switch (input_.choice(12)) {
      case 8: slaves_.knows_blocks = input_.flag(); return;
      case 9: slaves_.flash_status = input_.byte(); return;
      case 10: slaves_.version[input_.one_of(slave_ids)] = input_.byte(); return;
      case 11: master_.cancel_requests(input_.flag() ? 0 : input_.one_of(slave_ids), now_); return;
      case 0: full_ = input_.flag(); return;
      case 1: may_start_ = input_.flag(); return;
      case 2: channel_free_ = input_.flag(); return;
      case 3: reacts_ = input_.flag(); return;
      case 4: store_.works = input_.flag(); return;
      case 5: master_.clear_error_control(input_.one_of(slave_ids), now_); return;
      case 6: {
        const Silence silence(silent_);
        master_.stop(now_);
        expect(!master_.active() && master_.deadline() >= now_);
        return;
      }
      default:
        node_.power_off();
        {
          const Silence silence(silent_);
          master_.stop(now_);
        }
        slaves_.answers.clear();
        if (input_.flag()) start_up_ = input_.byte() & 0x7F;
        node_.power_on(now_);
    }
  }

  Input& input_;
  can::Time now_{1s};
  Frames node_sink_{*this, false};
  Frames master_sink_{*this, true};
  Store store_;
  canopen::Node node_;
  manager::NmtMaster master_;
  manager::ConfigurationManager configurations_;
  std::uint32_t start_up_ = 0;
  std::array<std::uint8_t, 4> settings_{};
  Slaves slaves_;
  unsigned requests_ = 0;
  bool asked_ = false;  // SDO requests were made
  unsigned frames_ = 0;
  bool was_master_ = false;  // 1F80H had bit 0 set
  bool silent_ = false;
  bool full_ = false;
  bool may_start_ = true;
  bool channel_free_ = true;
  bool reacts_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  Run(input).run();
  return 0;
}
