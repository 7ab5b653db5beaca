#include "canopus/app/lss_command.hpp"

#include <cstdio>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "canopus/app/bus_command.hpp"
#include "canopus/app/sdo_value.hpp"
#include "canopus/app/text_values.hpp"
#include "canopus/manager/lss_master.hpp"

namespace canopus::app {
namespace {

using manager::LssAddress;
using manager::LssMaster;
using manager::LssResult;

struct Arguments {
  BusOptions bus;
  std::string node;
  std::string vendor, product, revision, serial;
  std::string assign;
  bool store = false;
};

/// Of a fastscan: is anybody there, and for each part 32 bits and a confirmation.
constexpr unsigned fastscan_questions = 1 + 4 * 33;

/// One LSS service at a time, waited for.
class LssOnBus final : public can::Participant, private manager::LssMasterUser, private can::Sink {
 public:
  LssOnBus(BusLoop& bus, can::Duration time_out) : bus_(bus), master_(*this, *this, {.time_out = time_out}) {
    bus_.add(*this);
  }
  ~LssOnBus() override { bus_.remove(*this); }
  LssOnBus(const LssOnBus&) = delete;
  LssOnBus& operator=(const LssOnBus&) = delete;

  /// Begins a service and waits for its end; nothing when the bus or the person ended it.
  template <typename Service>
  std::optional<LssResult> service(Service begin) {
    result_.reset();
    frames_ = 0;
    if (!begin(master_, bus_.now())) return std::nullopt;
    end_ = BusLoop::End::time_over;
    while (end_ == BusLoop::End::time_over) {
      end_ = bus_.run([this] { return result_.has_value(); },
                      progress_ ? bus_.now() + std::chrono::milliseconds(100) : can::never);
      if (progress_) progress_(frames_);
    }
    return result_;
  }
  void set_progress(std::function<void(unsigned frames)> progress) { progress_ = std::move(progress); }
  [[nodiscard]] const LssMaster& master() const noexcept { return master_; }
  /// Why service() gave nothing.
  [[nodiscard]] BusLoop::End end() const noexcept { return end_; }

  void receive(const can::Frame& frame, can::Time now) override { master_.receive(frame, now); }
  void tick(can::Time now) override { master_.tick(now); }
  [[nodiscard]] can::Time deadline() const noexcept override { return master_.deadline(); }

 private:
  void lss_finished(LssMaster&, LssResult result, can::Time) override { result_ = result; }
  bool send(const can::Frame& frame) override {
    ++frames_;
    return bus_.send(frame);
  }

  BusLoop& bus_;
  LssMaster master_;
  std::function<void(unsigned)> progress_;
  std::optional<LssResult> result_;
  unsigned frames_ = 0;
  BusLoop::End end_ = BusLoop::End::done;
};

int print_device(const Arguments& arguments, const LssAddress& address, unsigned node) {
  if (arguments.bus.json) {
    nlohmann::ordered_json line;
    line["vendor"] = address.vendor;
    line["product"] = address.product;
    line["revision"] = address.revision;
    line["serial"] = address.serial;
    if (node != 0) line["node"] = node;
    fmt::print("{}\n", line.dump());
  } else {
    fmt::print("vendor {:08X}  product {:08X}  revision {:08X}  serial {:08X}", address.vendor,
               address.product, address.revision, address.serial);
    if (node != 0) fmt::print("  is node {} now", node);
    fmt::print("\n");
  }
  std::fflush(stdout);
  return exit_code::done;
}

/// What a service that had to succeed ended with, as an exit code.
int judge(const LssOnBus& lss, const BusLoop& bus, std::optional<LssResult> result, std::string_view what) {
  if (!result) return complain_of(lss.end(), bus, "");
  switch (*result) {
    case LssResult::done: return exit_code::done;
    case LssResult::silence: return complain(exit_code::failed, fmt::format("{}: no answer", what));
    case LssResult::lost:
      return complain(exit_code::failed, fmt::format("{}: the device stopped answering in the middle", what));
    case LssResult::refused: break;
  }
  return complain(exit_code::failed, fmt::format("{}: refused with error {} (specific {})", what,
                                                 lss.master().error(), lss.master().specific_error()));
}

/// The selected device gets its node-ID, keeps it if asked to, and all go back to waiting state.
int configure(LssOnBus& lss, const BusLoop& bus, std::uint8_t node, bool store) {
  const auto configured =
      lss.service([&](auto& master, can::Time now) { return master.configure_node_id(node, now); });
  int code = judge(lss, bus, configured, fmt::format("setting node-ID {}", node));
  if (code == exit_code::done && store) {
    const auto stored = lss.service([](auto& master, can::Time now) { return master.store(now); });
    code = judge(lss, bus, stored, "storing");
  }
  (void)lss.service([](auto& master, can::Time now) { return master.switch_global(false, now); });
  return code;
}

int scan(const Arguments& arguments) {
  const unsigned first = arguments.assign.empty() ? 0 : parse_node(arguments.assign);
  if (first == 0 && !arguments.assign.empty()) {
    return complain(exit_code::usage,
                    fmt::format("--assign: \"{}\" is not a node-ID 1 to 127", arguments.assign));
  }
  if (first == 0 && arguments.store) return complain(exit_code::usage, "--store needs --assign");
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    LssOnBus lss(bus, time_out);
    unsigned count = 0;
    const bool bar = is_terminal(STDERR_FILENO);
    const auto end_bar = [&] {
      if (bar) std::fputs("\r\x1b[K", stderr);
    };
    if (bar) {
      lss.set_progress([&count](unsigned frames) {
        fmt::print(stderr, "\r\x1b[Kdevice {}: question {} of {}", count + 1, frames, fastscan_questions);
        std::fflush(stderr);
      });
    }
    (void)lss.service([](auto& master, can::Time now) { return master.switch_global(false, now); });
    unsigned node = first;
    int code = exit_code::done;
    while (code == exit_code::done) {
      const auto result = lss.service([](auto& master, can::Time now) { return master.fastscan(now); });
      end_bar();
      if (result == LssResult::silence) break;
      code = judge(lss, bus, result, "fastscan");
      if (code != exit_code::done) break;
      const LssAddress address = lss.master().address();
      if (node > 127) {
        code = complain(exit_code::failed, "no node-ID is left for the next device");
        break;
      }
      if (node != 0) code = configure(lss, bus, static_cast<std::uint8_t>(node), arguments.store);
      end_bar();
      if (code != exit_code::done) break;
      ++count;
      print_device(arguments, address, node);
      if (node != 0) ++node;
    }
    // Those that were found wait in configuration state, so that they did not answer again.
    lss.set_progress({});
    (void)lss.service([](auto& master, can::Time now) { return master.switch_global(false, now); });
    if (code != exit_code::done) return code;
    if (count == 0) return complain(exit_code::failed, "no device without a node-ID answers");
    if (!arguments.bus.json) fmt::print("{} device{} found\n", count, count == 1 ? "" : "s");
    return exit_code::done;
  });
}

