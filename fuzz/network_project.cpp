// Any bytes as the DCF or XDC of a node of a project, beside a good one: looked at, reviewed, linked and changed; and the same
// bytes as the notes beside the list.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "canopus/network_project/network_load.hpp"
#include "canopus/network_project/network_review.hpp"
#include "canopus/network_project/pdo_link.hpp"

namespace {

using namespace canopus::network_project;

constexpr std::string_view good =
    "[DeviceInfo]\nProductName=good\n[DummyUsage]\nDummy0005=1\nDummy0006=1\n"
    "[1000]\nParameterName=type\nDataType=7\nAccessType=ro\n[1001]\nParameterName=error\nDataType="
    "5\nAccessType=ro\n"
    "[1400]\nObjectType=9\n[1400sub0]\nDataType=5\nAccessType=ro\nDefaultValue=2\n"
    "[1400sub1]\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x200\n[1400sub2]\nDataType=5\nAccessType="
    "rw\nDefaultValue=255\n"
    "[1600]\nObjectType=9\n[1600sub0]\nDataType=5\nAccessType=rw\nDefaultValue=0\n[1600sub1]\nDataType="
    "7\nAccessType=rw\n"
    "[1600sub2]\nDataType=7\nAccessType=rw\n[1600sub3]\nDataType=7\nAccessType=rw\n"
    "[2000]\nParameterName=byte\nDataType=5\nAccessType=rww\nPDOMapping=1\n[2001]\nParameterName="
    "word\nDataType=6\nAccessType=rww\n"
    "PDOMapping=1\n[2002]\nParameterName=double word\nDataType=7\nAccessType=rww\nPDOMapping=1\n"
    "[DeviceComissioning]\nNodeID=2\nBaudrate=250\n";
constexpr std::string_view list =
    "[Topology]\nNodes=2\nNode1Present=1\nNode1DCFName=1.dcf\nNode2Present=1\nNode2DCFName=2.dcf\n";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);  // NOLINT
  const ReadFile read =
      [&](const std::string& path) -> std::expected<std::optional<std::string>, std::string> {
    if (path == "1.dcf" || path == notes_path("list")) return text;
    if (path == "2.dcf") return std::string(good);
    return path == "list" ? std::optional(std::string(list)) : std::nullopt;
  };
  auto project = NetworkProject::open("list", read);
  if (!project || !project->changes().empty()) std::abort();
  for (const Finding& finding : review(*project)) {
    if (finding.message.empty()) std::abort();
  }
  static_cast<void>(reckon_load(*project));
  NetworkProject noted = *project;
  const auto done = noted.set_note(1, "a \"b\"\n");
  if (done ? noted.notes().note(1) != "a \"b\"\n" : noted.changes() != project->changes()) std::abort();
  if (done && !noted.set_note(1, "")) std::abort();
  const ProjectNode& node = project->nodes()[0];
  if (node.device == nullptr) return 0;
  constexpr std::size_t most = 24;
  std::size_t tried = 0;
  std::vector<SignalEnd> ends;
  for (const auto& object : node.device->dictionary->objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub && ends.size() < most; ++sub) {
      ends.push_back({1, object.index, static_cast<std::uint8_t>(sub)});
    }
  }
  for (const SignalEnd& from : ends) {
    const SignalEnd to{2, static_cast<std::uint16_t>(0x2000 + tried++ % 3), 0};
    const NetworkProject before = *project;
    const auto changes = link_signals(*project, from, to);
    if (!changes) {
      if (changes.error().empty() || project->changes() != before.changes()) std::abort();
      continue;
    }
    bool is_there = false;
    for (const SignalLink& link : find_links(*project))
      is_there = is_there || (link.from == from && link.to == to);
    if (!is_there) std::abort();
  }
  return 0;
}
