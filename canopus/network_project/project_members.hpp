#pragma once
// The nodes of a CiA 306 project, for code that simulates or boots it: from the list and their DCFs.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <vector>

#include "canopus/network_project/nodelist.hpp"

namespace canopus::network_project {

struct ProjectMember {
  std::uint8_t node_id = 0;  ///< 1 to 127
  std::string name;
  std::string path;         ///< of its DCF, with the folder of the list
  bool is_manager = false;  ///< CANopenManager of its DCF
};

struct ProjectMembers {
  std::vector<ProjectMember> members;  ///< that are present and have a DCF, by node-ID
  std::uint32_t bit_rate = 0;       ///< bit/s, that all DCFs have that name one; 0: none does, or they differ
  std::vector<std::string> errors;  ///< sentences that name the file
};

/// `list`: path of nodelist.cpj; `text`: its contents, or a sentence why it cannot be read; `network`: from
/// 0. `read_dcf` gives the content of the file `name` below `folder`, that of the list ("" or with '/' at its
/// end), and of no other folder; its error is a sentence that names the file. `find` is asked when it has one.
[[nodiscard]] ProjectMembers read_members(
    const std::string& list, const std::expected<std::string, std::string>& text, std::size_t network,
    const std::function<std::expected<std::string, std::string>(const std::string& folder,
                                                                const std::string& name)>& read_dcf,
    const FindFile& find = {});

}  // namespace canopus::network_project
