#include "plant_run.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canopus/cli/analysis/message_printer.hpp"
#include "canopus/cli/events/event_printer.hpp"
#include "canopus/cli/terminal/plant_loading.hpp"
#include "canopus/client/sdo_transfer_on_bus.hpp"
#include "canopus/plant/device_seat.hpp"
#include "canopus/plant/file/process_value.hpp"
#include "canopus/plant/initial_nodes.hpp"
#include "canopus/serve/linked_buses.hpp"
#include "canopus/serve/plant_runs.hpp"
#include "canopus/serve/run_control.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/trace/decode/decoder.hpp"

namespace canopus::python {

using namespace std::chrono_literals;

/// A port of the plant, and what it has heard.
class PlantPort::Seat final : public can::Participant {
 public:
  Seat(can::Bus& bus, can::Timeline& timeline, const std::string& name)
      : timeline_(&timeline), port_(&bus.add_port(name)), handle_(timeline.add(*this, name)) {
    port_->connect(*this, handle_);
  }
  void leave() noexcept {
    if (port_ == nullptr) return;
    port_->plug(false);
    port_->disconnect();
    timeline_->remove(handle_);
    port_ = nullptr;
  }
  /// The plant has gone, and the port with it.
  void forget() noexcept { port_ = nullptr; }

  void receive(const can::Frame& frame, can::Time now) override { keep({now, frame, false}); }
  void transmitted(const can::Frame& frame, can::Time now) override { keep({now, frame, true}); }
  void tick(can::Time) override {}
  [[nodiscard]] can::Time deadline() const noexcept override { return can::never; }

  [[nodiscard]] can::Port* port() const noexcept { return port_; }
  std::deque<TimedFrame> frames;
  std::uint64_t lost = 0;

 private:
  void keep(const TimedFrame& frame) {
    if (frames.size() >= most_frames) {
      ++lost;
      frames.pop_front();
    }
    frames.push_back(frame);
  }
  can::Timeline* timeline_;
  can::Port* port_;
  can::Timeline::Handle handle_;
};

namespace {

/// An SDO client on a bus.
class SdoSeat final : public can::Participant, private canopen::SdoClientUser {
 public:
  SdoSeat(can::Bus& bus, can::Timeline& timeline)
      : port(bus.add_port("SDO client")),
        timeline_(timeline),
        handle_(timeline.add(*this, "SDO client")),
        client(port) {
    port.connect(*this, handle_);
  }
  bool start(unsigned node, unsigned index, unsigned sub, const std::optional<std::string>& value,
             can::Duration time_out, bool block) {
    value_ = value.value_or("");
    is_over = false;
    client.set_server(static_cast<std::uint8_t>(node));
    client.set_switch_threshold(block ? 0 : 4);
    const auto mode = block ? canopen::SdoClient::Mode::block : canopen::SdoClient::Mode::segmented;
    const auto object = static_cast<std::uint16_t>(index);
    const auto part = static_cast<std::uint8_t>(sub);
    const can::Time now = timeline_.now();
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(value_.data()), value_.size());
    const bool started = value ? client.download(object, part, bytes, *this, now, time_out, mode)
                               : client.upload(object, part, *this, now, time_out, mode);
    timeline_.refresh(handle_);
    return started;
  }
  /// Nobody waits for the answer any more.
  void cancel() {
    if (client.busy()) client.cancel(canopen::AbortCode::general);
    timeline_.refresh(handle_);
  }
  void receive(const can::Frame& frame, can::Time now) override { client.receive(frame, now); }
  void tick(can::Time now) override { client.tick(now); }
  [[nodiscard]] can::Time deadline() const noexcept override { return client.deadline(); }

  can::Port& port;
  bool is_over = false;

 private:
  void sdo_finished(canopen::SdoClient&, can::Time) override { is_over = true; }
  can::Timeline& timeline_;
  can::Timeline::Handle handle_;
  std::string value_;

