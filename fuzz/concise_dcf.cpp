// Any bytes as a concise DCF: read without leaving them, checked, and written again.

#include "canopus/manager/boot/concise_dcf.hpp"

#include <string>
#include <vector>

#include "input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  using fuzz::expect;
  const std::span<const std::uint8_t> file(data, size);
  const auto checked = manager::check_concise_dcf(file);
  manager::ConciseDcfReader reader(file);
  manager::ConciseDcfWriter writer;
  std::uint32_t entries = 0;
  std::size_t read = 4;
  while (const auto entry = reader.next()) {
    ++entries;
    read += 7 + entry->data.size();
    expect(read <= size);
    expect(entry->data.empty() ||
           (entry->data.data() >= data && entry->data.data() + entry->data.size() <= data + size));
    writer.add(entry->index, entry->sub, entry->data);
  }
  expect(reader.intact() == checked.has_value());
  expect(!reader.next());
  if (!checked) {
    expect(!checked.error().empty());
    return 0;
  }
  expect(*checked == entries && reader.remaining() == 0);
  if (manager::is_empty_concise_dcf(file)) {
    expect(entries == 0);
    return 0;
  }
  // What the entries say is what was read, byte for byte; the file may have more behind them.
  expect(writer.file().size() == read && std::ranges::equal(writer.file(), file.first(read)));
  return 0;
}
