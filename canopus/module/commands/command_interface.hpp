#pragma once
// Command interface (CIF): the PLC writes a command code and its parameters into a block of 67 words, has it
// executed, and reads result code and data in the same words: SDO read and write (local and remote, single
// and multiple), sending an emergency message, and what else the module has [ME3CAN1-Q 3.5.18, 5].
//
// The block has two planes, or is one memory (CommandLayout::is_one_memory). Writes go to the request plane. After a command reads show the result plane; the
// next write (or the display command: as the last command found it) brings the request plane back. While a
// command runs the first word reads FFFFH; a write then locks the interface until command FFFFH is executed.
//
//   idle --execute--> busy --done--> idle (result shown)
//                     busy --write--> locked --execute FFFFH--> idle

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/module/canopen/emergency_buffer.hpp"
#include "canopus/module/canopen/nmt_status.hpp"
#include "canopus/module/commands/set_up_command.hpp"
#include "canopus/module/layer2/layer2.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

/// What a command does.
enum class CommandKind : std::uint8_t {
  display,   ///< show the request plane
  sdo_read,  ///< one object of up to 124 bytes
  sdo_write,
  multi_read,  ///< up to eight objects of up to 8 bytes
  multi_write,
  emergency,   ///< send an emergency message
  send_frame,  ///< send a plain CAN frame
  clear,       ///< end the locked state
  set_up,      ///< nodes, by SDO: CommandRow::set_up
  map_pdos,    ///< a PDO mapping mode: CommandRow::mapping
  // The FX2N-32CAN's own.
  emergency_bytes,  ///< send an emergency message of these eight bytes
  plain_frame,      ///< send a CAN frame, in any NMT state
  request_pdos,     ///< remote frames of one RPDO, or of all
  guarding_status,  ///< of a node, of the next failing one (success + 1), of all (success + 2)
  clear_guarding,   ///< failures of a node, or of all
  read_emergencies,  ///< received messages: of the stack, of the ring (success + 1), the next unread one (success + 2)
};

/// Where all PDOs of the module stand afterwards, and the process data words are 0 [FX3U-CAN 7.2].
enum class PdoMapping : std::uint8_t {
  mode_0,  ///< the factory's
  mode_a,  ///< RPDOs 1 to 32 receive TPDOs 1 to 4 of the nodes 1 to 8
  mode_b,  ///< all RPDOs are disabled
};

/// One row of a module's command table.
struct CommandRow {
  std::uint16_t code = 0;
  CommandKind kind = CommandKind::display;
  Modes modes = every_mode;
  std::uint16_t success = 0;  ///< result code
  std::uint16_t partial = 0;  ///< result code when some, or the special condition of the command, failed
  SetUpKind set_up{};
  PdoMapping mapping{};
};

/// Local abort codes beyond CiA 301 [ME3CAN1-Q 8.2.3].
inline constexpr auto abort_no_channel = static_cast<canopen::AbortCode>(0x50000000);
inline constexpr auto abort_buffer_too_small = static_cast<canopen::AbortCode>(0x60600000);

struct CommandLayout {
  BufferAddress first = 0;  ///< of the command code; 66 more words follow
  std::span<const CommandRow> commands{};
  /// A multiple access leaves a record without a node (FFFFH) out; else such a record ends the list [RJ71CN91 1.3].
  bool skips_empty_records = false;
  /// Abort code of a node number above 127.
  canopen::AbortCode no_such_node = abort_no_channel;
  /// A frame is sent when it was on the wire: within this time, else class slot_error, timeout. 0: it is sent when it waits
  /// in the controller [RJ71CN91 App. 2 CIF].
  can::Duration frame_time_out{};
  /// FFFFH ends a running command at once, not only a locked interface [FX3U-CAN 10.9.2].
  bool clear_code_stops = false;
  SetUpRules set_up{};
  /// Of SDO read and write.
  std::size_t data_bytes = 124;
  /// What is written is never read: reads show results alone [FX2N-32CAN 6.4.6].
  bool reads_results_only = false;
  /// Wrong state and bus-off have classes of their own; else an SDO access fails with abort_no_channel, and what is sent
  /// finds no queue [FX2N-32CAN 6.4.1].
  bool has_state_classes = true;
  /// Abort codes of a node that does not answer, and of a channel that is in use.
  canopen::AbortCode silent_node = canopen::AbortCode::timed_out;
  canopen::AbortCode channel_in_use = canopen::AbortCode::no_sdo_connection;
  /// Of a value that turns out too long only while it comes.
  canopen::AbortCode too_long_at_last = abort_buffer_too_small;
  /// The result of an SDO write has its length [FX2N-32CAN Tab. 6.1].
  bool shows_written_length = false;
  /// The words are one memory: the result overwrites what it is stored over, and every other word stays as it was
  /// [RJ71CN91 App. 2 CIF]. Else there are two planes.
  bool is_one_memory = false;
  /// This object of the own node takes no value from the interface (06010000H), but one byte 0, which deletes
  /// [RJ71CN91 App. 5].
  std::optional<std::uint16_t> object_not_set{};
};

