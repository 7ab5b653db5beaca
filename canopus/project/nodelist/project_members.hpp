#pragma once
// Who is in a CiA 306 project, for those that simulate or boot it: the list and what the DCFs say of themselves.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <vector>

namespace canopus::project {

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

/// `list`: path of nodelist.cpj; `network`: from 0. `read` gives a file's content; its error is a sentence that names the file.
[[nodiscard]] ProjectMembers read_members(
    const std::string& list, std::size_t network,
    const std::function<std::expected<std::string, std::string>(const std::string& path)>& read);

}  // namespace canopus::project
