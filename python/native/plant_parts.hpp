#pragma once
// What a plant of the Python module is made of, behind PlantRun and PlantPort.

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <fmt/format.h>

#include "canopus/client/sdo_transfer_on_bus.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/process_value.hpp"
#include "canopus/serve/linked_buses.hpp"
#include "canopus/serve/plant_runs.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/print/message_printer.hpp"

#include "pictures.hpp"
#include "plant_run.hpp"

namespace canopus::python {

using namespace std::chrono_literals;

/// A port of the plant, and what it has heard.
class PlantPort::Attachment final : public can::Participant {
 public:
  Attachment(can::Bus& bus, can::Timeline& timeline, const std::string& name)
      : timeline_(&timeline), port_(&bus.add_port(name)), handle_(timeline.add(*this, name)) {
    port_->connect(*this);
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
  void tick(can::Time now) override {
    for (Cycle& cycle : cycles_) {
      while (cycle.next <= now && cycle.next < cycle.end) {
        if (!port_->send(cycle.frames[cycle.position])) ++unsent;
        cycle.position = (cycle.position + 1) % cycle.frames.size();
        cycle.next = can::later(cycle.next, cycle.period);
      }
    }
    std::erase_if(cycles_, [](const Cycle& cycle) { return cycle.next >= cycle.end; });
    set_alarm();
  }

  std::size_t repeat(std::vector<can::Frame> frames_of_it, can::Duration period, can::Duration duration) {
    const can::Time now = timeline_->now();
    cycles_.push_back({.token = ++last_token_,
                       .frames = std::move(frames_of_it),
                       .period = period,
                       .next = now,
                       .end = duration == 0ns ? can::never : can::later(now, duration)});
    set_alarm();
    return last_token_;
  }
  /// False: it has ended.
  bool change(std::size_t token, std::vector<can::Frame> frames_of_it) {
    for (Cycle& cycle : cycles_) {
      if (cycle.token != token || cycle.frames.size() != frames_of_it.size()) continue;
      cycle.frames = std::move(frames_of_it);
      return true;
    }
    return false;
  }
  void stop(std::size_t token) {
    std::erase_if(cycles_, [token](const Cycle& cycle) { return cycle.token == token; });
    set_alarm();
  }

  [[nodiscard]] can::Port* port() const noexcept { return port_; }
  std::deque<TimedFrame> frames;
  std::uint64_t lost = 0;
  std::uint64_t unsent = 0;  ///< periodic frames that met a full queue
  bool is_awaited = false;   ///< time waits until somebody has taken the frames

 private:
  void keep(const TimedFrame& frame) {
    if (frames.size() >= most_frames) {
      ++lost;
      frames.pop_front();
    }
    frames.push_back(frame);
  }
  void set_alarm() {
    can::Time next = can::never;
    for (const Cycle& cycle : cycles_) next = std::min(next, cycle.next);
    alarm() = next;
  }
  /// Frames that are sent in turn, one each period.
  struct Cycle {
    std::size_t token = 0;
    std::vector<can::Frame> frames{};
    std::size_t position = 0;
    can::Duration period{};
    can::Time next{};
    can::Time end = can::never;
  };
  can::Timeline* timeline_;
  can::Port* port_;
  std::vector<Cycle> cycles_;
  std::size_t last_token_ = 0;
  can::Timeline::Handle handle_;
};

/// An SDO client on a bus.
class SdoOnBus final : public can::Participant, private canopen::SdoClientListener {
 public:
  SdoOnBus(can::Bus& bus, can::Timeline& timeline)
      : port(bus.add_port("SDO client")), timeline_(timeline), client(port) {
    alarm().add_part(client.alarm());
    timeline.add(*this, "SDO client");
    port.connect(*this);
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
    return started;
  }
  /// Nobody waits for the answer any more.
  void cancel() {
    if (client.busy()) client.cancel(canopen::AbortCode::general);
  }
  void receive(const can::Frame& frame, can::Time now) override { client.receive(frame, now); }
  void tick(can::Time now) override { client.tick(now); }

