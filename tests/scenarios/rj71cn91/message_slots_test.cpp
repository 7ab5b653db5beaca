// Message slots of the Layer 2 modes, clause by clause, in both [RJ71CN91 1.11, 5.3, 5.4, App. 1 Y4, App. 2 G5001, G6000,
// G10000].

#include "canopus/sim/bus/bus.hpp"

#include "scenarios/me3can1_q/layer2_forms.hpp"
#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_message_slots_test {
namespace {

using namespace rj71cn91_presets;

TEST(Rj71Slots, Kind_ByParametersAAndB) {
  RecordProperty("spec", "RJ71-L2-002");
  for (const Layer2Form& form : layer2_forms) {
    for (const unsigned slot : {1U, 42U}) {
      for (const std::uint16_t b : Words{0x7FFF, 0x6FFF, 0x5FFF}) {  // sends
        IntelligentScenario s(rj71cn91);
        s.power_on_layer2(form.mode);
        set_transmit(s, slot, form.highest, b, 4, 1);
        s.y(0x03, true).tx(frame(form, form.highest, {0})).rx(frame(form, form.highest, {9}));
        s.exchange().no_tx().expect(block(slot) + 3, 0).expect(29, 0);
      }
      for (const std::uint32_t identifier : {0U, 0x123U, form.highest}) {  // receives B:A
        IntelligentScenario s(rj71cn91);
        s.power_on_layer2(form.mode);
        s.write(parameters(slot),
                {static_cast<std::uint16_t>(identifier), static_cast<std::uint16_t>(identifier >> 16), 0, 0});
        s.y(0x03, true)
            .expect_x(0x03, true)
            .no_tx()
            .rx(frame(form, identifier ^ 1U, {9}))
            .rx(frame(form, identifier, {7}));
        s.exchange().no_tx();
        s.expect(block(slot), {static_cast<std::uint16_t>(identifier),
                               static_cast<std::uint16_t>(identifier >> 16), 0x0301, 7});
      }
      // Neither: G29.6 and the address.
      const std::uint16_t highest_word = form.mode == 29 ? 0x1FFF : 0;
      for (const std::uint16_t b :
           Words{static_cast<std::uint16_t>(highest_word + 1), 0x4FFF, 0x7FFE, 0xFFFE}) {
        IntelligentScenario s(rj71cn91);
        s.power_on_layer2(form.mode);
        s.write(parameters(slot) + 1, b)
            .expect(29, 0x0040)
            .expect(39, static_cast<std::uint16_t>(parameters(slot) + 1));
        s.expect(parameters(slot) + 1, 0xFFFF).expect_x(0x0F, true);
      }
    }
  }
}

/// The module in a Layer 2 mode at 125 kbit/s, and a partner who alone would acknowledge.
class TwoStations : can::Listener {
 public:
  explicit TwoStations(std::uint32_t bit_rate = 125'000) : bus("field", bit_rate, timeline) {
    module = make_module(rj71cn91, own, memory);
    module->preset_word(21, 11);
    module->preset_word(24, static_cast<std::uint16_t>(bit_rate / 1000));
    timeline.add(*module);
    own.connect(*module);
    partner.connect(*this);
    module->power_on(timeline.now());
    run(3s);
  }
  void receive(const can::Frame& received, can::Time) override { heard.push_back(received); }
  void run(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
  void y(unsigned number, bool on) { module->signals()->set_output(number, on, timeline.now()); }
  bool x(unsigned number) { return (module->signals()->inputs() >> number & 1U) != 0; }
  void write(module::BufferAddress first, const Words& words) {
    for (const std::uint16_t word : words) module->write_word(first++, word, timeline.now());
  }
  std::uint16_t read(module::BufferAddress address) { return module->program_read(address, timeline.now()); }

  can::Timeline timeline;
  sim::Bus bus;
  sim::Port& own = bus.add_port("module");
  sim::Port& partner = bus.add_port("partner");
  RamMemory memory;
  std::unique_ptr<module::ModuleEngine> module;
  std::vector<can::Frame> heard;
};

TEST(Rj71Slots, Offline_TheModuleAcknowledgesNothing) {
  RecordProperty("spec", "RJ71-L2-005");
  TwoStations b;
  b.partner.send(can::data_frame(0x123, Bytes{1}));
  b.run(1s);
  EXPECT_GE(b.partner.transmit_error_counter(), 96);  // nobody says that it got it
  b.y(0x03, true);
  b.run(1s);
  EXPECT_TRUE(b.x(0x03));
  EXPECT_LT(b.partner.transmit_error_counter(), 128);
  const auto counter = b.partner.transmit_error_counter();
  b.partner.send(can::data_frame(0x124, Bytes{1}));
  b.run(10ms);
  EXPECT_LT(b.partner.transmit_error_counter(), counter);
  b.y(0x03, false);
  b.run(10ms);
  b.partner.send(can::data_frame(0x125, Bytes{1}));
  b.run(1s);
  EXPECT_GE(b.partner.transmit_error_counter(), 128);
  EXPECT_EQ(b.read(36), 0);  // and it is not disturbed
}

TEST(Rj71Slots, Exchange_LoadsTheBuffer_TheTypeSends) {
  RecordProperty("spec", "RJ71-L2TX-001 RJ71-L2TX-003 RJ71-L2TX-008");
  for (const Layer2Form& form : layer2_forms) {
    for (const unsigned slot : {1U, 42U}) {
      IntelligentScenario s(rj71cn91);
      s.power_on_layer2(form.mode);
      set_transmit(s, slot, 0x123, 0x5FFF, 1, 8);  // event (COS)
      s.write(block(slot) + 3, {0x0201, 0x0403, 0x0605, 0x0807})
          .y(0x01, true)
          .advance(1s)
          .no_tx();  // offline
      s.y(0x01, false).expect_x(0x01, false);
      s.y(0x03, true).tx(frame(form, 0x123, {1, 2, 3, 4, 5, 6, 7, 8}));
      s.exchange().no_tx();  // as when going online
      Bytes data{1, 2, 3, 4, 5, 6, 7, 8};
      for (std::size_t byte = 0; byte < 8; ++byte) {  // every single byte is a change
        data[byte] = static_cast<std::uint8_t>(data[byte] ^ 0x80);
        const auto word = static_cast<module::BufferAddress>(block(slot) + 3 + byte / 2);
        s.write(word, static_cast<std::uint16_t>(data[byte | 1U] << 8 | data[byte & ~std::size_t{1}]));
        s.advance(100ms).no_tx().y(0x01, true).wait_x(0x01, true).tx(frame(form, 0x123, data));
        s.y(0x01, false).expect_x(0x01, false);
        s.exchange().no_tx();
      }
    }
  }
}

TEST(Rj71Slots, CycleOfChanges_SeesEveryByte) {
  RecordProperty("spec", "RJ71-L2TX-005");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    set_transmit(s, 42, 0x123, 0x5FFF, 3, 8, 5);  // every 50 ms
    s.y(0x03, true).tx(frame(form, 0x123, {0, 0, 0, 0, 0, 0, 0, 0})).advance(1s).no_tx();
    Bytes data(8, 0);
    for (std::size_t byte = 0; byte < 8; ++byte) {
      data[byte] = 0x5A;
      const auto word = static_cast<module::BufferAddress>(block(42) + 3 + byte / 2);
      s.write(word, static_cast<std::uint16_t>(data[byte | 1U] << 8 | data[byte & ~std::size_t{1}]));
      s.advance(200ms).no_tx();  // comes in by Y1
      s.exchange().advance(60ms).tx(frame(form, 0x123, data));
      s.advance(200ms).no_tx();
    }
  }
}

TEST(Rj71Slots, CycleTooShortForTheBitRate_IsAParameterError) {
  RecordProperty("spec", "RJ71-L2TX-009");
  struct Row {
    std::uint16_t mode, rate, d, dlc;
    bool good;
  };
  // The longest such frame has 135 bits (11-bit CAN-ID, 8 bytes) or 160 (29 bits).
  for (const Row& row : {Row{11, 10, 0, 8, false}, Row{11, 10, 1, 8, false}, Row{11, 10, 2, 8, true},
                         Row{29, 10, 1, 8, false}, Row{29, 10, 2, 8, true}, Row{11, 10, 1, 4, true},
                         Row{11, 20, 1, 8, true}, Row{29, 20, 1, 8, true}, Row{11, 1000, 1, 8, true}}) {
    for (const std::uint16_t type : Words{2, 3, 0, 1, 4}) {
      IntelligentScenario s(rj71cn91);
      s.power_on_layer2(row.mode);
      s.write(24, row.rate);
      set_transmit(s, 42, 0x123, 0x5FFF, type, row.dlc, row.d);
      const bool good = row.good || (type != 2 && type != 3);
      s.y(0x03, true)
          .expect_x(0x03, good)
          .expect(29, good ? 0 : 0x0040)
          .expect(39, good ? 0 : 6167)
          .ignore_tx();
      s.y(0x03, false).ignore_tx();
      if (good) continue;
      s.write(6167, 2).expect(29, 0).y(0x03, true).expect_x(0x03, true).ignore_tx();
    }
  }
  // Together they are too much: 42 frames every 10 ms at 250 kbit/s; the first that does not fit any more.
  IntelligentScenario s(rj71cn91);
  s.power_on_layer2(11);
  for (unsigned slot = 1; slot <= 42; ++slot) set_transmit(s, slot, 0x100 + slot, 0x5FFF, 2, 8, 1);
  s.y(0x03, true).expect_x(0x03, false).expect(29, 0x0040).expect(39, 6003 + 4 * 18).no_tx().y(0x03, false);
  s.write(24, 1000).y(0x03, true).expect_x(0x03, true).ignore_tx();
}

TEST(Rj71Slots, Trigger_WaitsWhileTheBufferIsFull_OfflineToo) {
  RecordProperty("spec", "RJ71-L2TX-013");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    set_transmit(s, 1, 0x101, 0x5FFF, 4, 1);
    set_transmit(s, 42, 0x142, 0x5FFF, 4, 1);
    s.write(8400, {1, 0, 0x0200}).y(0x04, true).advance(10s).expect_x(0x04, false).no_tx();  // offline
    s.expect(8400, {1, 0, 0x0200}).y(0x04, false);
    s.y(0x03, true).ignore_tx();
    s.controller().accepts = false;  // no partner: full
    s.write(8400, {1, 0, 0x0200}).y(0x04, true).advance(10s).expect_x(0x04, false).no_tx();
    s.controller().accepts = true;
    s.plug_in().transmitted(can::data_frame(0x555), s.now());  // what filled it has left
    s.advance(1ms).expect_x(0x04, true).tx(frame(form, 0x101, {0})).tx(frame(form, 0x142, {0})).no_tx();
    s.expect(8400, {0, 0, 0}).expect(29, 0).y(0x04, false).expect_x(0x04, false);
    s.error_counters(256, 0).write(8400, {1, 0, 0});  // bus-off
    s.controller().accepts = false;
    s.y(0x04, true).advance(10s).expect_x(0x04, false).no_tx();
  }
}

