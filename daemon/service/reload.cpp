#include "daemon/service/reload.hpp"

#include "daemon/configuration/key_table.hpp"

namespace slamd::service {

using configuration::Configuration;
using configuration::Key;

namespace {

std::string listed(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) {
    text += (text.empty() ? "" : ", ") + item;
  }
  return text;
}

}  // namespace

Reload take_over(Configuration& running, const Configuration& wanted) {
  Reload reload;
  for (const Key& key : configuration::all_keys()) {
    const std::string before = configuration::print_value(key, running);
    const std::string after = configuration::print_value(key, wanted);
    if (before == after) {
      continue;
    }
    const std::string change = key.path + " " + before + " → " + after;
    if (key.is_live) {
      key.set(running, key.get(wanted));
      reload.taken.push_back(change);
    } else {
      reload.refused.push_back(change);
    }
  }
  return reload;
}

std::string in_words(const Reload& reload) {
  if (reload.taken.empty() && reload.refused.empty()) {
    return "configuration read again: nothing has changed";
  }
  std::string words = "configuration read again: ";
  if (!reload.taken.empty()) {
    words += "now " + listed(reload.taken);
  }
  if (!reload.refused.empty()) {
    words += (reload.taken.empty() ? "" : "; ") + std::string("refused until a restart: ") +
             listed(reload.refused);
  }
  return words;
}

}  // namespace slamd::service
