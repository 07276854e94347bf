#include "io/serial/pseudo_terminal.hpp"

#include <array>
#include <cassert>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <boost/asio/steady_timer.hpp>

#include "core/hash.hpp"
#include "core/time.hpp"
#include "io/files/file_lock.hpp"
#include "io/serial/descriptor_channel.hpp"

namespace rubicon::io {

namespace fs = std::filesystem;
using boost::system::error_code;

namespace {

/// The system does not notify us when a program opens the other end.
constexpr duration looking_period = 50ms;

std::string reason() {
  return std::generic_category().message(errno);
}

/// As the next program is to find the other end: octets pass as they are, and what the last one has
/// not read is gone. A hang-up is reported only after it has been open once.
void make_ready(const std::string& other_end) {
  const int descriptor = ::open(other_end.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0)
    return;
  termios x{};
  if (::tcgetattr(descriptor, &x) == 0) {
    ::cfmakeraw(&x);
    static_cast<void>(::tcsetattr(descriptor, TCSANOW, &x));
  }
  static_cast<void>(::tcflush(descriptor, TCIOFLUSH));
  ::close(descriptor);
}

bool has_hung_up(int descriptor) {
  pollfd x{descriptor, 0, 0};
  return ::poll(&x, 1, 0) > 0 && (x.revents & POLLHUP) != 0;
}

/// Makes a link to `target`. @returns why it cannot be made; empty: it is
std::string make_link(const fs::path& link, const std::string& target) {
  std::error_code error;
  if (link.has_parent_path())
    fs::create_directories(link.parent_path(), error);
  const auto before = fs::symlink_status(link, error);
  if (fs::is_symlink(before) && fs::read_symlink(link, error).string().starts_with("/dev/pts/"))
    fs::remove(link, error);
  else if (fs::exists(before))
    return link.string() + ": exists already and is not a link to a pseudo-terminal; remove it, or "
                           "use another name";
  fs::create_symlink(target, link, error);
  return error ? link.string() + ": " + error.message() : std::string();
}

/// Held by whoever has made the link.
std::string lock_of(const fs::path& link) {
  std::error_code error;
  const auto full = fs::absolute(link, error).lexically_normal().string();
  return runtime_file("rubicon-pty-" + to_hex(fold64().add(full).value()));
}

} // namespace

struct pseudo_terminal::state : std::enable_shared_from_this<pseudo_terminal::state> {
  state(loop& where, int master, std::size_t room, file_lock held)
      : channel(std::make_shared<descriptor_channel>(where, master, room)), look(context_of(where)),
        lock(std::move(held)) {}

  std::shared_ptr<descriptor_channel> channel;
  boost::asio::steady_timer look;
  file_lock lock;
  fs::path link;
  std::string lock_path;
  std::string target;
  callbacks to_owner;
  bool attached = false;

  void look_later() {
    look.expires_after(looking_period);
    look.async_wait([x = weak_from_this()](const error_code& error) {
      const auto self = x.lock();
      if (!error && self)
        self->look_now();
    });
  }

  void look_now() {
    if (has_hung_up(channel->descriptor()))
      return look_later();
    attached = true;
    channel->start(
        [this](byte_view octets) {
          const auto self = shared_from_this(); // the owner may go
          to_owner.on_octets(octets);
        },
        [this](const error_code&) { on_hang_up(); });
    to_owner.on_attached(true);
  }

  void on_hang_up() {
    const auto self = shared_from_this();
    attached = false;
    make_ready(target);
    look_later();
    to_owner.on_attached(false);
  }

  void end() {
    look.cancel();
    channel->close();
    std::error_code ignored;
    if (fs::read_symlink(link, ignored) == target)
      fs::remove(link, ignored);
    fs::remove(lock_path, ignored);
  }
};

std::variant<pseudo_terminal, std::string>
pseudo_terminal::open(loop& where, const std::string& link, std::size_t room) {
  const auto lock_path = lock_of(link);
  auto lock = file_lock::take(lock_path);
  if (auto* why = std::get_if<std::string>(&lock))
    return link + ": another program provides it: " + *why;
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master < 0)
    return link + ": no pseudo-terminal is free: " + reason();
  auto x = std::make_shared<state>(where, master, room, std::get<file_lock>(std::move(lock)));
  std::array<char, 64> name{};
  if (::grantpt(master) != 0 || ::unlockpt(master) != 0 ||
      ::ptsname_r(master, name.data(), name.size()) != 0)
    return link + ": " + reason();
  x->target = name.data();
  make_ready(x->target);
  if (auto why = make_link(link, x->target); !why.empty()) {
    std::error_code ignored;
    fs::remove(lock_path, ignored);
    return why;
  }
  x->link = link;
  x->lock_path = lock_path;
  return pseudo_terminal(std::move(x));
}

pseudo_terminal::pseudo_terminal() = default;

pseudo_terminal::pseudo_terminal(std::shared_ptr<state> x) : state_(std::move(x)) {}

pseudo_terminal::~pseudo_terminal() {
  if (state_)
    state_->end();
}

pseudo_terminal::pseudo_terminal(pseudo_terminal&&) noexcept = default;

pseudo_terminal& pseudo_terminal::operator=(pseudo_terminal&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

void pseudo_terminal::start(callbacks x) {
  assert(state_ && x.on_octets && x.on_attached);
  state_->to_owner = std::move(x);
  state_->look_later();
}

void pseudo_terminal::read(bool wanted) {
  assert(state_);
  state_->channel->read(wanted);
}

bool pseudo_terminal::send(payload octets) {
  assert(state_);
  return state_->attached && state_->channel->send(std::move(octets));
}

} // namespace rubicon::io
