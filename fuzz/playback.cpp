// Any text as the CSV file of a playback: a mistake has a place in the text and a message, and what is read is played
// without one.

#include <algorithm>
#include <memory>
#include <string_view>

#include "canopus/eds/device_file.hpp"
#include "canopus/plant/device_script.hpp"
#include "canopus/sim/device/device.hpp"

#include "input.hpp"

namespace {

using namespace canopus;

struct Nobody final : can::Sink {
  bool send(const can::Frame&) override { return true; }
};

constexpr std::string_view device_file =
    "[DeviceInfo]\nVendorName=x\n[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n2=0x1001\n3=0x1018\n"
    "[1000]\nParameterName=Device type\nDataType=7\nAccessType=ro\nDefaultValue=0\n"
    "[1001]\nParameterName=Error register\nDataType=5\nAccessType=ro\nDefaultValue=0\n"
    "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=2\n"
    "[1018sub0]\nParameterName=Highest sub-index\nDataType=5\nAccessType=ro\nDefaultValue=1\n"
    "[1018sub1]\nParameterName=Vendor-ID\nDataType=7\nAccessType=ro\nDefaultValue=1\n"
    "[OptionalObjects]\nSupportedObjects=0\n[ManufacturerObjects]\nSupportedObjects=5\n"
    "1=0x2000\n2=0x2001\n3=0x2002\n4=0x2003\n5=0x2006\n"
    "[2000]\nParameterName=Level\nDataType=5\nAccessType=ro\nLowLimit=0\nHighLimit=200\n"
    "[2001]\nParameterName=Offset, signed\nDataType=3\nAccessType=ro\n"
    "[2002]\nParameterName=Ratio\nDataType=8\nAccessType=ro\n"
    "[2003]\nParameterName=Switch\nDataType=1\nAccessType=ro\n"
    "[2006]\nParameterName=Label\nDataType=9\nAccessType=ro\nDefaultValue=x\n";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using fuzz::expect;
  static const auto file = eds::read_device_file(device_file).file;
  expect(file != nullptr);
  Nobody nobody;
  const sim::Device device(file, 2, nobody);
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1;
  const plant::CsvLimits limits{.bytes = 1U << 16U, .columns = 8, .values = 1000};
  auto playback = plant::read_playback_csv(text, device, limits);
  if (!playback) {
    expect(playback.error().line <= lines && !playback.error().message.empty());
    return 0;
  }
  const std::size_t columns = playback->entries().size();
  expect(columns >= 1 && columns <= limits.columns && playback->rows() * columns <= limits.values);
  if (playback->rows() >= 2 && (size & 1U) != 0) playback->repeat();
  can::Time now{};
  for (std::size_t row = 0; row < playback->rows() + 2; ++row) {
    expect(playback->at(now).empty() || playback->at(now).size() == columns);
    const can::Time next = playback->next_after(now);
    if (next == can::never) break;
    expect(next > now);
    now = next;
  }
  return 0;
}