TEST(Rj71Slots, SendBufferOverflow_IsG29_8_And1800H) {
  RecordProperty("spec", "RJ71-L2TX-014");
  TwoStations b(10'000);  // a frame of 8 bytes lasts 11 to 14 ms
  for (std::uint16_t slot = 1; slot <= 42; ++slot) {
    b.write(parameters(slot), {0xFFFF, 0x5FFF, 0, 0});
    b.write(block(slot), {slot, 0, 8});
  }
  b.y(0x03, true);
  b.run(2s);
  ASSERT_TRUE(b.x(0x03));
  EXPECT_EQ(b.read(29), 0);
  for (unsigned times = 0; times < 100 && b.read(29) == 0; ++times) {
    b.y(0x01, true);
    b.run(2ms);
    b.y(0x01, false);
    b.run(1ms);
  }
  EXPECT_EQ(b.read(29), 0x0100);
  EXPECT_TRUE(b.x(0x0F));
  ASSERT_EQ(b.module->module_errors().size(), 1U);
  EXPECT_EQ(b.module->module_errors()[0].code, 0x1800);
}

TEST(Rj71Slots, RemoteFrames_MatchByIdentifier_OrWithTheDlc) {
  RecordProperty("spec", "RJ71-L2RTR-006 RJ71-L2RTR-007");
  for (const Layer2Form& form : layer2_forms) {
    for (const unsigned slot : {1U, 42U}) {
      const auto flag_word = static_cast<module::BufferAddress>(8350 + (slot - 1) / 16);
      const auto flag = static_cast<std::uint16_t>(1U << (slot - 1) % 16);
      for (const std::uint16_t b : Words{0x7FFF, 0x6FFF}) {
        for (const bool precise : {false, true}) {
          IntelligentScenario s(rj71cn91);
          s.power_on_layer2(form.mode);
          set_transmit(s, slot, form.highest - 1, b, 4,
                       static_cast<std::uint16_t>(precise ? 0x1003 : 0x0003));
          s.y(0x03, true).ignore_tx();
          for (std::uint8_t dlc = 0; dlc <= 8; ++dlc) {
            s.rx(remote(form, form.highest - 1, dlc)).rx(remote(form, form.highest, dlc));
            const bool taken = !precise || dlc == 3;
            if (taken && b == 0x7FFF) s.tx(frame(form, form.highest - 1, {0, 0, 0}));
            s.no_tx().expect(flag_word, taken && b == 0x6FFF ? flag : 0);
            s.write(static_cast<module::BufferAddress>(8400 + (slot - 1) / 16), flag)
                .y(0x04, true)
                .y(0x04, false)
                .ignore_tx();
            s.expect(flag_word, 0);
          }
        }
      }
      IntelligentScenario s(rj71cn91);  // bit 12 with RTR handling disabled: a setting error
      s.power_on_layer2(form.mode);
      set_transmit(s, slot, 0x123, 0x5FFF, 4, 2);
      s.write(block(slot) + 2, 0x1002)
          .expect(29, 0x0040)
          .expect(39, static_cast<std::uint16_t>(block(slot) + 2));
      s.expect(block(slot) + 2, 2);
    }
  }
}

TEST(Rj71Slots, ReceiveSlots_TakeDataFramesOnly) {
  RecordProperty("spec", "RJ71-L2RTR-009");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    s.write(6000, {0x181, 0, 0, 0}).write(6164, {0, 0, 0xFFFF, 0x1FFF}).y(0x03, true).no_tx();
    for (const std::uint8_t dlc : Bytes{0, 4, 8}) s.rx(remote(form, 0x181, dlc));
    s.exchange().expect(10000, Words(7, 0)).expect(10287, Words(7, 0)).expect(8350, {0, 0, 0}).no_tx();
    s.rx(frame(form, 0x181, {1}));
    s.exchange().expect(10000, {0x181, 0, 0x0301, 1}).expect(10287, {0x181, 0, 0x0301, 1});
  }
}

