#include "tools/bench/neighbour_peers.hpp"

namespace slamd::bench {

std::vector<std::unique_ptr<NeighbourPeer>> neighbour_peers() { return {}; }

}  // namespace slamd::bench
