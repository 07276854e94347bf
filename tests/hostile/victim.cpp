#include "hostile/victim.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>

namespace rubicon::hostile {

std::uint64_t resident_octets(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  std::string word;
  while (status >> word) {
    if (word == "VmRSS:") {
      std::uint64_t kilo_octets = 0;
      status >> kilo_octets;
      return kilo_octets * 1024;
    }
  }
  return 0;
}

memory_watch::memory_watch(pid_t process) : process_(process), now_(resident_octets(process)) {
  peak_ = now_.load();
  thread_ = std::thread([this] { run(); });
}

memory_watch::~memory_watch() {
  over_ = true;
  thread_.join();
}

void memory_watch::run() {
  while (!over_) {
    const auto x = resident_octets(process_);
    now_ = x;
    peak_ = std::max(peak_.load(), x);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

} // namespace rubicon::hostile
