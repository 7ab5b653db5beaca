// What does not fit in a concise DCF, in words [CiA 302-3].

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include "canopus/manager/boot/concise_dcf.hpp"

namespace canopus::manager::concise_dcf_damage_test {
namespace {

std::string damage_of(const std::vector<std::uint8_t>& file) {
  ConciseDcfReader reader(file);
  while (reader.next()) {
  }
  return reader.damage();
}

TEST(ConciseDcfDamage, SaysWhichEntry_AndWhatIsLeft) {
  ConciseDcfWriter writer;
  writer.add(0x1017, 0, 500, 2).add(0x1400, 1, 0x183, 4);
  std::vector<std::uint8_t> file = writer.file();
  EXPECT_EQ(damage_of(file), "");
  file[0] = 3;
  EXPECT_EQ(damage_of(file), "entry 3 of 3 is not there: the file ends before it");
  std::vector<std::uint8_t> head = file;
  head.insert(head.end(), {0x00, 0x60, 1});
  EXPECT_EQ(damage_of(head), "entry 3 of 3 begins with 7 bytes of index, sub-index and size, 3 are left");
  std::vector<std::uint8_t> size = head;
  size.insert(size.end(), {0x70, 0x11, 0x01, 0x00});
  size.insert(size.end(), 12, 0xAA);
  EXPECT_EQ(damage_of(size), "entry 3 says 70000 bytes, 12 are left");
  size.resize(size.size() - 11);
  EXPECT_EQ(damage_of(size), "entry 3 says 70000 bytes, 1 is left");
  EXPECT_EQ(damage_of({1, 2}), "2 bytes, but the number of entries alone takes 4");
  EXPECT_EQ(damage_of({0xFF, 0xFF, 0xFF, 0xFF}),
            "entry 1 of 4294967295 is not there: the file ends before it");
  for (const std::vector<std::uint8_t>& empty : {std::vector<std::uint8_t>{}, {0}, {0, 0, 0, 0}})
    EXPECT_EQ(damage_of(empty), "");
}

RC_GTEST_PROP(ConciseDcfDamage, IsSaid_WhereAndOnlyWhereAFileIsNotWhole,
              (const std::vector<std::uint8_t>& file)) {
  RC_ASSERT(damage_of(file).empty() == check_concise_dcf(file).has_value());
}

}  // namespace
}  // namespace canopus::manager::concise_dcf_damage_test
