#include "io/tcp/host_lookup.hpp"

#include <utility>

#include <boost/asio/ip/udp.hpp>
#include <boost/asio/post.hpp>

#include "io/context.hpp"
#include "io/tcp/tcp_socket.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

struct host_lookup::state : std::enable_shared_from_this<state> {
  state(loop& where, callback f) : resolver(context_of(where)), on_result(std::move(f)) {}

  udp::resolver resolver;
  callback on_result;
  bool over = false;

  void begin(const std::string& host) {
    if (const auto address = parse_ipv4_address(host)) {
      asio::post(resolver.get_executor(),
                 [x = shared_from_this(), address = *address] { x->finish(address); });
      return;
    }
    resolver.async_resolve(
        udp::v4(), host, "",
        [x = shared_from_this(), host](const error_code& error,
                                       const udp::resolver::results_type& found) {
          if (error || found.empty())
            x->finish(host + ": " + attempt_failure(error ? error : asio::error::host_not_found));
          else
            x->finish(found.begin()->endpoint().address().to_v4().to_bytes());
        });
  }

  void finish(std::variant<ipv4_address, std::string> result) {
    if (!std::exchange(over, true))
      on_result(std::move(result));
  }
};

host_lookup::host_lookup(loop& where, const std::string& host, callback on_result)
    : state_(std::make_shared<state>(where, std::move(on_result))) {
  state_->begin(host);
}

host_lookup::~host_lookup() {
  if (!state_)
    return;
  state_->over = true;
  state_->resolver.cancel();
}

host_lookup::host_lookup(host_lookup&&) noexcept = default;

} // namespace rubicon::io
