#include "canopus/link/tcp/socket_round.hpp"

#include <cstddef>
#include <utility>

#include <boost/asio/post.hpp>

namespace canopus::link {

void SocketRound::join(std::shared_ptr<User> user, bool alone) {
  if (ready_.empty()) {
    if (alone || served_last_ == user.get()) return serve(user);
    boost::asio::post(context_, [self = shared_from_this()] { self->serve_ready(); });
  }
  ready_.push_back(std::move(user));
}

void SocketRound::serve_ready() {
  served_.swap(ready_);
  serve_all(served_);
  served_.clear();
}

void SocketRound::serve(const std::shared_ptr<User>& user) {
  served_last_ = user.get();
  const BatchedRead read = user->begin();
  if (read.socket == nullptr || read.bytes.empty()) return;
  const BatchedWrite write = user->reply(read.socket->read(read.bytes));
  if (write.socket == nullptr) return;
  user->go_on(write.bytes.empty() ? WatchedSocket::Transfer{} : write.socket->write(write.bytes));
}

void SocketRound::serve_all(std::span<const std::shared_ptr<User>> some) {
  served_last_ = some.back().get();
  reads_.clear();
  users_.clear();
  for (const auto& user : some) {
    const BatchedRead read = user->begin();
    if (read.socket == nullptr || read.bytes.empty()) continue;
    reads_.push_back(read);
    users_.push_back(user.get());
  }
  batch_.read(reads_);
  writes_.clear();
  for (std::size_t i = 0; i < reads_.size(); ++i) {
    User& user = *users_[i];
    const BatchedWrite write = user.reply(reads_[i].result);
    if (write.socket == nullptr) continue;
    if (write.bytes.empty()) {
      user.go_on({});
      continue;
    }
    users_[writes_.size()] = &user;
    writes_.push_back(write);
  }
  batch_.write(writes_);
  for (std::size_t i = 0; i < writes_.size(); ++i) users_[i]->go_on(writes_[i].result);
}

}  // namespace canopus::link
