#include "io/mqtt/mqtt_client.hpp"

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "core/numbers/random.hpp"
#include "core/numbers/reconnect_pause.hpp"
#include "io/mqtt/mqtt_session.hpp"

namespace rubicon::io {

namespace {

using clock = std::chrono::steady_clock;

constexpr auto answer_max = 10s;   ///< of the broker to a connection
constexpr auto ending_max = 500ms; ///< for which the owner of a client waits for its thread

} // namespace

class mqtt_client::state {
public:
  state(mqtt_client_settings settings, std::function<void()> wake)
      : settings_(std::move(settings)), wake_(std::move(wake)),
        signal_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}
  ~state() {
    if (signal_ >= 0)
      ::close(signal_);
  }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  // For the owner.

  void add(mqtt_request x) {
    {
      const std::lock_guard lock(mutex_);
      if (!is_connected_ || seen_life_ != life_) {
        ++counters_.not_sent;
        return;
      }
      if (outbox_.size() >= outbox_max)
        overflowed_ = true;
      else
        outbox_.push_back(std::move(x));
    }
    interrupt();
  }

  std::vector<mqtt_event> take() {
    std::vector<mqtt_event> out;
    bool was_full = false;
    {
      const std::lock_guard lock(mutex_);
      was_full = is_full();
      out.assign(std::make_move_iterator(inbox_.begin()), std::make_move_iterator(inbox_.end()));
      inbox_.clear();
      inbox_octets_ = 0;
      seen_life_ = life_;
    }
    if (was_full)
      interrupt();
    return out;
  }

  mqtt_client_counters counters() const {
    const std::lock_guard lock(mutex_);
    return counters_;
  }

  /// @returns whether the thread has ended, and not only will
  bool end() {
    std::function<void()> dropped; // what it holds may end with it
    std::unique_lock lock(mutex_);
    ends_ = true;
    dropped.swap(wake_);
    interrupt();
    changed_.notify_all();
    return changed_.wait_for(lock, ending_max, [this] { return has_ended_; });
  }

  // For the thread.

  void run() {
    random_stream rng(static_cast<std::uint64_t>(::getpid()), settings_.client);
    reconnect_pause pause(pause_min, pause_max);
    while (!ends()) {
      const auto result = connection();
      if (result.has_lasted)
        pause.reset();
      const auto next = pause.next(rng);
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, result.is_refused ? refused_pause : next, [this] { return ends_; });
    }
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
    changed_.notify_all();
  }

