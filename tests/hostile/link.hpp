// One hostile TCP connection: the product's own codecs, and no scruples. Octets can be held back,
// falsified, left unread, or cut off.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "peis/link/link.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::hostile {

/// Whom the attacks are about.
struct target {
  std::uint16_t port = 8700; ///< on 127.0.0.1
  std::string network = "hostile";
  peer_id hub{30};       ///< listens on that port
  peer_id keeper{31};    ///< has no port, only a link to the hub
  peer_id porch{32};     ///< has another port
  peer_id bystander{40}; ///< the honest peer outside
};

/// A package of any kind; fields that are not named here are as an honest peer would have them.
struct draft {
  peis::package_type type = peis::package_type::direct;
  std::uint16_t port = 0;
  std::optional<peer_id> source = std::nullopt; ///< unset: who the link says it is
  peer_id destination = any_peer;
  bool reliable = false;
};

struct link_counts {
  std::uint64_t packages = 0; ///< said
  std::uint64_t octets = 0;
  std::uint64_t heard = 0; ///< packages
  std::uint64_t opened = 0;
  std::uint64_t cut = 0; ///< by the other side, refused attempts included
};

/// Never waits. The owner polls descriptor() for events() and passes on what happened.
class link {
public:
  link(const target& whom, std::size_t index, random_stream rng);
  ~link();
  link(const link&) = delete;
  link& operator=(const link&) = delete;

  // The connection.
  /// @param receive_buffer octets that the system holds for us; 0: its default
  void connect(int receive_buffer = 0);
  void drop(bool reset); ///< by a reset, or by an ordinary end
  [[nodiscard]] bool open() const { return open_; }
  [[nodiscard]] bool closed() const { return descriptor_ < 0; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] short events(bool reads) const;
  using listener = std::function<void(const peis::received_package&)>;
  void on_events(short events, bool reads, const listener& hear);
  [[nodiscard]] std::size_t waiting() const { return out_.size() - written_; }

  // What is said. Nothing of it is checked.
  void say_octets(byte_view octets);
  void say_as(const peis::package_header& header, byte_view data);
  void say(const draft& x, byte_view data);
  /// A package's header as an honest peer would write it.
  [[nodiscard]] peis::package_header header_of(const draft& x, std::size_t length);

  /// A message of any length, begun; its packages leave one by one.
  /// @param filling so many octets follow those of `message`
  void begin(const draft& x, bytes message, std::size_t filling = 0);
  [[nodiscard]] bool has_fragments() const { return next_fragment_ < fragments_; }
  void say_fragment();

  // What honest peers say.
  void request(std::uint32_t flags = 0);
  void introduce(); ///< our record and a routing page
  void greet(std::uint32_t flags = 0);
  void beat(); ///< a sign of life
  void acknowledge(const peis::received_package& x);

  // Who we claim to be; free to be changed.
  peer_id id;
  std::int32_t magic;
  std::string host_name;
  bool marked = true;

  [[nodiscard]] peis::host_record record() const;
  [[nodiscard]] std::int32_t number(); ///< a random id, 1..2^31-1
  [[nodiscard]] std::int32_t next_seqno() { return ++seqno_; }
  [[nodiscard]] const target& whom() const { return whom_; }
  [[nodiscard]] std::size_t index() const { return index_; }
  [[nodiscard]] random_stream& rng() { return rng_; }
  [[nodiscard]] const link_counts& counts() const { return counts_; }

  std::uint64_t said_since_open = 0; ///< packages

private:
  void write();
  void read(const listener& hear);
  void cut();

  target whom_;
  std::size_t index_;
  random_stream rng_;
  int descriptor_ = -1;
  bool open_ = false;
  bytes out_;
  std::size_t written_ = 0;
  peis::stream_decoder decoder_;
  std::uint32_t counter_ = 0;
  std::int32_t seqno_ = 1;
  link_counts counts_;

  draft long_;
  bytes message_;
  std::size_t message_size_ = 0; ///< with what it is filled up with
  std::uint16_t group_ = 1;
  std::size_t fragments_ = 0;
  std::size_t next_fragment_ = 0;
};

} // namespace rubicon::hostile
