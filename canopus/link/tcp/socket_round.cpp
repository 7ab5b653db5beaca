#include "canopus/link/tcp/socket_round.hpp"

#include <cstddef>
#include <utility>

#include <boost/asio/post.hpp>

namespace canopus::link {

void SocketRound::join(std::shared_ptr<User> user) {
  if (ready_.empty()) boost::asio::post(context_, [self = shared_from_this()] { self->serve_ready(); });
  ready_.push_back(std::move(user));
}

void SocketRound::serve_ready() {
  served_.swap(ready_);
  served_last_ = served_.back().get();
  reads_.clear();
  users_.clear();
  for (const auto& user : served_) {
    const BatchedRead read = user->begin();
    if (read.socket == nullptr || read.bytes.empty()) continue;
    reads_.push_back(read);
    users_.push_back(user.get());
  }
  batch_.read(reads_);
  std::size_t heard = 0;
  for (std::size_t i = 0; i < reads_.size(); ++i)
    if (users_[i]->hear(reads_[i].result)) users_[heard++] = users_[i];
  writes_.clear();
  for (std::size_t i = 0; i < heard; ++i) {
    User& user = *users_[i];
    const BatchedWrite write = user.reply();
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
  served_.clear();
}

}  // namespace canopus::link
