#include "communication/ports/program_list.hpp"

#include <algorithm>

namespace rubicon::communication {

std::size_t program_list::attach(communication_events& events, std::string name) {
  auto free = std::ranges::find(programs_, nullptr, &entry::events);
  if (free == programs_.end())
    free = programs_.emplace(free);
  *free = {&events, std::move(name)};
  return static_cast<std::size_t>(free - programs_.begin());
}

void program_list::detach(std::size_t program) {
  std::erase_if(events_, [program](const auto& x) { return x.first == program; });
  programs_[program].events = nullptr;
}

bool program_list::wants_ticks(std::size_t program) const {
  const auto* events = programs_[program].events;
  return events != nullptr && events->wants_ticks();
}

bool program_list::any_wants_ticks() const {
  return std::ranges::any_of(
      programs_, [](const entry& x) { return x.events != nullptr && x.events->wants_ticks(); });
}

void program_list::notify(std::size_t program, event x) {
  if (programs_[program].events != nullptr)
    events_.emplace_back(program, std::move(x));
}

void program_list::notify_all(const event& x) {
  for (std::size_t i = 0; i < programs_.size(); ++i)
    notify(i, x);
}

void program_list::dispatch() {
  if (std::exchange(dispatching_, true))
    return;
  while (!events_.empty()) {
    auto [program, what] = std::move(events_.front());
    events_.erase(events_.begin());
    what(*programs_[program].events);
  }
  dispatching_ = false;
}

void program_list::note(std::size_t program, program_note x) const {
  x.program = programs_[program].name;
  if (observer_ && (!x.program.empty() || x.what == program_note::kind::sent))
    observer_(x);
}

} // namespace rubicon::communication
