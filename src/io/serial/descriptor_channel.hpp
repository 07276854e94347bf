// For files of this room only: a descriptor that octets come from and go to, of a terminal of some
// kind.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "core/bytes.hpp"
#include "io/context.hpp"

namespace rubicon::io {

/// Reads while that is wanted and writes what it is given, at most `room` octets of which wait.
/// Callbacks run on the loop's thread, never from within a call, and may destroy their owner.
class descriptor_channel : public std::enable_shared_from_this<descriptor_channel> {
public:
  using error_code = boost::system::error_code;

  /// @param descriptor owned from now on
  descriptor_channel(loop& where, int descriptor, std::size_t room)
      : descriptor_(context_of(where), descriptor), room_(room) {
    error_code ignored;
    descriptor_.non_blocking(true, ignored);
  }

  /// @param on_failed nothing is read or written any more until start() is called again
  void start(std::function<void(byte_view)> on_octets,
             std::function<void(const error_code&)> on_failed) {
    on_octets_ = std::move(on_octets);
    on_failed_ = std::move(on_failed);
    open_ = true;
    receive();
  }

  void read(bool wanted) {
    wanted_ = wanted;
    receive();
  }

  /// @returns whether there was room for all of them; otherwise none of them goes
  bool send(payload octets) {
    if (!open_ || unsent_ + octets.size() > room_)
      return false;
    unsent_ += octets.size();
    output_.push_back(std::move(octets));
    transmit();
    return true;
  }

  [[nodiscard]] std::size_t unsent() const { return unsent_; }
  [[nodiscard]] int descriptor() { return descriptor_.native_handle(); }

  /// No callback comes from now on.
  void close() {
    on_octets_ = nullptr;
    on_failed_ = nullptr;
    stop();
    error_code ignored;
    descriptor_.close(ignored);
  }

private:
  void receive() {
    if (!open_ || !wanted_ || std::exchange(reading_, true))
      return;
    descriptor_.async_read_some(
        boost::asio::buffer(input_),
        [x = shared_from_this()](const error_code& error, std::size_t size) {
          x->reading_ = false;
          if (error)
            return x->fail(error);
          if (const auto on_octets = x->on_octets_; x->open_ && on_octets) // which may close it
            on_octets(byte_view(x->input_).first(size));
          x->receive();
        });
  }

  void transmit() {
    if (output_.empty() || std::exchange(writing_, true))
      return;
    const auto rest = output_.front().view().subspan(gone_);
    descriptor_.async_write_some(boost::asio::buffer(rest.data(), rest.size()),
                                 [x = shared_from_this(), what = output_.front()](
                                     const error_code& error, std::size_t size) {
                                   x->writing_ = false;
                                   if (error)
                                     return x->fail(error);
                                   x->on_written(size);
                                 });
  }

  void on_written(std::size_t size) {
    if (!open_)
      return;
    unsent_ -= size;
    gone_ += size;
    if (gone_ == output_.front().size()) {
      output_.pop_front();
      gone_ = 0;
    }
    transmit();
  }

  void fail(const error_code& error) {
    if (!open_)
      return;
    stop();
    if (on_failed_) {
      const auto on_failed = on_failed_; // which may put another in its place
      on_failed(error);
    }
  }

  void stop() {
    open_ = false;
    output_.clear();
    unsent_ = 0;
    gone_ = 0;
    error_code ignored;
    descriptor_.cancel(ignored);
  }

  boost::asio::posix::stream_descriptor descriptor_;
  std::size_t room_;
  std::function<void(byte_view)> on_octets_;
  std::function<void(const error_code&)> on_failed_;
  bool open_ = false;
  bool wanted_ = true;
  bool reading_ = false;
  bool writing_ = false;
  std::array<std::uint8_t, 1024> input_{};
  std::deque<payload> output_;
  std::size_t unsent_ = 0;
  std::size_t gone_ = 0; ///< octets of output_.front() that have left
};

} // namespace rubicon::io