 public:
  canopen::SdoClient client;
};

class Recorder final : public can::BusObserver {
 public:
  void frame_completed(const can::Frame& frame, can::Time, can::Time end) override {
    if (frames.size() < PlantPort::most_frames) frames.push_back({end, frame, false});
  }
  std::vector<TimedFrame> frames;
};

/// A bus whose frames are decoded as they come.
class Analyser final : public can::BusObserver {
 public:
  Analyser(trace::Decoder& decoder, std::uint16_t channel, std::string bus, cli::Output& out)
      : decoder_(decoder), channel_(channel), bus_(std::move(bus)), out_(out) {}
  void frame_completed(const can::Frame& frame, can::Time, can::Time end) override {
    decoder_.receive({.time = end, .channel = channel_, .frame = frame}, bus_,
                     [&](const trace::Message& message) { out_.json(cli::to_json(message, bus_)); });
  }

 private:
  trace::Decoder& decoder_;
  std::uint16_t channel_;
  std::string bus_;
  cli::Output& out_;
};

std::string take(cli::TextOutput& lines) {
  std::string text = lines.text();
  lines.clear();
  return text;
}

std::string joined(std::vector<text::FileError> errors, const std::string& path) {
  cli::TextOutput lines;
  cli::print_errors(std::move(errors), path, lines);
  std::string text = lines.text();
  while (text.ends_with('\n')) text.pop_back();
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

struct PlantRun::Parts {
  Parts(const std::string& path) : printer(lines), linked(io, path, true) {}

  cli::TextOutput lines;
  cli::JsonPrinter printer;
  boost::asio::io_context io{1};
  serve::LinkedBuses linked;
  trace::Names names;
  cli::TextOutput messages;
  std::unique_ptr<trace::Decoder> decoder;
  std::vector<std::unique_ptr<Analyser>> analysers;
  std::map<std::string, Recorder> recorders;
  std::map<std::string, std::unique_ptr<SdoSeat>> sdo_seats;
  std::vector<std::shared_ptr<PlantPort::Seat>> seats;
  std::unique_ptr<plant::Plant> plant;
  std::unique_ptr<serve::PlantRuns> runs;
  bool is_report_due = false;
  std::map<std::size_t, ScriptedDevice*> scripts;  // they belong to the devices
  std::optional<std::size_t> acting;
  Hook hook;
  Look look;
  bool is_on = false;
  bool is_running = false;
  can::Time last{};

  can::Timeline& timeline() { return plant->timeline(); }
  /// What a node on this bus is on.
  can::Timeline& timeline_of(const can::Bus& bus) {
    std::size_t number = 0;
    while (&plant->bus(number) != &bus) ++number;
    return plant->timeline_of_bus(number);
  }

  /// As long as it lives, callbacks may come.
  class Running {
   public:
    explicit Running(bool& flag) : flag_(flag) { flag_ = true; }
    ~Running() { flag_ = false; }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

   private:
    bool& flag_;
  };

  /// Nothing runs, and there is a plant.
  void check() const {
    if (!plant) throw PlantProblem("the plant is closed");
    if (is_running) {
      throw PlantProblem(
          "the plant runs just now: a callback reads and puts values of devices, and nothing else");
    }
  }
  void check_open() const {
    if (!plant) throw PlantProblem("the plant is closed");
  }
  void start() {
    if (std::exchange(is_on, true)) return;
    linked.start(nullptr, *plant);
    const Running running(is_running);  // devices start, and call back
    plant->power_on();
  }

  /// Lets time pass until `is_done`, up to `end` at most, in pieces of `step`; 0: from deadline to deadline.
  template <typename Done>
  void drive(can::Time end, can::Duration step, Done is_done) {
    start();
    const Running running(is_running);
    can::Timeline& line = timeline();
    constexpr unsigned often = 256;
    unsigned turns = 0;
    while (!is_done()) {
      if (plant->has_stalled())
        throw PlantProblem("a part of the plant asks for one moment without end: see the events");
      const can::Time next = line.next();
      if (line.now() >= end && next > end) return;
      if (next == can::never && end == can::never)
        throw PlantProblem("nothing happens in this plant any more");
      const can::Time piece =
          step == 0ns || !scripts.empty() ? next : std::max(next, can::later(line.now(), step));
      line.run_until(std::min(piece, end));
      if (std::exchange(is_report_due, false)) runs->report();
      if (look && (!scripts.empty() || ++turns % often == 0)) look();
    }
  }

  can::Bus& bus(std::string_view name) {
    std::vector<std::string_view> known;
    for (std::size_t i = 0; i < plant->bus_count(); ++i) {
      if (plant->bus(i).name() == name || (name.empty() && plant->bus_count() == 1)) return plant->bus(i);
      known.emplace_back(plant->bus(i).name());
    }
    throw PlantProblem(
        name.empty() ? fmt::format("which bus is missing; expected {}", text::one_of(known))
                     : fmt::format("the plant has no bus \"{}\"{}", name, text::suggestion(name, known)));
  }
  plc::Rack& rack(const std::string& name) {
    check();
    start();
    return plant->rack(rack_number(name));
  }
  [[nodiscard]] std::size_t rack_number(const std::string& name) const {
    std::vector<std::string_view> known;
    for (std::size_t i = 0; i < plant->plc_count(); ++i) {
      if (plant->plc_section(i).name == name) return i;
      known.emplace_back(plant->plc_section(i).name);
    }
    throw PlantProblem(fmt::format("the plant has no PLC \"{}\"{}", name,
                                   known.empty() ? "" : text::suggestion(name, known)));
  }

  /// By its name, bus and node-ID, or node-ID.
  std::size_t device(const std::string& wanted) {
    std::vector<std::string_view> names_of_devices;
    std::array<std::vector<std::size_t>, 3> found;
    for (std::size_t i = 0; i < plant->device_count(); ++i) {
      const plant::NodeLabel& label = plant->device(i).status().label;
      names_of_devices.push_back(label.name);
      if (label.name == wanted) found[0].push_back(i);
      if (fmt::format("{}:{}", label.bus, label.node_id) == wanted) found[1].push_back(i);
      if (std::to_string(label.node_id) == wanted) found[2].push_back(i);
    }
    for (const auto& each : found) {
      if (each.size() == 1) return each.front();
      if (each.size() > 1)
        throw PlantProblem(fmt::format("there is more than one device \"{}\"; expected BUS:NODE", wanted));
    }
    throw PlantProblem(
        fmt::format("the plant has no device \"{}\"{}", wanted,
                    names_of_devices.empty() ? "" : text::suggestion(wanted, names_of_devices)));
  }
  /// The behaviour of the device, made when it is asked for first.
  ScriptedDevice& script(std::size_t number) {
    if (const auto found = scripts.find(number); found != scripts.end()) return *found->second;
    const plant::DeviceSection& section = plant->file().devices.at(number);
    const std::string_view name = plant->device(number).status().label.name;
    if (section.drive || section.lift) {
      throw PlantProblem(
          fmt::format("device \"{}\" has a behaviour of its own in the plant file, a drive or a lift", name));
    }
    if (is_on) {
      throw PlantProblem(
          fmt::format("device \"{}\" is switched on: it gets a behaviour before time passes", name));
    }
    auto application =
        std::make_unique<ScriptedDevice>([this, number](std::size_t token, std::uint64_t, can::Time now) {
          if (!hook) return;
          const auto before = std::exchange(acting, number);
          hook(number, token, now);
          acting = before;
        });
    ScriptedDevice& script = *application;
    plant->device(number).device().set_application(std::move(application));
    scripts[number] = &script;
    return script;
  }
  canopen::Entry entry(std::size_t number, const std::string& object) {
    const auto found = plant::find_process_value(plant->device(number).device(), object);
    if (!found) throw PlantProblem(found.error());
    return *found;
  }
  ~Parts() { end(); }
  void end() {
    if (!plant) return;
    last = timeline().now();
    runs.reset();
    for (const auto& seat : seats) seat->leave();
    seats.clear();
    for (auto& [name, recorder] : recorders) bus(name).remove_observer(recorder);
    for (std::size_t i = 0; i < analysers.size(); ++i) plant->bus(i).remove_observer(*analysers[i]);
    scripts.clear();
    hook = nullptr;
    plant.reset();
    sdo_seats.clear();
  }
};

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
    parts->printer.warning(describe(warning.place, path), warning.message, {});
  }
  parts->runs = std::make_unique<serve::PlantRuns>(*parts->plant, serve::PlantRuns::Order::in_turn,
                                                   [due = &parts->is_report_due] { *due = true; });
  return std::shared_ptr<PlantRun>(new PlantRun(std::move(parts)));
}

