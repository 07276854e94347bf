#include "io/process/process.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <system_error>
#include <utility>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "io/context.hpp"
#include "io/process/group_guard.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using boost::system::error_code;
using pipe_end = asio::posix::stream_descriptor;

namespace {

/// Writes without the signal that a pipe without reader sends.
/// @returns octets written, or -1
ssize_t write_quietly(int to, std::string_view text) {
  sigset_t broken_pipe;
  sigset_t before;
  sigset_t pending;
  sigemptyset(&broken_pipe);
  sigaddset(&broken_pipe, SIGPIPE);
  sigpending(&pending);
  static_cast<void>(pthread_sigmask(SIG_BLOCK, &broken_pipe, &before));
  const auto written = ::write(to, text.data(), text.size());
  const int error = errno;
  if (written < 0 && error == EPIPE && sigismember(&pending, SIGPIPE) == 0) {
    const timespec at_once{};
    static_cast<void>(sigtimedwait(&broken_pipe, nullptr, &at_once));
  }
  static_cast<void>(pthread_sigmask(SIG_SETMASK, &before, nullptr));
  errno = error;
  return written;
}

} // namespace

std::string to_string(const process_end& x) {
  return x.signal != 0 ? "signal " + std::to_string(x.signal)
                       : "status " + std::to_string(x.status);
}

/// Handlers keep it alive; once it is `over` none of them does anything.
struct process::state : std::enable_shared_from_this<state> {
  state(loop& where, callbacks f)
      : in(context_of(where)), out(context_of(where)), err(context_of(where)),
        ends(context_of(where), SIGCHLD), to_owner(std::move(f)) {}

  pipe_end in;
  pipe_end out;
  pipe_end err;
  asio::signal_set ends; ///< of any child: each looks for its own
  callbacks to_owner;
  std::string waiting; ///< for `in`
  pid_t pid = -1;
  bool over = false;

  void begin(const spawned& x) {
    pid = x.pid;
    in.assign(x.in);
    out.assign(x.out);
    err.assign(x.err);
    await_output(output::out);
    await_output(output::err);
    await_end();
    look_for_end(); // it may have ended before
  }

  pipe_end& pipe_of(output from) { return from == output::out ? out : err; }

  void await_output(output from) {
    pipe_of(from).async_wait(pipe_end::wait_read,
                             [x = shared_from_this(), from](const error_code& error) {
                               if (!error && !x->over && x->read_block(from) != got::end)
                                 x->await_output(from);
                             });
  }

  enum class got : std::uint8_t { nothing, some, end };

  got read_block(output from) {
    std::array<std::uint8_t, 65536> block{};
    const auto size = ::read(pipe_of(from).native_handle(), block.data(), block.size());
    if (size < 0)
      return errno == EAGAIN || errno == EINTR ? got::nothing : got::end;
    if (size > 0)
      to_owner.on_output(from, byte_view(block.data(), static_cast<std::size_t>(size)));
    return size > 0 && !over ? got::some : got::end;
  }

  void await_end() {
    ends.async_wait([x = shared_from_this()](const error_code& error, int) {
      if (error || x->over)
        return;
      x->await_end();
      x->look_for_end();
    });
  }

  void look_for_end() {
    asio::post(ends.get_executor(), [x = shared_from_this()] { x->collect(); });
  }

  void collect() {
    siginfo_t ended{};
    if (over || pid == -1 ||
        ::waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
        ended.si_pid != pid)
      return;
    static_cast<void>(::kill(-pid, SIGKILL)); // what it has left behind
    group_guard::instance().remove(pid);
    int how = 0;
    static_cast<void>(::waitpid(pid, &how, 0)); // only now its number may be another's
    process_end x;
    if (WIFEXITED(how))
      x.status = WEXITSTATUS(how);
    else if (WIFSIGNALED(how))
      x.signal = WTERMSIG(how);
    pid = -1;
    drain(output::out);
    drain(output::err);
    if (over)
      return;
    close();
    std::exchange(to_owner, {}).on_end(x);
  }

  /// What the pipe still holds. Somebody who has left the group may write for ever: no more than
  /// that.
  void drain(output from) {
    constexpr int blocks_max = 16;
    for (int i = 0; i < blocks_max && !over && read_block(from) == got::some; ++i) {
    }
  }

  void await_room() {
    in.async_wait(pipe_end::wait_write, [x = shared_from_this()](const error_code& error) {
      if (!error && !x->over)
        x->write_waiting();
    });
  }

  void write_waiting() {
    const auto written = write_quietly(in.native_handle(), waiting);
    if (written < 0 && errno != EAGAIN && errno != EINTR) {
      waiting.clear(); // nobody reads any more
      error_code ignored;
      in.close(ignored);
      return;
    }
    if (written > 0)
      waiting.erase(0, static_cast<std::size_t>(written));
    if (!waiting.empty())
      await_room();
  }

  bool feed(std::string_view text) {
    if (over || !in.is_open() || waiting.size() + text.size() > waiting_octets_max)
      return false;
    const bool idle = waiting.empty();
    waiting += text;
    if (idle && !waiting.empty())
      write_waiting();
    return in.is_open();
  }

  /// No callback comes any more.
  void close() {
    over = true;
    error_code ignored;
    in.close(ignored);
    out.close(ignored);
    err.close(ignored);
    ends.cancel(ignored);
    ends.clear(ignored);
  }
};

process::process(std::shared_ptr<state> x) : state_(std::move(x)) {}

std::variant<process, std::string> process::start(loop& where, spawn_request x, callbacks f) {
  x.feeds = true;
  x.own_group = true;
  auto made = std::make_shared<state>(where, std::move(f)); // is notified of ends from now on
  try {
    made->begin(spawn(x));
  } catch (const std::system_error& error) {
    return std::string(error.what());
  }
  return process(std::move(made));
}

process::~process() {
  if (!state_)
    return;
  if (state_->pid != -1) {
    signal(SIGKILL);
    group_guard::instance().remove(state_->pid);
    while (::waitpid(state_->pid, nullptr, 0) == -1 && errno == EINTR) {
    }
    state_->pid = -1;
  }
  state_->close();
}

process::process(process&&) noexcept = default;

process& process::operator=(process&& x) noexcept {
  const process replaced(std::exchange(state_, std::exchange(x.state_, nullptr)));
  return *this;
}

bool process::feed(std::string_view text) {
  return state_->feed(text);
}

void process::signal(int number) const {
  if (state_->pid != -1)
    static_cast<void>(::kill(-state_->pid, number));
}

pid_t process::pid() const {
  return state_->pid;
}

} // namespace rubicon::io