/// Classes of the general error result 000FH [ME3CAN1-Q 5.4].
namespace command_error {
inline constexpr std::uint16_t result = 0x000F;
inline constexpr std::uint16_t sdo = 0x0003;
inline constexpr std::uint16_t unknown_command = 0x0064;
inline constexpr std::uint16_t internal = 0x00C8;  // [FX2N-32CAN 6.4.8]
inline constexpr std::uint16_t wrong_state = 0x0F0F;
inline constexpr std::uint16_t bus_off = 0xB0FF;
inline constexpr std::uint16_t queue_full = 0x8FFF;  // [FX3U-CAN 10.9]
inline constexpr std::uint16_t slot_error = 0x000F;
inline constexpr std::uint16_t was_busy = 0xFFFF;
}  // namespace command_error

/// What the command interface needs of the module around it.
class CommandHost {
 public:
  enum class EmergencyAnswer : std::uint16_t { sent = 0, inhibited = 1, wrong_state = 2 };

  /// 0 when a command may use the bus now, else the error class to report.
  [[nodiscard]] virtual std::uint16_t bus_obstacle() const = 0;
  [[nodiscard]] virtual std::uint8_t own_node_id() const = 0;
  [[nodiscard]] virtual canopen::ObjectDictionary& dictionary() = 0;
  [[nodiscard]] virtual can::Duration sdo_time_out() const = 0;
  /// False while another part of the module uses the default SDO channel of this node.
  [[nodiscard]] virtual bool sdo_channel_available(std::uint8_t node_id) const = 0;
  virtual EmergencyAnswer send_emergency(std::uint16_t code, std::uint8_t error_register,
                                         std::span<const std::uint8_t, 5> manufacturer, can::Time now) = 0;
  /// Queues a plain frame. `parameters` are the words after the command code; `faults` gets a value other
  /// than 0 at each parameter that is wrong.
  virtual PlainFrameResult send_plain_frame(std::span<const std::uint16_t> parameters,
                                            std::span<std::uint16_t> faults) = 0;
  /// 1F80H makes this node an NMT master.
  [[nodiscard]] virtual bool is_nmt_master() const = 0;
  /// PDOs of the module, each way.
  [[nodiscard]] virtual std::uint16_t pdos() const = 0;
  virtual void map_pdos(PdoMapping mapping, can::Time now) = 0;
  /// Nothing is executed now: what is requested begins with CommandInterface::release() [FX2N-32CAN 6.4.7].
  [[nodiscard]] virtual bool holds_commands() const = 0;
  /// False: no queue has room for it.
  virtual bool send_now(const can::Frame& frame) = 0;
  virtual EmergencyBuffer& emergencies() = 0;
  virtual const NmtStatus& nmt_status() const = 0;
  /// Failures of one node's error control are over, or of all (0).
  virtual void clear_error_control(std::uint8_t node_id, can::Time now) = 0;
  /// The command is finished and its result can be read.
  virtual void command_finished(can::Time now) = 0;

 protected:
  ~CommandHost() = default;
};

class CommandInterface final : public BufferArea, public canopen::SdoClientListener {
 public:
  static constexpr std::size_t word_count = 67;
  static constexpr std::size_t most_data_bytes = 124;

  /// Everything must outlive the interface. Without a layout there are no words and no commands.
  CommandInterface(const std::optional<CommandLayout>& layout, BufferMemory& memory, CommandHost& host,
                   can::Sink& sink);

