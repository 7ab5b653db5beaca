#pragma once
// The program's operator new counts. To be included by one file of a test program, outside of every namespace.

#include <cstddef>
#include <cstdlib>
#include <new>

namespace counted {
inline std::size_t allocations = 0;
}  // namespace counted

// The whole family, because a sanitizer brings its own of each that a program does not replace:
// std::stable_sort allocates with the nothrow one. GCC takes malloc() here and free() below for a mismatch,
// because it inlines only one of the two.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
void* operator new(std::size_t size, const std::nothrow_t& /*unused*/) noexcept {
  ++counted::allocations;
  return std::malloc(size);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new[](std::size_t size, const std::nothrow_t& /*unused*/) noexcept {
  return operator new(size, std::nothrow);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t& /*unused*/) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t& /*unused*/) noexcept { std::free(memory); }
#pragma GCC diagnostic pop
