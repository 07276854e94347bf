#include "io/files/line_input.hpp"

#include <array>
#include <cerrno>
#include <system_error>

#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <unistd.h>

#include "io/context.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using boost::system::error_code;

struct line_input::state : std::enable_shared_from_this<state> {
  state(loop& where, callback f) : in(context_of(where)), on_line(std::move(f)) {}

  void await() {
    in.async_read_some(asio::buffer(octets),
                       [me = shared_from_this()](error_code error, std::size_t count) {
                         if (error || me->over)
                           return;
                         me->lines.take(byte_view(me->octets).first(count), [&](std::string line) {
                           if (!me->over)
                             me->on_line(std::move(line));
                         });
                         if (!me->over)
                           me->await();
                       });
  }

  asio::posix::stream_descriptor in;
  callback on_line;
  line_splitter lines;
  std::array<std::uint8_t, 4096> octets{};
  bool over = false;
};

line_input::line_input(loop& where, callback on_line)
    : state_(std::make_shared<state>(where, std::move(on_line))) {
  const int own = ::dup(STDIN_FILENO);
  if (own == -1)
    throw std::system_error(errno, std::generic_category(), "standard input");
  error_code error;
  state_->in.assign(own, error);
  if (error) { // a file, of which epoll knows nothing: there is nothing to wait for
    ::close(own);
    return;
  }
  state_->await();
}

line_input::~line_input() {
  state_->over = true;
  error_code ignored;
  state_->in.close(ignored);
}

} // namespace rubicon::io