TEST(Rj71Slots, ReceiveOverflow_IsItsErrorCode_G29_15_And1803H) {
  RecordProperty("spec", "RJ71-L2RX-008");
  for (const Layer2Form& form : layer2_forms) {
    for (const std::uint16_t slot : Words{1, 17, 42}) {
      IntelligentScenario s(rj71cn91);
      s.power_on_layer2(form.mode);
      for (unsigned each = 1; each <= 42; ++each)
        s.write(parameters(each), {static_cast<std::uint16_t>(0x100 + each), 0, 0, 0});
      s.y(0x03, true).no_tx();
      for (int i = 0; i < 200; ++i) s.rx(frame(form, 0x100U + slot, {1, 2, 3, 4, 5, 6, 7, 8})).advance(200us);
      s.expect(29, 0);  // in time
      for (int i = 0; i < 50; ++i) s.rx(frame(form, 0x100U + slot, {}));
      for (unsigned each = 1; each <= 42; ++each) s.expect(5000 + each, each == slot ? 0x2000 : 0);
      s.expect(29, 0x8000).expect_x(0x0F, true);
      ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x1803}));
      EXPECT_EQ(s.plug_in().module_errors()[0].details[0].name, "Message slot number");
      EXPECT_EQ(s.plug_in().module_errors()[0].details[0].value, slot);
      s.y(0x0F, true).y(0x0F, false).expect(29, 0x8000);  // its code is still there
      s.write(5000U + slot, 0).y(0x0F, true).y(0x0F, false).expect(29, 0).expect_x(0x0F, false);
    }
  }
}

