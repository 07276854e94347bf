#include "io/files/pcap_file.hpp"

#include <cassert>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <utility>

#include <pcap/pcap.h>

namespace rubicon::io {

namespace {

struct close_pcap {
  void operator()(pcap_t* x) const { pcap_close(x); }
  void operator()(pcap_dumper_t* x) const { pcap_dump_close(x); }
};

} // namespace

struct pcap_file::impl {
  std::string path;
  std::unique_ptr<pcap_t, close_pcap> format;
  std::unique_ptr<pcap_dumper_t, close_pcap> file; // closed before its format
  std::uint64_t frames = 0;
  std::string error;

  /// Right after a call that may have failed. @param failed what the call itself says
  void check(bool failed) {
    const auto reason = errno;
    if (failed || std::ferror(pcap_dump_file(file.get())) != 0)
      error = path + ": " + std::generic_category().message(reason != 0 ? reason : EIO);
  }
};

std::variant<pcap_file, std::string> pcap_file::open(const std::string& path) {
  auto x = std::make_unique<impl>();
  x->path = path;
  x->format.reset(pcap_open_dead_with_tstamp_precision(
      DLT_IEEE802_15_4_WITHFCS, static_cast<int>(psdu_max), PCAP_TSTAMP_PRECISION_NANO));
  if (!x->format)
    return path + ": " + std::generic_category().message(ENOMEM);
  const auto name = path == "-" ? "./-" : path; // to libpcap a lone - is the standard output
  x->file.reset(pcap_dump_open(x->format.get(), name.c_str()));
  if (!x->file)
    return std::string(pcap_geterr(x->format.get()));
  return pcap_file(std::move(x));
}

pcap_file::pcap_file(std::unique_ptr<impl> x) : impl_(std::move(x)) {}

pcap_file::~pcap_file() = default;
pcap_file::pcap_file(pcap_file&&) noexcept = default;
pcap_file& pcap_file::operator=(pcap_file&&) noexcept = default;

void pcap_file::write(instant at, byte_view psdu) {
  assert(at >= instant{} && psdu.size() <= psdu_max);
  if (!impl_->error.empty())
    return;
  const auto since_start = at.time_since_epoch();
  const auto whole_seconds = std::chrono::floor<std::chrono::seconds>(since_start);
  pcap_pkthdr header{};
  header.ts.tv_sec = whole_seconds.count();
  header.ts.tv_usec = (since_start - whole_seconds).count(); // nanoseconds, as asked for
  header.caplen = header.len = static_cast<bpf_u_int32>(psdu.size());
  errno = 0;
  pcap_dump(reinterpret_cast<u_char*>(impl_->file.get()), &header, psdu.data());
  impl_->check(false);
  if (impl_->error.empty())
    ++impl_->frames;
}

void pcap_file::flush() {
  if (!impl_->error.empty())
    return;
  errno = 0;
  const auto failed = pcap_dump_flush(impl_->file.get()) != 0;
  impl_->check(failed);
}

const std::string& pcap_file::error() const {
  return impl_->error;
}

std::uint64_t pcap_file::frames() const {
  return impl_->frames;
}

} // namespace rubicon::io
