// Car door controller, car drive controller and load in CANopen 417 mode [FX3U-CAN 5.10.4 to 5.10.13, 8.4 to 8.17].

#include "scenarios/fx3u_can/lift_scenario.hpp"

namespace canopus::scenario::fx3u_can_car_controllers_test {
namespace {

using module::BufferAddress;

// T417-30
TEST(FxCarDoors, Commands_AreOneFrameOfFourDoors) {
  RecordProperty("spec",
                 "FX3U-DOOR-001 FX3U-DOOR-002 FX3U-DOOR-004 FX3U-DOOR-005 FX3U-DOOR-006 FX3U-OD417-004");
  BlockScenario s;
  start_lift_operational(s, 0xFF);
  for (BufferAddress word = 13050; word <= 13081; ++word) s.expect(word, 0xFFFF);
  s.expect_object(0x6300, 1, 0xFFFF, 2).write(13050, 0x4FFF).exchange().no_tx();
  for (std::uint32_t lift = 0; lift < 8; ++lift) {
    const auto pdo = static_cast<std::uint16_t>(0x1908 + 0x10 * lift);
    s.expect_object(pdo, 1, 0xC0000200 + 0x10 * lift, 4).set_object(pdo, 1, 0x40000200 + 0x10 * lift, 4);
  }
  s.ignore_tx();
  for (std::uint32_t lift = 0; lift < 8; ++lift) {
    for (std::uint32_t door = 0; door < 4; ++door) {
      s.write(13050 + 4 * lift + door, 0x1FFF).exchange();
      Bytes frame(8, 0xFF);
      frame[2 * door + 1] = 0x1F;
      s.tx(0x200 + 0x10 * lift, frame).no_tx();
      s.expect_object(static_cast<std::uint16_t>(0x6300 + 0x0800 * lift), static_cast<std::uint8_t>(door + 1),
                      0x1FFF, 2);
      s.write(3050 + 4 * lift + door, 0xFFFF).exchange().tx(0x200 + 0x10 * lift, Bytes(8, 0xFF));
    }
  }
  // Every command, reserved ones too.
  for (std::uint16_t command = 0; command < 0xF; ++command) {
    s.write(13050, static_cast<std::uint16_t>(command << 12 | 0x0FFF)).exchange();
    s.tx(0x200, {0xFF, static_cast<std::uint8_t>(command << 4 | 0x0F), 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF})
        .no_tx();
  }
  s.expect(29, 0);
}

TEST(FxCarDoors, BitsThatAreAlwaysOne) {
  RecordProperty("spec", "FX3U-DOOR-003");
  BlockScenario s;
  start_lift_operational(s, 0x80);
  s.set_object(0x1978, 1, 0x40000270, 4).ignore_tx();
  s.write(13081, 0x4000).expect(13081, 0x4003).exchange();
  s.tx(0x270, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x03, 0x40}).no_tx();
  s.write(3081, 0).expect(13081, 0x0003);
}

// T417-31, T417-34, T417-35
TEST(FxCarDoors, StatusAndPosition_OfDoors1To3OfEachLift) {
  RecordProperty("spec", "FX3U-DOOR-007 FX3U-DOOR-009 FX3U-DOOR-010 FX3U-DOOR-011");
  BlockScenario s;
  start_lift_operational(s, 0xFF);
  s.expect(12050, Words(32, 0xFFFF)).expect(12082, Words(32, 0xFFFF)).expect(12114, Words(32, 0x00FF));
  for (std::uint32_t lift = 0; lift < 8; ++lift) {
    for (std::uint32_t door = 0; door < 3; ++door) {
      const auto mm = static_cast<std::uint8_t>(lift * 16 + door);
      s.rx(0x201 + 0x10 * lift + door, {0x55, 0x45, mm, 3}).exchange(0x0100);
      s.expect(12050 + 4 * lift + door, 0x4555)
          .expect(12082 + 4 * lift + door, static_cast<std::uint16_t>(0x0300 | mm));
    }
    s.expect(12053 + 4 * lift, 0xFFFF).expect(12085 + 4 * lift, 0xFFFF);
  }
  // Open and at rest: what the unit says is shown as it is.
  s.rx(0x201, {0xFF, 0x5F, 0, 0}).exchange(0x0100).expect(12050, 0x5FFF).expect(12082, 0).no_tx();
}

// T417-32
TEST(FxCarDoors, LightBarriers) {
  RecordProperty("spec", "FX3U-DOOR-012 FX3U-DOOR-013");
  BlockScenario s;
  start_lift_operational(s, 0xFF);
  for (std::uint32_t lift = 0; lift < 8; ++lift) {
    s.rx(0x205 + 0x10 * lift, {0x7F})
        .rx(0x206 + 0x10 * lift, {0x3F})
        .rx(0x207 + 0x10 * lift, {0xBF})
        .exchange(0x0100);
    s.expect(12114 + 4 * lift, {0x007F, 0x003F, 0x00BF, 0x00FF});
    s.rx(0x205 + 0x10 * lift, {0xFF}).exchange(0x0100).expect(12114 + 4 * lift, 0x00FF);
  }
  s.no_tx();
}

// T417-33
TEST(FxCarDoors, Door4_HasNoPdo) {
  RecordProperty("spec", "FX3U-DOOR-008 FX3U-OD417-009");
  BlockScenario s;
  start_lift_operational(s);
  s.rx(0x204, {0, 0x10, 0, 0}).rx(0x208, {0x7F}).exchange(0x0100);
  s.expect(12053, 0xFFFF).expect(12085, 0xFFFF).expect(12117, 0x00FF);
  s.set_object(0x6301, 4, 0x1000, 2)
      .set_object(0x6302, 4, 800, 2)
      .set_object(0x6310, 4, 0x7F, 1)
      .expect(12053, 0xFFFF);
  s.exchange(0x0100).expect(12053, 0x1000).expect(12085, 800).expect(12117, 0x007F).no_tx();
}

// T417-40
TEST(FxCarDrive, VelocityMode) {
  RecordProperty(
      "spec", "FX3U-DRV-001 FX3U-DRV-004 FX3U-DRV-005 FX3U-DRV-006 FX3U-DRV-008 FX3U-DRV-016 FX3U-DRV-018");
  BlockScenario s;
  start_lift_operational(s, 0xFF);
  for (std::uint32_t lift = 0; lift < 8; ++lift) {
    const std::uint32_t shift = 0x10 * lift;
    const auto pdo = static_cast<std::uint16_t>(0x1902 + shift);
    s.expect(13428 + lift, 0).expect_object(pdo, 1, 0xC0000182 + shift, 4);
    s.write(13436 + lift, 3).write(13492 + 2 * lift, {0x03E8, 0}).write(13428 + lift, 6).exchange().no_tx();
    s.set_object(pdo, 1, 0x40000182 + shift, 4).ignore_tx();
    s.write(13428 + lift, 7).exchange().tx(0x182 + shift, {7, 0, 3, 0, 0xE8, 3, 0, 0});
    s.write(13428 + lift, 0xF).exchange().tx(0x182 + shift, {0xF, 0, 3, 0, 0xE8, 3, 0, 0});
    s.rx(0x183 + shift, {0x37, 6, 3, 0xA5, 0xF4, 1, 0, 0}).exchange().no_tx();
    s.expect(12428 + lift, 0x0637).expect(12436 + lift, 3).expect(12492 + 2 * lift, {500, 0});
    s.rx(0x183 + shift, {0x37, 6, 3, 0, 0x0C, 0xFE, 0xFF, 0xFF}).exchange().no_tx();
    s.expect(12492 + 2 * lift, {0xFE0C, 0xFFFF}).expect(13428 + lift, 0xF);  // no transition of its own
    s.write(13492 + 2 * lift, {0xFC18, 0xFFFF})
        .exchange()
        .tx(0x182 + shift, {0xF, 0, 3, 0, 0x18, 0xFC, 0xFF, 0xFF});
  }
}

// T417-41
TEST(FxCarDrive, ModesAreOneByte) {
  RecordProperty("spec", "FX3U-DRV-010 FX3U-DRV-011");
  BlockScenario s;
  start_lift_operational(s);
  s.set_object(0x1902, 1, 0x40000182, 4).ignore_tx();
  s.write(13436, 0x0103).expect(13436, 0x0003).exchange().tx(0x182, {0, 0, 3, 0, 0, 0, 0, 0});
  s.write(3436, 0xFFFF).expect(13436, 0x00FF).exchange().tx(0x182, {0, 0, 0xFF, 0, 0, 0, 0, 0});
  s.rx(0x183, {0, 0, 0xFF, 0, 0, 0, 0, 0}).exchange().expect(12436, 0x00FF).no_tx();
}

// T417-42
TEST(FxCarDrive, TargetPositionAndProfileVelocity) {
  RecordProperty("spec", "FX3U-DRV-007 FX3U-DRV-015 FX3U-DRV-016");
  BlockScenario s;
  start_lift_operational(s, 0xFF);
  for (std::uint32_t lift = 0; lift < 8; ++lift) {
    const std::uint32_t shift = 0x10 * lift;
    const auto pdo = static_cast<std::uint16_t>(0x1904 + shift);
    s.expect_object(pdo, 1, 0xC0000180 + shift, 4).set_object(pdo, 1, 0x40000180 + shift, 4).ignore_tx();
    s.write(13460 + 2 * lift, {0x2345, 1}).write(13476 + 2 * lift, {0x05DC, 0}).exchange();
    s.tx(0x180 + shift, {0x45, 0x23, 1, 0, 0xDC, 5, 0, 0}).no_tx();
    s.write(13460 + 2 * lift, {0xFFFF, 0xFFFF}).exchange();  // relative, by the control word's bit
    s.tx(0x180 + shift, {0xFF, 0xFF, 0xFF, 0xFF, 0xDC, 5, 0, 0}).no_tx();
  }
}

// T417-43
TEST(FxCarDrive, PositionUnitsAndControlEffort) {
  RecordProperty("spec", "FX3U-DRV-009 FX3U-DRV-012");
  BlockScenario s;
  start_lift_operational(s, 0xFF);
  s.expect(12300, Words(64, 0xFFFF)).expect(12444, Words(16, 0));
  for (std::uint32_t lift = 0; lift < 8; ++lift) {
    for (std::uint32_t unit = 0; unit < 4; ++unit) {
      const auto number = static_cast<std::uint16_t>(lift * 16 + unit);
      s.rx(0x18C + 0x10 * lift + unit, {static_cast<std::uint8_t>(number), 0x27, 1, 0}).exchange(0x0100);
      s.expect(12300 + 8 * lift + 2 * unit, {static_cast<std::uint16_t>(0x2700 | number), 1});
    }
    s.rx(0x181 + 0x10 * lift, {0x9C, 0xFF, 0xFF, 0xFF})
        .exchange(0x0100)
        .expect(12444 + 2 * lift, {0xFF9C, 0xFFFF});
  }
  s.no_tx();
}

// T417-44
TEST(FxCarDrive, ValuesWithoutAPdo_ComeBySdo) {
  RecordProperty("spec", "FX3U-DRV-013 FX3U-DRV-014 FX3U-OD417-009");
  BlockScenario s;
  start_lift_operational(s, 0xFF);
  s.expect(12364, Words(64, 0)).expect(12460, Words(16, 0xFFFF));
  for (std::uint32_t lift = 0; lift < 8; ++lift) {
    const auto index = [lift](std::uint32_t of_lift_1) {
      return static_cast<std::uint16_t>(of_lift_1 + 0x0800 * lift);
    };
    for (std::uint32_t unit = 0; unit < 4; ++unit) {
      const auto sub = static_cast<std::uint8_t>(unit + 1);
      s.set_object(index(0x6390), sub, 100 + unit, 2).set_object(index(0x6391), sub, 0xFF9C - unit, 2);
      s.exchange(0x0100).expect(12364 + 4 * lift + unit, static_cast<std::uint16_t>(100 + unit));
      s.expect(12396 + 4 * lift + unit, static_cast<std::uint16_t>(0xFF9C - unit));
    }
    s.set_object(index(0x6407), 0, 0x00012345, 4).exchange(0x0100).expect(12460 + 2 * lift, {0x2345, 1});
  }
  s.no_tx();
}

// T417-46, T417-47
TEST(FxCarDrive, ControlAndStatusWord_Bits) {
  RecordProperty("spec", "FX3U-DRV-002 FX3U-DRV-003 FX3U-DRV-004");
  BlockScenario s;
  start_lift_operational(s);
  s.set_object(0x1902, 1, 0x40000182, 4).ignore_tx();
  s.write(13428, 0xFFFF).expect(13428, 0xFBFF).exchange().tx(0x182, {0xFF, 0xFB, 0, 0, 0, 0, 0, 0});
  s.write(13428, 0x4000).exchange().tx(0x182, {0, 0x40, 0, 0, 0, 0, 0, 0});  // emergency recall
  s.write(13428, 0x8000).exchange().tx(0x182, {0, 0x80, 0, 0, 0, 0, 0, 0});  // car top inspection
  for (const std::uint16_t status :
       Words{0x0000, 0x0040, 0x0021, 0x0023, 0x0027, 0x0007, 0x000F, 0x0008, 0xFFFF}) {
    s.rx(0x183,
         {static_cast<std::uint8_t>(status), static_cast<std::uint8_t>(status >> 8), 0, 0, 0, 0, 0, 0});
    s.exchange().expect(12428, status).expect(13428, 0x8000).no_tx();
  }
}

// T417-45
TEST(FxCarLoad, LoadAndItsSignals) {
  RecordProperty("spec", "FX3U-LOAD-001 FX3U-LOAD-002 FX3U-LOAD-003 FX3U-LOAD-004 FX3U-LOAD-005");
  BlockScenario s;
  start_lift_operational(s, 0xFF);
  for (std::uint32_t lift = 0; lift < 8; ++lift) {
    s.expect(12508 + 2 * lift, {0xFFFF, 0x0002}).expect(12524 + 2 * lift, {0, 0});
    for (const std::uint8_t signal : Bytes{1, 2, 4, 8, 0xFF}) {
      s.rx(0x188 + 0x10 * lift, {signal, 0x2C, 1}).exchange(0x0100);
      s.expect(12524 + 2 * lift, {signal, 0}).expect(12508 + 2 * lift, {300, 2});
    }
    s.rx(0x188 + 0x10 * lift, {0, 0xFF, 0xFF}).exchange(0x0100).expect(12508 + 2 * lift, 0xFFFF);
    s.set_object(static_cast<std::uint16_t>(0x6480 + 0x0800 * lift), 2, 0x0301, 2);
    s.set_object(static_cast<std::uint16_t>(0x6482 + 0x0800 * lift), 2, 9, 1);
    s.exchange(0x0100).expect(12509 + 2 * lift, 0x0301).expect(12525 + 2 * lift, 9);
  }
  s.no_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_car_controllers_test
