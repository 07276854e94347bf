// Messages of a run that goes on, for its live page.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "cli/record/read_record.hpp"
#include "core/time.hpp"
#include "view/timeline.hpp"

namespace rubicon::cli {

/// Reads a record while it is written, and gives a timeline the messages in it. On
/// request it reads on from where it stopped, on a thread of its own: neither the writer nor the
/// requester waits. It takes at most an eleventh of one processor.
class message_reader {
public:
  static constexpr duration age = 2s;              ///< younger messages are not read again
  static constexpr duration reading_time_max = 1s; ///< then they are shown, and it rests
  static constexpr int rest_factor = 10; ///< it rests so many times as long as it has read

  /// How much of a record is put together, which takes several times as much memory.
  struct bound {
    std::uint64_t octets = 0;
    std::string beyond = {};   ///< what is said when there are more
    bool is_of_record = false; ///< it has no more itself; else more is read when it is complete
  };

  /// @param path of a record that has been made, though nothing may stand there yet
  message_reader(const std::string& path, bound most, std::shared_ptr<view::timeline> to);
  ~message_reader();
  message_reader(const message_reader&) = delete;
  message_reader& operator=(const message_reader&) = delete;

  /// Requests messages. From any thread.
  void ask();

  /// The record is complete: all of it is read, requested or not.
  void finish();

private:
  using steady = std::chrono::steady_clock;

  void run();
  void read(bool is_whole);
  void show(bool is_whole);

  // of the thread alone
  record_reader record_;
  bound most_;
  std::shared_ptr<view::timeline> to_;
  std::uint64_t octets_shown_ = 0;

  std::atomic<bool> stopped_ = false;
  std::mutex lock_; ///< of the next two
  bool asked_ = false;
  bool over_ = false;
  std::condition_variable wake_;
  std::thread thread_;
};

} // namespace rubicon::cli
