#include "canopus/eds/foreign_files.hpp"

#include <algorithm>

#include "canopus/ascii/words.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

struct Beginning {
  std::string_view text;  // in lower case
  std::string_view kind;
};
constexpr Beginning beginnings[] = {
    {"#profibus", "a PROFIBUS GSD file"},
    {"lin_description_file", "a LIN description file"},
    {"version \"", "a CAN database (DBC)"},
    {"{", "JSON"},
    {"pk\x03\x04", "a ZIP archive; a device file may be in it"},
    {"\x1f\x8b", "a gzip archive; a device file may be in it"},
    {"7z\xbc\xaf", "a 7z archive; a device file may be in it"},
    {"%pdf", "a PDF document"},
    {"\x7f"
     "elf",
     "a program"},
};

/// The lower-case text behind blanks and comments, as far as it is looked at.
std::string beginning_of(std::string_view text) {
  constexpr std::size_t most = 4096;
  text = text.substr(0, most);
  while (true) {
    const std::size_t start = text.find_first_not_of(" \t\r\n");
    if (start == std::string_view::npos) return {};
    text.remove_prefix(start);
    if (!text.starts_with(';')) break;
    text.remove_prefix(std::min(text.find('\n'), text.size()));
  }
  return ascii::lower(text.substr(0, 64));
}

/// The networks of CIP share one format of device files [CIP volume 1, chapter 7].
std::string_view cip_kind(const IniFile& file) {
  const Section* const device = file.find("device");
  if (device == nullptr || device->find("vendcode") == nullptr) return {};
  constexpr std::pair<std::string_view, std::string_view> networks[] = {
      {"ethernetip", "an EtherNet/IP device file"},
      {"devicenet", "a DeviceNet device file"},
      {"controlnet", "a ControlNet device file"},
      {"componet", "a CompoNet device file"},
  };
  if (const Section* const classes = file.find("deviceclassification")) {
    for (const Item& item : classes->items) {
      const std::string value = folded(item.value);
      for (const auto& [network, kind] : networks) {
        if (value.find(network) != std::string::npos) return kind;
      }
    }
    return "a device file of a CIP network";
  }
  return file.find("ioinfo") != nullptr ? "a DeviceNet device file" : "a device file of a CIP network";
}

}  // namespace

std::string_view foreign_kind(std::string_view text, const IniFile& file) {
  if (const std::string_view kind = cip_kind(file); !kind.empty()) return kind;
  if (file.find("topology") != nullptr) return "a list of nodes (CiA 306), which canopus project reads,";
  const std::string beginning = beginning_of(text);
  const auto* const known =
      std::ranges::find_if(beginnings, [&](const Beginning& one) { return beginning.starts_with(one.text); });
  return known == std::end(beginnings) ? std::string_view() : known->kind;
}

}  // namespace canopus::eds
