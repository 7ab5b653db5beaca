// `canopus eds show`.

#include "canopus/cli/files/eds_show.hpp"

#include <sstream>

#include <nlohmann/json.hpp>

#include "support/plant_folder.hpp"

namespace canopus::cli::eds_show_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string sections =
    "[1400]\nParameterName=R\nObjectType=9\n[1400sub0]\nDataType=5\nAccessType=ro\nDefaultValue=2\n"
    "[1400sub1]\nDataType=7\nAccessType=rw\nDefaultValue=0x80000301\n"
    "[1400sub2]\nDataType=5\nAccessType=rw\nDefaultValue=3\n"
    "[1800]\nParameterName=T\nObjectType=9\n[1800sub0]\nDataType=5\nAccessType=ro\nDefaultValue=5\n"
    "[1800sub1]\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x180\n"
    "[1800sub2]\nDataType=5\nAccessType=rw\nDefaultValue=254\n"
    "[1800sub3]\nDataType=6\nAccessType=rw\nDefaultValue=55\n"
    "[1800sub5]\nDataType=6\nAccessType=rw\nDefaultValue=100\n"
    "[1A00]\nParameterName=M\nObjectType=9\n[1A00sub0]\nDataType=5\nAccessType=rw\nDefaultValue=1\n"
    "[1A00sub1]\nDataType=7\nAccessType=rw\nDefaultValue=0x20010010\n"
    "[2001]\nParameterName=Offset of \x1B[2J a name that is much longer than any line can be\n"
    "DataType=3\nAccessType=ro\nPDOMapping=1\nDefaultValue=-5\n"
    "[2002]\nParameterName=Text\nDataType=9\nAccessType=const\nDefaultValue=abc\n";

class EdsShow : public support::PlantFolder {
 protected:
  std::vector<std::string> show(std::string_view text, bool json = false) {
    write("x.eds", text);
    TextOutput out;
    TextOutput err;
    exit_code_ = eds_show((folder_ / "x.eds").string(), json, out, err);
    errors_ = shortened(err.text());
    text_ = out.text();
    std::istringstream lines(text_);
    std::vector<std::string> all;
    for (std::string line; std::getline(lines, line);) all.push_back(line);
    return all;
  }
  std::string text_;
  std::string errors_;
};

TEST_F(EdsShow, ObjectsAndPdosInLinesOf80Columns) {
  const auto lines = show(support::device_file(sections));
  EXPECT_EQ(exit_code_, 0) << errors_;
  EXPECT_THAT(lines, Contains("1018H      vendor-ID 00000001H, product 00000002H, revision 00000003H"));
  EXPECT_THAT(lines, Contains("1800:01    UNSIGNED32     rw     180H+node      -         T 1"));
  EXPECT_THAT(lines,
              Contains("2001:00    INTEGER16      ro     -5             TPDO      Offset of \\x1B[2J a .."));
  EXPECT_THAT(lines, Contains("2002:00    VISIBLE_STRING const  \"abc\"          -         Text"));
  EXPECT_THAT(lines, Contains("RPDO1 301H, off, on every 3. SYNC (type 3)"));
  EXPECT_THAT(lines, Contains("TPDO1 180H+node, event-driven (type 254), inhibit 5.5 ms, timer 100 ms"));
  EXPECT_THAT(lines, Contains(HasSubstr("  2001:00  16 bit  Offset of \\x1B[2J")));
  for (const std::string& line : lines) EXPECT_LE(text::columns_of(line), 80U) << line;
  EXPECT_EQ(text_.find('\x1B'), std::string::npos);
}

TEST_F(EdsShow, AsJsonNothingIsCut) {
  const auto lines = show(support::device_file(sections), true);
  ASSERT_EQ(lines.size(), 1U);
  const auto sheet = nlohmann::json::parse(lines[0]);
  EXPECT_EQ(sheet["product_code"], 2);
  const auto& objects = sheet["objects"];
  const auto offset =
      std::ranges::find_if(objects, [](const auto& one) { return one["object"] == "2001:00"; });
  ASSERT_NE(offset, objects.end());
  EXPECT_EQ((*offset)["default"], -5);
  EXPECT_EQ((*offset)["tpdo"], true);
  EXPECT_THAT((*offset)["name"].get<std::string>(), HasSubstr("longer than any line can be"));
  EXPECT_EQ(sheet["pdos"][0]["valid"], false);
  EXPECT_EQ(sheet["pdos"][1]["mapping"][0]["object"], "2001:00");
}

TEST_F(EdsShow, AFileThatIsNone_IsSaidWithItsReason) {
  EXPECT_THAT(show("hello"), IsEmpty());
  EXPECT_EQ(exit_code_, 1);
  EXPECT_THAT(errors_, HasSubstr("x.eds:"));
  TextOutput out;
  TextOutput err;
  EXPECT_EQ(eds_show((folder_ / "none.eds").string(), false, out, err), 2);
  EXPECT_THAT(err.text(), HasSubstr("No such file"));
}

}  // namespace
}  // namespace canopus::cli::eds_show_test
