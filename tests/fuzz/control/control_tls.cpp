// What a stranger sends to a host with certificates: he gets nowhere, and nothing breaks.
#include <variant>

#include "io/files/temporary_folder.hpp"
#include "io/tls/certificates.hpp"
#include "io/tls/tls_session.hpp"

#include "fuzz/require.hpp"

using namespace rubicon;

namespace {

io::tls_identity make_identity() {
  const io::temporary_folder folder("rubicon-fuzz");
  const auto path = (folder.path() / "certs").string();
  const auto now = io::system_time();
  require(io::make_authority(path, {}, now).index() == 0);
  require(io::make_certificate(path, {"kitchen"}, now).index() == 0);
  auto loaded =
      io::tls_identity::load({path + "/kitchen.crt", path + "/kitchen.key", path + "/ca.crt"}, now);
  require(loaded.index() == 0);
  return std::get<io::tls_identity>(std::move(loaded));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto own = make_identity();
  io::tls_session host(own, io::tls_session::side::server);
  const byte_view octets(data, size);
  const auto half = size / 2;
  for (const auto& piece : {octets.first(half), octets.subspan(half)}) {
    require(host.take(piece).empty());
    static_cast<void>(host.outgoing());
  }
  require(host.now() != io::tls_session::phase::open);
  return 0;
}