PlantRun::PlantRun(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
PlantRun::~PlantRun() = default;

void PlantRun::set_look(Look look) { parts_->look = std::move(look); }
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

std::string PlantRun::take_events() { return take(parts_->lines); }

std::vector<std::string> PlantRun::buses() const {
  parts_->check_open();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parts_->plant->bus_count(); ++i) names.push_back(parts_->plant->bus(i).name());
  return names;
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
  auto& seat = parts_->sdo_seats[on.name()];
  if (!seat) seat = std::make_unique<SdoSeat>(on, parts_->timeline_of(on));
  if (!seat->start(node, index, sub, value, time_out, block)) throw PlantProblem("the bus takes no frame");
  try {
    parts_->drive(can::never, 0ns, [&seat] { return seat->is_over; });
  } catch (...) {
    seat->cancel();
    throw;
  }
  const canopen::AbortCode code = seat->client.abort_code();
  SdoResult result{.abort_code = static_cast<std::uint32_t>(code)};
  if (code != canopen::AbortCode::none) {
    result.reason = client::describe_abort(code, !seat->client.gave_up(), time_out);
  } else if (!value) {
    result.data.assign(seat->client.data().begin(), seat->client.data().end());
  }
  return result;
}

void PlantRun::record(const std::string& bus) {
  parts_->check();
  can::Bus& on = parts_->bus(bus);
  const auto [recorder, is_new] = parts_->recorders.try_emplace(on.name());
  if (is_new) on.add_observer(recorder->second);
}

