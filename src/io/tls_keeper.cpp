#include "io/tls_keeper.hpp"

#include <stdexcept>
#include <utility>
#include <variant>

#include <sys/stat.h>

#include "io/certificates.hpp"

namespace rubicon::io {

tls_keeper::tls_keeper(tls_files files, std::string name)
    : files_(std::move(files)), name_(std::move(name)), seen_(stamps_now()) {
  if (files_.empty())
    return;
  auto loaded = tls_identity::load(files_, system_time(), name_);
  if (const auto* why = std::get_if<std::string>(&loaded))
    throw std::runtime_error(*why);
  identity_ = std::get<tls_identity>(std::move(loaded));
}

tls_keeper::stamp tls_keeper::stamp_of(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0)
    return {};
  return {about.st_mtim.tv_sec, about.st_mtim.tv_nsec, about.st_ino, about.st_size};
}

tls_keeper::stamps tls_keeper::stamps_now() const {
  return {stamp_of(files_.certificate), stamp_of(files_.key), stamp_of(files_.authority)};
}

std::string tls_keeper::look(bool again) {
  if (files_.empty())
    return {};
  const auto now = stamps_now();
  if (!again && now == seen_)
    return {};
  seen_ = now;
  auto loaded = tls_identity::load(files_, system_time(), name_);
  if (const auto* why = std::get_if<std::string>(&loaded))
    return "keeps its certificate, for the new one is no good: " + *why;
  identity_ = std::get<tls_identity>(std::move(loaded));
  ++changes_;
  return "takes the certificate that " + files_.certificate + " holds now, valid until " +
         time_text(identity_->valid_until());
}

} // namespace rubicon::io
