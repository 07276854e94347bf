#include "core/account/provenance.hpp"

#include <memory>

#include "core/account/message_ledger.hpp"

namespace rubicon {

void account_ref::close(copy_count* of) noexcept {
  const std::unique_ptr<message_account> owned(static_cast<message_account*>(of));
  owned->ledger().end(*owned);
}

provenance provenance::begin(std::string_view what, std::uint64_t id) {
  auto* const who = provenance_here.who;
  return {who == nullptr ? 0 : who->begin(what, id), account_ref(provenance_here.account)};
}

} // namespace rubicon
