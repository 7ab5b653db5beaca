#pragma once
// A device description file as a device: the contents of an EDS or DCF [CiA 306], an XDD or XDC [CiA 311],
// read tolerantly. Files in the field are broken in many ways; the reader repairs what a person would repair,
// with a note that names the line, and refuses only files without a reasonable meaning.
//
// No file is opened here: the text comes in as it is, with any bytes, any line ends.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::eds {

/// Something about a file that is not as it should be.
struct Problem {
  enum class Severity : std::uint8_t {
    error,  ///< the file cannot be used
    loss,  ///< something in the file that matters for communication is not in the device: an object, value, type, limit or
           ///< mapping was left out or replaced
    warning,  ///< repaired: the file contradicts itself or [CiA 306], and a reading was chosen
    note,     ///< unusual, harmless
  };
  Severity severity = Severity::error;
  unsigned line = 0;    ///< from 1
  unsigned column = 0;  ///< from 1; 0 = the whole line
  std::string message;  ///< without file name and line: "DefaultValue=0x1FF does not fit UNSIGNED8: ..."
};

/// "error", "loss", "warning", "note".
[[nodiscard]] std::string_view name(Problem::Severity severity) noexcept;

/// [FileInfo]; empty or 0 where the file has no value.
struct FileInfo {
  std::string file_name;
  std::uint32_t version = 0;
  std::uint32_t revision = 0;
  std::string eds_version;  ///< "4.0"
  std::string description;
  std::string creation_time;  ///< hh:mmAM
  std::string creation_date;  ///< MM-DD-YYYY
  std::string created_by;
  std::string modification_time;  ///< hh:mmAM
  std::string modification_date;  ///< MM-DD-YYYY
  std::string modified_by;
  std::string last_eds;  ///< DCF: the EDS it was made from
};

/// [DeviceInfo]. A number that the file does not give is empty: 1018H may still have it (identity()).
struct DeviceInfo {
  std::string vendor_name;
  std::string product_name;
  std::string order_code;
  std::optional<std::uint32_t> vendor_number;
  std::optional<std::uint32_t> product_number;
  std::optional<std::uint32_t> revision_number;
  std::vector<std::uint32_t> bit_rates;  ///< supported, bit/s, rising; empty when the file names none
  bool simple_boot_up_master = false;
  bool simple_boot_up_slave = false;
  std::uint8_t granularity = 8;  ///< bits per mapped object, 0 = mapping fixed, 1..64
  std::uint32_t dynamic_channels = 0;
  bool group_messaging = false;
  std::uint16_t rpdos = 0;  ///< NrOfRXPDO of the file
  std::uint16_t tpdos = 0;  ///< NrOfTXPDO of the file
  bool lss = false;
  std::uint8_t compact_pdo = 0;  ///< bits 0..5: sub-indexes 01H..06H of generated PDO communication records
};

/// [DeviceComissioning] of a DCF.
struct Commissioning {
  std::optional<std::uint8_t> node_id;  ///< 1..127
  std::string node_name;
  std::uint32_t bit_rate = 0;  ///< bit/s; 0 = not given
  std::uint32_t net_number = 0;
  std::string network_name;
  bool canopen_manager = false;
  std::uint32_t lss_serial_number = 0;
};

/// A text that hardly any entry has: a pointer.
class RareText {
 public:
  RareText() = default;
  explicit RareText(std::string text)
      : text_(text.empty() ? nullptr : std::make_unique<const std::string>(std::move(text))) {}
  RareText(const RareText& other) : RareText(other.text()) {}
  RareText(RareText&&) noexcept = default;
  RareText& operator=(const RareText& other) { return *this = RareText(other); }
  RareText& operator=(RareText&&) noexcept = default;
  RareText& operator=(std::string text) { return *this = RareText(std::move(text)); }
  ~RareText() = default;

  [[nodiscard]] const std::string& text() const noexcept {
    static const std::string none;
    return text_ ? *text_ : none;
  }
  operator const std::string&() const noexcept { return text(); }
  [[nodiscard]] bool empty() const noexcept { return text_ == nullptr; }

  friend bool operator==(const RareText& a, const RareText& b) noexcept { return a.text() == b.text(); }
  friend bool operator==(const RareText& a, std::string_view b) noexcept { return a.text() == b; }
  template <typename Stream>
  friend Stream& operator<<(Stream& stream, const RareText& text) {
    stream << text.text();
    return stream;
  }

 private:
  std::unique_ptr<const std::string> text_;  // nullptr: empty
};

