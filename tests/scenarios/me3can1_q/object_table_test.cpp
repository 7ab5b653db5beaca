// Every row of spec/me3can1-q/od.csv against the running module, by SDO over the bus: type, default, access,
// length, persistence (1010H), and what may be mapped into a PDO.

#include <set>

#include "scenarios/me3can1_q/scenario.hpp"
#include "support/spec_table.hpp"

namespace canopus::scenario::me3can1_q_object_table_test {
namespace {

constexpr std::uint8_t node_id = 5;

enum Abort : std::uint32_t {
  done = 0,
  write_only = 0x06010001,
  read_only = 0x06010002,
  no_object = 0x06020000,
  not_mappable = 0x06040041,
  too_long = 0x06070012,
  too_short = 0x06070013,
  no_sub_index = 0x06090011,
  not_now = 0x08000022,
  not_stored = 0x08000020,
};

struct Answer {
  std::uint32_t abort = done;
  Bytes value;

  [[nodiscard]] std::uint64_t number() const {
    std::uint64_t result = 0;
    for (std::size_t i = value.size(); i-- > 0;) result = result << 8 | value[i];
    return result;
  }
};

// SDO as CiA 301 draws it, frame by frame.
class Client {
 public:
  explicit Client(IntelligentScenario& s) : s_(&s) {}

  Answer upload(std::uint16_t index, std::uint8_t sub) {
    const Bytes begin = transfer({0x40, low(index), high(index), sub, 0, 0, 0, 0});
    if (begin[0] == 0x80) return {code(begin), {}};
    if ((begin[0] & 2) != 0) return {done, {begin.begin() + 4, begin.end() - (begin[0] >> 2 & 3)}};
    Answer answer;
    for (std::uint8_t toggle = 0;; toggle ^= 0x10) {
      const Bytes segment = transfer({static_cast<std::uint8_t>(0x60 | toggle), 0, 0, 0, 0, 0, 0, 0});
      if (segment[0] == 0x80) return {code(segment), {}};
      answer.value.insert(answer.value.end(), segment.begin() + 1, segment.end() - (segment[0] >> 1 & 7));
      if ((segment[0] & 1) != 0) return answer;
    }
  }
  std::uint32_t download(std::uint16_t index, std::uint8_t sub, std::uint64_t value, std::size_t length) {
    Bytes request{
        static_cast<std::uint8_t>(0x23 | (4 - length) << 2), low(index), high(index), sub, 0, 0, 0, 0};
    for (std::size_t i = 0; i < length; ++i)
      request[4 + i] = static_cast<std::uint8_t>(value >> (8 * i) & 0xFF);
    const Bytes answer = transfer(request);
    return answer[0] == 0x80 ? code(answer) : std::uint32_t{done};
  }

 private:
  static std::uint8_t low(std::uint16_t word) { return static_cast<std::uint8_t>(word & 0xFF); }
  static std::uint8_t high(std::uint16_t word) { return static_cast<std::uint8_t>(word >> 8); }
  static std::uint32_t code(const Bytes& frame) {
    return static_cast<std::uint32_t>(frame[4]) | static_cast<std::uint32_t>(frame[5]) << 8 |
           static_cast<std::uint32_t>(frame[6]) << 16 | static_cast<std::uint32_t>(frame[7]) << 24;
  }
  Bytes transfer(const Bytes& request) {
    s_->rx(0x600 + node_id, request);
    for (auto& sent = s_->controller().sent; !sent.empty();) {
      const can::Frame frame = sent.front();
      sent.pop_front();
      if (frame.identifier == 0x580U + node_id) return {frame.data.begin(), frame.data.begin() + 8};
    }
    ADD_FAILURE() << "no answer to " << text(can::data_frame(0x600 + node_id, request));
    return {0x80, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF};
  }

  IntelligentScenario* s_;
};

struct Row : SpecRow {
  std::uint16_t first, last;
  std::uint8_t sub_first, sub_last;

  [[nodiscard]] const std::string& type() const { return (*this)["data_type"]; }
  [[nodiscard]] std::string access() const { return (*this)["access"]; }
  /// Bytes; 0 = as long as its value.
  [[nodiscard]] std::size_t length() const {
    if (type() == "U8" || type() == "I8") return 1;
    if (type() == "U16" || type() == "I16") return 2;
    if (type() == "U32" || type() == "I32" || type() == "Real32") return 4;
    return 0;
  }
  [[nodiscard]] bool is_string() const { return type().starts_with("VISIBLE_STRING"); }

