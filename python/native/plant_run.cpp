#include "plant_run.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/initial_nodes.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/serve/run_control.hpp"
#include "canopus/text/file_text.hpp"

#include "plant_parts.hpp"

namespace canopus::python {

std::string joined(std::vector<text::FileError> errors, const std::string& path) {
  text::TextOutput lines;
  text::print_errors(std::move(errors), path, lines);
  std::string text = lines.text();
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

namespace {

std::string drain(text::TextOutput& lines) {
  std::string text = lines.text();
  lines.clear();
  return text;
}

[[noreturn]] void refuse_access(plc::AccessError error, const std::string& what) {
  switch (error) {
    case plc::AccessError::no_device: throw PlantProblem(what + ": the CPU has no such device");
    case plc::AccessError::wrong_unit: throw PlantProblem(what + ": bits of a word device");
    case plc::AccessError::out_of_range:
      throw PlantProblem(what + ": the device number is beyond the last one");
    case plc::AccessError::no_module:
      throw PlantProblem(what + ": there is no module at this head address, or it has no supply");
    case plc::AccessError::beyond_buffer:
      throw PlantProblem(what + ": the address is beyond the module's buffer memory");
  }
  throw PlantProblem(what + ": refused");
}

constexpr std::size_t most_points = 1U << 20U;

plc::Device device_of(const std::string& name) {
  if (name == "U3E0\\HG") return plc::Device::hg;
  const auto device = plc::device_named(name);
  if (!device) throw PlantProblem(name + " is no device of a CPU");
  return *device;
}

}  // namespace

std::shared_ptr<PlantRun> PlantRun::open(const std::string& path, const std::optional<std::string>& text,
                                         std::optional<std::uint64_t> seed) {
  std::string content;
  if (text) {
    content = *text;
  } else {
    auto read = text::read_file(path);
    if (!read) throw PlantProblem(read.error());
    content = std::move(*read);
  }
  auto parts = std::make_unique<Parts>(path);
  plant::PlantReading reading = plant::read_plant(content, path);
  constexpr std::size_t enough = 100;
  if (reading.errors.size() < enough) {
    auto plant = plant::Plant::build(reading.plant, parts->printer, seed, &parts->linked);
    if (!plant) {
      reading.errors.insert(reading.errors.end(), plant.error().begin(), plant.error().end());
    } else if (reading.errors.empty()) {
      parts->plant = std::move(*plant);
    }
  }
  if (!parts->plant) throw PlantProblem(joined(std::move(reading.errors), path));
  if (auto errors = parts->plant->open_stores(); !errors.empty())
    throw PlantProblem(joined(std::move(errors), path));
  for (plant::InitialPlantNode& node : plant::initial_nodes(*parts->plant)) {
    parts->names.add(trace::describe_node(std::move(node.bus), node.node_id, std::move(node.name),
                                          std::move(node.objects)));
  }
  for (const text::FileWarning& warning : parts->plant->warnings()) {
    parts->printer.on({{}, plant::Warning{describe(warning.place, path), warning.message}});
  }
  parts->runs = std::make_unique<serve::PlantRuns>(*parts->plant, serve::PlantRuns::Order::in_turn,
                                                   [due = &parts->is_report_due] { *due = true; });
  return std::shared_ptr<PlantRun>(new PlantRun(std::move(parts)));
}

PlantRun::PlantRun(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
PlantRun::~PlantRun() = default;

void PlantRun::set_signal_check(Callback check_signals) { parts_->check_signals = std::move(check_signals); }
void PlantRun::set_arrival(Callback arrival) { parts_->arrival = std::move(arrival); }
void PlantRun::set_hook(Hook hook) { parts_->hook = std::move(hook); }

void PlantRun::close() {
  if (!parts_->plant) return;
  parts_->check();
  parts_->end();
}

bool PlantRun::is_closed() const noexcept { return !parts_->plant; }
can::Time PlantRun::now() const noexcept { return parts_->plant ? parts_->timeline().now() : parts_->last; }

std::string PlantRun::ask(const std::string& line) {
  parts_->check();
  parts_->start();
  std::optional<std::string> answer;
  serve::RunControl control(*parts_->plant, *parts_->runs);
  const auto call_off = control.answer(line, [&answer](std::string text) { answer = std::move(text); });
  if (std::exchange(parts_->is_report_due, false)) parts_->runs->report();
  try {
    while (!answer) {
      parts_->drive(std::min(parts_->runs->next(), can::later(now(), 100ms)), 5ms,
                    [&answer] { return answer.has_value(); });
      if (std::exchange(parts_->is_report_due, false)) parts_->runs->report();
    }
  } catch (...) {
    if (call_off) call_off();
    throw;
  }
  return *answer;
}

void PlantRun::run_until(can::Time end) {
  parts_->check();
  parts_->drive(end, 5ms, [] { return false; });
}

std::string PlantRun::drain_events() { return drain(parts_->lines); }

std::vector<std::string> PlantRun::buses() const {
  parts_->check_open();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parts_->plant->bus_count(); ++i) names.push_back(parts_->plant->bus(i).name());
  return names;
}

std::uint32_t PlantRun::bit_rate(const std::string& bus) const {
  parts_->check_open();
  return parts_->bus(bus).bit_rate();
}

std::vector<std::string> PlantRun::plcs() const {
  parts_->check_open();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parts_->plant->plc_count(); ++i)
    names.push_back(parts_->plant->plc_section(i).name);
  return names;
}

namespace {

void check_points(const std::string& what, std::size_t count) {
  if (count > most_points)
    throw PlantProblem(fmt::format("{}: {} points; {} at most", what, count, most_points));
}

}  // namespace

std::vector<std::uint16_t> PlantRun::read_words(const std::string& plc, const std::string& device,
                                                std::uint32_t first, std::size_t count) {
  plc::Rack& rack = parts_->rack(plc);
  check_points(device, count);
  std::vector<std::uint16_t> words(count);
  const auto done = rack.read_words(device_of(device), first, words, now());
  if (!done) refuse_access(done.error(), fmt::format("{}{}", device, first));
  return words;
}

void PlantRun::write_words(const std::string& plc, const std::string& device, std::uint32_t first,
                           std::span<const std::uint16_t> words) {
  const auto done = parts_->rack(plc).write_words(device_of(device), first, words, now());
  if (!done) refuse_access(done.error(), fmt::format("{}{}", device, first));
}

std::vector<std::uint8_t> PlantRun::read_bits(const std::string& plc, const std::string& device,
                                              std::uint32_t first, std::size_t count) {
  plc::Rack& rack = parts_->rack(plc);
  check_points(device, count);
  std::vector<std::uint8_t> bits(count);
  const auto done = rack.read_bits(device_of(device), first, bits, now());
  if (!done) refuse_access(done.error(), fmt::format("{}{}", device, first));
  return bits;
}

void PlantRun::write_bits(const std::string& plc, const std::string& device, std::uint32_t first,
                          std::span<const std::uint8_t> bits) {
  const auto done = parts_->rack(plc).write_bits(device_of(device), first, bits, now());
  if (!done) refuse_access(done.error(), fmt::format("{}{}", device, first));
}

namespace {

std::uint16_t head_of(const plc::Rack&, unsigned unit) {
  constexpr unsigned last_unit = 0xFF;
  if (unit > last_unit) throw PlantProblem(fmt::format("U{:X}: expected 0 to FFH", unit));
  return static_cast<std::uint16_t>(16 * unit);
}

}  // namespace

std::vector<std::uint16_t> PlantRun::read_buffer(const std::string& plc, unsigned unit, std::uint32_t first,
                                                 std::size_t count) {
  plc::Rack& rack = parts_->rack(plc);
  const std::string what = fmt::format("U{:X}\\G{}", unit, first);
  check_points(what, count);
  std::vector<std::uint16_t> words(count);
  const auto done = rack.read_buffer(head_of(rack, unit), first, words, now());
  if (!done) refuse_access(done.error(), what);
  return words;
}

void PlantRun::write_buffer(const std::string& plc, unsigned unit, std::uint32_t first,
                            std::span<const std::uint16_t> words) {
  plc::Rack& rack = parts_->rack(plc);
  const auto done = rack.write_buffer(head_of(rack, unit), first, words, now());
  if (!done) refuse_access(done.error(), fmt::format("U{:X}\\G{}", unit, first));
}

void PlantRun::set_cpu(const std::string& plc, const std::string& state) {
  plc::Rack& rack = parts_->rack(plc);
  if (state == "pause") return rack.pause(now());
  rack.set_cpu_state(state == "run" ? module::CpuState::run : module::CpuState::stop, now());
}

std::string PlantRun::cpu_name(const std::string& plc) const {
  parts_->check_open();
  return std::string(parts_->plant->rack(parts_->rack_number(plc)).model().name);
}

SdoResult PlantRun::sdo(const std::string& bus, unsigned node, unsigned index, unsigned sub,
                        const std::optional<std::string>& value, can::Duration time_out, bool block) {
  parts_->check();
  can::Bus& on = parts_->bus(bus);
  constexpr unsigned last_node = 127;
  if (node < 1 || node > last_node) throw PlantProblem(fmt::format("node {}: a node-ID is 1 to 127", node));
  if (index > 0xFFFF || sub > 0xFF) {
    throw PlantProblem(
        fmt::format("object {:X}:{:02X}: expected 0 to FFFFH, sub-index 0 to FFH", index, sub));
  }
  if (time_out <= 0ns) throw PlantProblem("the time-out is not above 0");
  parts_->start();
  auto& attachment = parts_->sdo_clients[on.name()];
  if (!attachment) attachment = std::make_unique<SdoOnBus>(on, parts_->timeline_of(on));
  if (!attachment->start(node, index, sub, value, time_out, block))
    throw PlantProblem("the bus takes no frame");
  try {
    parts_->drive(can::never, 0ns, [&attachment] { return attachment->is_over; });
  } catch (...) {
    attachment->cancel();
    throw;
  }
  const canopen::AbortCode code = attachment->client.abort_code();
  SdoResult result{.abort_code = static_cast<std::uint32_t>(client::abort_on_bus(code))};
  if (code != canopen::AbortCode::none) {
    const can::Frame* const short_answer = attachment->client.short_answer();
    result.reason = short_answer != nullptr
                        ? client::describe_short_answer(*short_answer)
                        : client::describe_abort(code, !attachment->client.gave_up(), time_out);
  } else if (!value) {
    result.data.assign(attachment->client.data().begin(), attachment->client.data().end());
    result.size_indicated = attachment->client.is_size_indicated();
  }
  return result;
}

void PlantRun::record(const std::string& bus) {
  parts_->check();
  can::Bus& on = parts_->bus(bus);
  const auto [recorder, is_new] = parts_->recorders.try_emplace(on.name());
  if (is_new) on.add_observer(recorder->second);
}

std::vector<TimedFrame> PlantRun::drain_frames(const std::string& bus) {
  parts_->check_open();
  const auto found = parts_->recorders.find(parts_->bus(bus).name());
  return found == parts_->recorders.end() ? std::vector<TimedFrame>()
                                          : std::exchange(found->second.frames, {});
}

void PlantRun::monitor() {
  parts_->check();
  if (parts_->decoder) return;
  parts_->decoder = std::make_unique<trace::Decoder>(parts_->names);
  for (std::size_t i = 0; i < parts_->plant->bus_count(); ++i) {
    can::Bus& bus = parts_->plant->bus(i);
    parts_->analysers.push_back(std::make_unique<Analyser>(*parts_->decoder, static_cast<std::uint16_t>(i),
                                                           bus.name(), parts_->messages));
    bus.add_observer(*parts_->analysers.back());
  }
}

std::string PlantRun::drain_messages() { return drain(parts_->messages); }

std::shared_ptr<PlantPicture> PlantRun::draw(const std::string& bus,
                                             const std::vector<std::string>& signals) {
  parts_->check();
  can::Bus& on = parts_->bus(bus);
  auto picture = std::make_shared<PlantPicture>(parts_->names, on, signals);
  on.add_observer(*picture);
  parts_->pictures.emplace_back(&on, picture);
  return picture;
}

std::vector<DeviceView> PlantRun::device_views() const {
  parts_->check_open();
  std::vector<DeviceView> views;
  for (std::size_t i = 0; i < parts_->plant->device_count(); ++i) {
    const plant::NodeStatus& status = parts_->plant->device(i).status();
    views.push_back({.bus = std::string(status.label.bus),
                     .node = status.label.node_id,
                     .name = std::string(status.label.name),
                     .state = std::string(status.is_on ? canopen::name(status.state) : "off")});
  }
  return views;
}

std::vector<ObjectView> PlantRun::object_views(const std::string& device) const {
  parts_->check_open();
  sim::Device& shown = parts_->plant->device(parts_->device(device)).device();
  std::vector<ObjectView> views;
  for (const canopen::Entry& entry : plant::process_values(shown)) {
    const auto bits = shown.node().dictionary().get<std::uint64_t>(entry);
    views.push_back({.object = canopen::object_text(entry.index, entry.sub),
                     .name = std::string(shown.file().dictionary->name(entry)),
                     .type = std::string(eds::name(entry.description->type)),
                     .value = plant::show_value(entry.description->type, bits)});
  }
  return views;
}

std::size_t PlantRun::device_number(const std::string& device) {
  parts_->check_open();
  return parts_->device(device);
}

std::size_t PlantRun::watch(const std::string& device, const std::string& object) {
  parts_->check();
  const std::size_t number = parts_->device(device);
  const canopen::Entry entry = parts_->entry(number, object);
  return parts_->script(number).watch(entry);
}

std::size_t PlantRun::every(const std::string& device, can::Duration period) {
  parts_->check();
  if (period < 1us) throw PlantProblem("the period is less than 1 us");
  return parts_->script(parts_->device(device)).every(period);
}

void PlantRun::script(const std::string& device) {
  parts_->check();
  (void)parts_->script(parts_->device(device));
}

void PlantRun::put(const std::string& device, const std::string& object, const std::string& value) {
  parts_->check_open();
  const std::size_t number = parts_->device(device);
  const canopen::Entry entry = parts_->entry(number, object);
  sim::Device& target = parts_->plant->device(number).device();
  const auto bits = plant::parse_value(value, entry, *target.file().dictionary);
  if (!bits) throw PlantProblem(fmt::format("{}: {}", object, bits.error()));
  ScriptedDevice& script = parts_->script(number);
  if (!parts_->is_running) parts_->start();
  if (!target.put(entry, *bits)) return;
  if (parts_->acting == number) return script.changed();
  script.value_put(now());
}

std::string PlantRun::get(const std::string& device, const std::string& object) {
  parts_->check_open();
  const std::size_t number = parts_->device(device);
  const canopen::Entry entry = parts_->entry(number, object);
  const auto bits = parts_->plant->device(number).device().node().dictionary().get<std::uint64_t>(entry);
  return plant::json_value(entry.description->type, bits).dump();
}

}  // namespace canopus::python
