#pragma once
// Labels of the engineering tool, as operands of instruction lists.

#include <string>

namespace canopus::instruction_list {

struct Label {
  std::string program{};  ///< whose local label it is: the name of a list; empty: a global one
  std::string name{};
  std::string type{};    ///< "INT"
  std::string device{};  ///< what it stands for; empty: it is a variable
};

}  // namespace canopus::instruction_list