  /// The default as the column's formula has it.
  [[nodiscard]] std::optional<std::uint64_t> initial(std::uint16_t index, std::uint8_t sub) const {
    const std::string& formula = (*this)["default"];
    if (formula.starts_with("n=index-")) {  // n=index-1600H; m=4*n+sub-1; (A580H + m div 254)<<16 | ... | 10H
      const unsigned base = first == 0x1600 ? 0xA580 : 0xA100;
      const unsigned m = 4U * (index - first) + sub - 1U;
      return (std::uint64_t{base} + m / 254) << 16 | (m % 254 + 1) << 8 | 0x10;
    }
    if (formula == "4000+10*node") return 4000 + 10 * node_id;
    const std::size_t plus = formula.find('+');
    const auto number = spec_number(formula.substr(0, plus));
    if (!number) return {};
    const std::string added = plus == std::string::npos ? "" : formula.substr(plus + 1);
    EXPECT_TRUE(added.empty() || added == "node" || added == "sub") << place;
    return static_cast<std::uint64_t>(*number) + (added == "node" ? node_id : added == "sub" ? sub : 0U);
  }

  template <typename Use>
  void for_each(Use use) const {
    for (unsigned index = first; index <= last; ++index) {
      for (unsigned sub = sub_first; sub <= sub_last; ++sub) {
        use(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub));
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
};

std::vector<Row> od() {
  std::vector<Row> rows;
  for (const SpecRow& spec : spec_rows("me3can1-q", "od.csv")) {
    rows.push_back({spec, static_cast<std::uint16_t>(spec.number("index_first", 16)),
                    static_cast<std::uint16_t>(spec.number("index_last", 16)),
                    static_cast<std::uint8_t>(spec.number("sub_first", 16)),
                    static_cast<std::uint8_t>(spec.number("sub_last", 16))});
  }
  return rows;
}

/// Highest sub-index of each index that exists.
std::map<std::uint16_t, unsigned> highest_subs(const std::vector<Row>& rows) {
  std::map<std::uint16_t, unsigned> highest;
  for (const Row& row : rows) {
    if (row.access() == "none") continue;
    for (unsigned index = row.first; index <= row.last; ++index) {
      unsigned& sub = highest[static_cast<std::uint16_t>(index)];
      sub = std::max<unsigned>(sub, row.sub_last);
    }
  }
  return highest;
}

std::string at(const Row& row, std::uint16_t index, std::uint8_t sub) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), " %04X/%02X", index, sub);
  return row.place + text.data();
}

TEST(Me3ObjectTable, EveryRow_HasItsDefault_ItsLength_AndItsReadAccess) {
  RecordProperty(
      "spec", "ME3-OD-001 ME3-OD-003 ME3-OD-012 ME3-PDO-001 ME3-PDO-002 ME3-PDO-003 ME3-PRO-001 ME3-PRO-002");
  const auto rows = od();
  const auto highest = highest_subs(rows);
  IntelligentScenario s;
  s.power_on_as(node_id);
  Client client(s);
  for (const Row& row : rows) {
    row.for_each([&](std::uint16_t index, std::uint8_t sub) {
      const Answer answer = client.upload(index, sub);
      if (row.access() == "none") {
        ASSERT_EQ(answer.abort, highest.contains(index) ? no_sub_index : no_object) << at(row, index, sub);
        return;
      }
      if (row.access() == "wo") {
        ASSERT_EQ(answer.abort, write_only) << at(row, index, sub);
        return;
      }
      ASSERT_EQ(answer.abort, done) << at(row, index, sub);
      if (row.is_string()) {
        ASSERT_EQ(std::string(answer.value.begin(), answer.value.end()), row["default"])
            << at(row, index, sub);
        ASSERT_EQ("VISIBLE_STRING[" + std::to_string(answer.value.size()) + "]", row.type());
        return;
      }
      if (row.type() == "DOMAIN") {
        ASSERT_TRUE(answer.value.empty()) << at(row, index, sub);
        return;
      }
      ASSERT_EQ(answer.value.size(), row.length()) << at(row, index, sub);
      if (index == 0x1F82 && sub == node_id) return;  // the own state
      const auto initial = row.initial(index, sub);
      ASSERT_TRUE(initial) << row.place << ": default " << row["default"];
      ASSERT_EQ(answer.number(), *initial) << at(row, index, sub);
    });
  }
  // Nothing behind the last sub-index of an object, nothing between the rows.
  unsigned between = 0;
  for (unsigned index = 0; index <= 0xFFFF; ++index) {
    const auto found = highest.find(static_cast<std::uint16_t>(index));
    if (found == highest.end()) {
      if (index % 7 == 0 || highest.contains(static_cast<std::uint16_t>(index - 1))) {
        ASSERT_EQ(client.upload(static_cast<std::uint16_t>(index), 0).abort, no_object) << std::hex << index;
        ++between;
      }
    } else {
      ASSERT_EQ(client.upload(found->first, static_cast<std::uint8_t>(found->second + 1)).abort, no_sub_index)
          << std::hex << index;
      ASSERT_EQ(client.upload(found->first, 0xFF).abort, no_sub_index) << std::hex << index;
    }
  }
  EXPECT_GT(between, 1000U);
}

// What a write of the default value comes to, where it is not simply taken.
std::uint32_t answer_to_default(const Row& row, std::uint16_t index, std::uint8_t sub) {
  if (row.access() == "ro") return read_only;
  if (index == 0x1010 || index == 0x1011) return not_stored;  // 1 is not the signature
  const bool mapping = (index >= 0x1600 && index <= 0x16FF) || (index >= 0x1A00 && index <= 0x1AFF);
  // No mapping of a PDO that is valid can be changed, and no entry as long as the number is not 0 [4.6.5].
  if (mapping && index % 0x100 < 4) return not_now;
  if (mapping && sub > 0) return 0x06010000;
  if (index == 0x1F25) return not_stored;                  // 0 is not the signature
  if (index == 0x1F82 || index == 0x1F83) return not_now;  // NMT slave
  return done;
}

TEST(Me3ObjectTable, EveryRow_TakesWritesOfItsLength_OrIsReadOnly) {
  RecordProperty("spec", "ME3-OD-004 ME3-OD-005");
  const auto rows = od();
  IntelligentScenario s;
  s.power_on_as(node_id);
  Client client(s);
  for (const Row& row : rows) {
    if (row.length() == 0 || row.access() == "none") continue;
    row.for_each([&](std::uint16_t index, std::uint8_t sub) {
      const std::uint64_t value =
          index == 0x1F82 && row.access() != "ro" ? 5 : row.initial(index, sub).value_or(0);
      const std::uint32_t expected = answer_to_default(row, index, sub);
      ASSERT_EQ(client.download(index, sub, value, row.length()), expected) << at(row, index, sub);
      if (row.length() > 1) {
        ASSERT_EQ(client.download(index, sub, value, row.length() - 1),
                  expected == read_only ? read_only : too_short)
            << at(row, index, sub);
      }
      if (row.length() < 4) {
        ASSERT_EQ(client.download(index, sub, value, row.length() + 1),
                  expected == read_only ? read_only : too_long)
            << at(row, index, sub);
      }
      if (row.access() == "rw" && index != 0x1F82) {
        ASSERT_EQ(client.upload(index, sub).number(), *row.initial(index, sub)) << at(row, index, sub);
      }
    });
  }
  for (const Row& row : rows) {  // strings
    if (!row.is_string()) continue;
    EXPECT_EQ(client.download(row.first, 0, 'x', 1), read_only) << row.place;
  }
  s.ignore_tx();
}

// --- persistence

/// A value that the object takes and that is not its default.
std::uint32_t another_value(std::uint16_t index, std::uint8_t sub) {
  switch (index) {
    case 0x1005: return 0x81;
    case 0x1012: return 0x00000100;
    case 0x1016: return sub << 16 | 60000U;
    case 0x1028: return 0x80000080U + sub;
    case 0x1029: return 1;
    case 0x1F80: return 0x40;  // bit 0 stays 0: a slave
    case 0x1F81: return 0x00640305;
    case 0x1F90: return 2;
    default: break;
  }
  const unsigned pdo = index & 0xFF;
  switch (index & 0xFF00) {
    case 0x1400: return sub == 1 ? 0x80000220 : 1;
    case 0x1800: return sub == 1 ? 0xC00001A0 : 10;
    case 0x1600: return sub == 0 ? 8 : 0xA4C00008U | (pdo % 200 + 1) << 8;
    case 0x1A00: return sub == 0 ? 8 : 0xA0400008U | (pdo % 200 + 1) << 8;
    default: return 7;
  }
}

TEST(Me3ObjectTable, EveryRow_IsStoredOrNot_AsItSays) {
  RecordProperty("spec", "ME3-STO-001 ME3-STO-008 ME3-STO-003 ME3-ID-001");
  const auto rows = od();
  IntelligentScenario s;
  s.power_on_as(node_id);
  Client client(s);
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t> written;
  const auto write = [&](std::uint16_t index, std::uint8_t sub, std::size_t length) {
    const std::uint32_t value = another_value(index, sub);
    ASSERT_EQ(client.download(index, sub, value, length), done) << std::hex << index << '/' << int{sub};
    written[{index, sub}] = value;
  };
  for (const Row& row : rows) {  // PDOs that exist cannot be changed: bit 31 first
    const bool is_pdo = row.first / 0x100 == 0x14 || row.first / 0x100 == 0x18;
    if (!is_pdo || row.sub_first != 1) continue;
    row.for_each([&](std::uint16_t index, std::uint8_t sub) { write(index, sub, 4); });
  }
  for (const Row& row : rows) {
    if (row["persisted"] != "yes" || row.first == 0x1020) continue;
    ASSERT_EQ(row.access(), "rw") << row.place;
    const bool mapping = row.first == 0x1600 || row.first == 0x1A00;
    if (mapping && row.sub_first == 0) continue;  // after its entries
    row.for_each([&](std::uint16_t index, std::uint8_t sub) {
      if (mapping && sub == 1) {
        ASSERT_EQ(client.download(index, 0, 0, 1), done);
      }
      write(index, sub, row.length());
      if (mapping && sub == 8) write(index, 0, 1);
    });
  }
  // Output variables are written, too; they are not stored. Nor is the history.
  for (const Row& row : rows) {
    if (row["persisted"] != "no" || row.access() != "rw" || row.first < 0xA000) continue;
    row.for_each([&](std::uint16_t index, std::uint8_t sub) {
      ASSERT_EQ(client.download(index, sub, 7, row.length()), done) << at(row, index, sub);
      ASSERT_EQ(client.upload(index, sub).number(), 7U) << at(row, index, sub);
    });
  }
  ASSERT_EQ(client.download(0x1F22, 9, 0x11, 4), done);
  s.cif({0x000A, 0x1000, 0x0001, 0, 0});
  ASSERT_EQ(client.download(0x1020, 1, 5, 4), done);  // last: any other change makes it 0
  ASSERT_EQ(client.download(0x1020, 2, 6, 4), done);
  written[{0x1020, 1}] = 5;
  written[{0x1020, 2}] = 6;
  ASSERT_EQ(client.download(0x1010, 1, 0x65766173, 4), done);
  s.ignore_tx().supply_off();
  s.power_on();

  unsigned stored = 0;
  for (const Row& row : rows) {
    if (row.access() == "none" || row.access() == "wo" || row.length() == 0) continue;
    row.for_each([&](std::uint16_t index, std::uint8_t sub) {
      if (index == 0x1F82 && sub == node_id) return;
      const Answer answer = client.upload(index, sub);
      ASSERT_EQ(answer.abort, done) << at(row, index, sub);
      if (row["persisted"] == "yes") {
        ++stored;
        ASSERT_TRUE(written.contains({index, sub})) << at(row, index, sub);
        ASSERT_EQ(answer.number(), (written[{index, sub}])) << at(row, index, sub);
        ASSERT_NE(answer.number(), *row.initial(index, sub)) << at(row, index, sub);
      } else {
        ASSERT_EQ(answer.number(), *row.initial(index, sub)) << at(row, index, sub);
      }
    });
  }
  EXPECT_GT(stored, 5000U);
  EXPECT_EQ(client.upload(0x1F22, 9).value, (Bytes{0x11, 0, 0, 0}));  // in its own store
  s.ignore_tx();
}

// --- mapping

TEST(Me3ObjectTable, EveryRow_CanBeMappedOrNot_AsItSays) {
  RecordProperty("spec", "ME3-PDO-005 ME3-PDO-006 ME3-OD-002");
  const auto rows = od();
  const auto highest = highest_subs(rows);
  IntelligentScenario s;
  s.power_on_as(node_id);
  Client client(s);
  ASSERT_EQ(client.download(0x16FF, 0, 0, 1), done);
  ASSERT_EQ(client.download(0x1AFF, 0, 0, 1), done);
  for (const Row& row : rows) {
    const std::string& mappable = row["pdo_mappable"];
    for (const std::uint16_t index : std::set<std::uint16_t>{row.first, row.last}) {
      for (const std::uint8_t sub : std::set<std::uint8_t>{row.sub_first, row.sub_last}) {
        const std::size_t bits = row.length() == 0 ? 8 : 8 * row.length();
        const std::uint32_t entry =
            static_cast<std::uint32_t>(index) << 16 | sub << 8U | static_cast<std::uint32_t>(bits);
        const bool exists = highest.contains(index) && row.access() != "none";
        const std::uint32_t refused = exists || mappable == "RPDO dummy" ? not_mappable
                                      : highest.contains(index)          ? no_sub_index
                                                                         : no_object;
        const bool into_rpdo = mappable == "RPDO" || mappable == "RPDO dummy";
        EXPECT_EQ(client.download(0x16FF, 1, entry, 4), into_rpdo ? done : refused) << at(row, index, sub);
        EXPECT_EQ(client.download(0x1AFF, 1, entry, 4), mappable == "TPDO" ? done : refused)
            << at(row, index, sub);
        // With another length it is not the object.
        if (into_rpdo) {
          EXPECT_NE(client.download(0x16FF, 1, entry - 1, 4), done) << at(row, index, sub);
        }
        if (mappable == "TPDO") {
          EXPECT_NE(client.download(0x1AFF, 1, entry - 1, 4), done) << at(row, index, sub);
        }
      }
    }
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_object_table_test
