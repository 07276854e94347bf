#include "bench_peers.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "calibration.hpp"

extern char** environ;

namespace bench {

namespace {

/// Both ends, not inherited by other peers.
std::array<int, 2> open_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "no pipe");
  return ends;
}

std::string peer_program() {
  return std::filesystem::read_symlink("/proc/self/exe").replace_filename("peis_bench_peer");
}

/// Ignored in children as well: they leave when their input ends.
void ignore_broken_pipes() {
  std::signal(SIGPIPE, SIG_IGN);
}

} // namespace

double event::number(std::string_view label) const {
  const auto found = std::find(words.begin(), words.end(), label);
  return found == words.end() || found + 1 == words.end() ? std::nan("")
                                                          : std::atof((found + 1)->c_str());
}

bench_peer::bench_peer(int id, const std::string& network, const std::string& connect) : id_(id) {
  ignore_broken_pipes();
  std::vector<std::string> words = {peer_program(), "--peis-id", std::to_string(id),
                                    "--peis-network", network};
  if (!connect.empty())
    words.insert(words.end(), {"--peis-connect", connect});
  std::vector<char*> arguments;
  for (auto& word : words)
    arguments.push_back(word.data());
  arguments.push_back(nullptr);

  const auto in = open_pipe();
  const auto out = open_pipe();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDERR_FILENO);
  const auto error =
      ::posix_spawn(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(in[0]);
  ::close(out[1]);
  to_ = in[1];
  from_ = out[0];
  if (error != 0) {
    ::close(to_);
    ::close(from_);
    throw std::system_error(error, std::generic_category(), words[0] + " cannot be started");
  }
  static_cast<void>(::fcntl(from_, F_SETFL, O_NONBLOCK));
}

bench_peer::~bench_peer() {
  kill();
  for (const int x : {to_, from_}) {
    if (x != -1)
      ::close(x);
  }
  for (const auto& [text, times] : complaints_)
    std::printf("  peer %d: %s%s\n", id_, text.c_str(),
                times == 1 ? "" : (" (" + std::to_string(times) + " times)").c_str());
}

void bench_peer::kill() {
  if (pid_ == -1)
    return;
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, nullptr, 0) == -1 && errno == EINTR) {
  }
  pid_ = -1;
}

const event* bench_peer::find(std::string_view name, std::size_t from) const {
  for (auto i = from; i < heard_.size(); ++i) {
    if (heard_[i].name == name)
      return &heard_[i];
  }
  return nullptr;
}

const event* bench_peer::complete(int count) const {
  const auto found = std::find_if(heard_.begin(), heard_.end(), [&](const event& x) {
    return x.name == "MON" && x.number("known") == count && x.number("routable") == count - 1;
  });
  return found == heard_.end() ? nullptr : &*found;
}

void bench_peer::send(const std::string& line) {
  const auto text = line + '\n';
  static_cast<void>(!::write(to_, text.data(), text.size())); // if it has ended, no answer comes
}

void bench_peer::read() {
  std::array<char, 65536> block{};
  const auto size = from_ == -1 ? 0 : ::read(from_, block.data(), block.size());
  if (size == 0 && from_ != -1) {
    ::close(from_);
    from_ = -1;
  }
  for (long i = 0; i < size; ++i) {
    if (const char x = block[static_cast<std::size_t>(i)]; x != '\n')
      line_ += x;
    else
      take(std::exchange(line_, {}));
  }
}

void bench_peer::take(const std::string& line) {
  std::istringstream text(line);
  std::string mark;
  event x;
  text >> mark >> x.at_s >> x.name;
  if (mark != "@" || x.name == "ERROR") {
    ++complaints_[line.substr(line.find("ERROR") == std::string::npos ? 0 : line.find("ERROR"))];
    return;
  }
  for (std::string word; text >> word;)
    x.words.push_back(word);
  heard_.push_back(std::move(x));
}

double bench_peer::processor_s() const {
  double ns = std::nan(""); // of its main thread; it has no other
  std::ifstream("/proc/" + std::to_string(pid_) + "/schedstat") >> ns;
  return ns * 1e-9;
}

double bench_peer::memory_kib(std::string_view what) const {
  std::ifstream file("/proc/" + std::to_string(pid_) + "/smaps_rollup");
  for (std::string word; file >> word;) {
    double kib = 0;
    if (word == what && file >> kib)
      return kib;
  }
  return std::nan("");
}

bench_peers::bench_peers(int count) {
  const auto network = "bench-" + std::to_string(::getpid());
  std::string first;
  for (int i = 0; i < count; ++i) {
    started_s_ = wall_s();
    auto& x = *all_.emplace_back(std::make_unique<bench_peer>(100 + i, network, first));
    x.send("monitor");
    if (i > 0)
      continue;
    if (!wait(10, [&] { return x.find("READY") != nullptr; }))
      throw std::runtime_error("the first peer does not listen");
    const auto port = static_cast<int>(x.find("READY")->number("port"));
    first = "tcp://127.0.0.1:" + std::to_string(port);
  }
}

bench_peers::~bench_peers() {
  for (auto& x : all_) {
    if (x->output() != -1)
      x->send("quit");
  }
  wait(4, [&] {
    return std::all_of(all_.begin(), all_.end(), [](auto& x) { return x->output() == -1; });
  });
}

bool bench_peers::wait(double timeout_s, const std::function<bool()>& done) {
  const auto end_s = wall_s() + timeout_s;
  while (!done()) {
    const auto left_ms = (end_s - wall_s()) * 1e3;
    if (left_ms <= 0)
      return false;
    std::vector<pollfd> waited;
    for (const auto& x : all_)
      waited.push_back({x->output(), POLLIN, 0}); // poll skips those that have ended
    ::poll(waited.data(), waited.size(), static_cast<int>(std::ceil(std::min(left_ms, 100.0))));
    for (std::size_t i = 0; i < waited.size(); ++i) {
      if (waited[i].revents != 0)
        all_[i]->read();
    }
  }
  return true;
}

void bench_peers::wait_complete(double timeout_s) {
  const auto count = static_cast<int>(all_.size());
  if (!wait(timeout_s, [&] {
        return std::all_of(all_.begin(), all_.end(),
                           [&](auto& x) { return x->complete(count) != nullptr; });
      }))
    throw std::runtime_error("not all peers reach each other after " +
                             std::to_string(static_cast<int>(timeout_s)) + " s");
}

event bench_peers::ask(bench_peer& whom, const std::string& command, std::string_view answer,
                       double timeout_s) {
  const auto from = whom.heard().size();
  whom.send(command);
  if (!wait(timeout_s, [&] { return whom.find(answer, from) != nullptr || whom.output() == -1; }) ||
      whom.find(answer, from) == nullptr)
    throw std::runtime_error("peer " + std::to_string(whom.id()) + " does not answer '" + command +
                             (whom.output() == -1 ? "': it has ended" : "'"));
  return *whom.find(answer, from);
}

} // namespace bench
