// Values of many bytes in words: concise DCFs of 1F22H, other DOMAINs.

#include "canopus/client/domain_words.hpp"

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include "canopus/cli/files/eds_command.hpp"
#include "canopus/cli/output/device_names.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"

#include "paths.hpp"

namespace canopus::cli::domain_words_test {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;
using Bytes = std::vector<std::uint8_t>;

std::string encoder_file() { return CANOPUS_SOURCE_DIR "/examples/devices/encoder.eds"; }

TEST(DomainWords, ConciseDcf_ObjectNameValue_AsTheDeviceHasThem) {
  manager::ConciseDcfWriter writer;
  writer.add(0x1017, 0, 500, 2).add(0x1800, 1, 0x40000183, 4).add(0x6000, 0, 1, 2).add(0x2FFF, 7, 0xAB, 1);
  const auto file = device_file_of_names(encoder_file());
  ASSERT_TRUE(file) << file.error();
  const client::DomainWords words =
      client::domain_words(client::concise_dcf_object, writer.file(), (*file)->dictionary.get());
  EXPECT_EQ(words.heading, "concise DCF, 41 bytes, 4 entries");
  EXPECT_EQ(words.problem, "");
  EXPECT_THAT(words.dump, IsEmpty());
  ASSERT_THAT(words.entries, SizeIs(4));
  EXPECT_EQ(words.entries[0].object, "1017:00");
  EXPECT_THAT(words.entries[0].name, HasSubstr("eartbeat"));
  EXPECT_EQ(words.entries[0].value, "500 ms");
  EXPECT_EQ(words.entries[1].value, "40000183H");
  EXPECT_EQ(words.entries[2].name, "Operating parameters") << "the device's own, of CiA 406";
  EXPECT_EQ(words.entries[3].name, "");
  EXPECT_EQ(words.entries[3].value, "ABH");
  const auto lines = client::lines_of(words);
  ASSERT_THAT(lines, SizeIs(5));
  EXPECT_THAT(lines[1], StartsWith("  1017:00  "));
  EXPECT_THAT(lines[1], EndsWith("  500 ms"));
}

TEST(DomainWords, ConciseDcf_WithoutADeviceFile_HasTheNamesOfTheStandard) {
  manager::ConciseDcfWriter writer;
  writer.add(0x1017, 0, 500, 2).add(0x6000, 0, 1, 2);
  const client::DomainWords words = client::domain_words(client::concise_dcf_object, writer.file(), nullptr);
  EXPECT_THAT(words.entries.at(0).name, HasSubstr("eartbeat"));
  EXPECT_EQ(words.entries.at(1).name, "");
}

TEST(DomainWords, ConciseDcf_ThatDoesNotFit_IsSaid_AndItsBytesFromThereOn) {
  manager::ConciseDcfWriter writer;
  Bytes file = writer.add(0x1017, 0, 500, 2).file();
  file[0] = 2;
  file.insert(file.end(), {0x00, 0x60, 1, 0x70, 0x11, 0x01, 0x00, 'a', 'b', 0});
  const client::DomainWords words = client::domain_words(client::concise_dcf_object, file, nullptr);
  EXPECT_THAT(words.entries, SizeIs(1));
  EXPECT_EQ(words.problem, "entry 2 says 70000 bytes, 3 are left");
  EXPECT_THAT(words.dump,
              ElementsAre("0000000D  00 60 01 70 11 01 00 61 62 00                    |.`.p...ab.|"));
  file.resize(13);
  file[0] = 1;
  file.push_back(0x55);
  EXPECT_EQ(client::domain_words(client::concise_dcf_object, file, nullptr).problem,
            "1 byte behind the last entry");
}

TEST(DomainWords, ConciseDcf_OfTooManyEntries_IsCut) {
  manager::ConciseDcfWriter writer;
  for (std::size_t i = 0; i < client::DomainWords::most_entries + 1; ++i) writer.add(0x2000, 0, Bytes{});
  const client::DomainWords words = client::domain_words(client::concise_dcf_object, writer.file(), nullptr);
  EXPECT_THAT(words.entries, SizeIs(client::DomainWords::most_entries));
  EXPECT_EQ(words.entries[0].value, "no bytes");
  EXPECT_EQ(words.problem, "only the first 8192 entries are shown");
}

TEST(DomainWords, OtherDomains_AreSizeAndBytesWithText) {
  const std::string text = "firmware 1.2\n\x01 end";
  const client::DomainWords words = client::domain_words(0x2001, Bytes(text.begin(), text.end()), nullptr);
  EXPECT_EQ(words.heading, "18 bytes");
  EXPECT_THAT(words.dump,
              ElementsAre("00000000  66 69 72 6D 77 61 72 65 20 31 2E 32 0A 01 20 65  |firmware 1.2.. e|",
                          "00000010  6E 64                                            |nd|"));
  const client::DomainWords large = client::domain_words(0x2001, Bytes(70'000, 7), nullptr);
  EXPECT_EQ(large.heading, "70000 bytes, the first 4096 of them");
  EXPECT_THAT(large.dump, SizeIs(256));
  EXPECT_EQ(client::domain_words(0x2001, Bytes{}, nullptr).heading, "0 bytes");
  EXPECT_EQ(client::domain_words(0x2001, Bytes{1}, nullptr).heading, "1 byte");
}

TEST(DomainWords, TextsOfAConciseDcf_ControlNoTerminal) {
  const std::string text = "\x1b[31mred\n";
  manager::ConciseDcfWriter writer;
  writer.add(0x1008, 0, Bytes(text.begin(), text.end())).add(0x1021, 0, Bytes(100, 9));
  const client::DomainWords words = client::domain_words(client::concise_dcf_object, writer.file(), nullptr);
  for (const std::string& line : client::lines_of(words))
    EXPECT_TRUE(std::ranges::all_of(line, [](char c) { return c >= 0x20 && c < 0x7F; })) << line;
  EXPECT_THAT(words.entries.at(1).value, EndsWith(" ... (100 bytes)"));
}

RC_GTEST_PROP(DomainWords, AnyBytes_AreShownWithoutControlCharacters, (const Bytes& bytes)) {
  for (const std::uint16_t index : {client::concise_dcf_object, std::uint16_t{0x2001}}) {
    for (const std::string& line : client::lines_of(client::domain_words(index, bytes, nullptr)))
      RC_ASSERT(std::ranges::all_of(line, [](char c) { return c >= 0x20 && c < 0x7F; }));
  }
}

}  // namespace
}  // namespace canopus::cli::domain_words_test
