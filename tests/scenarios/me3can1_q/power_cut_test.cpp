// The supply goes off in the middle of saves: each of the three stores (G22 and Y1F, 1010H and 1011H, 1F22H)
// holds the old or the new content at the next start, never a mixture, and what was reported as saved is
// there. CANOPUS_SEEDS: so many random sequences instead of 1000, or of 10000 in ./check --all.

#include <random>

#include "canopus/store/file_memory.hpp"

#include "scenarios/me3can1_q/scenario.hpp"
#include "store/cut_files.hpp"
#include "support/random_cases.hpp"

namespace canopus::scenario::me3can1_q_power_cut_test {
namespace {

using module::me3can1_q::Me3can1Q;
using store::CutFiles;

const std::filesystem::path folder = "state/U000-ME3CAN1-Q";

// What one save writes: all of it is made of one number, so that a mixture shows.
struct Settings {
  unsigned number = 0;  // 0: factory defaults

  static constexpr std::array<module::BufferAddress, 5> words{24, 27, 59, 70, 71};
  [[nodiscard]] Words word_values() const {
    static const Words rates{10, 20, 50, 100, 125, 250, 500, 800, 1000};
    if (number == 0) return {250, 127, 0, 500, 500};
    return {rates[number % 9], static_cast<std::uint16_t>(number % 127 + 1),
            static_cast<std::uint16_t>(number % 121 - 60U), static_cast<std::uint16_t>(number * 7919U),
            static_cast<std::uint16_t>(50 + number * 31U % 32000)};
  }

  static constexpr std::array<std::uint8_t, 6> objects{1, 2, 3, 64, 126, 127};  // sub-indexes of 1F84H
  [[nodiscard]] std::uint32_t object_value(std::uint8_t sub) const {
    return number == 0 ? 0 : number * 0x9E3779B1U + sub;
  }

  [[nodiscard]] Bytes file() const {
    if (number == 0) return {};
    Bytes bytes(5 + number % 60);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(number + i * 37 + 1);
    return bytes;
  }
};

// A module on a file system, until the supply goes off.
class Machine {
 public:
  explicit Machine(CutFiles& files)
      : memory_(folder, "the module", files), module_(bus_, memory_, profile()) {
    module_.power_on(now_);
    wait([&] { return (g(25) & 0x80) == 0; });
  }

  std::uint16_t g(module::BufferAddress address) { return module_.program_read(address, now_); }
  void g(module::BufferAddress address, std::uint16_t value) { module_.write_word(address, value, now_); }
  void request(unsigned signal) {
    module_.set_output(signal, true, now_);
    wait([&] { return (module_.inputs() >> signal & 1U) != 0; });
    module_.set_output(signal, false, now_);
  }
  std::uint16_t cif(const Words& command) {
    for (std::size_t i = 0; i < command.size(); ++i) {
      g(static_cast<module::BufferAddress>(1000 + i), command[i]);
    }
    request(0x17);
    return g(1000);
  }
  bool write_object(std::uint16_t index, std::uint8_t sub, const Bytes& value) {
    Words command{0x0002, 0, index, sub, static_cast<std::uint16_t>(value.size())};
    for (std::size_t i = 0; i < value.size(); i += 2) {
      command.push_back(
          static_cast<std::uint16_t>(value[i] | (i + 1 < value.size() ? value[i + 1] << 8 : 0)));
    }
    return cif(command) == 0x0003;
  }
  Bytes read_object(std::uint16_t index, std::uint8_t sub) {
    EXPECT_EQ(cif({0x0004, 0, index, sub}), 0x0005);
    Bytes value;
    for (unsigned i = 0; i < g(1004); ++i) {
      value.push_back(static_cast<std::uint8_t>(g(1005 + i / 2) >> (8 * (i % 2)) & 0xFF));
    }
    return value;
  }

