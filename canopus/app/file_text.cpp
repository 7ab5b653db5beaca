#include "canopus/app/file_text.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <fmt/format.h>

namespace canopus::app {

std::expected<std::string, std::string> read_file(const std::string& path) {
  constexpr std::size_t most = std::size_t{64} << 20;
  const auto refuse = [&path](const std::string& why) {
    return std::unexpected(fmt::format("cannot read {}: {}", path, why));
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) return refuse(std::strerror(errno));
  std::string text;
  std::array<char, 65536> piece;
  while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), file.get())) {
    text.append(piece.data(), count);
    if (text.size() > most) return refuse("it is larger than 64 MiB");
  }
  if (std::ferror(file.get()) != 0) return refuse(std::strerror(errno));
  return text;
}

}  // namespace canopus::app
