#include "io/tls/tls_keeper.hpp"

#include <stdexcept>
#include <utility>
#include <variant>

#include <sys/stat.h>

#include "io/files/replace_file.hpp"
#include "io/tls/certificates.hpp"
#include "io/tls/revocation_content.hpp"

namespace rubicon::io {

namespace {

constexpr const char* no_good = "keeps its certificate, since the new one is invalid: ";

template <class T>
T need(std::variant<T, std::string> x) {
  if (const auto* why = std::get_if<std::string>(&x))
    throw std::runtime_error(*why);
  return std::get<T>(std::move(x));
}

std::string list_text(const revocation_list& x) {
  return "list " + std::to_string(x.number()) + " of revoked certificates, with " +
         std::to_string(x.size());
}

/// Why it is not to be shown; empty: it may be.
std::string why_revoked(const std::string& path, const tls_identity& own,
                        const std::optional<revocation_list>& list) {
  const auto at = list ? own.revoked_by(*list) : std::nullopt;
  return at ? path + ": revoked on " + time_text(*at) +
                  "; `rubicon certs renew --new-key` makes a new one"
            : "";
}

} // namespace

tls_keeper::tls_keeper(tls_files files, std::string name, std::string store)
    : files_(std::move(files)), name_(std::move(name)), store_(std::move(store)),
      seen_(stamps_now()) {
  if (files_.empty())
    return;
  auto own = need(tls_identity::load(files_, system_time(), name_));
  if (auto why = adopt(std::move(own)); !why.empty())
    throw std::runtime_error(why);
  begin_with_list();
  if (const auto why = why_revoked(files_.certificate, *identity_, revoked_); !why.empty())
    throw std::runtime_error(why);
  if (identity_->use() == certificate_use::any)
    warnings_.push_back(files_.certificate +
                        " is valid both for a host and for a coordinator: `rubicon certs renew "
                        "--host` or `--coordinator` restricts it to one use");
}

tls_keeper::stamp tls_keeper::stamp_of(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0)
    return {};
  return {about.st_mtim.tv_sec, about.st_mtim.tv_nsec, about.st_ino, about.st_size};
}

tls_keeper::stamps tls_keeper::stamps_now() const {
  return {{stamp_of(files_.certificate), stamp_of(files_.key), stamp_of(files_.authority)},
          stamp_of(list_path())};
}

std::string tls_keeper::list_path() const {
  return revocations_beside(files_.authority);
}

/// A new authority has a list of its own.
std::string tls_keeper::stored_path(const tls_identity& x) const {
  return store_.empty() ? "" : store_ + '-' + x.authority_mark() + ".crl";
}

/// Shows it from now on, with what is known of revoked certificates of its authority.
/// @returns why not; empty: it does
std::string tls_keeper::adopt(tls_identity x) {
  auto list = revoked_;
  if (!identity_ || identity_->authority_mark() != x.authority_mark()) {
    list.reset();
    if (const auto path = stored_path(x); !path.empty()) {
      auto found = read_revocations(path, files_.authority, system_time(), /*may_be_over=*/true);
      if (auto* why = std::get_if<std::string>(&found))
        return *why;
      list = std::get<0>(std::move(found));
    }
  }
  if (list) {
    auto with_list = x.with(*list);
    if (auto* why = std::get_if<std::string>(&with_list))
      return *why;
    x = std::get<tls_identity>(std::move(with_list));
  }
  identity_ = std::move(x);
  revoked_ = std::move(list);
  return {};
}

void tls_keeper::begin_with_list() {
  auto beside = read_revocations(list_path(), files_.authority, system_time());
  if (revoked_ && beside.index() == 1) {
    auto old = read_revocations(list_path(), files_.authority, system_time(), /*may_be_over=*/true);
    if (old.index() == 0 && is_same(*std::get<0>(old), *revoked_))
      return; // the one in force holds on
  }
  auto list = need(std::move(beside));
  if (!list)
    return;
  if (revoked_ && list->number() < revoked_->number())
    return warnings_.push_back(list_path() + " is older than " + list_text(*revoked_) +
                               ", which is in force");
  const auto found = take(*std::move(list));
  if (!found.is_taken && !found.report.empty())
    throw std::runtime_error(list_path() + ' ' + found.report);
}

tls_keeper::outcome tls_keeper::take(const std::string& pem) {
  if (files_.empty())
    return {false, "has no effect without certificates"};
  auto read = revocation_list::read(pem, files_.authority, system_time());
  if (auto* why = std::get_if<std::string>(&read))
    return {false, std::move(*why)};
  return take(std::get<revocation_list>(std::move(read)));
}

tls_keeper::outcome tls_keeper::take(revocation_list x) {
  if (revoked_ && x.number() == revoked_->number())
    return {false, is_same(x, *revoked_) ? ""
                                         : "differs from but has the number of " +
                                               list_text(*revoked_) + ", which is in force"};
  if (revoked_ && x.number() < revoked_->number())
    return {false, "has number " + std::to_string(x.number()) + ", and " + list_text(*revoked_) +
                       ", is in force"};
  auto own = identity_->with(x);
  if (auto* why = std::get_if<std::string>(&own))
    return {false, std::move(*why)};
  identity_ = std::get<tls_identity>(std::move(own));
  revoked_ = std::move(x);
  std::string report = "accepts " + list_text(*revoked_);
  if (identity_->revoked_by(*revoked_))
    report += "; its own certificate is among them";
  if (const auto path = stored_path(*identity_); !path.empty())
    if (const auto why = replace_file(path, revoked_->text(), durability::of_power); !why.empty())
      report += "; it is lost when this process ends: " + why;
  return {true, std::move(report)};
}

std::string tls_keeper::look(bool again) {
  if (files_.empty())
    return {};
  const auto now = stamps_now();
  const auto before = std::exchange(seen_, now);
  std::string report;
  if (again || now.certificate != before.certificate)
    report = look_at_certificate();
  if (again || now.list != before.list)
    if (const auto more = look_at_list(); !more.empty())
      report += (report.empty() ? "" : "; ") + more;
  return report;
}

std::string tls_keeper::look_at_certificate() {
  auto loaded = tls_identity::load(files_, system_time(), name_);
  if (const auto* why = std::get_if<std::string>(&loaded))
    return no_good + *why;
  auto& found = std::get<tls_identity>(loaded);
  if (auto why = why_revoked(files_.certificate, found, revoked_); !why.empty())
    return no_good + why;
  if (auto why = adopt(std::move(found)); !why.empty())
    return no_good + why;
  ++changes_;
  return "uses the certificate that " + files_.certificate + " contains now, valid until " +
         time_text(identity_->valid_until());
}

std::string tls_keeper::look_at_list() {
  auto found = read_revocations(list_path(), files_.authority, system_time());
  if (const auto* why = std::get_if<std::string>(&found))
    return "does not accept a list of revoked certificates: " + *why;
  auto& list = std::get<0>(found);
  if (!list)
    return {};
  auto what = take(*std::move(list));
  return what.is_taken || what.report.empty() ? what.report : list_path() + ' ' + what.report;
}

} // namespace rubicon::io
