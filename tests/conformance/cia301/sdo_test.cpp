// SDO server, CiA 301 7.2.4: every service, and for each what must not be accepted.

#include "conformance/cia301/script.hpp"

namespace canopus::canopen::sdo_test {
namespace {

class Sdo : public testing::TestWithParam<Case> {};

TEST_P(Sdo, Conversation) {
  Conversation node;
  run(node, GetParam().script);
}

const Case protocol[] = {
    // --- initiate upload
    {"Upload_U32_Expedited", "605 40 00 10 00 00 00 00 00 -> 585 43 00 10 00 91 01 02 00"},
    {"Upload_U16_Expedited", "605 40 21 20 00 00 00 00 00 -> 585 4B 21 20 00 34 12 00 00"},
    {"Upload_U8_Expedited", "605 40 01 10 00 00 00 00 00 -> 585 4F 01 10 00 00 00 00 00"},
    {"Upload_String3_Expedited", "605 40 09 10 00 00 00 00 00 -> 585 47 09 10 00 31 2E 30 00"},
    {"Upload_String9_Segmented",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n"
     "605 60 00 00 00 00 00 00 00 -> 585 00 4D 45 33 43 41 4E 31\n"
     "605 70 00 00 00 00 00 00 00 -> 585 1B 2D 51 00 00 00 00 00"},
    {"Upload_ReservedBytesAreNotLookedAt", "605 40 00 10 00 FF FF FF FF -> 585 43 00 10 00 91 01 02 00"},
    {"Upload_NoObject", "605 40 FF 5F 00 00 00 00 00 -> 585 80 FF 5F 00 00 00 02 06"},
    {"Upload_NoSubIndexOfVariable", "605 40 00 10 01 00 00 00 00 -> 585 80 00 10 01 11 00 09 06"},
    {"Upload_NoSubIndexOfRecord", "605 40 18 10 05 00 00 00 00 -> 585 80 18 10 05 11 00 09 06"},
    {"Upload_NoSubIndexInAGap", "605 40 00 18 04 00 00 00 00 -> 585 80 00 18 04 11 00 09 06"},
    {"Upload_WriteOnly", "605 40 20 20 00 00 00 00 00 -> 585 80 20 20 00 01 00 01 06"},
    {"Upload_DataTypeIndex", "605 40 05 00 00 00 00 00 00 -> 585 80 05 00 00 00 00 02 06"},
    {"Upload_NewInitiateDuringSegments",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n"
     "605 40 00 10 00 00 00 00 00 -> 585 80 08 10 00 01 00 04 05\n"
     "605 40 00 10 00 00 00 00 00 -> 585 43 00 10 00 91 01 02 00"},
    {"Upload_AbortBeforeTheFirstSegment",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n"
     "605 80 08 10 00 00 00 00 08 ->\n"
     "605 60 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"Upload_AbortBetweenSegments",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n"
     "605 60 00 00 00 00 00 00 00 -> 585 00 4D 45 33 43 41 4E 31\n"
     "605 80 08 10 00 00 00 00 08 ->\n"
     "605 70 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"Upload_FirstToggleWrong",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n"
     "605 70 00 00 00 00 00 00 00 -> 585 80 08 10 00 00 00 03 05"},
    {"Upload_SecondToggleWrong",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n"
     "605 60 00 00 00 00 00 00 00 -> 585 00 4D 45 33 43 41 4E 31\n"
     "605 60 00 00 00 00 00 00 00 -> 585 80 08 10 00 00 00 03 05"},
    {"Upload_SegmentAfterTheLast",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n"
     "605 60 00 00 00 00 00 00 00 -> 585 00 4D 45 33 43 41 4E 31\n"
     "605 70 00 00 00 00 00 00 00 -> 585 1B 2D 51 00 00 00 00 00\n"
     "605 60 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"Upload_DownloadSegmentDuringIt",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n"
     "605 00 01 02 03 04 05 06 07 -> 585 80 08 10 00 01 00 04 05"},
    {"Upload_TimeOut",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n"
     "+999ms ->\n+1ms -> 1000: 585 80 08 10 00 00 00 04 05\n+5000ms ->"},
    {"Upload_ValueIsThatOfTheInitiate",
     "605 40 16 20 00 00 00 00 00 -> 585 41 16 20 00 08 00 00 00\n"
     "605 60 00 00 00 00 00 00 00 -> 585 00 00 00 00 00 00 00 00\n"
     "605 70 00 00 00 00 00 00 00 -> 585 1D 00 00 00 00 00 00 00"},

    // --- initiate download
    {"Download_U16_Expedited",
     "605 2B 17 10 00 E8 03 00 00 -> 585 60 17 10 00 00 00 00 00\n"
     "605 40 17 10 00 00 00 00 00 -> 585 4B 17 10 00 E8 03 00 00"},
    {"Download_SizeNotIndicated",
     "605 22 05 20 00 34 12 FF FF -> 585 60 05 20 00 00 00 00 00\n"
     "605 40 05 20 00 00 00 00 00 -> 585 4B 05 20 00 34 12 00 00"},
    {"Download_String_Expedited",
     "605 27 08 20 00 61 62 63 00 -> 585 60 08 20 00 00 00 00 00\n"
     "605 40 08 20 00 00 00 00 00 -> 585 47 08 20 00 61 62 63 00"},
    {"Download_StringSizeNotIndicated_IsFourBytes",
     "605 22 08 20 00 61 62 63 64 -> 585 60 08 20 00 00 00 00 00\n"
     "605 40 08 20 00 00 00 00 00 -> 585 43 08 20 00 61 62 63 64"},
    {"Download_ReadOnly", "605 2B 21 20 00 00 00 00 00 -> 585 80 21 20 00 02 00 01 06"},
    {"Download_Constant", "605 23 08 10 00 61 62 63 64 -> 585 80 08 10 00 02 00 01 06"},
    {"Download_HighestSubIndex", "605 2F 18 10 00 09 00 00 00 -> 585 80 18 10 00 02 00 01 06"},
    {"Download_NoObject", "605 2B FF 5F 00 00 00 00 00 -> 585 80 FF 5F 00 00 00 02 06"},
    {"Download_NoSubIndex", "605 2B 17 10 01 00 00 00 00 -> 585 80 17 10 01 11 00 09 06"},
    {"Download_TooLong", "605 23 17 10 00 00 00 00 00 -> 585 80 17 10 00 12 00 07 06"},
    {"Download_TooShort", "605 2F 17 10 00 00 00 00 00 -> 585 80 17 10 00 13 00 07 06"},
    {"Download_AboveTheHighLimit", "605 2B 22 20 00 65 00 00 00 -> 585 80 22 20 00 31 00 09 06"},
    {"Download_BelowTheLowLimit", "605 2B 22 20 00 9B FF 00 00 -> 585 80 22 20 00 32 00 09 06"},
    {"Download_AtTheHighLimit", "605 2B 22 20 00 64 00 00 00 -> 585 60 22 20 00 00 00 00 00"},
    {"Download_AtTheLowLimit", "605 2B 22 20 00 9C FF 00 00 -> 585 60 22 20 00 00 00 00 00"},
    {"Download_BooleanOfTwo", "605 2F 00 20 00 02 00 00 00 -> 585 80 00 20 00 31 00 09 06"},
    {"Download_WriteOnlyIsWritable", "605 2F 20 20 00 01 00 00 00 -> 585 60 20 20 00 00 00 00 00"},

    // --- segmented download
    {"Segments_SizeIndicated",
     "605 21 16 20 00 08 00 00 00 -> 585 60 16 20 00 00 00 00 00\n"
     "605 00 01 02 03 04 05 06 07 -> 585 20 00 00 00 00 00 00 00\n"
     "605 1D 08 00 00 00 00 00 00 -> 585 30 00 00 00 00 00 00 00"},
    {"Segments_SizeNotIndicated",
     "605 20 16 20 00 00 00 00 00 -> 585 60 16 20 00 00 00 00 00\n"
     "605 00 01 02 03 04 05 06 07 -> 585 20 00 00 00 00 00 00 00\n"
     "605 1D 08 00 00 00 00 00 00 -> 585 30 00 00 00 00 00 00 00"},
    {"Segments_ShortOnesInTheMiddle",
     "605 20 16 20 00 00 00 00 00 -> 585 60 16 20 00 00 00 00 00\n"
     "605 06 01 02 03 04 00 00 00 -> 585 20 00 00 00 00 00 00 00\n"
     "605 17 05 06 07 08 00 00 00 -> 585 30 00 00 00 00 00 00 00\n"
     "605 40 16 20 00 00 00 00 00 -> 585 41 16 20 00 08 00 00 00\n"
     "605 60 00 00 00 00 00 00 00 -> 585 00 01 02 03 04 05 06 07"},
    {"Segments_OfASmallObject",
     "605 21 05 20 00 02 00 00 00 -> 585 60 05 20 00 00 00 00 00\n"
     "605 0B 34 12 00 00 00 00 00 -> 585 20 00 00 00 00 00 00 00\n"
     "605 40 05 20 00 00 00 00 00 -> 585 4B 05 20 00 34 12 00 00"},
    {"Segments_NoData",
     "605 21 08 20 00 00 00 00 00 -> 585 60 08 20 00 00 00 00 00\n"
     "605 0F 00 00 00 00 00 00 00 -> 585 20 00 00 00 00 00 00 00"},
    {"Segments_FirstToggleWrong",
     "605 21 16 20 00 08 00 00 00 -> 585 60 16 20 00 00 00 00 00\n"
     "605 10 01 02 03 04 05 06 07 -> 585 80 16 20 00 00 00 03 05"},
    {"Segments_SecondToggleWrong",
     "605 21 16 20 00 08 00 00 00 -> 585 60 16 20 00 00 00 00 00\n"
     "605 00 01 02 03 04 05 06 07 -> 585 20 00 00 00 00 00 00 00\n"
     "605 0D 08 00 00 00 00 00 00 -> 585 80 16 20 00 00 00 03 05"},
    {"Segments_MoreThanAnnounced",
     "605 21 08 20 00 02 00 00 00 -> 585 60 08 20 00 00 00 00 00\n"
     "605 09 61 62 63 00 00 00 00 -> 585 80 08 20 00 12 00 07 06"},
    {"Segments_FewerThanAnnounced",
     "605 21 08 20 00 04 00 00 00 -> 585 60 08 20 00 00 00 00 00\n"
     "605 09 61 62 63 00 00 00 00 -> 585 80 08 20 00 13 00 07 06"},
    {"Segments_MoreThanTheObjectHolds",
     "605 20 05 20 00 00 00 00 00 -> 585 60 05 20 00 00 00 00 00\n"
     "605 09 61 62 63 00 00 00 00 -> 585 80 05 20 00 12 00 07 06"},
    {"Segments_FewerThanTheObjectHolds",
     "605 20 05 20 00 00 00 00 00 -> 585 60 05 20 00 00 00 00 00\n"
     "605 0D 61 00 00 00 00 00 00 -> 585 80 05 20 00 13 00 07 06"},
    {"Segments_AnnouncedTooLong", "605 21 16 20 00 09 00 00 00 -> 585 80 16 20 00 12 00 07 06"},
    {"Segments_AnnouncedTooShort", "605 21 16 20 00 07 00 00 00 -> 585 80 16 20 00 13 00 07 06"},
    {"Segments_AnnouncedFourGigabytes", "605 21 0A 20 00 FF FF FF FF -> 585 80 0A 20 00 05 00 04 05"},
    {"Segments_ReadOnly", "605 21 21 20 00 02 00 00 00 -> 585 80 21 20 00 02 00 01 06"},
    {"Segments_ReadOnlyWithoutSize", "605 20 21 20 00 00 00 00 00 -> 585 80 21 20 00 02 00 01 06"},
    {"Segments_NoObject", "605 21 FF 5F 00 08 00 00 00 -> 585 80 FF 5F 00 00 00 02 06"},
    {"Segments_NoSubIndex", "605 21 16 20 09 08 00 00 00 -> 585 80 16 20 09 11 00 09 06"},
    {"Segments_LimitsAreCheckedAtTheEnd",
     "605 21 22 20 00 02 00 00 00 -> 585 60 22 20 00 00 00 00 00\n"
     "605 0B FF 7F 00 00 00 00 00 -> 585 80 22 20 00 31 00 09 06"},
    {"Segments_NewInitiateDuringThem",
     "605 21 16 20 00 08 00 00 00 -> 585 60 16 20 00 00 00 00 00\n"
     "605 2B 17 10 00 E8 03 00 00 -> 585 80 16 20 00 01 00 04 05"},
    {"Segments_UploadSegmentDuringThem",
     "605 21 16 20 00 08 00 00 00 -> 585 60 16 20 00 00 00 00 00\n"
     "605 60 00 00 00 00 00 00 00 -> 585 80 16 20 00 01 00 04 05"},
    {"Segments_AbortLeavesTheValue",
     "605 21 16 20 00 08 00 00 00 -> 585 60 16 20 00 00 00 00 00\n"
     "605 00 01 02 03 04 05 06 07 -> 585 20 00 00 00 00 00 00 00\n"
     "605 80 16 20 00 00 00 00 08 ->\n"
     "605 40 16 20 00 00 00 00 00 -> 585 41 16 20 00 08 00 00 00\n"
     "605 60 00 00 00 00 00 00 00 -> 585 00 00 00 00 00 00 00 00"},
    {"Segments_TimeOut",
     "605 21 16 20 00 08 00 00 00 -> 585 60 16 20 00 00 00 00 00\n"
     "+600ms ->\n"
     "605 00 01 02 03 04 05 06 07 -> 585 20 00 00 00 00 00 00 00\n"
     "+999ms ->\n+1ms -> 1600: 585 80 16 20 00 00 00 04 05"},

    // --- block download
    {"BlockDownload_WithSizeAndCrc",
     "605 C6 0A 20 00 0A 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 01 30 31 32 33 34 35 36 ->\n"
     "605 82 37 38 39 00 00 00 00 -> 585 A2 02 7F 00 00 00 00 00\n"
     "605 D1 58 9C 00 00 00 00 00 -> 585 A1 00 00 00 00 00 00 00\n"
     "605 40 0A 20 00 00 00 00 00 -> 585 41 0A 20 00 0A 00 00 00"},
    {"BlockDownload_WithoutSizeAndCrc",
     "605 C0 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 81 30 31 32 00 00 00 00 -> 585 A2 01 7F 00 00 00 00 00\n"
     "605 D1 00 00 00 00 00 00 00 -> 585 A1 00 00 00 00 00 00 00\n"
     "605 40 0A 20 00 00 00 00 00 -> 585 47 0A 20 00 30 31 32 00"},
    {"BlockDownload_OfAFixedObject",
     "605 C2 16 20 00 08 00 00 00 -> 585 A4 16 20 00 7F 00 00 00\n"
     "605 01 01 02 03 04 05 06 07 ->\n"
     "605 82 08 00 00 00 00 00 00 -> 585 A2 02 7F 00 00 00 00 00\n"
     "605 D9 00 00 00 00 00 00 00 -> 585 A1 00 00 00 00 00 00 00"},
    {"BlockDownload_NoObject", "605 C6 FF 5F 00 0A 00 00 00 -> 585 80 FF 5F 00 00 00 02 06"},
    {"BlockDownload_NoSubIndex", "605 C6 0A 20 01 0A 00 00 00 -> 585 80 0A 20 01 11 00 09 06"},
    {"BlockDownload_ReadOnly", "605 C6 21 20 00 02 00 00 00 -> 585 80 21 20 00 02 00 01 06"},
    {"BlockDownload_TooLong", "605 C6 05 20 00 03 00 00 00 -> 585 80 05 20 00 12 00 07 06"},
    {"BlockDownload_TooShort", "605 C6 05 20 00 01 00 00 00 -> 585 80 05 20 00 13 00 07 06"},
    {"BlockDownload_EndWhileIdle", "605 C1 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"BlockDownload_WrongCrc",
     "605 C6 0A 20 00 03 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 81 30 31 32 00 00 00 00 -> 585 A2 01 7F 00 00 00 00 00\n"
     "605 D1 01 00 00 00 00 00 00 -> 585 80 0A 20 00 04 00 04 05"},
    {"BlockDownload_SequenceNumberZero",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 00 30 31 32 33 34 35 36 -> 585 80 0A 20 00 03 00 04 05"},
    {"BlockDownload_GapIsConfirmedUpToIt",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 01 30 31 32 33 34 35 36 ->\n"
     "605 03 30 31 32 33 34 35 36 ->\n"
     "605 84 30 31 32 33 34 35 36 -> 585 A2 01 7F 00 00 00 00 00"},
    {"BlockDownload_RepeatedSegmentIsDropped",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 01 30 31 32 33 34 35 36 ->\n"
     "605 01 30 31 32 33 34 35 36 ->\n"
     "605 82 37 38 39 00 00 00 00 -> 585 A2 02 7F 00 00 00 00 00\n"
     "605 D1 58 9C 00 00 00 00 00 -> 585 A1 00 00 00 00 00 00 00"},
    {"BlockDownload_EarlyConfirmationAfterAPause",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 01 30 31 32 33 34 35 36 ->\n"
     "+250ms -> 250: 585 A2 01 7F 00 00 00 00 00"},
    {"BlockDownload_TimeOut",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "+1000ms -> 1000: 585 80 0A 20 00 00 00 04 05"},
    {"BlockDownload_TimeOutBeforeTheEnd",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 81 30 31 32 00 00 00 00 -> 585 A2 01 7F 00 00 00 00 00\n"
     "+1000ms -> 1000: 585 80 0A 20 00 00 00 04 05"},
    {"BlockDownload_TimeOutWithoutCrc",
     "605 C0 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 01 30 31 32 33 34 35 36 ->\n"
     "+1000ms -> 1000: 585 80 0A 20 00 00 00 04 05"},
    {"BlockDownload_RepeatedLastSegmentIsDropped",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 81 30 31 32 00 00 00 00 -> 585 A2 01 7F 00 00 00 00 00\n"
     "605 81 30 31 32 00 00 00 00 ->\n"
     "605 80 0A 20 00 00 00 00 08 ->"},
    {"BlockDownload_SegmentAfterTheLast",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 81 30 31 32 00 00 00 00 -> 585 A2 01 7F 00 00 00 00 00\n"
     "605 01 30 31 32 00 00 00 00 -> 585 80 0A 20 00 01 00 04 05"},
    {"BlockDownload_AbortAmongSegments",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 80 0A 20 00 00 00 00 08 ->\n"
     "605 01 30 31 32 33 34 35 36 -> 585 80 00 00 00 01 00 04 05"},
    {"BlockDownload_AbortInsteadOfTheEnd",
     "605 C4 0A 20 00 00 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 81 30 31 32 00 00 00 00 -> 585 A2 01 7F 00 00 00 00 00\n"
     "605 80 0A 20 00 00 00 00 08 ->\n"
     "605 40 0A 20 00 00 00 00 00 -> 585 41 0A 20 00 00 00 00 00"},
    {"BlockDownload_FewerThanAnnounced",
     "605 C2 0A 20 00 04 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 81 30 31 32 00 00 00 00 -> 585 A2 01 7F 00 00 00 00 00\n"
     "605 D1 00 00 00 00 00 00 00 -> 585 80 0A 20 00 13 00 07 06"},
    {"BlockDownload_MoreThanAnnounced",
     "605 C2 0A 20 00 02 00 00 00 -> 585 A4 0A 20 00 7F 00 00 00\n"
     "605 81 30 31 32 00 00 00 00 -> 585 A2 01 7F 00 00 00 00 00\n"
     "605 D1 00 00 00 00 00 00 00 -> 585 80 0A 20 00 12 00 07 06"},

    // --- block upload
    {"BlockUpload_WithCrc",
     "605 A4 08 10 00 7F 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31 | 585 82 2D 51 00 00 00 00 00\n"
     "605 A2 02 7F 00 00 00 00 00 -> 585 D5 7F 25 00 00 00 00 00\n"
     "605 A1 00 00 00 00 00 00 00 ->"},
    {"BlockUpload_WithoutCrc",
     "605 A0 08 10 00 7F 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31 | 585 82 2D 51 00 00 00 00 00\n"
     "605 A2 02 7F 00 00 00 00 00 -> 585 D5 00 00 00 00 00 00 00"},
    {"BlockUpload_OneSegmentABlock",
     "605 A0 08 10 00 01 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31\n"
     "605 A2 01 01 00 00 00 00 00 -> 585 81 2D 51 00 00 00 00 00\n"
     "605 A2 01 01 00 00 00 00 00 -> 585 D5 00 00 00 00 00 00 00"},
    {"BlockUpload_NothingArrived_AllAgain",
     "605 A0 08 10 00 7F 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31 | 585 82 2D 51 00 00 00 00 00\n"
     "605 A2 00 7F 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31 | 585 82 2D 51 00 00 00 00 00"},
    {"BlockUpload_LastLost_GoesOnThere",
     "605 A0 08 10 00 7F 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31 | 585 82 2D 51 00 00 00 00 00\n"
     "605 A2 01 7F 00 00 00 00 00 -> 585 81 2D 51 00 00 00 00 00"},
    {"BlockUpload_BlockSizeZero", "605 A0 08 10 00 00 00 00 00 -> 585 80 08 10 00 02 00 04 05"},
    {"BlockUpload_BlockSize128", "605 A0 08 10 00 80 00 00 00 -> 585 80 08 10 00 02 00 04 05"},
    {"BlockUpload_BlockSizeZeroInAConfirmation",
     "605 A0 08 10 00 01 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31\n"
     "605 A2 01 00 00 00 00 00 00 -> 585 80 08 10 00 02 00 04 05"},
    {"BlockUpload_MoreConfirmedThanSent",
     "605 A0 08 10 00 01 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31\n"
     "605 A2 02 01 00 00 00 00 00 -> 585 80 08 10 00 03 00 04 05"},
    {"BlockUpload_NoObject", "605 A0 FF 5F 00 7F 00 00 00 -> 585 80 FF 5F 00 00 00 02 06"},
    {"BlockUpload_WriteOnly", "605 A0 20 20 00 7F 00 00 00 -> 585 80 20 20 00 01 00 01 06"},
    {"BlockUpload_SwitchToExpedited", "605 A0 00 10 00 7F 04 00 00 -> 585 43 00 10 00 91 01 02 00"},
    {"BlockUpload_NoSwitchWithThresholdZero", "605 A0 00 10 00 7F 00 00 00 -> 585 C6 00 10 00 04 00 00 00"},
    {"BlockUpload_SwitchToSegmented", "605 A0 08 10 00 7F 09 00 00 -> 585 41 08 10 00 09 00 00 00"},
    {"BlockUpload_NoSwitchAboveTheThreshold", "605 A0 08 10 00 7F 08 00 00 -> 585 C6 08 10 00 09 00 00 00"},
    {"BlockUpload_StartWhileIdle", "605 A3 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"BlockUpload_ConfirmationWhileIdle", "605 A2 01 7F 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"BlockUpload_EndWhileIdle", "605 A1 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"BlockUpload_ConfirmationInsteadOfStart",
     "605 A0 08 10 00 7F 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A2 00 7F 00 00 00 00 00 -> 585 80 08 10 00 01 00 04 05"},
    {"BlockUpload_StartTwice",
     "605 A0 08 10 00 01 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 80 08 10 00 01 00 04 05"},
    {"BlockUpload_AbortBeforeStart",
     "605 A0 08 10 00 7F 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 80 08 10 00 00 00 00 08 ->\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"BlockUpload_TimeOutBeforeStart",
     "605 A0 08 10 00 7F 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "+1000ms -> 1000: 585 80 08 10 00 00 00 04 05"},
    {"BlockUpload_TimeOutBeforeConfirmation",
     "605 A0 08 10 00 01 00 00 00 -> 585 C6 08 10 00 09 00 00 00\n"
     "605 A3 00 00 00 00 00 00 00 -> 585 01 4D 45 33 43 41 4E 31\n"
     "+1000ms -> 1000: 585 80 08 10 00 00 00 04 05"},

    // --- what is no request
    {"Idle_Abort", "605 80 00 10 00 00 00 04 05 ->"},
    {"Idle_DownloadSegment", "605 00 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"Idle_UploadSegment", "605 60 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"Idle_NetworkIndication", "605 E0 01 00 05 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"OtherNodesRequest", "606 40 00 10 00 00 00 00 00 ->"},
    {"ExtendedFrameOfTheSameNumber", "00000605 40 00 10 00 00 00 00 00 ->"},
    {"RemoteFrame", "605 R8 ->"},
};

INSTANTIATE_TEST_SUITE_P(Protocol, Sdo, testing::ValuesIn(protocol), case_name);

/// Requests of fewer than eight bytes are ignored, and do not disturb a running transfer.
std::vector<Case> short_frames() {
  const std::pair<const char*, const char*> requests[] = {
      {"InitiateUpload", "40 00 10 00 00 00 00 00"}, {"InitiateDownload", "2B 17 10 00 E8 03 00 00"},
      {"UploadSegment", "60 00 00 00 00 00 00 00"},  {"DownloadSegment", "00 01 02 03 04 05 06 07"},
      {"BlockUpload", "A4 08 10 00 7F 00 00 00"},    {"BlockDownload", "C6 0A 20 00 0A 00 00 00"},
  };
  std::vector<Case> cases;
  for (const auto& [name, bytes] : requests) {
    for (const std::size_t length : {0U, 1U, 4U, 7U}) {
      const std::string frame = "605 " + std::string(bytes).substr(0, length * 3);
      cases.push_back({std::string(name) + "_Dlc" + std::to_string(length),
                       frame + " ->\n605 40 00 10 00 00 00 00 00 -> 585 43 00 10 00 91 01 02 00"});
    }
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Dlc, Sdo, testing::ValuesIn(short_frames()), case_name);

struct TypeCase {
  const char* name;
  std::uint16_t index;
  unsigned length;
};
const TypeCase types[] = {
    {"Boolean", 0x2000, 1},    {"Integer8", 0x2001, 1},   {"Integer16", 0x2002, 2},
    {"Integer32", 0x2003, 4},  {"Unsigned8", 0x2004, 1},  {"Unsigned16", 0x2005, 2},
    {"Unsigned32", 0x2006, 4}, {"Real32", 0x2007, 4},     {"TimeOfDay", 0x200B, 6},
    {"Integer24", 0x200C, 3},  {"Real64", 0x200D, 8},     {"Integer40", 0x200E, 5},
    {"Integer48", 0x200F, 6},  {"Integer56", 0x2010, 7},  {"Integer64", 0x2011, 8},
    {"Unsigned24", 0x2012, 3}, {"Unsigned40", 0x2013, 5}, {"Unsigned48", 0x2014, 6},
    {"Unsigned56", 0x2015, 7}, {"Unsigned64", 0x2016, 8}, {"TimeDifference", 0x2017, 6},
};

/// Every data type of a fixed length: read back what was written, refuse one byte more and one byte less.
std::vector<Case> data_types() {
  std::vector<Case> cases;
  for (const TypeCase& type : types) {
    const std::string address = hex(type.index, 2) + " 00";
    const std::uint64_t pattern = 0x0807060504030201;
    const std::string zeros = " 00 00 00 00";
    const auto segmented = [&](unsigned length) { return "605 21" + address + hex(length, 4) + " -> "; };
    const std::string confirmed = "585 60" + address + zeros + "\n";
    std::string script;
    if (type.length <= 4) {
      const unsigned n = (4 - type.length) << 2;
      const std::string value =
          hex(type.length == 4 ? pattern & 0xFFFFFFFF : pattern & ((1ULL << (8 * type.length)) - 1), 4);
      script = "605" + hex(0x23 | n, 1) + address + value + " -> " + confirmed;
      script += "605 40" + address + zeros + " -> 585" + hex(0x43 | n, 1) + address + value;
    } else {
      const unsigned rest = type.length > 7 ? type.length - 7 : 0;
      const unsigned first = type.length - rest;
      const std::string data = hex(pattern & (first == 8 ? ~0ULL : (1ULL << (8 * first)) - 1), 7);
      const unsigned command = (7 - first) << 1 | (rest == 0 ? 1U : 0U);
      const std::string tail = hex(8, 7);
      script = segmented(type.length) + confirmed;
      script += "605" + hex(command, 1) + data + " -> 585 20" + hex(0, 7) + "\n";
      if (rest != 0) script += "605 1D" + tail + " -> 585 30" + hex(0, 7) + "\n";
      script += "605 40" + address + zeros + " -> 585 41" + address + hex(type.length, 4) + "\n";
      script += "605 60" + hex(0, 7) + " -> 585" + hex(command, 1) + data + "\n";
      if (rest != 0) script += "605 70" + hex(0, 7) + " -> 585 1D" + tail + "\n";
    }
    cases.push_back({std::string(type.name) + "_WrittenAndRead", script});
    cases.push_back({std::string(type.name) + "_OneByteMore",
                     segmented(type.length + 1) + "585 80" + address + " 12 00 07 06"});
    cases.push_back({std::string(type.name) + "_OneByteLess",
                     segmented(type.length - 1) + "585 80" + address + " 13 00 07 06"});
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(DataType, Sdo, testing::ValuesIn(data_types()), case_name);

}  // namespace
}  // namespace canopus::canopen::sdo_test
