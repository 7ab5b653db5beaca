// A node with every service of CiA 301, that hears mutated frames (mostly on identifiers it listens to), is
// used by its application in any order, and lives through time steps of any size. It sends nothing its NMT
// state forbids, hears nothing it says it does not want, its deadlines lead somewhere, and streams are closed
// as often as opened.

#include "canopus/canopen/node/node.hpp"

#include <vector>

#include "canopus/canopen/service/node_listener.hpp"

#include "input.hpp"
#include "node_objects.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;
using namespace canopus::fuzz;
using canopen::NmtState;

class Run final : can::Sink, canopen::NodeListener {
 public:
  explicit Run(Input& input)
      : input_(input), node_(description(), own_id, *this, options(input.byte(), input.byte())) {
    node_.set_listener(this);
    node_.attach(stream_object, stream_object, stream_);
    const std::uint8_t set_up = input.byte();
    if ((set_up & 1) != 0) node_.set_parameter_store(&store_);
    produces_sync_ = (set_up & 2) != 0;
    counts_sync_ = (set_up & 4) != 0;
    heartbeat_ = (set_up & 8) != 0;
    consumes_ = (set_up & 16) != 0;
    inhibits_emcy_ = (set_up & 32) != 0;
    error_behaviour_ = static_cast<std::uint8_t>(set_up >> 6);
    node_.power_on(now_);
    node_.command(canopen::NmtCommand::start, now_);
  }

  void run() {
    for (unsigned steps = 0; steps < 300 && !input_.empty(); ++steps) {
      frames_ = 0;
      step();
      expect(frames_ <= 4000);
      const can::Time deadline = node_.deadline();
      expect(deadline >= now_ - 1s);
      expect(node_.state() != NmtState::initialising || !stream_.is_open());
    }
    node_.power_off();
    expect(!stream_.is_open() && node_.deadline() == can::never);
  }

 private:
  static std::shared_ptr<const canopen::DictionaryDescription> description() {
    static const auto built = build_node_objects();
    return built;
  }
  static canopen::NodeOptions options(std::uint8_t low, std::uint8_t high) {
    canopen::NodeOptions o;
    o.dismiss_events_during_inhibit = (low & 1) != 0;
    o.unsent_values_are_changed = (low & 2) == 0;
    o.send_tpdos_on_start = (low & 4) == 0;
    o.sdo_write_is_event = (low & 8) == 0;
    o.tpdo_rtr_bit_is_constant = (low & 16) != 0;
    o.rtr_transmission_types = (low & 32) == 0;
    o.extended_identifiers = (low & 64) == 0;
    if ((low & 128) != 0) o.inhibit_time_resolution = o.sync_period_resolution = 1ms;
    o.sync_needs_active_master = (high & 1) != 0;
    o.history_clears_error_register = (high & 2) != 0;
    o.empty_history_reads_zero = (high & 4) != 0;
    o.guarding_emergency_names_node = (high & 8) != 0;
    if ((high & 16) != 0) o.sdo_server_time_out = 0s;
    if ((high & 32) != 0) o.sdo_maximum_download = 20;
    o.save_before_restored = (high & 64) != 0;
    if ((high & 128) != 0) o.stored_length = canopen::StoredLength::two_bytes;
    return o;
  }

