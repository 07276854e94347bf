#include "io/tcp/web_client.hpp"

#include <exception>
#include <thread>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "io/tcp/signals_blocked.hpp"
#include "io/tcp/web_boxes.hpp"
#include "io/tcp/web_connection.hpp"

namespace rubicon::io {

namespace {

namespace asio = boost::asio;

} // namespace

class web_client::state {
public:
  state(web_client_settings settings, std::function<void()> wake)
      : settings_(std::move(settings)), boxes_(std::move(wake)) {
    const signals_blocked here;
    thread_ = std::thread([this] { run(); });
  }

  ~state() {
    context_.stop();
    thread_.join();
  }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  void connect() {
    asio::post(context_, [this] {
      if (connection_ && !connection_->is_over())
        return;
      connection_ = make_web_connection(context_, boxes_, settings_);
      connection_->begin();
    });
  }

  void send(std::string text) {
    if (boxes_.add(std::move(text)))
      asio::post(context_, [this] {
        if (connection_)
          connection_->send_waiting();
      });
  }

  std::vector<web_event> take() {
    std::vector<web_event> out;
    if (boxes_.take(out))
      asio::post(context_, [this] {
        if (connection_)
          connection_->read();
      });
    return out;
  }

  [[nodiscard]] web_client_counters counters() const { return boxes_.counters(); }

private:
  void run() {
    while (!context_.stopped()) {
      try {
        context_.run();
      } catch (const std::exception& x) { // out of memory, say
        if (connection_)
          connection_->end(x.what());
      }
    }
  }

  const web_client_settings settings_;
  web_boxes boxes_; ///< before the context, whose handlers keep connections alive
  asio::io_context context_{1};
  asio::executor_work_guard<asio::io_context::executor_type> work_{context_.get_executor()};
  std::shared_ptr<web_connection> connection_; ///< of the thread
  std::thread thread_;
};

web_client::web_client(web_client_settings settings, std::function<void()> wake)
    : state_(std::make_unique<state>(std::move(settings), std::move(wake))) {}

web_client::~web_client() = default;

void web_client::connect() {
  state_->connect();
}

void web_client::send(std::string text) {
  state_->send(std::move(text));
}

std::vector<web_event> web_client::take() {
  return state_->take();
}

web_client_counters web_client::counters() const {
  return state_->counters();
}

} // namespace rubicon::io