  can::Port& port;
  bool is_over = false;

 private:
  void sdo_finished(canopen::SdoClient&, can::Time) override { is_over = true; }
  can::Timeline& timeline_;
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
  Analyser(trace::Decoder& decoder, std::uint16_t channel, std::string bus, text::Output& out)
      : decoder_(decoder), channel_(channel), bus_(std::move(bus)), out_(out) {}
  void frame_completed(const can::Frame& frame, can::Time, can::Time end) override {
    decoder_.receive({.time = end, .channel = channel_, .frame = frame}, bus_,
                     [&](const trace::Message& message) { out_.json(trace::to_json(message, bus_)); });
  }

 private:
  trace::Decoder& decoder_;
  std::uint16_t channel_;
  std::string bus_;
  text::Output& out_;
};

/// Somebody on a bus of the plant who has to go before it does.
class PlantGuest {
 public:
  virtual void plant_ends() noexcept = 0;

 protected:
  ~PlantGuest() = default;
};

/// Lines: what is wrong with a file.
std::string joined(std::vector<text::FileError> errors, const std::string& path);

struct PlantRun::Parts {
  Parts(const std::string& path) : printer(lines), linked(io, path, true) {}

  text::TextOutput lines;
  plant::JsonPrinter printer;
  boost::asio::io_context io{1};
  serve::LinkedBuses linked;
  trace::Names names;
  text::TextOutput messages;
  std::unique_ptr<trace::Decoder> decoder;
  std::vector<std::unique_ptr<Analyser>> analysers;
  std::map<std::string, Recorder> recorders;
  std::map<std::string, std::unique_ptr<SdoOnBus>> sdo_clients;
  std::vector<std::shared_ptr<PlantPort::Attachment>> attachments;
  std::vector<PlantGuest*> guests;
  std::vector<std::pair<can::Bus*, std::shared_ptr<PlantPicture>>> pictures;
  std::unique_ptr<plant::Plant> plant;
  std::unique_ptr<serve::PlantRuns> runs;
  bool is_report_due = false;
  std::map<std::size_t, ScriptedDevice*> scripts;  // they belong to the devices
  std::optional<std::size_t> acting;
  Hook hook;
  Callback check_signals;
  Callback arrival;
  bool is_on = false;
  bool is_running = false;
  bool is_between = false;  // time waits for those who take frames: they may send
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
  /// Nothing runs, or time waits.
  void check_between() const {
    if (!is_between) check();
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
      const can::Time piece = step == 0ns || !scripts.empty() || is_awaited()
                                  ? next
                                  : std::max(next, can::later(line.now(), step));
      line.run_until(std::min(piece, end));
      if (std::exchange(is_report_due, false)) runs->report();
      wait_for_takers();
      if (check_signals && (!scripts.empty() || ++turns % often == 0)) check_signals();
    }
  }

  [[nodiscard]] bool is_awaited() const noexcept {
    return std::ranges::any_of(attachments, [](const auto& attachment) { return attachment->is_awaited; });
  }
  /// Those in other threads who wait for frames get them at their moment.
  void wait_for_takers() {
    const auto is_due = [](const auto& attachment) {
      return attachment->is_awaited && !attachment->frames.empty();
    };
    if (!arrival || std::ranges::none_of(attachments, is_due)) return;
    const Running between(is_between);
    arrival();
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
    for (const auto& attachment : attachments) attachment->leave();
    attachments.clear();
    for (PlantGuest* guest : std::exchange(guests, {})) guest->plant_ends();
    for (auto& [name, recorder] : recorders) bus(name).remove_observer(recorder);
    for (std::size_t i = 0; i < analysers.size(); ++i) plant->bus(i).remove_observer(*analysers[i]);
    for (const auto& [on, picture] : pictures) on->remove_observer(*picture);
    pictures.clear();
    scripts.clear();
    hook = nullptr;
    plant.reset();
    sdo_clients.clear();
  }
};

}  // namespace canopus::python
