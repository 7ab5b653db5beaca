// The trace of a run's page: lines, filters, transfers as lines, statistics, exports. The frames are written out.
#include "canopus/web/trace/query_engine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::web::query_engine_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using text::Json;

/// {{"filter", "x"}} alone could be an array, too.
struct Wish {
  Wish(std::initializer_list<std::pair<const char*, Json>> fields) {
    for (const auto& [key, value] : fields) object[key] = value;
  }
  Json object = Json::object();
};

class TraceQueryEngineTest : public testing::Test {
 protected:
  void start(std::size_t most = 1'000'000, std::size_t most_bytes = 64U << 20) {
    engine_.emplace(TraceQueryEngine::Use{.names = {},
                                          .buses = {"line1", "line2"},
                                          .bit_rates = {500'000, 125'000},
                                          .most = most,
                                          .most_bytes = most_bytes,
                                          .has_time = [this] { return turns_-- > 0; }});
  }
  void frame(can::Duration at, std::uint32_t identifier, std::initializer_list<std::uint8_t> bytes,
             std::uint16_t bus = 0) {
    const trace::TraceRecord record{
        .time = can::Time{} + at, .channel = bus, .frame = can::data_frame(identifier, bytes)};
    engine_->add({&record, 1});
  }
  /// An upload of 1000:00 of this node.
  void upload(can::Duration at, std::uint8_t node) {
    frame(at, 0x600U + node, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    frame(at + 1ms, 0x580U + node, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00});
  }
  void heartbeats(unsigned count) {
    for (unsigned i = 0; i < count; ++i) frame(i * 10ms, 0x703, {0x05});
  }
  Json look(const Wish& wish) {
    turns_ = 1'000'000;
    auto answer = engine_->answer(wish.object);
    EXPECT_TRUE(answer) << answer.error();
    return answer ? *answer : Json();
  }
  std::string refused(const Wish& wish) {
    const auto answer = engine_->answer(wish.object);
    EXPECT_FALSE(answer);
    return answer ? "" : answer.error();
  }
  std::vector<std::string> texts(const Wish& wish) {
    std::vector<std::string> all;
    for (const Json answer = look(wish); const Json& row : answer["rows"])
      all.push_back(row["text"].get<std::string>());
    return all;
  }
  std::vector<unsigned> numbers(const Wish& wish) {
    std::vector<unsigned> all;
    for (const Json answer = look(wish); const Json& row : answer["rows"])
      all.push_back(row["n"].get<unsigned>());
    return all;
  }

  int turns_ = 0;
  std::optional<TraceQueryEngine> engine_;
};

TEST_F(TraceQueryEngineTest, Line_SaysWhatTheFrameMeans) {
  start();
  frame(1502860us, 0x703, {0x05}, 1);
  const Json answer = look({{"filter", ""}});
  EXPECT_EQ(answer["records"], 1);
  EXPECT_EQ(answer["first"], 0);
  EXPECT_EQ(answer["end"], 1);
  ASSERT_EQ(answer["rows"].size(), 1U);
  const Json& row = answer["rows"][0];
  EXPECT_EQ(row["n"], 0);
  EXPECT_EQ(row["record"], 0);
  EXPECT_DOUBLE_EQ(row["t"].get<double>(), 1.50286);
  EXPECT_EQ(row["bus"], "line2");
  EXPECT_EQ(row["id"], "703");
  EXPECT_EQ(row["service"], "error-control");
  EXPECT_EQ(row["what"], "heartbeat");
  EXPECT_EQ(row["node"], 3);
  EXPECT_EQ(row["text"], "operational");
  EXPECT_EQ(row["data"], "05");
  EXPECT_FALSE(row.contains("trouble"));
}

TEST_F(TraceQueryEngineTest, Transfer_IsALineAtItsEnd_UnlessItsFramesAreWanted) {
  start();
  upload(1s, 4);
  Json answer = look({{"filter", ""}});
  ASSERT_EQ(answer["rows"].size(), 1U);
  EXPECT_EQ(answer["rows"][0]["frames"], 2);
  EXPECT_DOUBLE_EQ(answer["rows"][0]["duration"].get<double>(), 0.001);
  EXPECT_EQ(answer["rows"][0]["record"], 1);
  EXPECT_THAT(answer["rows"][0]["object"].get<std::string>(), HasSubstr("1000:00"));
  EXPECT_FALSE(answer["rows"][0].contains("data"));
  answer = look({{"filter", ""}, {"fold", false}});
  ASSERT_EQ(answer["rows"].size(), 2U);
  EXPECT_EQ(answer["rows"][0]["data"], "4000100000000000");
  EXPECT_EQ(answer["rows"][1]["data"], "4300100092010200");
}

