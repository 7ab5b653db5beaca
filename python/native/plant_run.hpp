#pragma once
// A plant in virtual time, in this process, as the Python module drives it: its time moves when somebody asks for that, and
// stands still otherwise. For one thread at a time. Nothing here knows Python.

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/trace/decode/names.hpp"

#include "scripted_device.hpp"

namespace canopus::python {

/// What was asked for is not possible, in a sentence. Nothing has happened.
class PlantProblem : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A frame and when its last bit was on the bus.
struct TimedFrame {
  can::Time time{};
  can::Frame frame{};
  bool sent = false;  ///< by the port itself
};

/// How an SDO transfer ended.
struct SdoResult {
  std::uint32_t abort_code = 0;  ///< 0: well
  std::string reason{};          ///< "abort 06020000H: object does not exist"
  std::vector<std::uint8_t> data{};
  bool size_indicated = true;  ///< false: `data` is all four bytes of an expedited answer
};

class PlantRun;
class PlantPicture;  // pictures.hpp

/// A simulated device, and a value of its process: what they show of themselves.
struct DeviceView {
  std::string bus{};
  unsigned node = 0;
  std::string name{};
  std::string state{};  ///< of NMT, or "off"
};
struct ObjectView {
  std::string object{};  ///< "6000:01"
  std::string name{};
  std::string type{};
  std::string value{};
};

/// A node of its own on a bus: hears every frame, acknowledges, and sends. What nobody takes is kept, up to `most_frames`.
class PlantPort {
 public:
  static constexpr std::size_t most_frames = 1'000'000;
  PlantPort(std::shared_ptr<PlantRun> run, std::string_view bus, const std::string& name);
  ~PlantPort();
  PlantPort(const PlantPort&) = delete;
  PlantPort& operator=(const PlantPort&) = delete;

  /// Queues the frame. A problem: the queue of 128 frames is full, or the port is closed.
  void send(const can::Frame& frame);
  /// False: the queue is full.
  [[nodiscard]] bool offer(const can::Frame& frame);
  /// The next frame; lets plant time pass until one comes, `time_out` at most.
  std::optional<TimedFrame> receive(can::Duration time_out);
  /// The next frame that is there already, at any time.
  std::optional<TimedFrame> next();
  /// From now on one of the frames in turn each period, for so long, 0: until stop(). Those that meet a full queue are not
  /// sent. A token.
  std::size_t repeat(std::vector<can::Frame> frames, can::Duration period, can::Duration duration);
  /// Other frames, as many, without a change of the moments. False: it has ended.
  bool change(std::size_t token, std::vector<can::Frame> frames);
  void stop(std::size_t token);
  /// Time waits, in the plant's arrival callback, until the frames that the port hears are taken.
  void await(bool is_awaited) noexcept;
  /// Frames heard that nobody has taken.
  [[nodiscard]] std::size_t waiting() const noexcept;
  [[nodiscard]] std::uint64_t unsent() const noexcept;
  [[nodiscard]] std::uint64_t lost() const noexcept;
  [[nodiscard]] std::string state() const;
  /// Off the bus; again: nothing.
  void close() noexcept;

  class Attachment;  // known to plant_run.cpp alone

 private:
  std::shared_ptr<PlantRun> run_;
  std::shared_ptr<Attachment> attachment_;
};

class PlantRun : public std::enable_shared_from_this<PlantRun> {
 public:
  /// Called every now and then while time passes; may throw, which ends the run at that moment.
  using Callback = std::function<void()>;

  /// Reads the file at `path`, or `text` as if it were there. A problem: every mistake, a line each.
  static std::shared_ptr<PlantRun> open(const std::string& path, const std::optional<std::string>& text,
                                        std::optional<std::uint64_t> seed);
  ~PlantRun();
  PlantRun(const PlantRun&) = delete;
  PlantRun& operator=(const PlantRun&) = delete;