  // --- what the node does
  bool send(const can::Frame& frame) override {
    ++frames_;
    fuzz::expect_well_formed(frame);
    expect(!frame.remote);
    const bool is_error_control = !frame.extended && frame.identifier == 0x700U + node_.node_id();
    if (node_.state() == NmtState::stopped) expect(is_error_control && frame.dlc == 1);
    if (node_.state() == NmtState::initialising) {
      expect(is_error_control && frame.dlc == 1 && frame.data[0] == 0);
    }
    if (frame.data[0] != 0x80 && (frame.data[0] & 0x7F) != 0) last_sequence_ = frame.data[0] & 0x7F;
    static_cast<void>(node_.identifiers_revision());  // as a bus may ask at any time
    return !full_;
  }
  void tpdo_sent(std::uint16_t number, can::Time) override {
    expect(node_.state() == NmtState::operational && number < pdo_count);
  }
  void rpdo_received(std::uint16_t number, can::Time) override {
    expect(node_.state() == NmtState::operational && number < pdo_count);
  }
  void sync_received(std::uint8_t, can::Time) override { expect_communicates(); }
  void time_received(const canopen::TimeOfDay&, can::Time) override { expect_communicates(); }
  void emergency_received(const canopen::Emergency& e, can::Time) override {
    expect_communicates();
    expect(e.node_id >= 1 && e.node_id <= 12);
  }
  void emergency_raised(const canopen::Emergency& e, can::Time) override {
    expect(e.node_id == node_.node_id());
    if (reacts_) node_.values_changed(now_);
  }
  bool may_become_operational() override { return may_start_; }
  void heartbeat_lost(std::uint8_t id, can::Time) override {
    expect(id >= 1 && id <= 127);
    if (reacts_) node_.command(canopen::NmtCommand::stop, now_);
  }
  void life_guarding_event(bool, can::Time) override {
    if (reacts_) node_.command(canopen::NmtCommand::reset_communication, now_);
  }
  void reset_done(canopen::NmtCommand, can::Time) override {
    auto& d = node_.dictionary();
    if (produces_sync_) d.set<std::uint32_t>(0x1005, 0, 0x4000'0080);
    if (counts_sync_) d.set<std::uint8_t>(0x1019, 0, 5);
    if (heartbeat_) d.set<std::uint16_t>(0x1017, 0, 30);
    if (inhibits_emcy_) d.set<std::uint16_t>(0x1015, 0, 100);
    d.set<std::uint8_t>(0x1029, 1, error_behaviour_);
    if (consumes_) {
      for (std::uint8_t sub = 1; sub <= 3; ++sub) d.set(0x1016, sub, (8U + sub) << 16 | 40U);
      for (std::uint8_t sub = 1; sub <= 12; ++sub) d.set(0x1028, sub, 0x80U + sub);
    }
  }
  void expect_communicates() const {
    expect(node_.state() == NmtState::operational || node_.state() == NmtState::pre_operational);
  }

  // --- what is done to it
  void step() {
    switch (input_.choice(16)) {
      case 0: return receive(input_.frame(own_identifier(), false));
      case 1: return receive(input_.frame(static_cast<std::uint32_t>(input_.number(2)) & 0x7FF));
      case 2: return receive(input_.frame(static_cast<std::uint32_t>(input_.number(4)) & 0x1FFF'FFFF, true));
      case 3:
        return receive(
            can::data_frame(0x000, {input_.one_of(commands), input_.flag() ? own_id : std::uint8_t{0}}));
      case 4:
      case 5: return receive(sdo_request());
      case 6: return write();
      case 7:
        return receive(
            can::remote_frame(0x700U + node_.node_id(), static_cast<std::uint8_t>(input_.choice(2))));
      case 8: return receive(can::data_frame(0x080, std::span(counter_).first(counts_sync_ ? 1 : 0)));
      case 9: return receive(can::data_frame(0x709U + input_.choice(3), {input_.one_of(states)}));
      case 10:
      case 11: return pass_time();
      case 12: return application();
      case 13: return application_write();
      case 14: return input_.flag() ? sdo_block() : sdo_conversation();
      default: return surroundings();
    }
  }

  void receive(const can::Frame& frame) {
    const bool wanted = frame.extended ? node_.wants_extended() : node_.wants(frame.identifier);
    if (frame.identifier == 0x080 && !frame.extended)
      counter_[0] = static_cast<std::uint8_t>(counter_[0] % 5 + 1);
    node_.receive(frame, now_);
    expect(wanted || frames_ == 0);
  }

  std::uint32_t own_identifier() {
    const std::uint32_t which = input_.byte();
    if (which < pdo_count) return 0x300 + 0x10 * which;
    if (which < 2 * pdo_count) return 0x200 + 0x10 * (which - pdo_count);
    constexpr std::uint32_t others[] = {0x000, 0x080, 0x081, 0x085, 0x08A, 0x100,
                                        0x605, 0x6A0, 0x705, 0x709, 0x70A};
    return others[which % std::size(others)];
  }

  std::uint16_t some_object() {
    constexpr std::uint16_t objects[] = {
        0x1001, 0x1003, 0x1005, 0x1006, 0x1007, 0x1008, 0x100C, 0x100D, 0x1010, 0x1011, 0x1012, 0x1014,
        0x1015, 0x1016, 0x1017, 0x1018, 0x1019, 0x1028, 0x1029, 0x1200, 0x1201, 0x1202, 0x1280, 0x1FA0,
        0x1FD0, 0x2000, 0x2005, 0x2006, 0x2008, 0x2009, 0x200A, 0x200B, 0x2016, 0x2018, 0x2020, 0x2022,
        0x2040, 0x6000, 0x6020, 0x6200, 0x6220, 0x6401, 0x6411, 0x6500, 0x6501};
    const std::uint32_t which = input_.byte();
    if (which < std::size(objects)) return objects[which];
    constexpr std::uint16_t pdos[] = {0x1400, 0x1600, 0x1800, 0x1A00};
    return static_cast<std::uint16_t>(pdos[which % 4] + which / 4 % pdo_count);
  }

  can::Frame sdo_request() {
    constexpr std::uint8_t usual[] = {0x40, 0x23, 0x27, 0x2B, 0x2F, 0x20, 0x21, 0x22, 0x60, 0x70, 0x00,
                                      0x10, 0x01, 0x11, 0x0F, 0x80, 0xA0, 0xA1, 0xA2, 0xA3, 0xA4, 0xC0,
                                      0xC2, 0xC4, 0xC6, 0xC1, 0xDD, 0x81, 0x82, 0x02, 0x7F};
    const std::uint8_t command = input_.one_of(usual);
    const std::uint16_t index = some_object();
    can::Frame frame = can::data_frame(input_.flag() ? 0x6A0 : 0x605,
                                       {command, static_cast<std::uint8_t>(index),
                                        static_cast<std::uint8_t>(index >> 8), input_.byte(), 0, 0, 0, 0});
    std::ranges::copy(input_.bytes(4), frame.data.begin() + 4);
    return frame;
  }

  /// A write that gets as far as the object's own rules: a value of the right length.
  void write() {
    const std::uint16_t index = some_object();
    const auto sub = static_cast<std::uint8_t>(input_.choice(10));
    const canopen::Entry entry = node_.dictionary().description().find(index, sub);
    if (!entry) return;
    std::uint64_t value = 0;
    constexpr std::uint64_t interesting[] = {0,           1,           2,           8,           0x40,
                                             0xFE,        0xFF,        0x85,        0x300,       0x8000'0300,
                                             0x4000'0080, 0x2000'0085, 0x6000'0008, 0x6000'0108, 0x6200'0108,
                                             0x6500'0040, 0x6020'0101, 0x0005'0008, 0x6576'6173, 0x6461'6F6C,
                                             0xA000'0310, 0xFFFF'FFFF, 0x0009'000A, 0xC000'0200};
    const std::uint8_t which = input_.byte();
    value = which < std::size(interesting) ? interesting[which] : input_.number(entry.description->length);
    const auto bytes = little_endian(value, entry.description->length);
    const AbortCode code = node_.dictionary().write(index, sub, bytes, now_);
    if (code == AbortCode::none && index >= 0x2000) {
      expect(std::ranges::equal(node_.dictionary().bytes(entry), bytes));
    }
  }

  /// Segments of a block download in a row.
  void sdo_block() {
    const std::uint32_t identifier = input_.flag() ? 0x6A0 : 0x605;
    const unsigned first = input_.choice(128);
    const unsigned count = input_.choice(128);
    const bool last = input_.flag();
    for (unsigned i = 0; i < count; ++i) {
      const unsigned mark = last && i + 1 == count ? 0x80 : 0;
      receive(can::data_frame(identifier,
                              {static_cast<std::uint8_t>((first + i) % 128 | mark), 1, 2, 3, 4, 5, 6, 7}));
    }
  }

  /// A block transfer as a good client does it, as far as the input lets it come.
  void sdo_conversation() {
    const std::uint32_t identifier = input_.flag() ? 0x6A0 : 0x605;
    const std::uint16_t index = some_object();
    const auto low = static_cast<std::uint8_t>(index);
    const auto high = static_cast<std::uint8_t>(index >> 8);
    const std::uint8_t sub = static_cast<std::uint8_t>(input_.choice(4));
    const auto send_request = [&](std::initializer_list<std::uint8_t> bytes) {
      receive(can::data_frame(identifier, bytes));
    };
    if (input_.flag()) {
      const auto block_size = static_cast<std::uint8_t>(1 + input_.choice(127));
      send_request(
          {static_cast<std::uint8_t>(0xA0 | (input_.flag() ? 4 : 0)), low, high, sub, block_size, 0, 0, 0});
      send_request({0xA3, 0, 0, 0, 0, 0, 0, 0});
      for (unsigned blocks = input_.choice(8); blocks != 0; --blocks) {
        const std::uint8_t confirmed =
            input_.flag() ? static_cast<std::uint8_t>(input_.choice(128)) : last_sequence_;
        send_request({0xA2, confirmed, block_size, 0, 0, 0, 0, 0});
      }
      if (input_.flag()) send_request({0xA1, 0, 0, 0, 0, 0, 0, 0});
      return;
    }
    const unsigned count = 1 + input_.choice(140);
    const unsigned unused = input_.choice(8);
    const unsigned size = 7 * count - std::min(unused, 7 * count);
    send_request(
        {0xC2, low, high, sub, static_cast<std::uint8_t>(size), static_cast<std::uint8_t>(size >> 8), 0, 0});
    for (unsigned i = 0; i < count; ++i) {
      const unsigned last = i + 1 == count ? 0x80 : 0;
      send_request(
          {static_cast<std::uint8_t>((i % 127 + 1) | last), 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77});
    }
    send_request({static_cast<std::uint8_t>(0xC1 | unused << 2), 0, 0, 0, 0, 0, 0, 0});
  }

  void pass_time() {
    constexpr can::Duration spans[] = {0us,  1us,  100us, 500us, 1ms, 3ms, 10ms,
                                       20ms, 40ms, 50ms,  250ms, 1s,  5s,  3600s};
    fuzz::pass_time(node_, now_, now_ + input_.one_of(spans));
  }

  void application() {
    switch (input_.choice(12)) {
      case 0: return node_.command(input_.one_of(all_commands), now_);
      case 1: return node_.communication_error(now_);
      case 2: return node_.set_active_master(input_.flag(), now_);
      case 3: {
        const std::array<std::uint8_t, 5> manufacturer{1, 2, 3, 4, 5};
        const auto code = static_cast<std::uint16_t>(input_.number(2));
        const bool sent = node_.emergency(code, input_.byte(), manufacturer, now_);
        if (sent) expect_communicates();
        return;
      }
      case 4: return static_cast<void>(node_.emergency_reset(now_));
      case 5: return static_cast<void>(node_.values_changed(now_));
      case 6: return static_cast<void>(node_.tpdo_event(input_.byte(), now_));
      case 7: {
        const auto object = some_object();
        const std::uint8_t value[] = {1, 2, 3, 4};
        const auto length = input_.choice(5);
        node_.send_destination_mpdo(7, input_.byte(), object, input_.byte(), std::span(value).first(length),
                                    now_);
        return;
      }
      case 8: return static_cast<void>(node_.send_source_mpdo(some_object(), input_.byte(), now_));
      case 9:
        node_.send_time(
            {static_cast<std::uint32_t>(input_.number(4)), static_cast<std::uint16_t>(input_.number(2))},
            now_);
        return;
      case 10:
        node_.power_off();
        expect(node_.state() == NmtState::initialising && node_.deadline() == can::never && frames_ == 0);
        if (input_.flag()) node_.power_on(now_);
        return;
      default:
        constexpr std::uint8_t ids[] = {own_id, 1, 127, 9, 0, 128, 255};
        node_.set_node_id(input_.one_of(ids));
    }
  }

  /// The device changes its process values.
  void application_write() {
    const std::uint16_t index = some_object();
    const canopen::Entry entry =
        node_.dictionary().description().find(index, static_cast<std::uint8_t>(input_.choice(5)));
    if (!entry || entry.description->length == 0 || index < 0x2000) return;
    node_.dictionary().set(entry, input_.number(entry.description->length));
    node_.values_changed(now_);
  }

  void surroundings() {
    switch (input_.choice(6)) {
      case 0: full_ = input_.flag(); return;
      case 1: may_start_ = input_.flag(); return;
      case 2: reacts_ = input_.flag(); return;
      case 3: store_.fails = input_.flag(); return;
      case 4: {
        constexpr std::size_t lengths[] = {0, 1, 4, 5, 7, 13, 100, 889, 890, 1000, 5001};
        if (!stream_.is_open()) stream_.length = input_.one_of(lengths);
        return;
      }
      default: {
        const auto image = input_.bytes(64);
        store_.image.assign(image.begin(), image.end());
      }
    }
  }

  static constexpr std::uint8_t commands[] = {0x01, 0x02, 0x80, 0x81, 0x82, 0x01, 0x01, 0x00};
  static constexpr canopen::NmtCommand all_commands[] = {
      canopen::NmtCommand::start, canopen::NmtCommand::stop, canopen::NmtCommand::enter_pre_operational,
      canopen::NmtCommand::reset_node, canopen::NmtCommand::reset_communication};
  static constexpr std::uint8_t states[] = {0x05, 0x7F, 0x04, 0x00, 0x85, 0x01};

  Input& input_;
  can::Time now_{1s};
  Stream stream_;
  Store store_;
  canopen::Node node_;
  unsigned frames_ = 0;
  std::uint8_t last_sequence_ = 0;
  std::array<std::uint8_t, 1> counter_{1};
  std::uint8_t error_behaviour_ = 0;
  bool produces_sync_ = false;
  bool counts_sync_ = false;
  bool heartbeat_ = false;
  bool consumes_ = false;
  bool inhibits_emcy_ = false;
  bool full_ = false;
  bool may_start_ = true;
  bool reacts_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  Run(input).run();
  return 0;
}
