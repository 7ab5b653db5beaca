#include "canopus/web/commands/modules.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/can/bus.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/interface/module.hpp"
#include "canopus/module/interface/program_interface.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/web/commands/wish_fields.hpp"

namespace canopus::web {
namespace {

using module::ResetRequest;
using Kind = ResetRequest::Kind;

/// Between two looks at the module, as a program's scan would have it.
constexpr can::Duration look_interval = std::chrono::milliseconds(1);

/// "Y0F", as the manual writes it in `text`; and the X that belongs to it.
std::string output_name(const ResetRequest& request) {
  return std::string(request.text.substr(0, request.text.find(' ')));
}
std::string input_name(const ResetRequest& request) { return "X" + output_name(request).substr(1); }

std::uint32_t point_of(const plant::ModuleSection& section, const ResetRequest& request) {
  return section.head + request.signal;
}

bool is_on(plc::Rack& rack, plc::Device device, std::uint32_t number, can::Time now) {
  std::uint8_t bit = 0;
  return rack.read_bits(device, number, std::span(&bit, 1), now).has_value() && bit != 0;
}

void set_output(plc::Rack& rack, std::uint32_t number, bool on, can::Time now) {
  const std::uint8_t bit = on ? 1 : 0;
  (void)rack.write_bits(plc::Device::y, number, std::span(&bit, 1), now);
}

/// The rows of a word: one for FROM and another one for TO, or one for CANopen modes and another one for Layer 2.
struct WordRows {
  std::vector<const module::BufferRow*> all{};
  std::vector<const module::BufferRow*> writable{};
};

WordRows rows_of(std::span<const module::BufferRow> rows, module::BufferAddress address, bool is_layer2) {
  WordRows found;
  for (const module::BufferRow& row : rows) {
    if (row.name.empty() || !row.covers(address) || row.access == module::WordAccess::none) continue;
    // The first one is that of the CANopen modes.
    if (!is_layer2 && !found.all.empty() && (row.modes & found.all.front()->modes) == 0) continue;
    found.all.push_back(&row);
    if (row.access != module::WordAccess::read) found.writable.push_back(&row);
  }
  return found;
}

/// "expected 1 to 127"
std::string expected_of(const module::ValueRange& range) {
  if (range.kind != module::ValueRange::Kind::one_of)
    return fmt::format("expected {} to {}", range.low, range.high);
  return fmt::format("expected {}{}", range.values.size() == 1 ? "" : "one of ",
                     fmt::join(range.values, ", "));
}

}  // namespace

WebModules::WebModules(plant::Plant& plant, link::LoopClock& clock) : plant_(plant), clock_(clock) {
  plant.timeline().add(*this, "the page's requests to modules");
}

void WebModules::clear_errors(const text::Json& wish, Done done) { begin(wish, false, std::move(done)); }
void WebModules::restart(const text::Json& wish, Done done) { begin(wish, true, std::move(done)); }

std::string WebModules::live_bus(const text::Json& wish) const {
  const auto modules = plant_.modules();
  const auto number = number_field(wish, "number", 0, modules.size() - 1);
  if (modules.empty() || !number) return {};
  const std::string_view name = modules[*number].label.bus;
  for (std::size_t i = 0; i < plant_.bus_count(); ++i) {
    const plant::BusSection& section = plant_.bus_section(i);
    if (plant_.bus(i).name() == name && section.is_linked() && section.replay.empty())
      return std::string(name);
  }
  return {};
}

std::expected<std::size_t, std::string> WebModules::module_of(const text::Json& wish) const {
  const std::size_t count = plant_.modules().size();
  if (count == 0) return std::unexpected("the plant has no modules");
  if (const auto number = number_field(wish, "number", 0, count - 1)) return *number;
  return std::unexpected(fmt::format("number: expected that of a module of the plant, 0 to {}", count - 1));
}

plc::Rack* WebModules::rack_of(std::size_t module) const {
  const std::uint16_t head = plant_.module_section(module).head;
  for (std::size_t i = 0; i < plant_.plc_count(); ++i) {
    if (plant_.rack(i).module_at(head) == &plant_.module(module)) return &plant_.rack(i);
  }
  return nullptr;
}

std::expected<WebModules::Json, std::string> WebModules::write_word(const text::Json& wish) {
  const auto number = module_of(wish);
  if (!number) return std::unexpected(number.error());
  constexpr std::uint64_t most = 0xFFFF;
  const auto address_field = number_field(wish, "address", 0, most);
  const auto value_field = number_field(wish, "value", 0, most);
  if (!address_field) return std::unexpected("address: expected 0 to 65535");
  if (!value_field) return std::unexpected("value: expected 0 to 65535");
  const auto address = static_cast<std::uint16_t>(*address_field);
  const auto value = static_cast<std::uint16_t>(*value_field);
  const plant::ModuleStatus status = plant_.modules()[*number];
  const auto refuse = [&](const auto& why) {
    return std::unexpected(fmt::format("{} G{}: {}", status.label.name, address, why));
  };
  const bool is_layer2 = !status.information.node_id;
  const WordRows rows =
      rows_of(plant::find_module(plant_.module(*number).model())->buffer_rows, address, is_layer2);
  if (rows.all.empty()) return refuse("the module has no such word");
  if (rows.writable.empty()) return refuse("a program can only read this word");
  const auto row = std::ranges::find_if(
      rows.writable, [&](const module::BufferRow* one) { return one->range.contains(value); });
  if (row == rows.writable.end())
    return refuse(fmt::format("{} does not fit; {}", value, expected_of(rows.writable.front()->range)));
  plc::Rack* const rack = rack_of(*number);
  if (rack == nullptr || !status.is_on) return refuse("the PLC has no supply");
  (void)clock_.now();
  const can::Time now = plant_.timeline().now();
  const std::uint16_t head = plant_.module_section(*number).head;
  if (const auto done = rack->write_buffer(head, address, std::span(&value, 1), now); !done)
    return refuse("the rack refuses the write");
  clock_.touched();
  return Json{{"module", status.label.name},
              {"address", address},
              {"name", (*row)->name},
              {"value", plant_.module(*number).buffer_memory()->peek(address, now)}};
}

std::expected<WebModules::Job, std::string> WebModules::job_of(const text::Json& wish, bool is_restart) {
  const auto number = module_of(wish);
  if (!number) return std::unexpected(number.error());
  const auto modules = plant_.modules();
  Job job{.module = *number, .is_restart = is_restart};
  const plant::ModuleSection& section = plant_.module_section(job.module);
  const plant::ModuleStatus& status = modules[job.module];
  const auto refuse = [&](const auto& why) {
    return std::unexpected(fmt::format("{}: {}", status.label.name, why));
  };
  if (std::ranges::any_of(jobs_, [&](const Job& other) { return other.module == job.module; }))
    return refuse("another request of the page is not yet over; it goes on with plant time");
  job.procedure = plant::find_module(plant_.module(job.module).model())->reset_procedure;
  if (job.request().kind == Kind::none) return refuse(job.request().text);
  job.rack = rack_of(job.module);
  if (job.rack == nullptr || !status.is_on) return refuse("the PLC has no supply");
  if (job.request().kind == Kind::word) {
    // Other words than these are refused then, and that would be one error more [FX3U-CAN 6.8].
    if (!is_restart && initializes(job.module, plant_.timeline().now()))
      return refuse("it still initializes, and takes no words");
    return job;
  }
  const std::string y = output_name(job.request());
  if (job.rack->cpu_state() == module::CpuState::stop)
    return refuse(fmt::format("the CPU is in STOP, where its Y are OFF: {} wants RUN", y));
  if (job.rack->is_paused())
    return refuse(fmt::format("the CPU is in PAUSE, where its Y stay as they are: {} wants RUN", y));
  if (is_on(*job.rack, plc::Device::y, point_of(section, job.request()), plant_.timeline().now()))
    return refuse(fmt::format("{} is ON already: the PLC program, or another client, asks for the same", y));
  return job;
}

void WebModules::begin(const text::Json& wish, bool is_restart, Done done) {
  (void)clock_.now();
  auto job = job_of(wish, is_restart);
  if (!job) return done(std::unexpected(job.error()));
  const can::Time now = plant_.timeline().now();
  const plant::ModuleSection& section = plant_.module_section(job->module);
  const can::Duration longest =
      is_restart
          ? std::max(longest_restart, section.restart_time.value_or(can::Duration::zero()) + longest_clear)
          : longest_clear;
  job->began = now;
  job->until = can::later(now, longest);
  job->done = std::move(done);
  if (job->request().kind == Kind::signal) {
    set_output(*job->rack, point_of(section, job->request()), true, now);
  } else {
    const std::uint16_t value = job->request().value;
    (void)job->rack->write_buffer(section.head, job->request().word, std::span(&value, 1), now);
  }
  if (jobs_.empty()) alarm() = can::later(now, look_interval);
  jobs_.push_back(std::move(*job));
  clock_.touched();
}

void WebModules::tick(can::Time now) {
  alarm() = can::later(now, look_interval);
  for (Job& job : jobs_) step(job, now);
  // The receiver of a result may ask for the next one at once.
  std::vector<std::pair<Done, std::expected<Json, std::string>>> finished;
  for (Job& job : jobs_)
    if (std::exchange(job.has_result, false))
      finished.emplace_back(std::exchange(job.done, {}), std::move(job.result));
  std::erase_if(jobs_, [](const Job& job) { return job.is_over; });
  if (jobs_.empty()) alarm().cancel();
  for (auto& [done, result] : finished) done(std::move(result));
}

void WebModules::step(Job& job, can::Time now) {
  if (!plant_.modules()[job.module].is_on) {  // with it all Y have gone
    if (job.step != Step::in_stop) fail(job, "the PLC's supply went off meanwhile");
    job.is_over = true;
    return;
  }
  if (job.request().kind == Kind::signal) return step_signal(job, now);
  step_word(job, now);
}

void WebModules::step_signal(Job& job, can::Time now) {
  const std::uint32_t point = point_of(plant_.module_section(job.module), job.request());
  plc::Rack& rack = *job.rack;
  const bool is_stopped = rack.cpu_state() == module::CpuState::stop;
  if (job.step == Step::in_stop) {
    if (is_stopped) return;
    set_output(rack, point, false, now);
    job.is_over = true;
    return;
  }
  if (is_stopped && job.step == Step::asked) {
    fail(job, fmt::format("the CPU went to STOP meanwhile, and {} OFF with all its Y",
                          output_name(job.request())));
    job.step = Step::in_stop;
    return;
  }
  // With a scan of its own the rack shows the module's X, and the module the Y, later.
  const module::SignalAccess& signals = *plant_.module(job.module).signals();
  const bool is_seen = (signals.outputs() >> job.request().signal & 1U) != 0;
  const bool answer = is_on(rack, plc::Device::x, point, now);
  if (job.step == Step::asked) {
    const bool is_answered = is_seen && answer == job.is_restart;
    if (!is_answered && now < job.until) return;
    if (!is_answered) {
      job.trouble = fmt::format("{} stays {} for {} s; {} is OFF again", input_name(job.request()),
                                answer ? "ON" : "OFF", can::seconds(now) - can::seconds(job.began),
                                output_name(job.request()));
    }
    job.took = now - job.began;
    set_output(rack, point, false, now);
    job.step = Step::released;
    job.until = can::later(now, longest_clear);
    return;
  }
  if ((is_seen || (job.is_restart && answer)) && now < job.until) return;
  end(job, now);
}

void WebModules::step_word(Job& job, can::Time now) {
  if (job.is_restart && initializes(job.module, now)) {
    if (now < job.until) return;
    job.trouble =
        fmt::format("the module still initializes after {} s", can::seconds(now) - can::seconds(job.began));
  }
  job.took = now - job.began;
  end(job, now);
}

void WebModules::end(Job& job, can::Time now) {
  job.is_over = true;
  if (!job.trouble.empty()) return fail(job, job.trouble);
  const double seconds = std::chrono::duration<double>(job.took).count();
  job.result =
      Json{{"module", plant_.modules()[job.module].label.name},
           {"said", job.is_restart
                        ? fmt::format("restarted in {:.3f} s: {}", seconds, job.request().text)
                        : fmt::format("errors cleared: {}{}", job.request().text, still_wrong(job, now))},
           {"seconds", seconds}};
  job.has_result = true;
}

void WebModules::fail(Job& job, std::string why) {
  job.result =
      std::unexpected(fmt::format("{}: {}", plant_.modules()[job.module].label.name, std::move(why)));
  job.has_result = true;
}

bool WebModules::initializes(std::size_t module, can::Time now) const {
  const module::ProgramInterface& interface = plant_.module(module).program_interface();
  module::BufferMemoryAccess* const buffer = plant_.module(module).buffer_memory();
  if (buffer == nullptr || interface.initializing == 0) return false;
  const bool is_0 = (buffer->peek(interface.status, now) & interface.initializing) == 0;
  return is_0 == interface.initializing_is_0;
}

/// What has come back, or never went.
std::string WebModules::still_wrong(const Job& job, can::Time now) const {
  module::BufferMemoryAccess* const buffer = plant_.module(job.module).buffer_memory();
  if (buffer == nullptr || job.procedure->error_word_name.empty()) return {};
  const std::uint16_t errors = buffer->peek(job.procedure->error_word, now);
  if (errors == 0) return {};
  return fmt::format("; {} is {:04X}H: that is still wrong", job.procedure->error_word_name, errors);
}

}  // namespace canopus::web