std::expected<std::optional<LssAddress>, std::string> address_of(const Arguments& arguments) {
  const std::string* words[] = {&arguments.vendor, &arguments.product, &arguments.revision,
                                &arguments.serial};
  LssAddress address;
  unsigned given = 0;
  for (unsigned part = 0; part < 4; ++part) {
    if (words[part]->empty()) continue;
    ++given;
    const auto bytes = encode_value(*words[part], canopen::DataType::unsigned32);
    if (!bytes) return std::unexpected(bytes.error());
    std::uint32_t value = 0;
    for (std::size_t i = bytes->size(); i-- > 0;) value = value << 8 | (*bytes)[i];
    address.set_part(part, value);
  }
  if (given == 0) return std::nullopt;
  if (given == 4) return address;
  return std::unexpected("an LSS address has four parts: --vendor, --product, --revision and --serial");
}

int set_node(const Arguments& arguments) {
  const auto node = static_cast<std::uint8_t>(parse_node(arguments.node));
  if (node == 0) {
    return complain(exit_code::usage,
                    fmt::format("\"{}\" is not a node-ID; expected 1 to 127", arguments.node));
  }
  const auto address = address_of(arguments);
  if (!address) return complain(exit_code::usage, address.error());
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    LssOnBus lss(bus, time_out);
    (void)lss.service([](auto& master, can::Time now) { return master.switch_global(false, now); });
    if (*address) {
      const auto selected =
          lss.service([&](auto& master, can::Time now) { return master.select(**address, now); });
      if (const int code = judge(lss, bus, selected, "selecting the device"); code != exit_code::done)
        return code;
    } else {
      const auto switched =
          lss.service([](auto& master, can::Time now) { return master.switch_global(true, now); });
      if (const int code = judge(lss, bus, switched, "switching"); code != exit_code::done) return code;
    }
    const int code = configure(lss, bus, node, arguments.store);
    if (code == exit_code::done && !arguments.bus.json) {
      fmt::print("node-ID {} set{}\n", node, arguments.store ? " and stored" : "");
    } else if (code == exit_code::done) {
      fmt::print("{}\n", nlohmann::ordered_json{{"node", node}, {"stored", arguments.store}}.dump());
    }
    return code;
  });
}

}  // namespace

void add_lss_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  arguments->bus.time_out = "100ms";
  CLI::App* lss = app.add_subcommand("lss", "Find devices without a node-ID and give them one (LSS)");
  lss->require_subcommand(1);
  lss->footer(
      "Only one LSS master at a time may be on a bus.\n"
      "Exit code: 0 done, 1 no answer, refused, or no bus, 2 wrong command line.");

  CLI::App* scanning = lss->add_subcommand("scan", "Find all devices without a node-ID (fastscan)");
  scanning
      ->add_option("--assign", arguments->assign, "give them node-IDs from this one on, as they are found")
      ->type_name("NODE");
  scanning->add_flag("--store", arguments->store, "and have them keep it");
  add_bus_options(*scanning, arguments->bus, "for each answer; a device takes 133 of them");
  scanning->callback([arguments, &exit_code] { exit_code = scan(*arguments); });

  CLI::App* setting = lss->add_subcommand("set-node", "Give one device its node-ID");
  setting->add_option("NODE", arguments->node, "node-ID, 1 to 127")->required();
  setting->add_option("--vendor", arguments->vendor, "vendor-ID: 405, 0x195 or 195H")->type_name("U32");
  setting->add_option("--product", arguments->product, "product code")->type_name("U32");
  setting->add_option("--revision", arguments->revision, "revision number")->type_name("U32");
  setting->add_option("--serial", arguments->serial, "serial number")->type_name("U32");
  setting->add_flag("--store", arguments->store, "have the device keep it");
  add_bus_options(*setting, arguments->bus, "for each answer");
  setting->footer("Without an address the device must be the only one on the bus that knows LSS.");
  setting->callback([arguments, &exit_code] { exit_code = set_node(*arguments); });
}

}  // namespace canopus::app