TEST(Rj71Slots, LowerIdentifierFirst_WhenSeveralBeginTogether) {
  RecordProperty("spec", "RJ71-CANID-001");
  TwoStations b;
  b.write(6000, {0xFFFF, 0x5FFF, 4, 0, 0xFFFF, 0x5FFF, 4, 0});
  b.write(10000, {0x200, 0, 0});
  b.write(10007, {0x1FE, 0, 0});
  b.y(0x03, true);
  b.run(1s);
  const auto both = [&b](std::uint16_t own, std::uint16_t other) {
    // While a third frame is on the wire both get theirs ready.
    b.partner.send(can::data_frame(0x001, Bytes{1, 2, 3, 4, 5, 6, 7, 8}));
    b.run(300us);
    b.write(8400, {static_cast<std::uint16_t>(own == 0x200 ? 1 : 2)});
    b.y(0x04, true);
    b.partner.send(can::data_frame(other, Bytes{}));
    b.run(20ms);
    b.y(0x04, false);
  };
  std::vector<std::uint32_t> order;
  struct Order : can::Listener {
    explicit Order(std::vector<std::uint32_t>& list) : order(&list) {}
    void receive(const can::Frame& received, can::Time) override { order->push_back(received.identifier); }
    std::vector<std::uint32_t>* order;
  } third(order);
  sim::Port& ear = b.bus.add_port("third");
  ear.connect(third);
  b.run(10ms);
  both(0x200, 0x1FF);
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0x001, 0x1FF, 0x200}));
  order.clear();
  both(0x1FE, 0x1FF);
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0x001, 0x1FE, 0x1FF}));
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_message_slots_test