private:
  struct connection_end {
    bool was_connected = false;
    bool has_lasted = false;
    bool is_refused = false;
  };

  void interrupt() const {
    const std::uint64_t one = 1;
    static_cast<void>(!::write(signal_, &one, sizeof one)); // full: it is readable already
  }

  bool ends() const {
    const std::lock_guard lock(mutex_);
    return ends_;
  }

  /// @pre the mutex is held
  bool is_full() const { return inbox_.size() >= inbox_max || inbox_octets_ >= inbox_octets_max; }

  /// @pre the mutex is held
  void report(mqtt_event x) {
    inbox_.push_back(std::move(x));
    if (inbox_.size() == 1 && wake_)
      wake_();
  }

  connection_end connection() {
    mqtt_session session([this](mqtt_message x) {
      const std::lock_guard lock(mutex_);
      inbox_octets_ += x.topic.size() + x.payload.size();
      report(std::move(x));
    });
    {
      const std::lock_guard lock(mutex_);
      ++counters_.attempts;
    }
    connection_end out;
    auto cause = session.open(settings_);
    const auto opened = clock::now();
    while (cause.empty() && !ends()) {
      if (!out.was_connected && session.is_connected()) {
        out.was_connected = true;
        begin_life();
      }
      cause = send_waiting(session);
      if (cause.empty())
        cause = session.serve(signal_, may_read());
      if (cause.empty() && !session.is_connected() && clock::now() > opened + answer_max)
        cause = "the broker does not answer";
    }
    if (cause.empty() && out.was_connected)
      session.close();
    out.is_refused = session.is_refused();
    out.has_lasted = out.was_connected && clock::now() > opened + lasting;
    end_life(std::move(cause), out.is_refused, session.oversized());
    return out;
  }

  void begin_life() {
    const std::lock_guard lock(mutex_);
    ++life_;
    is_connected_ = true;
    is_reported_ = false;
    is_refusal_reported_ = false;
    report(mqtt_connected{});
  }

  void end_life(std::string cause, bool is_refused, std::uint64_t oversized) {
    const std::lock_guard lock(mutex_);
    counters_.oversized += oversized;
    counters_.not_sent += outbox_.size();
    counters_.queue_full += std::exchange(overflowed_, false) ? 1 : 0;
    outbox_.clear();
    counters_.refused += is_refused ? 1 : 0;
    if (std::exchange(is_connected_, false)) {
      ++life_;
      ++counters_.lost;
    }
    const bool is_news = !is_reported_ || (is_refused && !is_refusal_reported_);
    is_reported_ = true;
    is_refusal_reported_ = is_refusal_reported_ || is_refused;
    if (is_news)
      report(mqtt_disconnected{std::move(cause)});
  }

  bool may_read() {
    const std::lock_guard lock(mutex_);
    const bool full = is_full();
    counters_.read_pauses += full && !std::exchange(was_full_, full) ? 1 : 0;
    was_full_ = full;
    return !full;
  }

  std::string send_waiting(mqtt_session& session) {
    while (session.is_free()) {
      mqtt_request next;
      {
        const std::lock_guard lock(mutex_);
        if (overflowed_)
          return "too much waits to be sent";
        if (outbox_.empty())
          break;
        next = std::move(outbox_.front());
        outbox_.pop_front();
      }
      const bool sent = session.send(next);
      const std::lock_guard lock(mutex_);
      ++(sent ? counters_.sent : counters_.not_sent);
    }
    const std::lock_guard lock(mutex_);
    return overflowed_ ? "too much waits to be sent" : std::string();
  }

  const mqtt_client_settings settings_;
  mutable std::mutex mutex_; ///< guards what follows
  std::condition_variable changed_;
  std::function<void()> wake_;
  const int signal_; ///< an event of the thread's poll
  bool ends_ = false;
  bool has_ended_ = false;
  bool is_connected_ = false;
  bool is_reported_ = false; ///< that there is no connection
  bool is_refusal_reported_ = false;
  bool overflowed_ = false;
  bool was_full_ = false;
  std::uint64_t life_ = 0;      ///< changes when a connection begins, and when it ends
  std::uint64_t seen_life_ = 0; ///< when take() was called last
  std::deque<mqtt_request> outbox_;
  std::deque<mqtt_event> inbox_;
  std::size_t inbox_octets_ = 0;
  mqtt_client_counters counters_;
};

mqtt_client::mqtt_client(mqtt_client_settings settings, std::function<void()> wake)
    : state_(std::make_shared<state>(std::move(settings), std::move(wake))) {
  // Signals are for the main thread; and a connection that is lost while it is written to raises
  // one.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &before);
  std::thread([x = state_] { x->run(); }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

/// A thread that still waits for TCP ends by itself.
mqtt_client::~mqtt_client() {
  static_cast<void>(state_->end());
}

void mqtt_client::publish(std::string topic, std::string payload) {
  state_->add({mqtt_request::kind::publish, std::move(topic), std::move(payload)});
}

void mqtt_client::subscribe(std::string filter) {
  state_->add({mqtt_request::kind::subscribe, std::move(filter), {}});
}

void mqtt_client::unsubscribe(std::string filter) {
  state_->add({mqtt_request::kind::unsubscribe, std::move(filter), {}});
}

std::vector<mqtt_event> mqtt_client::take() {
  return state_->take();
}

mqtt_client_counters mqtt_client::counters() const {
  return state_->counters();
}

} // namespace rubicon::io
