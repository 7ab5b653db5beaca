#pragma once
// Collects what is wrong with a file while it is read.

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/device_file.hpp"

namespace canopus::eds {

class Problems {
 public:
  using Severity = Problem::Severity;

  void report(Severity severity, unsigned line, std::string message, unsigned column = 0);
  void error(unsigned line, std::string message) { report(Severity::error, line, std::move(message)); }
  void loss(unsigned line, std::string message) { report(Severity::loss, line, std::move(message)); }
  void warning(unsigned line, std::string message) { report(Severity::warning, line, std::move(message)); }
  void note(unsigned line, std::string message) { report(Severity::note, line, std::move(message)); }
  /// For what files do in hundreds of places: the first of its `kind` is reported, the others are counted. A loss is
  /// reported at every place.
  void repeated(Severity severity, const std::string& kind, unsigned line, std::string message,
                unsigned column = 0);

  /// Everything, worst first, then by line.
  [[nodiscard]] std::vector<Problem> release();

 private:
  struct Repeated {
    std::size_t position;
    unsigned more = 0;
  };
  std::vector<Problem> list_;
  std::map<std::string, Repeated> repeated_;
  unsigned not_listed_ = 0;
  bool not_listed_loss_ = false;
};

/// Text of the file as it may stand in a message: control characters and bytes that are not UTF-8 replaced,
/// long text cut.
[[nodiscard]] std::string printable(std::string_view text);
using ascii::counted;
using canopen::object_name;
using canopen::object_text;

}  // namespace canopus::eds