  void save_words(const Settings& settings) {
    if (settings.number == 0) {
      g(22, 3);
    } else {
      const Words values = settings.word_values();
      for (std::size_t i = 0; i < values.size(); ++i) g(Settings::words[i], values[i]);
      g(22, 1);
    }
    request(0x1F);
  }
  void save_objects(const Settings& settings) {
    for (const std::uint8_t sub : Settings::objects) {
      EXPECT_TRUE(write_object(0x1F84, sub, little_endian(settings.object_value(sub))));
    }
    EXPECT_TRUE(write_object(0x1010, 1, {'s', 'a', 'v', 'e'}));
  }
  void delete_file() {
    EXPECT_TRUE(write_object(0x1F22, 5, {0}));
    now_ += 3s;  // the flash memory is busy for a while
  }

  [[nodiscard]] Words words() {
    Words values;
    for (const module::BufferAddress address : Settings::words) values.push_back(g(address));
    return values;
  }
  [[nodiscard]] std::vector<Bytes> objects() {
    std::vector<Bytes> values;
    for (const std::uint8_t sub : Settings::objects) values.push_back(read_object(0x1F84, sub));
    return values;
  }
  [[nodiscard]] static std::vector<Bytes> objects(const Settings& settings) {
    std::vector<Bytes> values;
    for (const std::uint8_t sub : Settings::objects)
      values.push_back(little_endian(settings.object_value(sub)));
    return values;
  }
  [[nodiscard]] Bytes file() { return read_object(0x1F22, 5); }
  [[nodiscard]] std::uint32_t flash_writes() const { return module_.flash_writes(); }

  static Bytes little_endian(std::uint32_t value) {
    return {static_cast<std::uint8_t>(value & 0xFF), static_cast<std::uint8_t>(value >> 8 & 0xFF),
            static_cast<std::uint8_t>(value >> 16 & 0xFF), static_cast<std::uint8_t>(value >> 24)};
  }

 private:
  static module::Profile profile() { return {.power_on_time = 1ms}; }
  template <typename Condition>
  void wait(Condition condition) {
    for (unsigned ticks = 0; !condition(); ++ticks) {
      ASSERT_LT(ticks, 1000U) << "nothing comes";
      now_ = std::max(now_, module_.deadline());
      module_.tick(now_);
      bus_.sent.clear();
      bus_.completing.clear();
    }
  }

  store::FileMemory memory_;
  FreeBus bus_;
  Me3can1Q module_;
  can::Time now_{};
};

// Of one store: what was reported as saved, and what may be there instead because its save was cut off.
struct Store {
  Settings saved{};
  std::optional<Settings> cut_off{};

  template <typename Found, typename Of>
  void check(const Found& found, Of of, std::string_view what) {
    if (cut_off && found == of(*cut_off)) saved = *cut_off;
    EXPECT_EQ(found, of(saved)) << what << " are neither those of " << saved.number << " nor those of "
                                << (cut_off ? cut_off->number : saved.number);
    cut_off.reset();
  }
};

struct Stores {
  Store words, objects, file;
  std::uint32_t writes = 0;

