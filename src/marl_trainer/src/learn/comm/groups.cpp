#include "marl_trainer/learn/comm/groups.hpp"

#include <algorithm>

namespace stg::learn {

GroupShare GroupShare::Of(const Communicator& ranks) {
  GroupShare share;
  share.groups = std::max(kGroups, ranks.size());
  share.count = share.groups / ranks.size();
  share.first = share.count * ranks.rank();
  return share;
}

}  // namespace stg::learn
