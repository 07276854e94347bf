#include "cli/child_process.hpp"

#include <array>
#include <cassert>
#include <cerrno>
#include <csignal>
#include <utility>

#include <sys/wait.h>
#include <unistd.h>

#include "io/process/spawn.hpp"

namespace rubicon::cli {

child_process::child_process(const std::string& program, const std::vector<std::string>& words) {
  const auto x = io::spawn({program, words});
  pid_ = x.pid;
  out_.descriptor = x.out;
  err_.descriptor = x.err;
}

child_process::child_process(child_process&& x) noexcept
    : pid_(std::exchange(x.pid_, -1)), out_(std::exchange(x.out_, {})),
      err_(std::exchange(x.err_, {})), overlong_(x.overlong_) {}

child_process::~child_process() {
  if (pid_ == -1)
    return;
  kill();
  static_cast<void>(wait());
}

std::vector<int> child_process::descriptors() const {
  std::vector<int> open;
  for (const auto* x : {&out_, &err_}) {
    if (x->descriptor != -1)
      open.push_back(x->descriptor);
  }
  return open;
}

void child_process::close(output& x) {
  if (x.descriptor != -1)
    ::close(std::exchange(x.descriptor, -1));
}

bool child_process::read_block(output& from) {
  std::array<char, 65536> block{};
  const auto size = ::read(from.descriptor, block.data(), block.size());
  if (size < 0)
    return errno == EAGAIN || errno == EINTR;
  from.text.append(block.data(), static_cast<std::size_t>(size));
  return size > 0;
}

void child_process::read() {
  if (out_.descriptor != -1 && !read_block(out_))
    close(out_);
  if (err_.descriptor != -1 && !read_block(err_))
    close(err_);
  if (err_.text.size() > err_octets_max)
    err_.text.erase(0, err_.text.size() - err_octets_max);
  if (out_.text.size() > out_octets_max) {
    overlong_ = true;
    kill(); // first: a closed pipe would end it too
    close(out_);
  }
}

void child_process::kill() const {
  if (pid_ != -1)
    ::kill(pid_, SIGKILL);
}

child_end child_process::wait() {
  assert(pid_ != -1);
  int how = 0;
  while (::waitpid(pid_, &how, 0) == -1 && errno == EINTR) {
  }
  pid_ = -1;
  close(out_);
  close(err_);
  child_end x{-1, 0, std::move(out_.text), std::move(err_.text), overlong_};
  if (WIFEXITED(how))
    x.status = WEXITSTATUS(how);
  else if (WIFSIGNALED(how))
    x.signal = WTERMSIG(how);
  return x;
}

} // namespace rubicon::cli