  // One save of one of the stores; PowerCut leaves it marked as cut off.
  void save(Machine& machine, std::mt19937& random) {
    const Settings next{.number = random() % 8 == 0 ? 0U : static_cast<unsigned>(random() % 30'000 + 1)};
    Store& store = random() % 3 == 0 ? words : random() % 2 == 0 ? objects : file;
    if (&store == &file && file.saved.number != 0) {  // a used sub-index is deleted first
      run(file, {}, [&] { machine.delete_file(); });
    }
    if (&store == &words) run(store, next, [&] { machine.save_words(next); });
    if (&store == &objects) run(store, next, [&] { machine.save_objects(next); });
    if (&store == &file && next.number != 0) {
      run(store, next, [&] { EXPECT_TRUE(machine.write_object(0x1F22, 5, next.file())); });
    }
  }

  // The module just started.
  void check(Machine& machine) {
    const bool words_cut = words.cut_off.has_value();
    const bool any_cut = words_cut || objects.cut_off || file.cut_off;
    // A save by G22 that was cut off is reported; anything else never is.
    if (!words_cut) {
      EXPECT_EQ(machine.g(29), 0);
    } else {
      EXPECT_EQ(machine.g(29) & ~0x0010, 0);
    }
    EXPECT_TRUE(machine.flash_writes() == writes || (any_cut && machine.flash_writes() == writes + 1))
        << machine.flash_writes() << " writes, expected " << writes;
    writes = machine.flash_writes();
    words.check(
        machine.words(), [](const Settings& s) { return s.word_values(); }, "words");
    objects.check(
        machine.objects(), [](const Settings& s) { return Machine::objects(s); }, "objects");
    file.check(
        machine.file(), [](const Settings& s) { return s.file(); }, "bytes of 1F22H");
  }

 private:
  template <typename Save>
  void run(Store& store, const Settings& next, Save save) {
    store.cut_off = next;
    save();
    store.cut_off.reset();
    store.saved = next;
    ++writes;
  }
};

TEST(Me3PowerCut, S83_RandomSequencesOfSavesAndCuts_LeaveTheOldOrTheNewContent) {
  RecordProperty("spec", "ME3-SYS-013 ME3-SYS-014 ME3-SAVE-009 ME3-CFG-003 ME3-STO-003");
  const unsigned sequences = support::random_cases(1000, 10'000);
  for (unsigned seed = 1; seed <= sequences && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    CutFiles files;
    Stores stores;
    for (int starts = 0; starts < 2 && !HasFailure(); ++starts) {
      try {
        Machine machine(files);
        stores.check(machine);
        // Within the first bytes and calls, or somewhere in the many bytes of the object dictionary.
        files.cut_after(random() % 2 == 0 ? random() % 600 : random() % 60'000);
        for (int saves = 0; saves < 4; ++saves) stores.save(machine, random);
      } catch (const store::PowerCut&) {
      }
      files.power_back(random);
    }
    Machine machine(files);
    stores.check(machine);
  }
}

TEST(Me3PowerCut, EveryCallAndByteOfASaveOfTheWords) {
  RecordProperty("spec", "ME3-SAVE-009 ME3-ERR-003");
  bool done = false, reported = false;
  for (std::uint64_t cut = 0; !done && !HasFailure(); ++cut) {
    for (unsigned round = 0; round < 5; ++round) {
      SCOPED_TRACE("cut after " + std::to_string(cut) + " steps, round " + std::to_string(round));
      std::mt19937 random(static_cast<unsigned>(cut) * 5 + round);
      CutFiles files;
      Store words{.saved = {.number = 17}};
      try {
        Machine machine(files);
        machine.save_words(words.saved);
        files.cut_after(cut);
        words.cut_off = Settings{.number = 4711};
        machine.save_words(*words.cut_off);
        words = {.saved = *words.cut_off};
        done = true;
      } catch (const store::PowerCut&) {
      }
      files.power_back(random);
      Machine machine(files);
      reported = reported || machine.g(29) == 0x0010;
      EXPECT_EQ(machine.g(29) & ~0x0010, 0);
      if (done) {
        EXPECT_EQ(machine.g(29), 0);
      }
      words.check(
          machine.words(), [](const Settings& s) { return s.word_values(); }, "words");
    }
  }
  EXPECT_TRUE(reported);
}

// Every byte of each file damaged in turn (of the long one every 97th).
TEST(Me3PowerCut, DamagedStore_IsReported_AndAnsweredWithItsDefaults) {
  RecordProperty("spec", "ME3-ERR-003");
  const Settings settings{.number = 1234}, defaults{};
  for (const std::string name : {"buffer-memory", "object-dictionary", "concise-dcf"}) {
    CutFiles files;
    {
      Machine machine(files);
      machine.save_words(settings);
      machine.save_objects(settings);
      EXPECT_TRUE(machine.write_object(0x1F22, 5, settings.file()));
    }
    Bytes& content = *files.content(folder / name);
    const std::size_t step = content.size() > 1000 ? 97 : 1;
    for (std::size_t i = 0; i < content.size() && !HasFailure(); i += step) {
      SCOPED_TRACE(name + " byte " + std::to_string(i));
      content[i] ^= 0x10;
      Machine machine(files);
      content[i] ^= 0x10;
      EXPECT_EQ(machine.g(29), 0x0010);
      EXPECT_EQ(machine.words(), (name == "buffer-memory" ? defaults : settings).word_values());
      EXPECT_EQ(machine.objects(), Machine::objects(name == "object-dictionary" ? defaults : settings));
      EXPECT_EQ(machine.file(), (name == "concise-dcf" ? defaults : settings).file());
    }
  }
}

// Content with a good checksum that no module can have written: all of it is left aside.
TEST(Me3PowerCut, ImpossibleContent_IsReported_AndNothingOfItIsUsed) {
  RecordProperty("spec", "ME3-ERR-003");
  const Bytes count{1, 1, 0, 0, 0};  // FlashMemory: content, first write
  const auto with = [&](const Bytes& bytes) {
    Bytes all = count;
    all.insert(all.end(), bytes.begin(), bytes.end());
    return module::NonVolatileMemory::Content{module::NonVolatileMemory::Content::State::good, all};
  };
  {
    IntelligentScenario s;  // G70 = 1000 and G27 = 200
    s.flash().blobs["buffer-memory"] = with({70, 0, 0xE8, 0x03, 27, 0, 200, 0});
    s.power_on();
    s.expect(29, 0x0010).expect(70, 500).expect(27, 127);
  }
  {
    IntelligentScenario s;  // 1015H = 77, then half an object
    s.flash().blobs["object-dictionary"] = with({0x15, 0x10, 0, 2, 0, 77, 0, 0x17, 0x10, 0, 2, 0, 1});
    s.power_on();
    s.expect(29, 0x0010);
    s.expect_object(0x1015, 0, 0, 2);
  }
  {
    IntelligentScenario s;  // neither content nor erased
    s.flash().blobs["buffer-memory"] = {module::NonVolatileMemory::Content::State::good, {9, 1, 0, 0, 0}};
    s.power_on();
    s.expect(29, 0x0010);
  }
}

TEST(Me3PowerCut, RestoredDefaults_LeaveTheConciseDcfs_UntilARestart) {
  RecordProperty("spec", "ME3-STO-006");
  IntelligentScenario s;
  s.power_on();
  s.cif({0x0002, 0, 0x1F22, 2, 5, 0x0001, 0x0000, 0x0055});
  s.expect(1000, 0x0003);
  s.set_object(0x1011, 1, 0x64616F6C, 4);
  s.supply_off();  // no restart command was carried out
  s.power_on();
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1004, 5);
  s.set_object(0x1011, 1, 0x64616F6C, 4);
  s.restart();
  s.cif({0x0004, 0, 0x1F22, 2});
  s.expect(1004, 0);
}

TEST(Me3PowerCut, FlashWrites_AreCounted_OverPowerCyclesAndStores) {
  RecordProperty("spec", "ME3-SYS-014");
  IntelligentScenario s;
  s.power_on();
  EXPECT_EQ(s.plug_in().flash_writes(), 0U);
  s.save();
  EXPECT_EQ(s.plug_in().flash_writes(), 1U);
  s.save(2);  // into the memory only
  s.save(0);
  EXPECT_EQ(s.plug_in().flash_writes(), 1U);
  s.store_objects();
  EXPECT_EQ(s.plug_in().flash_writes(), 2U);
  s.cif({0x0002, 0, 0x1F22, 2, 1, 0x0000});  // nothing to delete
  EXPECT_EQ(s.plug_in().flash_writes(), 2U);
  // One entry: 1000 to 1017:00.
  s.cif({0x0002, 0, 0x1F22, 2, 13, 0x0001, 0x0000, 0x1017, 0x0200, 0x0000, 0xE800, 0x0003});
  EXPECT_EQ(s.plug_in().flash_writes(), 3U);
  s.cif({0x0002, 0, 0x1F22, 2, 1, 0x0000});
  EXPECT_EQ(s.plug_in().flash_writes(), 4U);
  s.supply_off();
  s.power_on();
  EXPECT_EQ(s.plug_in().flash_writes(), 4U);
  s.restart();
  for (int i = 4; i < 10'001; ++i) s.save();
  EXPECT_EQ(s.plug_in().flash_writes(), 10'001U);
  s.expect(29, 0);  // no error is defined for it
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_power_cut_test
