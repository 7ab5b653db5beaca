#pragma once
// A shared object in this process.

#include <expected>
#include <string>

namespace canopus::c_program {

class SharedObject {
 public:
  /// A copy of the file as it is now: two of one file share no variables, and the file may be replaced meanwhile. Runs its constructors.
  [[nodiscard]] static std::expected<SharedObject, std::string> open(const std::string& path);
  SharedObject(SharedObject&& other) noexcept;
  SharedObject& operator=(SharedObject&&) = delete;
  ~SharedObject();

  /// nullptr: it has none of that name.
  [[nodiscard]] void* symbol(const char* name) const;

 private:
  explicit SharedObject(int file) : file_(file) {}

  int file_ = -1;           // stays open: the loader knows a file by its name, which has this number
  void* handle_ = nullptr;  // of dlopen()
};

}  // namespace canopus::c_program
