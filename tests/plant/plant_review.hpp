#pragma once
// What `canopus check` says of a plant file that a test writes.

#include "canopus/canopen/dictionary/stored_values.hpp"
#include "canopus/module/storage/flash_memory.hpp"
#include "canopus/store/file_memory.hpp"

#include "support/plant_folder.hpp"

namespace canopus::plant::plant_review {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

inline const std::string bus = "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n";  // 3 lines

/// A PDO with one byte mapped: communication record, mapping record.
inline std::string pdo(const std::string& communication, const std::string& mapping,
                       const std::string& cob_id, const std::string& type,
                       const std::string& mapped = "0x60000008") {
  const auto record = [](const std::string& index) {
    return "[" + index + "]\nParameterName=P\nObjectType=9\n";
  };
  const auto sub = [](const std::string& index, int number, int data_type, const std::string& value) {
    return "[" + index + "sub" + std::to_string(number) + "]\nDataType=" + std::to_string(data_type) +
           "\nAccessType=rw\nDefaultValue=" + value + "\n";
  };
  return record(communication) + sub(communication, 0, 5, "2") + sub(communication, 1, 7, cob_id) +
         sub(communication, 2, 5, type) + record(mapping) + sub(mapping, 0, 5, "1") +
         sub(mapping, 1, 7, mapped);
}

inline const std::string input = "[6000]\nParameterName=I\nDataType=5\nAccessType=ro\nPDOMapping=1\n";
inline const std::string output = "[6200]\nParameterName=O\nDataType=5\nAccessType=rww\nPDOMapping=1\n";

class PlantReviewTest : public support::PlantFolder {
 protected:
  /// 4 lines.
  [[nodiscard]] static std::string device(int node, const std::string& eds, const std::string& more = "") {
    return "[[device]]\nnode = " + std::to_string(node) + "\neds = \"" + eds + "\"\nname = \"" +
           eds.substr(0, eds.find('.')) + std::to_string(node) + "\"\n" + more;
  }
  [[nodiscard]] static std::string unconfigured(const std::string& name, const std::string& eds,
                                                const std::string& more = "") {
    return "[[device]]\nnode = \"unconfigured\"\neds = \"" + eds + "\"\nname = \"" + name + "\"\n" + more;
  }
  /// 7 lines.
  [[nodiscard]] static std::string master(const std::string& more) {
    return "[[plc]]\nlisten = \"off\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nnode = 1\n"
           "master = true\n" +
           more;
  }
  const std::string served = bus + "serve = \"socketcand:127.0.0.1:0\"\n";
};

}  // namespace canopus::plant::plant_review