  void set_signal_check(Callback check_signals);
  /// Called as soon as a port that is awaited has frames; ports may take and send frames meanwhile, and nothing else.
  void set_arrival(Callback arrival);
  /// Ends the run. Everything but now() is a problem afterwards; again: nothing.
  void close();
  [[nodiscard]] bool is_closed() const noexcept;
  /// Readable at any time, also after close().
  [[nodiscard]] can::Time now() const noexcept;

  /// A request of the control server and its answer (docs/control.md).
  std::string ask(const std::string& line);
  void run_until(can::Time end);
  /// Lines of JSON since the last call (docs/events.md).
  std::string drain_events();
  [[nodiscard]] std::vector<std::string> buses() const;
  /// In bit/s; of the only bus when the name is empty.
  [[nodiscard]] std::uint32_t bit_rate(const std::string& bus) const;
  [[nodiscard]] std::vector<std::string> plcs() const;

  std::vector<std::uint16_t> read_words(const std::string& plc, const std::string& device,
                                        std::uint32_t first, std::size_t count);
  void write_words(const std::string& plc, const std::string& device, std::uint32_t first,
                   std::span<const std::uint16_t> words);
  std::vector<std::uint8_t> read_bits(const std::string& plc, const std::string& device, std::uint32_t first,
                                      std::size_t count);
  void write_bits(const std::string& plc, const std::string& device, std::uint32_t first,
                  std::span<const std::uint8_t> bits);
  std::vector<std::uint16_t> read_buffer(const std::string& plc, unsigned unit, std::uint32_t first,
                                         std::size_t count);
  void write_buffer(const std::string& plc, unsigned unit, std::uint32_t first,
                    std::span<const std::uint16_t> words);
  /// "run", "stop", "pause"
  void set_cpu(const std::string& plc, const std::string& state);
  [[nodiscard]] std::string cpu_name(const std::string& plc) const;

  /// Reads, or with `value` writes, an object of a node; plant time passes until the answer is there.
  SdoResult sdo(const std::string& bus, unsigned node, unsigned index, unsigned sub,
                const std::optional<std::string>& value, can::Duration time_out, bool block);

  /// From now on every frame of the bus is kept for drain_frames().
  void record(const std::string& bus);
  std::vector<TimedFrame> drain_frames(const std::string& bus);
  /// What frames mean, as `canopus trace show --json` says it: for drain_messages(), all buses.
  void monitor();
  std::string drain_messages();

  /// Draws the bus from now on, and these signals; without any the first that come.
  std::shared_ptr<PlantPicture> draw(const std::string& bus, const std::vector<std::string>& signals);
  /// Neither lets time pass nor switches anything on.
  [[nodiscard]] std::vector<DeviceView> device_views() const;
  [[nodiscard]] std::vector<ObjectView> object_views(const std::string& device) const;

  using Hook = std::function<void(std::size_t device, std::size_t token, can::Time now)>;
  /// What callbacks of devices are; it must not throw.
  void set_hook(Hook hook);
  /// Before time has passed. `device` as in control requests; a token.
  std::size_t watch(const std::string& device, const std::string& object);
  std::size_t every(const std::string& device, can::Duration period);
  [[nodiscard]] std::size_t device_number(const std::string& device);
  /// The device is to have values put. Before time has passed.
  void script(const std::string& device);
  /// The device's own value, beneath one that is forced. Also inside of the hook.
  void put(const std::string& device, const std::string& object, const std::string& value);
  /// As text: "17", "-3", "true", "2.5". Also inside of the hook.
  [[nodiscard]] std::string get(const std::string& device, const std::string& object);

  struct Parts;

 private:
  friend class PlantPort;
  friend class PlantPlace;
  explicit PlantRun(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// `canopus trace show --json`: lines. A problem: the file cannot be read to its end, with what is wrong.
std::string decode_trace(const std::string& path, const std::string& plant, const std::string& network,
                         const std::vector<std::string>& nodes, bool frames);

}  // namespace canopus::python
