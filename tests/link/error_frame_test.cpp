// Error frames as SocketCAN has them, against the numbers of the kernel's own header.

#include "canopus/can/error_frame.hpp"

#include <gtest/gtest.h>
#include <linux/can/error.h>

namespace canopus::can::error_frame_test {
namespace {

constexpr std::uint32_t counters = 0x200;  // CAN_ERR_CNT, which older headers do not have

BusErrorReport found(BusError error, FrameField field, bool transmitter = false, bool dominant = false) {
  return {.error = error,
          .field = field,
          .transmitter = transmitter,
          .dominant = dominant,
          .transmit_errors = transmitter ? std::uint16_t{8} : std::uint16_t{0},
          .receive_errors = transmitter ? std::uint16_t{0} : std::uint16_t{1}};
}

TEST(ErrorFrame, OfEachError_HasTheKernelsClassKindAndPlace) {
  struct Case {
    BusErrorReport report;
    std::uint32_t error_class;
    int kind;
    int location;
  };
  const Case cases[] = {
      {found(BusError::stuff, FrameField::data), 0, CAN_ERR_PROT_STUFF, CAN_ERR_PROT_LOC_DATA},
      {found(BusError::form, FrameField::end_of_frame), 0, CAN_ERR_PROT_FORM, CAN_ERR_PROT_LOC_EOF},
      {found(BusError::crc, FrameField::ack_delimiter), 0, 0, CAN_ERR_PROT_LOC_CRC_SEQ},
      {found(BusError::acknowledgement, FrameField::ack_slot, true), CAN_ERR_ACK, CAN_ERR_PROT_TX,
       CAN_ERR_PROT_LOC_ACK},
      {found(BusError::bit, FrameField::dlc, true, true), 0,
       CAN_ERR_PROT_BIT | CAN_ERR_PROT_BIT1 | CAN_ERR_PROT_TX, CAN_ERR_PROT_LOC_DLC},
      {found(BusError::bit, FrameField::start_of_frame, true, false), 0,
       CAN_ERR_PROT_BIT | CAN_ERR_PROT_BIT0 | CAN_ERR_PROT_TX, CAN_ERR_PROT_LOC_SOF},
  };
  for (const Case& one : cases) {
    const Frame frame = error_frame(one.report);
    EXPECT_EQ(frame.identifier, CAN_ERR_PROT | CAN_ERR_BUSERROR | counters | one.error_class);
    EXPECT_EQ(frame.dlc, CAN_ERR_DLC);
    EXPECT_EQ(frame.data[2], one.kind);
    EXPECT_EQ(frame.data[3], one.location);
    EXPECT_EQ(frame.data[6], one.report.transmitter ? 8 : 0);
    EXPECT_EQ(frame.data[7], one.report.transmitter ? 0 : 1);
  }
}

TEST(ErrorFrame, OfEachField_HasTheKernelsPlace) {
  const std::pair<FrameField, int> places[] = {{FrameField::start_of_frame, CAN_ERR_PROT_LOC_SOF},
                                               {FrameField::identifier_28_21, CAN_ERR_PROT_LOC_ID28_21},
                                               {FrameField::identifier_20_18, CAN_ERR_PROT_LOC_ID20_18},
                                               {FrameField::rtr, CAN_ERR_PROT_LOC_SRTR},
                                               {FrameField::ide, CAN_ERR_PROT_LOC_IDE},
                                               {FrameField::identifier_17_13, CAN_ERR_PROT_LOC_ID17_13},
                                               {FrameField::identifier_12_5, CAN_ERR_PROT_LOC_ID12_05},
                                               {FrameField::identifier_4_0, CAN_ERR_PROT_LOC_ID04_00},
                                               {FrameField::extended_rtr, CAN_ERR_PROT_LOC_RTR},
                                               {FrameField::r1, CAN_ERR_PROT_LOC_RES1},
                                               {FrameField::r0, CAN_ERR_PROT_LOC_RES0},
                                               {FrameField::dlc, CAN_ERR_PROT_LOC_DLC},
                                               {FrameField::data, CAN_ERR_PROT_LOC_DATA},
                                               {FrameField::crc, CAN_ERR_PROT_LOC_CRC_SEQ},
                                               {FrameField::crc_delimiter, CAN_ERR_PROT_LOC_CRC_DEL},
                                               {FrameField::ack_slot, CAN_ERR_PROT_LOC_ACK},
                                               {FrameField::ack_delimiter, CAN_ERR_PROT_LOC_ACK_DEL},
                                               {FrameField::end_of_frame, CAN_ERR_PROT_LOC_EOF},
                                               {FrameField::intermission, CAN_ERR_PROT_LOC_INTERM}};
  for (const auto& [field, place] : places) {
    EXPECT_EQ(error_frame(found(BusError::form, field)).data[3], place) << name(field);
  }
}

TEST(ErrorFrame, OfEachState_HasTheKernelsClassAndFlags) {
  const auto frame = [](ErrorState before, ErrorState state, std::uint16_t transmit, std::uint16_t receive) {
    return error_frame(ControllerReport{.before = before,
                                        .state = state,
                                        .warning = transmit >= 96 || receive >= 96,
                                        .transmit_errors = transmit,
                                        .receive_errors = receive});
  };
  using enum ErrorState;
  EXPECT_EQ(frame(error_active, error_active, 96, 0).identifier, CAN_ERR_CRTL | counters);
  EXPECT_EQ(frame(error_active, error_active, 96, 0).data[1], CAN_ERR_CRTL_TX_WARNING);
  EXPECT_EQ(frame(error_active, error_active, 0, 96).data[1], CAN_ERR_CRTL_RX_WARNING);
  EXPECT_EQ(frame(error_active, error_passive, 128, 0).data[1], CAN_ERR_CRTL_TX_PASSIVE);
  EXPECT_EQ(frame(error_active, error_passive, 0, 130).data[1], CAN_ERR_CRTL_RX_PASSIVE);
  EXPECT_EQ(frame(error_active, error_active, 95, 0).data[1], 0x40);  // CAN_ERR_CRTL_ACTIVE
  EXPECT_EQ(frame(error_passive, bus_off, 256, 0).identifier, CAN_ERR_BUSOFF | counters);
  EXPECT_EQ(frame(error_passive, bus_off, 256, 0).data[6], 255);
  EXPECT_EQ(frame(bus_off, error_active, 0, 0).identifier, CAN_ERR_CRTL | CAN_ERR_RESTARTED | counters);
}

}  // namespace
}  // namespace canopus::can::error_frame_test