/// Attributes of a sub-index that a dictionary does not need.
struct EntryFacts {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  unsigned line = 0;               ///< of its section
  std::uint32_t object_flags = 0;  ///< bit 0: do not write on download, bit 1: do not read on scan
  bool configured = false;         ///< a DCF gives it a ParameterValue to download
  RareText default_text;           ///< of a configured one: its DefaultValue as the file writes it
  RareText denotation;             ///< the application's name for it
  RareText description;            ///< what it is for, in sentences; may have line ends
  RareText object_description;     ///< in sub-index 00H of an ARRAY or RECORD: that of the whole object
  RareText upload_file;            ///< DOMAIN: receives what is read
  RareText download_file;          ///< DOMAIN: is written to the device
};

/// [MxModuleInfo] of a modular device, x = position + 1.
struct ModuleInfo {
  std::string product_name;
  std::uint32_t product_version = 0;
  std::uint32_t product_revision = 0;
  std::string order_code;
};

/// 1000H and 1018H, as a master compares them (1F84H-1F88H). Empty: the file has no value, or the object does
/// not exist.
struct Identity {
  std::optional<std::uint32_t> device_type;
  std::optional<std::uint32_t> vendor_id;
  std::optional<std::uint32_t> product_code;
  std::optional<std::uint32_t> revision;
  std::optional<std::uint32_t> serial_number;
};

/// Values that never change, shared by all copies.
template <typename T>
class SharedValues {
 public:
  SharedValues() = default;
  SharedValues(std::vector<T> values) : values_(std::make_shared<const std::vector<T>>(std::move(values))) {}
  [[nodiscard]] const T* begin() const noexcept { return values_ ? values_->data() : nullptr; }
  [[nodiscard]] const T* end() const noexcept {
    return values_ ? values_->data() + values_->size() : nullptr;
  }
  [[nodiscard]] std::size_t size() const noexcept { return values_ ? values_->size() : 0; }
  [[nodiscard]] bool empty() const noexcept { return size() == 0; }
  [[nodiscard]] const T& operator[](std::size_t position) const { return (*values_)[position]; }

 private:
  std::shared_ptr<const std::vector<T>> values_;
};

/// A copy with another dictionary (DictionaryDescription::with) costs its few texts.
struct DeviceFile {
  FileInfo file;
  DeviceInfo device;
  std::optional<Commissioning> commissioning;  ///< present: the file is a DCF
  std::uint32_t dummy_usage = 0;               ///< bit n: data type n may be mapped as a dummy into an RPDO
  SharedValues<std::string> comments;
  SharedValues<EntryFacts> facts;        ///< every sub-index, in order of index and sub-index
  std::vector<ModuleInfo> modules;       ///< that a modular device can take
  std::vector<std::uint16_t> connected;  ///< module types by slot, 1 = modules[0]
  std::shared_ptr<const canopen::DictionaryDescription> dictionary;  ///< never null

  /// Facts of one sub-index, or nullptr. Sub-indexes of a uniform object share those of sub-index 01H.
  [[nodiscard]] const EntryFacts* find_facts(std::uint16_t index, std::uint8_t sub) const noexcept;
};

struct ReadResult {
  std::shared_ptr<const DeviceFile> file;  ///< null: refused, and problems[0] is the error
  std::vector<Problem> problems;           ///< worst first, then by line; every one has a line

  [[nodiscard]] bool has_losses() const noexcept {
    return !problems.empty() && file != nullptr && problems.front().severity == Problem::Severity::loss;
  }
};

/// Reads an EDS, DCF, XDD or XDC; the content decides which. A refusal is the only failure.
[[nodiscard]] ReadResult read_device_file(std::string_view text);

/// The values of 1000H and 1018H of a device made from this file.
[[nodiscard]] Identity identity(const DeviceFile& file);
/// The default (or configured) value of a sub-index of fixed length for this node-ID, zero-extended; empty
/// when there is none.
[[nodiscard]] std::optional<std::uint64_t> default_value(const canopen::DictionaryDescription& dictionary,
                                                         std::uint16_t index, std::uint8_t sub,
                                                         std::uint8_t node_id);
/// Receive and transmit PDOs that have a communication record.
struct PdoCount {
  unsigned rpdos = 0;
  unsigned tpdos = 0;
};
[[nodiscard]] PdoCount count_pdos(const canopen::DictionaryDescription& dictionary) noexcept;

/// Name of a data type as in CiA 301: "UNSIGNED8"; "unknown" for others.
[[nodiscard]] std::string_view name(canopen::DataType type) noexcept;

}  // namespace canopus::eds
