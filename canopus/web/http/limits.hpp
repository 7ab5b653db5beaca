#pragma once
// How often one address may ask, and how often somebody may try a password. Moments are given: no clock.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "canopus/link/allow_list.hpp"

namespace canopus::web {

using WebMoment = std::chrono::steady_clock::time_point;

/// A client with an IPv6 address has all of its network of 64 bits, and one on this machine all of 127.0.0.0/8: they count as one.
[[nodiscard]] link::InternetAddress network_of(link::InternetAddress address) noexcept;

/// Requests: so many at once, and so many a second from then on.
struct WebRateOptions {
  double of_address_at_once = 600;
  double of_address = 60;  ///< a second
  double in_all_at_once = 1200;
  double in_all = 120;
  std::size_t most_addresses = 4096;  ///< that are kept in mind
};

class WebRate {
 public:
  explicit WebRate(WebRateOptions options = {}) : options_(options) {}
  /// Counts a request, if it is to be answered.
  [[nodiscard]] bool admits(const link::InternetAddress& address, WebMoment now);
  [[nodiscard]] std::size_t addresses() const noexcept { return addresses_.size(); }

 private:
  struct Bucket {
    double left = 0;
    WebMoment at{};
  };
  static void fill(Bucket& bucket, double most, double a_second, WebMoment now);
  void forget(WebMoment now);

  WebRateOptions options_;
  Bucket all_{};
  std::map<link::InternetAddress, Bucket> addresses_;
  bool has_begun_ = false;
};

/// Attempts at passwords: a few at once, then each has to wait twice as long as the one before, by its address and by the name
/// that it is for, be that a user or not.
struct WebAttemptOptions {
  unsigned at_once = 5;
  std::chrono::seconds first_wait{1};
  std::chrono::seconds longest_wait_of_address{300};
  /// Short: who guesses must not keep the user out.
  std::chrono::seconds longest_wait_of_user{30};
  std::chrono::seconds forgotten_after{900};
  std::size_t most_kept = 4096;  ///< of addresses and of names each
};

class WebAttempts {
 public:
  explicit WebAttempts(WebAttemptOptions options = {}) : options_(options) {}
  /// Zero: the attempt is taken, and counts as one that failed until succeeded() is called. Else the time to wait, of
  /// seconds that have begun.
  [[nodiscard]] std::chrono::seconds wait(const link::InternetAddress& address, const std::string& user,
                                          WebMoment now);
  void succeeded(const link::InternetAddress& address, const std::string& user);
  [[nodiscard]] std::size_t kept() const noexcept { return addresses_.size() + users_.size(); }

 private:
  struct Failures {
    unsigned count = 0;
    WebMoment last{};
    WebMoment next{};  ///< an attempt is taken from then on
  };
  template <typename Key>
  void forget(std::map<Key, Failures>& of, WebMoment now) const;
  void count(Failures& failures, std::chrono::seconds longest, WebMoment now) const;

  WebAttemptOptions options_;
  std::map<link::InternetAddress, Failures> addresses_;
  std::map<std::string, Failures> users_;
};

}  // namespace canopus::web
