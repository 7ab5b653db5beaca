#pragma once
// The containers of a BLF file: their unpacked contents as one stream of objects. Memory use does not depend
// on the size that a container declares.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "canopus/trace/file/trace_input.hpp"

namespace canopus::trace {

class BlfContainers {
 public:
  /// `input` is positioned behind the header of the file.
  explicit BlfContainers(TraceInput input);
  ~BlfContainers();
  BlfContainers(const BlfContainers&) = delete;
  BlfContainers& operator=(const BlfContainers&) = delete;

  /// The next bytes of the objects, 0 at their end. Objects outside of containers come as they are.
  std::size_t read(std::span<char> out);
  /// The error of the file, with its name and the offset; empty: none.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }

 private:
  enum class Content : std::uint8_t { none, plain, deflated };
  struct Inflater;

  bool find_object();
  std::size_t read_plain(std::span<char> out);
  std::size_t read_deflated(std::span<char> out);
  void fail(const std::string& expected);

  TraceInput input_;
  Content content_ = Content::none;
  std::uint64_t left_ = 0;  // bytes of the container or object that are not read yet
  std::unique_ptr<Inflater> inflater_;
  std::string error_{};
};

}  // namespace canopus::trace
