#include "cli/words/original_options.hpp"

#include <algorithm>
#include <charconv>
#include <deque>
#include <sstream>
#include <string_view>

#include "peis/wire/link_url.hpp"

namespace rubicon::cli {

namespace {

constexpr std::string_view prefix = "--peis-";
constexpr std::size_t network_max = 62; // of an announcement
constexpr std::size_t name_max = 63;    // of a host record
constexpr std::size_t files_max = 16;   // of options, which may name others

/// Those without effect here that have a word behind them.
constexpr std::string_view ignored_with_value[] = {"net-metric", "package-loss", "bluetooth",
                                                   "user"};

std::optional<std::uint32_t> number(const std::string& text, std::uint32_t least,
                                    std::uint32_t most) {
  std::uint32_t x = 0;
  const auto* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, x);
  const bool good = error == std::errc{} && stop == end && x >= least && x <= most;
  return good ? std::optional(x) : std::nullopt;
}

class taker {
public:
  taker(std::deque<std::string> words, const options_reader& read)
      : words_(std::move(words)), read_(&read) {}

  void run(std::vector<std::string>& rest) {
    while (!words_.empty() && why.empty()) {
      auto word = next();
      if (word.starts_with(prefix))
        take(word, word.substr(prefix.size()));
      else
        rest.push_back(std::move(word));
    }
  }

  original_options found;
  std::string why; ///< one was refused

private:
  std::string next() {
    auto x = std::move(words_.front());
    words_.pop_front();
    return x;
  }

  void refuse(const std::string& option, const std::string& what) {
    why = why.empty() ? option + ": " + what : why;
  }

  /// The word behind an option.
  std::string value(const std::string& option) {
    if (words_.empty()) {
      refuse(option, "its value is missing");
      return {};
    }
    found.said.push_back(words_.front());
    return next();
  }

  std::optional<std::string> text(const std::string& option, std::size_t most) {
    auto x = value(option);
    if (why.empty() && (x.empty() || x.size() > most))
      refuse(option, "not a text of 1 to " + std::to_string(most) + " octets");
    return x;
  }

  std::optional<std::uint32_t> whole(const std::string& option) {
    const auto said = value(option);
    const auto x = number(said, 1, 65535);
    if (!x)
      refuse(option, "not a number from 1 to 65535: '" + said + '\'');
    return x;
  }

  void connect(const std::string& option) {
    const auto said = value(option);
    const auto url =
        peis::parse_link_url(said.find("://") == std::string::npos ? "tcp://" + said : said);
    using scheme = peis::link_url::scheme;
    if (!url || (url->medium != scheme::tcp && url->medium != scheme::udp))
      refuse(option, "not tcp://HOST:PORT or udp://HOST:PORT: '" + said + '\'');
    else
      found.connect.push_back(peis::to_string(*url));
  }

  /// More options, in which the prefix is left out.
  void load(const std::string& option) {
    const auto file = words_.empty() ? std::string() : next();
    const auto content = ++files_ > files_max ? std::nullopt : (*read_)(file);
    if (!content)
      return refuse(option, file + " cannot be read");
    std::vector<std::string> more;
    std::istringstream lines(*content);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line.substr(0, line.find('#')));
      std::string word;
      for (bool first = true; words >> word; first = false)
        more.push_back(first && !word.starts_with(prefix) ? std::string(prefix) + word : word);
    }
    words_.insert(words_.begin(), more.begin(), more.end());
  }

  void take(const std::string& option, const std::string& name) {
    if (name != "load")
      found.said.push_back(option);
    if (name == "id" || name == "address") {
      if (const auto x = whole(option))
        found.id = peer_id{static_cast<std::int32_t>(*x)};
    } else if (name == "port") {
      if (const auto x = whole(option))
        found.port = static_cast<std::uint16_t>(*x);
    } else if (name == "connect") {
      connect(option);
    } else if (name == "network") {
      found.network = text(option, network_max);
    } else if (name == "name") {
      found.name = text(option, name_max);
    } else if (name == "hostname") {
      found.host_name = text(option, name_max);
    } else if (name == "load") {
      load(option);
    } else if (name == "time-master") {
      found.time_master = true;
    } else if (name == "leaf") {
      found.leaf = true;
    } else {
      found.without_effect.push_back(option);
      if (name == "set-tuple") // key and value
        static_cast<void>(value(option));
      if (name == "set-tuple" || std::ranges::count(ignored_with_value, name) > 0)
        static_cast<void>(value(option));
    }
  }

  std::deque<std::string> words_;
  const options_reader* read_;
  std::size_t files_ = 0;
};

bool is_used(peer_id id, const config::peer_description& except,
             const config::ecology_description& x) {
  const auto is_gateway = [id](const auto& island) {
    const auto all = config::gateways_of(island);
    return std::ranges::find(all, id) != all.end();
  };
  const auto is_peer = [&](const auto& each) { return each.id == id && &each != &except; };
  return std::ranges::any_of(x.islands, is_gateway) || std::ranges::any_of(x.peers, is_peer);
}

/// Whom the options are about.
config::peer_description* peer_of(config::ecology_description& x) {
  const auto is_real = [](const auto& each) { return config::has_real_links(each); };
  if (x.peers.size() == 1)
    return &x.peers.front();
  if (std::ranges::count_if(x.peers, is_real) != 1)
    return nullptr;
  return &*std::ranges::find_if(x.peers, is_real);
}

/// Others name a peer by its id where they may stop it, or it them.
void rename(peer_id from, peer_id to, config::ecology_description& x) {
  for (auto& peer : x.peers) {
    std::ranges::replace(peer.managers, from, to);
    if (peer.init == from)
      peer.init = to;
  }
}

} // namespace

std::variant<original_options, std::string>
take_original_options(std::vector<std::string>& arguments, const options_reader& read) {
  taker all({arguments.begin(), arguments.end()}, read);
  std::vector<std::string> rest;
  all.run(rest);
  if (!all.why.empty())
    return all.why;
  arguments = std::move(rest);
  return std::move(all.found);
}

std::string take_over(const original_options& x, config::ecology_description& to) {
  if (!x.any())
    return {};
  auto* peer = peer_of(to);
  if (peer == nullptr)
    return "options of --peis- apply to one peer: the file has none, or several";
  if (x.id && is_used(*x.id, *peer, to))
    return "--peis-id: the file uses " + to_string(*x.id) + " for another peer";
  if (x.name && std::ranges::any_of(to.peers, [&](const auto& each) {
        return each.name == *x.name && &each != peer;
      }))
    return "--peis-name: the file has another peer of this name";
  if (x.network)
    to.network = *x.network;
  if (x.port) {
    peer->tcp = peer->tcp.value_or(config::tcp_listener{});
    peer->tcp->port = *x.port;
  }
  peer->connect.insert(peer->connect.end(), x.connect.begin(), x.connect.end());
  peer->udp = peer->udp || std::ranges::any_of(x.connect, [](const auto& each) {
                return each.starts_with("udp://");
              });
  peer->host = x.host_name.value_or(peer->host);
  peer->name = x.name.value_or(peer->name);
  peer->leaf = peer->leaf || x.leaf;
  peer->time_master = peer->time_master || x.time_master;
  if (x.id) {
    rename(peer->id, *x.id, to);
    peer->id = *x.id;
    std::ranges::sort(to.peers, {}, &config::peer_description::id);
  }
  return {};
}

} // namespace rubicon::cli
