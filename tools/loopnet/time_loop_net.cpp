#include <ctime>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include "core/loop/loop_net.hpp"
#include "core/loop/retrieval.hpp"

namespace {

using namespace slamd;

/// CPU time of this thread: what else runs on the machine does not count. Units: s.
double cpu_s() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Prints median and worst of some runs. Units: ms.
void time(const char* what, int runs, const std::function<void()>& run) {
  std::vector<double> times_ms;
  for (int i = 0; i < runs; ++i) {
    const double begin_s = cpu_s();
    run();
    times_ms.push_back(1e3 * (cpu_s() - begin_s));
  }
  std::sort(times_ms.begin(), times_ms.end());
  std::printf("%-44s %8.3f %8.3f\n", what, times_ms[times_ms.size() / 2], times_ms.back());
}

}  // namespace

/// CPU time of Loop-Net's parts on one core, for docs/loop-net.md.
int main() {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> metres(-50.0F, 50.0F);
  std::vector<Eigen::Vector3f> points(30'000);
  for (Eigen::Vector3f& p : points) {
    p = {metres(random), metres(random), 0.1F * metres(random)};
  }
  loop::PolarImager imager;
  loop::PolarImage image;
  loop::LoopNet net;
  std::printf("%-44s %8s %8s\n", "ms of CPU time", "median", "worst");
  time("polar image of 30,000 points", 50, [&] {
    imager.clear();
    imager.add({}, points);
    imager.finish(image);
  });
  loop::Descriptor descriptor;
  time("describe", 200, [&] { net.describe(image, descriptor); });
  float sum = 0.0F;
  time("compare", 1000, [&] { sum += net.compare(descriptor, descriptor).yaw_rad; });

  loop::Retrieval retrieval{loop::RetrievalConfig{}};
  std::normal_distribution<float> normal;
  for (loop::KeyframeNumber keyframe = 0; keyframe < 10'000; ++keyframe) {
    loop::Descriptor other = descriptor;
    std::generate(other.global.begin(), other.global.end(), [&] { return normal(random); });
    retrieval.add(keyframe, other);
  }
  time("search among 10,000 keyframes", 50, [&] { sum += static_cast<float>(retrieval.search(net, descriptor, 10'000).size()); });
  return sum == 0.0F ? 1 : 0;
}