  /// As from power-on; a running transfer is given up.
  void reset();
  /// Starts the command in the request plane; it runs at least `duration`. Nothing happens while busy.
  void execute(Modes mode, can::Time now, can::Duration duration);
  [[nodiscard]] bool busy() const noexcept { return running_; }
  /// The address is one of its words.
  [[nodiscard]] bool owns(BufferAddress address) const noexcept {
    return layout_ && address - layout_->first < word_count;
  }
  /// The bus may not be used any more: a command that waits for another node ends with this error class, and
  /// sends nothing.
  void bus_lost(std::uint16_t error_class, can::Time now);
  /// The node whose default SDO channel is in use, or 0.
  [[nodiscard]] std::uint8_t remote_node() const noexcept { return client_.busy() ? client_.server() : 0; }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) const override;
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

  /// The frame of CommandHost::send_plain_frame() is sent.
  void frame_sent(can::Time now);
  /// A frame is on the wire: the next remote frame of `request_pdos` may follow.
  void transmitted(const can::Frame& frame, can::Time now) {
    if (pdo_requested_ && frame == *pdo_requested_) request_next_pdo(now);
  }
  /// CommandHost::holds_commands() is over.
  void release(can::Time now) {
    if (held_) begin(now);
  }

  /// True when the frame was for the running transfer.
  bool receive(const can::Frame& frame, can::Time now) { return client_.receive(frame, now); }
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }
  void sdo_finished(canopen::SdoClient& client, can::Time now) override;

 private:
  static constexpr std::size_t records = 8;  // of a multiple access
  static constexpr std::size_t words_per_record = 8;
  static constexpr std::uint16_t frame_timeout = 0x2002;

  using Plane = std::array<std::uint16_t, word_count>;
  void begin(can::Time now);
  void start_access(can::Time now);
  void access_done(canopen::AbortCode code, std::span<const std::uint8_t> data, can::Time now);
  void next_access(can::Time now);
  [[nodiscard]] bool skip_empty_records() noexcept;
  void send_emergency(can::Time now);
  void send_frame(can::Time now);
  void connection_lost(can::Time now);
  void set_up(can::Time now);
  void refuse_slaves(can::Time now);
  void continue_set_up(can::Time now);
  void map_pdos(can::Time now);
  void send_emergency_bytes(can::Time now);
  void send_any_frame(can::Time now);
  void request_pdos(can::Time now);
  void request_next_pdo(can::Time now);
  [[nodiscard]] std::uint16_t shown_guarding(std::uint8_t node_id) const;
  void show_guarding(can::Time now);
  void clear_guarding(can::Time now);
  void show_emergencies(can::Time now);
  void put_emergency(const EmergencyBuffer::Received& received, std::size_t word);
  /// A parameter that is none, which no error class is for.
  void fail_internally(can::Time now);
  void give_up_sending(can::Time now);
  void finish(std::uint16_t result, can::Time now);
  void fail(std::uint16_t error_class, can::Time now);
  /// The words of the result before the command stores its own.
  void begin_result() noexcept;
  [[nodiscard]] bool is_multiple() const noexcept {
    return command_->kind == CommandKind::multi_read || command_->kind == CommandKind::multi_write;
  }
  [[nodiscard]] bool is_read() const noexcept {
    return command_->kind == CommandKind::sdo_read || command_->kind == CommandKind::multi_read;
  }
  [[nodiscard]] bool needs_bus() const noexcept;
  /// The abort code of the last transfer as this module shows it.
  [[nodiscard]] canopen::AbortCode shown_code() const noexcept;
  /// 0 when `command_` may use the bus; what has no class for it fails in its own way.
  [[nodiscard]] std::uint16_t bus_obstacle_class() const;
  [[nodiscard]] bool is_local(std::uint16_t node) const noexcept {
    return node == 0 || node == host_->own_node_id();
  }

  std::optional<CommandLayout> layout_;
  CommandHost* host_;
  canopen::SdoClient client_;
  Plane request_{};
  Plane result_{};
  Plane running_request_{};
  Plane last_issued_{};  // of the commands that have parameters
  bool show_result_ = false;
  bool running_ = false;  // between execute() and the end of the command
  bool locked_ = false;   // written to while running
  Modes mode_ = 0;
  const CommandRow* command_ = nullptr;
  can::Alarm alarm_;  // of these, and of the client
  can::Alarm begin_at_;
  can::Alarm frame_due_;  // the frame waits to be sent
  std::size_t record_ = 0;
  bool any_failed_ = false;
  std::array<std::uint8_t, most_data_bytes> download_{};
  SetUpCommand set_up_;
  bool set_up_reads_ = false;                // its access under way
  bool held_ = false;                        // by CommandHost::holds_commands()
  std::uint16_t next_pdo_ = 0;               // of request_pdos
  std::optional<can::Frame> pdo_requested_;  // waits to be on the wire
  std::uint8_t shown_failing_ = 0;           // by guarding_status
};

}  // namespace canopus::module