TEST_F(TraceQueryEngineTest, FramesOfATransfer_AreItsOwn) {
  start();
  upload(1s, 4);
  frame(1100ms, 0x604, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});
  frame(1101ms, 0x605, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});  // another node's
  frame(1102ms, 0x704, {0x05});
  frame(1103ms, 0x584, {0x43, 0x18, 0x10, 0x01, 1, 0, 0, 0}, 1);  // of the other bus
  frame(1104ms, 0x584, {0x80, 0x18, 0x10, 0x01, 0, 0, 0x02, 0x06});
  upload(2s, 4);
  const Json answer = look({{"frames", 6}});
  std::vector<std::string> data;
  for (const Json& row : answer["rows"]) data.push_back(row["data"].get<std::string>());
  EXPECT_THAT(data, ElementsAre("4018100100000000", "8018100100000206"));
  EXPECT_TRUE(look({{"frames", 4}})["rows"].empty()) << "no SDO";
  EXPECT_TRUE(look({{"frames", 99}})["rows"].empty()) << "none yet";
  const Json aborted = look({{"filter", "errors"}});
  ASSERT_EQ(aborted["rows"].size(), 1U);
  EXPECT_EQ(aborted["rows"][0]["trouble"], true);
  EXPECT_EQ(look({{"filter", "errors"}, {"fold", false}})["rows"].size(), 1U) << "the frame that says so";
}

