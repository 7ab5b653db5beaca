// Lines of any bytes to the control server of a plant: each gets one answer, at once or when plant time has come so
// far, and it is a line of JSON. The first byte chooses the plant; a line that begins with '!' lets the client leave that
// has waited for the longest time.

#include <cstdio>
#include <deque>
#include <memory>
#include <string>
#include <string_view>

#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/serve/control_message.hpp"
#include "canopus/serve/plant_runs.hpp"
#include "canopus/serve/run_control.hpp"

#include "input.hpp"

namespace {

using namespace canopus;
using fuzz::expect;
using serve::PlantRuns;

constexpr std::size_t longest_line = 4096;  // of the server
constexpr can::Duration longest_turn = std::chrono::milliseconds(10);

constexpr std::string_view device =
    "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[device]]\nnode = 2\nname = \"io-block\"\n"
    "eds = \"" CANOPUS_SOURCE_DIR
    "/examples/devices/io-block.eds\"\n[[device.behaviour]]\nobject = \"6000:01\"\nkind = \"counter\"\n"
    "low = 0\nhigh = 255\nperiod = \"1ms\"\n[[device]]\nnode = 3\neds = \"" CANOPUS_SOURCE_DIR
    "/examples/devices/encoder.eds\"\n"  // alone on its bus a node repeats its frame for ever
    "[[plc]]\nname = \"plc1\"\nlisten = \"off\"\nscan = \"1ms\"\n";
constexpr std::string_view module =
    "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nbus = \"line1\"\nnode = 1\n";
constexpr std::string_view second_plc = "[[plc]]\nname = \"fx\"\nfamily = \"FX5\"\nlisten = \"off\"\n";

plant::PlantFile read(const std::string& text) {
  plant::PlantReading reading = plant::read_plant(text, "plant.toml");
  for (const text::FileError& error : reading.errors)
    std::fprintf(stderr, "%s\n", text::describe(error, "plant.toml").c_str());
  expect(reading.errors.empty());
  return std::move(reading.plant);
}

class Silent final : public plant::PlantObserver {};

/// The plants to choose from. Building one takes far longer than an input: each is built once, and its time goes on
/// from input to input.
plant::Plant& plant_of(unsigned number) {
  static Silent silent;
  static const auto built = [](const std::string& text) {
    auto plant = plant::Plant::build(read(text), silent);
    expect(plant.has_value());
    (*plant)->power_on();
    return std::move(*plant);
  };
  static const std::unique_ptr<plant::Plant> plants[] = {
      built(std::string(device)), built(std::string(device) + std::string(module)),
      built(std::string(device) + std::string(second_plc))};
  return *plants[number % 3];
}

/// What came for one line.
struct Asked {
  serve::Json fields;
  unsigned answers = 0;
};

void expect_answer(const Asked& asked, const std::string& line) {
  expect(line.ends_with('\n') && line.find('\n') == line.size() - 1);
  for (const char character : line)
    expect(character == '\n' || static_cast<unsigned char>(character) >= 0x20);
  const serve::Json answer = serve::control_request(line);
  expect(answer.is_object() && answer.contains("ok") && answer["ok"].is_boolean() && answer.contains("t") &&
         answer["t"].is_number());
  if (!answer["ok"].get<bool>())
    expect(answer.contains("error") && !answer["error"].get<std::string>().empty());
  const bool has_id =
      asked.fields.is_object() && asked.fields.contains("id") && asked.fields["id"].is_primitive();
  expect(answer.contains("id") == has_id);
}

}  // namespace

/// The plants are not part of the first input's time.
extern "C" int LLVMFuzzerInitialize(int* /*count*/, char*** /*arguments*/) {
  (void)plant_of(0);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const auto order = (data[0] & 0x80U) != 0 ? PlantRuns::Order::side_by_side : PlantRuns::Order::in_turn;
  std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);

  plant::Plant& plant = plant_of(data[0] & 0x7FU);
  PlantRuns runs(plant, order, [] {});
  serve::RunControl control(plant, runs);
  std::deque<std::shared_ptr<Asked>> all;
  std::deque<std::pair<std::shared_ptr<Asked>, serve::ControlServer::CallOff>> waiting;

  while (!text.empty()) {
    const std::string_view line = text.substr(0, std::min(text.find('\n'), longest_line));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.starts_with('!') && !waiting.empty()) {
      const auto [left, call_off] = std::move(waiting.front());
      waiting.pop_front();
      if (left->answers == 0) {
        call_off();
        std::erase(all, left);
      }
      continue;
    }
    const auto asked = std::make_shared<Asked>(Asked{serve::control_request(line)});
    all.push_back(asked);
    auto call_off = control.answer(line, [weak = std::weak_ptr(asked)](const std::string& answer) {
      const auto one = weak.lock();
      expect(one != nullptr);  // who has left gets none
      ++one->answers;
      expect_answer(*one, answer);
    });
    if (call_off) waiting.emplace_back(asked, std::move(call_off));
    // As far as somebody wants it, a little at a time.
    const can::Time end = plant.timeline().now() + longest_turn;
    runs.report();
    for (unsigned turns = 0; turns < 200 && runs.wants_time() && plant.timeline().now() < end; ++turns) {
      plant.timeline().run_until(std::min(runs.next(), end));
      runs.report();
    }
  }
  runs.end_all();
  runs.report();
  for (const auto& asked : all) expect(asked->answers == 1);
  // The next input finds nothing forced.
  (void)control.answer(R"({"request":"release","device":"io-block"})",
                       [](const std::string& answer) { expect(answer.starts_with(R"({"ok":true)")); });
  return 0;
}
