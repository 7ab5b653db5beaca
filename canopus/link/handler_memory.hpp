#pragma once
// Memory for the handler of one asynchronous operation at a time, so that a read or a write that is begun again and again
// allocates nothing. Boost.Asio itself keeps the memory of two handlers a thread.

#include <array>
#include <cstddef>
#include <memory>
#include <new>
#include <utility>

#include <boost/asio/bind_allocator.hpp>

namespace canopus::link {

class HandlerMemory {
 public:
  void* allocate_bytes(std::size_t size) {
    if (in_use_ || size > place_.size()) return ::operator new(size);
    in_use_ = true;
    return place_.data();
  }
  void give_back(void* memory) noexcept {
    if (memory == place_.data()) {
      in_use_ = false;
    } else {
      ::operator delete(memory);
    }
  }

 private:
  alignas(std::max_align_t) std::array<std::byte, 512> place_;
  bool in_use_ = false;
};

/// The memory may outlive the object that began the operation: a handler that is never called is destroyed
/// with its io_context.
template <typename T>
class HandlerAllocator {
 public:
  using value_type = T;
  explicit HandlerAllocator(std::shared_ptr<HandlerMemory> memory) noexcept : memory_(std::move(memory)) {}
  template <typename Other>
  explicit(false) HandlerAllocator(const HandlerAllocator<Other>& other) noexcept : memory_(other.memory()) {}

  T* allocate(std::size_t count) { return static_cast<T*>(memory_->allocate_bytes(count * sizeof(T))); }
  void deallocate(T* place, std::size_t /*count*/) noexcept { memory_->give_back(place); }
  [[nodiscard]] const std::shared_ptr<HandlerMemory>& memory() const noexcept { return memory_; }
  template <typename Other>
  friend bool operator==(const HandlerAllocator& a, const HandlerAllocator<Other>& b) noexcept {
    return a.memory() == b.memory();
  }

 private:
  std::shared_ptr<HandlerMemory> memory_;
};

/// For one operation that is begun again when it is done.
class HandlerPlace {
 public:
  template <typename Handler>
  auto operator()(Handler handler) const {
    return boost::asio::bind_allocator(HandlerAllocator<char>(memory_), std::move(handler));
  }

 private:
  std::shared_ptr<HandlerMemory> memory_ = std::make_shared<HandlerMemory>();
};

}  // namespace canopus::link
