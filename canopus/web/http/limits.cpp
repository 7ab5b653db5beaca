#include "canopus/web/http/limits.hpp"

#include <algorithm>

namespace canopus::web {

link::InternetAddress network_of(link::InternetAddress address) noexcept {
  if (link::is_loopback(address)) return link::InternetAddress{};
  const bool is_ipv4 =
      std::ranges::all_of(address.begin(), address.begin() + 10, [](auto byte) { return byte == 0; });
  if (!is_ipv4) std::fill(address.begin() + 8, address.end(), std::uint8_t{0});
  return address;
}

void WebRate::fill(Bucket& bucket, double most, double a_second, WebMoment now) {
  const std::chrono::duration<double> passed = now - bucket.at;
  bucket.left = std::min(most, bucket.left + std::max(0.0, passed.count()) * a_second);
  bucket.at = now;
}

bool WebRate::admits(const link::InternetAddress& address, WebMoment now) {
  if (!has_begun_) all_ = {.left = options_.in_all_at_once, .at = now};
  has_begun_ = true;
  fill(all_, options_.in_all_at_once, options_.in_all, now);
  if (addresses_.size() >= options_.most_addresses) forget(now);
  const auto [place, is_new] =
      addresses_.try_emplace(network_of(address), Bucket{.left = options_.of_address_at_once, .at = now});
  Bucket& bucket = place->second;
  fill(bucket, options_.of_address_at_once, options_.of_address, now);
  if (bucket.left < 1 || all_.left < 1) return false;
  bucket.left -= 1;
  all_.left -= 1;
  return true;
}

/// Those that have asked nothing for long have their full number anyway; if there are none, the one that is silent longest goes.
void WebRate::forget(WebMoment now) {
  const std::chrono::duration<double> until_full(options_.of_address_at_once / options_.of_address);
  std::erase_if(addresses_, [&](const auto& one) { return now - one.second.at >= until_full; });
  if (addresses_.size() < options_.most_addresses) return;
  addresses_.erase(std::ranges::min_element(addresses_, {}, [](const auto& one) { return one.second.at; }));
}

std::chrono::seconds WebAttempts::wait(const link::InternetAddress& address, const std::string& user,
                                       WebMoment now) {
  forget(addresses_, now);
  forget(users_, now);
  Failures& of_address = addresses_[network_of(address)];
  Failures& of_user = users_[user];
  const WebMoment next = std::max(of_address.next, of_user.next);
  if (next > now) return std::chrono::ceil<std::chrono::seconds>(next - now);
  count(of_address, options_.longest_wait_of_address, now);
  count(of_user, options_.longest_wait_of_user, now);
  return std::chrono::seconds(0);
}

void WebAttempts::succeeded(const link::InternetAddress& address, const std::string& user) {
  addresses_.erase(network_of(address));
  users_.erase(user);
}

void WebAttempts::count(Failures& failures, std::chrono::seconds longest, WebMoment now) const {
  failures.last = now;
  if (++failures.count < options_.at_once) return;
  const unsigned doublings = std::min(failures.count - options_.at_once, 20U);
  failures.next = now + std::min(longest, options_.first_wait * (1U << doublings));
}

template <typename Key>
void WebAttempts::forget(std::map<Key, Failures>& of, WebMoment now) const {
  std::erase_if(of, [&](const auto& one) { return now - one.second.last > options_.forgotten_after; });
  if (of.size() < options_.most_kept) return;
  of.erase(std::ranges::min_element(of, {}, [](const auto& one) { return one.second.last; }));
}

}  // namespace canopus::web