std::vector<TimedFrame> PlantRun::take_frames(const std::string& bus) {
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

std::string PlantRun::take_messages() { return take(parts_->messages); }

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
  script.touched(now());
  parts_->plant->device_touched(number);
}

std::string PlantRun::get(const std::string& device, const std::string& object) {
  parts_->check_open();
  const std::size_t number = parts_->device(device);
  const canopen::Entry entry = parts_->entry(number, object);
  const auto bits = parts_->plant->device(number).device().node().dictionary().get<std::uint64_t>(entry);
  return plant::json_value(entry.description->type, bits).dump();
}

PlantPort::PlantPort(std::shared_ptr<PlantRun> run, std::string_view bus, const std::string& name)
    : run_(std::move(run)) {
  PlantRun::Parts& parts = *run_->parts_;
  parts.check();
  parts.start();
  can::Bus& on = parts.bus(bus);
  seat_ = std::make_shared<Seat>(on, parts.timeline_of(on), name);
  parts.seats.push_back(seat_);
}

PlantPort::~PlantPort() { close(); }

void PlantPort::close() noexcept {
  PlantRun::Parts& parts = *run_->parts_;
  if (seat_->port() == nullptr || parts.is_running) return;
  seat_->leave();
  std::erase(parts.seats, seat_);
}

void PlantPort::send(const can::Frame& frame) {
  run_->parts_->check();
  if (seat_->port() == nullptr) throw PlantProblem("the port is closed");
  if (!seat_->port()->send(frame)) throw PlantProblem("the transmit queue is full: let time pass");
}

std::optional<TimedFrame> PlantPort::receive(can::Duration time_out) {
  run_->parts_->check();
  if (seat_->port() == nullptr) throw PlantProblem("the port is closed");
  if (seat_->frames.empty() && time_out > 0ns) {
    run_->parts_->drive(can::later(run_->now(), time_out), 0ns, [this] { return !seat_->frames.empty(); });
  }
  if (seat_->frames.empty()) return std::nullopt;
  const TimedFrame frame = seat_->frames.front();
  seat_->frames.pop_front();
  return frame;
}

std::uint64_t PlantPort::lost() const noexcept { return seat_->lost; }

std::string PlantPort::state() const {
  if (seat_->port() == nullptr) throw PlantProblem("the port is closed");
  return std::string(can::name(seat_->port()->error_state()));
}

}  // namespace canopus::python
