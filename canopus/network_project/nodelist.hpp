#pragma once
// A CiA 306 project: nodelist.cpj names the nodes of one or more networks, and the DCF of each node beside it.
//
//   [Topology]                        a further network: [Topology2] ...
//   NetName=Line 1
//   Nodes=0x02                        how many are listed
//   Node5Present=0x01                 0: configured, but not there; no such key: no such node
//   Node5Name=Pump                    5: the node-ID, in decimal
//   Node5Refd=-M1                     reference designation
//   Node5DCFName=pump.dcf
//   EDSBaseName=../eds                folder of the EDS files

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/eds/device_file.hpp"
#include "canopus/eds/ini_text.hpp"
#include "canopus/eds/problems.hpp"

namespace canopus::network_project {

inline constexpr std::uint8_t highest_node_id = 127;  ///< [CiA 301]

struct ListedNode {
  std::uint8_t node_id = 0;  ///< 1 to 127
  bool present = true;
  std::string name;       ///< UTF-8, as are all texts here; from a file: any characters
  std::string reference;  ///< Refd
  std::string dcf_name;   ///< as written, without quotes; listed_path() makes a path of it
  unsigned line = 0;      ///< of NodeXPresent, from 1; ignored when a node is set
};

struct ListedNetwork {
  std::string section;  ///< "topology", "topology2" ...
  std::string name;     ///< NetName
  std::string reference;
  std::string eds_base_name;
  std::vector<ListedNode> nodes;  ///< by node-ID

  /// The node, or nullptr.
  [[nodiscard]] const ListedNode* find(std::uint8_t node_id) const noexcept;
};

/// The path below the project's folder, with '/', of a file that the project names. Fails with the reason: no name
/// at all, a path that is absolute or leads out of the folder, control characters.
[[nodiscard]] std::expected<std::string, std::string> path_in_project(std::string_view name);

/// Of a file as a list from any computer names it.
struct ListedPath {
  std::string path;  ///< below the project's folder, with '/'
  std::string note;  ///< a sentence about a path of another computer; empty: none
};
/// The same as path_in_project(), but of a Windows path with a drive or server, the file of this name in the project's
/// folder.
[[nodiscard]] std::expected<ListedPath, std::string> listed_path(std::string_view name);

/// Finds a file whose name differs in upper and lower case alone, as Windows lets it: of `name`, a path below `folder`
/// with '/', the path as it is. Nothing: there is none, or more than one.
using FindFile =
    std::function<std::optional<std::string>(const std::string& folder, const std::string& name)>;

/// The list, read, changed and written so that all else in the file stays as it is.
class Nodelist {
 public:
  /// Of a new project: one network without nodes.
  Nodelist();
  /// Takes any bytes. With errors among the problems, the readable part is there, and no change is accepted.
  explicit Nodelist(std::string_view text);

  [[nodiscard]] const std::vector<ListedNetwork>& networks() const noexcept { return networks_; }
  /// The mistakes in its file, worst first, then by line.
  [[nodiscard]] const std::vector<eds::Problem>& problems() const noexcept { return problems_; }
  /// The file as it is now.
  [[nodiscard]] std::string text() const { return file_.text(); }

  /// All of these fail with the reason and change nothing: an unusable file, a network that is not there, a text
  /// that the file cannot hold, a node-ID other than 1 to 127, a DCF outside the folder.
  /// `network`: position in networks().
  [[nodiscard]] std::expected<void, std::string> set_network_name(std::size_t network, std::string_view name);
  /// Adds the node or changes what differs. Nodes= follows.
  [[nodiscard]] std::expected<void, std::string> set_node(std::size_t network, const ListedNode& node);
  /// Takes the node's keys out; no such node: nothing happens. Nodes= follows.
  [[nodiscard]] std::expected<void, std::string> remove_node(std::size_t network, std::uint8_t node_id);

 private:
  void read();
  void read_network(const std::string& section);
  void review(const ListedNetwork& network);
  void report(eds::Problem::Severity severity, unsigned line, std::string message);
  [[nodiscard]] std::expected<void, std::string> usable(std::size_t network) const;
  /// Sets Nodes= of the network to the number of listed nodes, when it differs.
  [[nodiscard]] static std::expected<void, std::string> count_nodes(eds::IniText& file,
                                                                    const std::string& section);
  void set_file(eds::IniText file);

  eds::IniText file_;
  std::vector<ListedNetwork> networks_;
  eds::Problems found_;
  std::vector<eds::Problem> problems_;
};

}  // namespace canopus::network_project