TEST_F(TraceQueryEngineTest, NewestLines_OrThoseFromANumberOn) {
  start();
  heartbeats(100);
  EXPECT_THAT(numbers({{"filter", ""}, {"count", 3}}), ElementsAre(97, 98, 99));
  EXPECT_THAT(numbers({{"filter", ""}, {"count", 3}, {"from", 10}}), ElementsAre(10, 11, 12));
  EXPECT_THAT(numbers({{"filter", ""}, {"count", 3}, {"from", 99}}), ElementsAre(97, 98, 99));
  EXPECT_THAT(numbers({{"filter", ""}, {"count", 3}, {"from", 1'000'000}}), ElementsAre(97, 98, 99));
  heartbeats(1);
  EXPECT_THAT(numbers({{"filter", ""}, {"count", 3}, {"from", 10}}), ElementsAre(10, 11, 12));
  heartbeats(300);
  EXPECT_EQ(numbers({{"filter", ""}, {"count", 100'000}}).size(), TraceQueryEngine::most_rows);
  EXPECT_TRUE(numbers({{"filter", "node=9"}}).empty());
}

TEST_F(TraceQueryEngineTest, OldestFrames_AreForgotten_AndNumbersStay) {
  start(5'000);
  heartbeats(20'000);
  const Json answer = look({{"filter", ""}, {"count", 2}});
  EXPECT_GE(answer["records"].get<unsigned>(), 5'000U);
  EXPECT_LE(answer["records"].get<unsigned>(), 5'000U + 2 * TraceStore::block);
  EXPECT_EQ(answer["records"].get<unsigned>() + answer["forgotten"].get<unsigned>(), 20'000U);
  EXPECT_EQ(answer["rows"][1]["record"], 19'999);
  EXPECT_EQ(look({{"filter", ""}, {"count", 1}, {"from", 0}})["rows"][0]["record"], answer["forgotten"]);
  // A query that goes on while frames are forgotten.
  const auto last = answer["rows"][1]["n"].get<unsigned>();
  heartbeats(5'000);
  const Json later = look({{"filter", ""}, {"count", 1}});
  EXPECT_EQ(later["rows"][0]["n"], last + 5'000);
  EXPECT_EQ(later["rows"][0]["record"], 24'999);
  EXPECT_GT(later["first"].get<unsigned>(), 0U);
}

TEST_F(TraceQueryEngineTest, LongWork_IsDoneInTurns) {
  start();
  heartbeats(10'000);
  turns_ = 0;
  auto answer = engine_->answer(Wish{{"filter", "heartbeat"}}.object);
  ASSERT_TRUE(answer);
  EXPECT_DOUBLE_EQ((*answer)["progress"].get<double>(), 0.2);
  EXPECT_EQ((*answer)["end"], TraceQueryEngine::slice);
  turns_ = 1;
  answer = engine_->answer(Wish{{"filter", "heartbeat"}}.object);
  EXPECT_DOUBLE_EQ((*answer)["progress"].get<double>(), 0.6);
  EXPECT_FALSE(look({{"filter", "heartbeat"}}).contains("progress"));
  turns_ = 0;
  answer = engine_->answer(Wish{{"statistics", true}}.object);
  EXPECT_LT((*answer)["progress"].get<double>(), 0.5);
  EXPECT_EQ(look({{"statistics", true}})["channels"][0]["frames"], 10'000);
}

TEST_F(TraceQueryEngineTest, Filters_AreToHoldAll) {
  start();
  heartbeats(2);
  upload(1s, 4);
  frame(2s, 0x000, {0x01, 0x00});
  frame(3s, 0x080, {}, 1);
  EXPECT_THAT(texts({{"filter", "node=3"}}), ElementsAre("operational", "operational"));
  EXPECT_EQ(texts({{"filter", "service=sdo"}}).size(), 1U);
  EXPECT_EQ(texts({{"filter", "!service=sdo,error-control"}}).size(), 2U);
  EXPECT_EQ(texts({{"filter", "bus=line2"}}).size(), 1U);
  EXPECT_EQ(texts({{"filter", "bus=line2 node=3"}}).size(), 0U);
  EXPECT_EQ(texts({{"filter", "object=1000"}}).size(), 1U);
  EXPECT_EQ(texts({{"filter", "id=703"}}).size(), 2U);
  EXPECT_EQ(texts({{"filter", "from=5ms to=1500ms"}}).size(), 2U);
  EXPECT_EQ(texts({{"filter", "OPERational"}}).size(), 2U);
  EXPECT_EQ(texts({{"filter", "sdo"}}).size(), 1U) << "SDO in the line";
  EXPECT_EQ(texts({{"filter", "!operational"}}).size(), 3U);
  EXPECT_EQ(texts({{"filter", "\"heartbeat 3  heartbeat\""}}).size(), 2U) << "with blanks";
  EXPECT_EQ(texts({{"filter", "  "}}).size(), 5U);
}

TEST_F(TraceQueryEngineTest, MistakesOfAFilter_AreSaid) {
  start();
  EXPECT_EQ(refused({{"filter", "service=sdp"}}), "service=sdp: unknown service; did you mean \"sdo\"?");
  EXPECT_THAT(refused({{"filter", "node=128"}}), HasSubstr("node=128: expected a node-ID 1 to 127"));
  EXPECT_THAT(refused({{"filter", "nod=3"}}), HasSubstr("nod=3: expected node, service, object"));
  EXPECT_THAT(refused({{"filter", "node="}}), HasSubstr("expected a value behind the \"=\""));
  EXPECT_THAT(refused({{"filter", "node=3,,4"}}), HasSubstr("expected a value behind the \"=\""));
  EXPECT_THAT(refused({{"filter", "!"}}), HasSubstr("expected a term"));
  EXPECT_THAT(refused({{"filter", "\"half"}}), HasSubstr("second quote"));
  EXPECT_THAT(refused({{"filter", "from=x"}}), HasSubstr("from: "));
  EXPECT_THAT(refused({{"filter", "id=\x1b[2J"}}), testing::Not(HasSubstr("\x1b")));
  EXPECT_THAT(refused({{"filter", std::string(1001, 'x')}}), HasSubstr("at most 1000"));
}

TEST_F(TraceQueryEngineTest, OldQueries_EndWithMoreOfThem_AndCanBeginAgain) {
  start();
  heartbeats(10);
  for (const char* filter : {"", "node=3", "node=4", "id=703", "service=nmt", "heartbeat"})
    look({{"filter", filter}});
  EXPECT_EQ(numbers({{"filter", ""}}).size(), 10U);
}

TEST_F(TraceQueryEngineTest, LinesOfAllFilters_HaveABound_AndTheNewestAreThere) {
  constexpr std::size_t most_bytes = 1U << 20;
  start(1'000'000, most_bytes);
  heartbeats(100'000);
  for (const char* filter : {"", "node=3", "id=703", "heartbeat"}) {
    const Json answer = look({{"filter", filter}, {"count", 1}});
    EXPECT_FALSE(answer.contains("progress"));
    EXPECT_LE(engine_->bytes(), most_bytes) << filter;
    EXPECT_GT(engine_->bytes(), most_bytes / 2) << filter;
    EXPECT_EQ(answer["end"], 100'000);
    EXPECT_GT(answer["first"].get<unsigned>(), 0U) << "the oldest lines have gone";
    EXPECT_EQ(answer["rows"][0]["record"], 99'999);
  }
}

TEST_F(TraceQueryEngineTest, AMillionFrames_AreShownWhole) {
  start();
  heartbeats(1'000'000);
  EXPECT_EQ(look({{"filter", ""}, {"count", 1}})["first"], 0);
}

TEST_F(TraceQueryEngineTest, AFilterThatIsNotLookedAt_IsNotKept) {
  start(5'000);
  heartbeats(5'000);
  (void)look({{"filter", "heartbeat"}});
  const std::size_t of_one = engine_->bytes();
  EXPECT_GT(of_one, 5'000U * 32);
  for (std::size_t i = 0; i <= TraceQueryEngine::most_unasked; ++i) (void)look({{"filter", "node=9"}});
  EXPECT_EQ(engine_->bytes(), 0U) << "others are looked at";
  (void)look({{"filter", "heartbeat"}});
  EXPECT_EQ(engine_->bytes(), of_one);
  heartbeats(20'000);
  EXPECT_EQ(engine_->bytes(), 0U) << "all its frames have gone";
}

TEST_F(TraceQueryEngineTest, WhatDistinctObjectsAreCalled_GoesWithTheirLines) {
  start(5'000);
  std::size_t after_some = 0;
  for (unsigned i = 0; i < 100'000; ++i) {
    const auto low = static_cast<std::uint8_t>(i);
    const auto high = static_cast<std::uint8_t>(i >> 8);
    frame(i * 2ms, 0x604, {0x40, low, high, 0x00, 0, 0, 0, 0});
    frame(i * 2ms + 1ms, 0x584, {0x43, low, high, 0x00, 0, 0, 0, 0});
    if (i % 2'000 != 1'999) continue;
    (void)look({{"filter", ""}});
    if (i < 20'000) after_some = std::max(after_some, engine_->bytes());
  }
  EXPECT_LE(engine_->bytes(), after_some);
}

TEST_F(TraceQueryEngineTest, Statistics_AreThoseOfTheAnalyser) {
  start(5'000);
  for (unsigned i = 0; i < 10; ++i) upload(i * 1s, 4);
  heartbeats(3);
  const Json figures = look({{"statistics", true}});
  EXPECT_EQ(figures["services"]["sdo"], 20);
  EXPECT_EQ(figures["channels"][0]["frames"], 23);
  EXPECT_GT(figures["channels"][0]["load"].get<double>(), 0);
  EXPECT_EQ(figures["channels"][0]["nodes"][1]["sdo"]["reads"], 10);
  heartbeats(20'000);
  const Json later = look({{"statistics", true}});
  EXPECT_EQ(later["services"]["sdo"], 0) << "what is forgotten does not count";
}

/// Without padding in between: digits of RFC 4648.
std::string from_base64(const std::string& text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xFF);
  }
  return bytes;
}

TEST_F(TraceQueryEngineTest, Export_HasTheFramesOfTheFilter_InParts) {
  start();
  heartbeats(2);
  upload(1s, 4);
  auto row = engine_->export_part(Wish{{"filter", "service=sdo"}, {"format", "candump"}, {"part", 0}}.object);
  ASSERT_TRUE(row) << row.error();
  EXPECT_EQ((*row)["frames"], 2);
  EXPECT_EQ((*row)["done"], true);
  EXPECT_DOUBLE_EQ((*row)["at"].get<double>(), 1);
  EXPECT_EQ(
      from_base64((*row)["data"].get<std::string>()),
      "(0000000001.000000) line1 604#4000100000000000\n(0000000001.001000) line1 584#4300100092010200\n");
  heartbeats(40'000);
  std::string all;
  unsigned parts = 0;
  for (bool done = false; !done; ++parts) {
    row = engine_->export_part(Wish{{"filter", ""}, {"format", "candump"}, {"part", parts}}.object);
    ASSERT_TRUE(row) << row.error();
    all += from_base64((*row)["data"].get<std::string>());
    done = (*row)["done"].get<bool>();
  }
  EXPECT_EQ(parts, 3U);
  EXPECT_EQ(std::ranges::count(all, '\n'), 40'004);
}

TEST_F(TraceQueryEngineTest, ExportThatCannotBe_IsRefused) {
  start();
  heartbeats(40'000);
  const auto error = [&](const Wish& wish) { return engine_->export_part(wish.object).error(); };
  EXPECT_THAT(error({{"part", 0}}), HasSubstr("\"format\" is to be"));
  EXPECT_THAT(error({{"part", 0}, {"format", "blf"}}), HasSubstr("\"format\" is to be"));
  EXPECT_THAT(error({{"part", 0}, {"format", "csv"}, {"filter", "x=1"}}), HasSubstr("x=1"));
  EXPECT_THAT(error({{"format", "csv"}}), HasSubstr("\"part\""));
  EXPECT_THAT(error({{"part", 1}, {"format", "csv"}}), HasSubstr("another export"));
  ASSERT_TRUE(engine_->export_part(Wish{{"part", 0}, {"format", "csv"}}.object));
  ASSERT_TRUE(engine_->export_part(Wish{{"part", 1}, {"format", "csv"}}.object));
  EXPECT_THAT(error({{"part", 1}, {"format", "csv"}}), HasSubstr("another export"));
}

TEST_F(TraceQueryEngineTest, ErrorFrames_AreLines_AndNoSdo) {
  start();
  const trace::TraceRecord record{.time = can::Time{} + 1s,
                                  .error_frame = true,
                                  .frame = can::data_frame(0x004, {0, 0x10, 0, 0, 0, 0, 0, 0})};
  engine_->add({&record, 1});
  const Json answer = look({{"filter", "errors"}});
  ASSERT_EQ(answer["rows"].size(), 1U);
  EXPECT_EQ(answer["rows"][0]["service"], "error-frame");
  EXPECT_EQ(answer["rows"][0]["trouble"], true);
}

RC_GTEST_FIXTURE_PROP(TraceQueryEngineTest, AnyWishAndAnyFrames_AreSurvived, ()) {
  start(5'000);
  turns_ = 1'000'000;
  for (const auto& [identifier, data] :
       *rc::gen::container<std::vector<std::pair<std::uint32_t, std::uint64_t>>>(
           rc::gen::pair(rc::gen::inRange<std::uint32_t>(0, 0x800), rc::gen::arbitrary<std::uint64_t>()))) {
    trace::TraceRecord record{
        .frame = {.identifier = identifier, .dlc = static_cast<std::uint8_t>(data & 15)}};
    for (std::size_t i = 0; i < record.frame.length(); ++i)
      record.frame.data[i] = static_cast<std::uint8_t>(data >> (8 * i));
    engine_->add({&record, 1});
  }
  const auto filter = *rc::gen::string<std::string>();
  Json wish{{"filter", filter}, {"fold", *rc::gen::arbitrary<bool>()}, {"from", *rc::gen::inRange(0, 100)}};
  (void)engine_->answer(wish);
  (void)engine_->answer(Wish{{"filter", ""}, {"from", *rc::gen::inRange(0, 100)}, {"fold", false}}.object);
  (void)engine_->answer(Wish{{"frames", *rc::gen::inRange(0, 100)}}.object);
  (void)engine_->answer(Wish{{"statistics", 1}}.object);
  (void)engine_->export_part(Wish{{"filter", filter}, {"part", 0}, {"format", "pcapng"}}.object);
}

TEST_F(TraceQueryEngineTest, At_IsTheFirstLineAtOrAfterAMoment) {
  start();
  heartbeats(10'000);  // one every 10 ms
  const auto at = [&](double seconds) { return look({{"at", seconds}, {"count", 30}}); };
  EXPECT_EQ(at(50)["at"], 5000);
  EXPECT_EQ(at(50)["from"], 4990) << "a third of what is shown was before it";
  EXPECT_EQ(at(50.001)["at"], 5001);
  EXPECT_EQ(at(0)["at"], 0);
  EXPECT_EQ(at(-5)["at"], 0);
  EXPECT_EQ(at(1e300)["at"], 10'000) << "there is none";
  EXPECT_EQ(at(1e300)["from"], 9970);
  const Json filtered = look({{"filter", "node=4"}, {"at", 1}});
  EXPECT_EQ(filtered["at"], 0);
  EXPECT_EQ(filtered["rows"].size(), 0U);
}

TEST_F(TraceQueryEngineTest, AbortCodes_AreAFilter) {
  start();
  upload(1s, 4);
  frame(2s, 0x604, {0x40, 0xFF, 0x2F, 0x01, 0, 0, 0, 0});
  frame(2001ms, 0x584, {0x80, 0xFF, 0x2F, 0x01, 0x00, 0x00, 0x02, 0x06});
  EXPECT_EQ(look({{"filter", "abort=06020000"}})["end"], 1);
  EXPECT_EQ(look({{"filter", "abort=0x6020000,05040000"}})["end"], 1);
  EXPECT_EQ(look({{"filter", "abort=05040000"}})["end"], 0);
  EXPECT_EQ(look({{"filter", "!abort=06020000"}})["end"], 1) << "what was not aborted";
  EXPECT_EQ(refused({{"filter", "abort=x"}}),
            "abort=x: expected an abort code in hexadecimal digits, 0 to FFFFFFFF");
}

}  // namespace
}  // namespace canopus::web::query_engine_test
