#pragma once
// A CANopen network as a CiA 306 project: nodelist.cpj and the DCF or XDC of each node, read, changed and written so that only
// the lines concerned differ. "DCF" means DCF or XDC. No file is opened here.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/eds/device_file.hpp"
#include "canopus/eds/files/device_text.hpp"
#include "canopus/eds/problems.hpp"
#include "canopus/network_project/nodelist.hpp"
#include "canopus/network_project/pdo.hpp"
#include "canopus/network_project/project_notes.hpp"

namespace canopus::network_project {

/// The folder of a project: the content of a file of this path below it, or nothing when there is none. The error is a
/// sentence.
using ReadFile =
    std::function<std::expected<std::optional<std::string>, std::string>(const std::string& path)>;

struct ProjectNode {
  ListedNode listed;
  std::string path;  ///< of its DCF below the folder; empty: it has none
  std::string
      path_note{};  ///< a sentence about a file whose name differs from the listed one; empty: it does not
  std::optional<eds::DeviceText> text{};
  std::shared_ptr<const eds::DeviceFile> device{};  ///< nullptr: there is none, `unreadable` has the reason
  std::vector<eds::Problem> problems{};             ///< of its DCF
  std::string unreadable{};                         ///< a sentence without the file's name
  std::vector<Pdo> pdos{};

  [[nodiscard]] std::uint8_t id() const noexcept { return listed.node_id; }
  /// "node 5 (Pump)"
  [[nodiscard]] std::string shown_name() const;
  /// Why it cannot be read, with its file.
  [[nodiscard]] std::string trouble() const {
    return path.empty() || unreadable.contains(path) ? unreadable : path + ": " + unreadable;
  }
  /// A value as the DCF has it, zero-extended; nothing: no such object of fixed length.
  [[nodiscard]] std::optional<std::uint64_t> value(std::uint16_t index, std::uint8_t sub = 0) const;
};

/// The arguments of add_node().
struct NewNode {
  std::uint8_t node_id = 0;    ///< 1 to 127; 0: the lowest that is free
  std::string name{};          ///< empty: the product's name
  std::string eds{};           ///< the device file's text
  std::string eds_name{};      ///< and its file name
  std::uint32_t bit_rate = 0;  ///< bit/s; 0: that of the other nodes
};

class NetworkProject {
 public:
  using Done = std::expected<void, std::string>;

  /// `list`: path of nodelist.cpj below the folder. Fails when there is no such file, or no network of that position; mistakes
  /// in the files are problems of the list and of the nodes.
  [[nodiscard]] static std::expected<NetworkProject, std::string> open(std::string list, ReadFile read,
                                                                       std::size_t network = 0,
                                                                       FindFile find = {});
  /// A project that is not there yet.
  [[nodiscard]] static std::expected<NetworkProject, std::string> make(std::string list, ReadFile read,
                                                                       std::string_view network_name);

  [[nodiscard]] const std::string& list_path() const noexcept { return list_path_; }
  [[nodiscard]] const Nodelist& list() const noexcept { return list_; }
  [[nodiscard]] const ListedNetwork& network() const noexcept { return list_.networks()[network_]; }
  /// By node-ID.
  [[nodiscard]] const std::vector<ProjectNode>& nodes() const noexcept { return nodes_; }
  [[nodiscard]] const ProjectNode* find(std::uint8_t node_id) const noexcept;
  /// "5", "0x05" or a node's name, in any case when that is the only one. The error names what was expected.
  [[nodiscard]] std::expected<const ProjectNode*, std::string> find(std::string_view node) const;
  /// Bit rate in bit/s on which the DCFs agree; 0: none has one, or they differ.
  [[nodiscard]] std::uint32_t bit_rate() const;
  /// The lowest node-ID from 1 on that no node has, 0: none.
  [[nodiscard]] std::uint8_t free_node_id() const noexcept;

