#pragma once

namespace canopus::web {

/// Environment variables by which ChildProcess passes on that it is the parent: its process ID, and the folder that it made for this
/// process alone (empty: none).
inline constexpr const char* parent_variable = "CANOPUS_PARENT";
inline constexpr const char* parent_folder_variable = "CANOPUS_PARENT_FOLDER";
/// Of the name of such a folder; others are left alone.
inline constexpr const char* child_folder_prefix = "canopus-";

/// To be called first of all in main(), while there is one thread. Where ChildProcess has started this process, it gets SIGTERM when
/// its parent ends. With a folder the process becomes two: the call returns in the second one; the first one passes signals on to it,
/// ends as it has ended, and removes the folder if the parent, which would do that, is there no more.
void end_with_parent();

}  // namespace canopus::web
