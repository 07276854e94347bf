#include "testkit/mail.hpp"

#include <algorithm>
#include <cassert>

#include "scheduler/actor.hpp"

namespace rubicon::test {

namespace {

mail::letter copy_of(const mail::letter& x) {
  return {x.to, x.content->type().copy(*x.content), x.from};
}

} // namespace

bool mail::takes(scheduler::actor& to, scheduler::envelope_ptr& content, scheduler::actor* from) {
  if (closed_ || passes_ || !actors_.contains(to.id()))
    return false;
  letter x{caf::strong_actor_ptr(to.ctrl()), std::move(content),
           caf::strong_actor_ptr(from != nullptr ? from->ctrl() : nullptr)};
  const auto found =
      std::ranges::find_if(planned_, [&x](const planned& each) { return matches(each.which, x); });
  if (found == planned_.end() && !hold_) {
    content = std::move(x.content);
    return false;
  }
  std::vector<letter> left;
  if (found == planned_.end()) {
    left.push_back(std::move(x));
  } else {
    const auto what = found->what;
    planned_.erase(found);
    left = befall(std::move(x), what);
  }
  for (auto& each : left) {
    if (hold_)
      letters_.push_back(std::move(each));
    else
      hand_over(std::move(each));
  }
  return true;
}

std::vector<mail::letter> mail::befall(letter x, mishap what) {
  std::vector<letter> left;
  switch (what.what) {
  case mishap::kind::drop:
    break;
  case mishap::kind::delay:
    later_(std::move(x), what.length);
    break;
  case mishap::kind::duplicate:
    left.push_back(copy_of(x));
    left.push_back(std::move(x));
    break;
  }
  return left;
}

void mail::add(scheduler::actor& who, std::string path) {
  actors_[who.id()] = {caf::weak_actor_ptr(who.ctrl()), std::move(path)};
}

caf::strong_actor_ptr mail::actor_of(caf::actor_id x) const {
  const auto found = actors_.find(x);
  return found != actors_.end() ? found->second.handle.lock() : nullptr;
}

void mail::plan(message_pattern which, mishap what) {
  const auto found =
      std::ranges::find_if(letters_, [&which](const letter& x) { return matches(which, x); });
  if (found == letters_.end()) {
    planned_.push_back({std::move(which), what});
    return;
  }
  auto x = std::move(*found);
  auto at = letters_.erase(found);
  for (auto& each : befall(std::move(x), what))
    at = std::next(letters_.insert(at, std::move(each)));
}

bool mail::matches(const message_pattern& x, const letter& y) {
  return (!x.to || *x.to == y.to->id()) && (!x.from || *x.from == y.content->sender) &&
         x.type == &y.content->type() && (!x.fits || x.fits(*y.content));
}

const mail::letter* mail::next(const message_pattern& x) const {
  const auto found = std::ranges::find_if(
      letters_, [&x](const letter& y) { return !x.to || *x.to == y.to->id(); });
  return found != letters_.end() && matches(x, *found) ? &*found : nullptr;
}

const mail::letter* mail::find(const message_pattern& x) const {
  const auto found =
      std::ranges::find_if(letters_, [&x](const letter& y) { return matches(x, y); });
  return found != letters_.end() ? &*found : nullptr;
}

void mail::deliver(const letter& x) {
  const auto found =
      std::ranges::find_if(letters_, [&x](const letter& each) { return &each == &x; });
  assert(found != letters_.end());
  auto taken = std::move(*found);
  letters_.erase(found);
  hand_over(std::move(taken));
}

bool mail::deliver_first() {
  if (letters_.empty())
    return false;
  deliver(letters_.front());
  return true;
}

void mail::hand_over(letter x) {
  const bool before = std::exchange(passes_, true);
  scheduler::actor_at(x.to)->deliver(std::move(x.content), scheduler::actor_at(x.from));
  passes_ = before;
}

void mail::close() {
  closed_ = true;
  planned_.clear();
  letters_.clear();
}

std::string mail::name_of(caf::actor_id x) const {
  if (x == 0)
    return "nobody";
  const auto found = actors_.find(x);
  return found == actors_.end() ? "an actor without a name" : found->second.path;
}

std::string mail::text(const message_pattern& x) const {
  return std::string(x.type->name()) + (x.from ? " from " + name_of(*x.from) : "") +
         (x.to ? " to " + name_of(*x.to) : "");
}

std::string mail::text(const letter& x) const {
  constexpr std::size_t shown_max = 300;
  auto content = x.content->text();
  if (content.size() > shown_max)
    content.replace(shown_max, std::string::npos, "...");
  return content + " from " + name_of(x.content->sender) + " to " + name_of(x.to->id());
}

std::string mail::text() const {
  constexpr std::size_t shown_max = 20;
  std::string all;
  for (std::size_t i = 0; i < std::min(letters_.size(), shown_max); ++i)
    all += "  " + text(letters_[i]) + '\n';
  if (letters_.size() > shown_max)
    all += "  and " + std::to_string(letters_.size() - shown_max) + " more\n";
  return all;
}

std::string mail::text_of_next(const message_pattern& x) const {
  const auto found = std::ranges::find_if(
      letters_, [&x](const letter& y) { return !x.to || *x.to == y.to->id(); });
  const auto receiver = x.to ? name_of(*x.to) : std::string("anybody");
  if (found == letters_.end())
    return "nothing is on its way to " + receiver;
  const bool differs =
      x.type != &found->content->type() || (x.from && *x.from != found->content->sender);
  return std::string(differs ? "next is " : "its content is not as asked: ") + text(*found);
}

} // namespace rubicon::test