  /// Each of these fails with a sentence and changes nothing then.
  [[nodiscard]] Done set_name(std::string_view name);
  /// In the DCF of every node. bit/s; refused when a device does not have it.
  [[nodiscard]] Done set_bit_rate(std::uint32_t bit_rate);
  /// Makes a DCF of an EDS or DCF, an XDC of an XDD or XDC: its node-ID.
  [[nodiscard]] std::expected<std::uint8_t, std::string> add_node(const NewNode& node);
  /// Removes it from the list, and its DCF if no other node uses it.
  [[nodiscard]] Done remove_node(std::uint8_t node_id);
  /// Name, reference, present and node-ID, in the list and its DCF.
  [[nodiscard]] Done change_node(std::uint8_t node_id, const ListedNode& node);
  /// ParameterValue of a sub-index, as a device file has it.
  [[nodiscard]] Done set_value(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                               std::string_view value);
  /// Takes its ParameterValue out, so that the default counts; none: nothing happens.
  [[nodiscard]] Done remove_value(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub);
  /// Gives a PDO the COB-ID, transmission type, times and mapping of `pdo`; values that are already equal are
  /// not written.
  [[nodiscard]] Done set_pdo(std::uint8_t node_id, const Pdo& pdo);

  /// Of its nodes; project_notes.hpp.
  [[nodiscard]] const ProjectNotes& notes() const noexcept { return notes_; }
  /// Empty takes it out.
  [[nodiscard]] Done set_note(std::uint8_t node_id, std::string_view note);

  /// The changes since the project was read, notes (nodelist.notes.toml) included: the text of each file, or
  /// nothing for one to delete. Still the same after they were saved: then open the project again.
  [[nodiscard]] std::map<std::string, std::optional<std::string>> changes() const;

 private:
  NetworkProject(std::string list_path, ReadFile read, Nodelist list, std::size_t network);
  void read_notes();
  void read_nodes();
  void read_node(ProjectNode& node);
  [[nodiscard]] ProjectNode* find_own(std::uint8_t node_id) noexcept;
  /// The node to change, with a DCF that can be changed.
  [[nodiscard]] std::expected<ProjectNode*, std::string> editable(std::uint8_t node_id);
  [[nodiscard]] std::expected<std::string, std::string> free_file_name(const std::string& name,
                                                                       std::uint8_t node_id,
                                                                       std::string_view extension) const;
  void put(ProjectNode& node, eds::DeviceText text);
  [[nodiscard]] std::string in_folder(std::string_view name) const;
  /// The path below the folder of a file that is there in other upper and lower case; empty: none.
  [[nodiscard]] std::string path_in_other_case(const std::string& name) const;

  std::string list_path_;
  ReadFile read_;
  FindFile find_{};
  Nodelist list_;
  std::size_t network_;
  std::vector<ProjectNode> nodes_;
  ProjectNotes notes_{std::nullopt, 0};
  std::map<std::string, std::optional<std::string>> original_;  // of each path that was read or made
};

/// Sub-indexes of a node by number ("6000:01", "1017") or name ("Producer heartbeat time", "Read input.Input
/// 1"), in upper or lower case. The error names similar objects, or those that have that name.
[[nodiscard]] std::expected<canopen::Entry, std::string> find_object(const ProjectNode& node,
                                                                     std::string_view text);
/// The same in a dictionary; `owner` is how its node is shown: "node 5 (Pump)".
[[nodiscard]] std::expected<canopen::Entry, std::string> find_object(
    const canopen::DictionaryDescription& dictionary, std::string_view owner, std::string_view text);
/// The name of a sub-index: "Read input 8-bit: Input 1", "Producer heartbeat time".
[[nodiscard]] std::string object_title(const eds::DeviceFile& file, const canopen::Entry& entry);
[[nodiscard]] std::string object_title(const canopen::DictionaryDescription& dictionary,
                                       const canopen::Entry& entry);

}  // namespace canopus::network_project
