#include "core/loop/loop_net.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/loop/loop_net_weights.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::loop {
namespace {

std::vector<std::byte> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

/// What PyTorch made of some images, as tools/loopnet/export.py wrote it.
class Vectors {
 public:
  Vectors() : bytes_(bytes_of(std::string(SLAMD_SOURCE_DIR) + "/tests/core/loop/loop_net_vectors.bin")) {
    images_ = load_le<std::uint32_t>(bytes_, 0);
  }

  std::size_t images() const { return images_; }

  PolarImage image(std::size_t i) const {
    PolarImage image;
    std::memcpy(image.cells.data(), bytes_.data() + 4 + i * PolarImage::kCells, PolarImage::kCells);
    return image;
  }

  float global(std::size_t i, std::size_t k) const { return number(i * Descriptor::kLength + k); }
  float column(std::size_t i, std::size_t k) const {
    return number(images_ * Descriptor::kLength + i * kColumnFloats + k);
  }
  /// Table 0: overlap logits, 1: yaws, 2: margins.
  float pair(std::size_t table, std::size_t a, std::size_t b) const {
    return number(images_ * (Descriptor::kLength + kColumnFloats) + table * images_ * images_ + a * images_ + b);
  }

 private:
  static constexpr std::size_t kColumnFloats = Descriptor::kFeatures * Descriptor::kColumns;

  float number(std::size_t i) const { return load_le<float>(bytes_, 4 + images_ * PolarImage::kCells + 4 * i); }

  std::vector<std::byte> bytes_;
  std::size_t images_ = 0;
};

std::vector<Descriptor> descriptors_of(LoopNet& net, const Vectors& vectors) {
  std::vector<Descriptor> descriptors(vectors.images());
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    net.describe(vectors.image(i), descriptors[i]);
  }
  return descriptors;
}

TEST(LoopNet, DescribesAsPyTorchDoes) {
  const Vectors vectors;
  LoopNet sut;

  const std::vector<Descriptor> descriptors = descriptors_of(sut, vectors);

  ASSERT_GE(descriptors.size(), 4U);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    for (std::size_t k = 0; k < Descriptor::kLength; ++k) {
      ASSERT_NEAR(descriptors[i].global[k], vectors.global(i, k), 1e-4F);
    }
    for (std::size_t k = 0; k < Descriptor::kFeatures * Descriptor::kColumns; ++k) {
      ASSERT_NEAR(descriptors[i].columns[k], vectors.column(i, k), 1e-4F);
    }
  }
}

TEST(LoopNet, ComparesAsPyTorchDoes) {
  const Vectors vectors;
  LoopNet sut;
  const std::vector<Descriptor> descriptors = descriptors_of(sut, vectors);

  for (std::size_t a = 0; a < descriptors.size(); ++a) {
    for (std::size_t b = 0; b < descriptors.size(); ++b) {
      const Comparison pair = sut.compare(descriptors[a], descriptors[b]);
      // A logit is a sum of some tens of products of sizes of ten: relative to its size.
      EXPECT_NEAR(pair.overlap_logit, vectors.pair(0, a, b), 1e-4F * std::max(1.0F, std::abs(vectors.pair(0, a, b))));
      EXPECT_NEAR(std::remainder(pair.yaw_rad - vectors.pair(1, a, b), 2.0F * static_cast<float>(M_PI)), 0.0F, 1e-4F);
      EXPECT_NEAR(pair.yaw_margin, vectors.pair(2, a, b), 1e-4F);
    }
  }
}

/// The same image with all that is seen at azimuth φ moved to φ + 3° · azimuths.
PolarImage turned(const PolarImage& image, std::size_t azimuths) {
  PolarImage result;
  for (std::size_t row = 0; row < PolarImage::kSlices * PolarImage::kRings; ++row) {
    for (std::size_t azimuth = 0; azimuth < PolarImage::kAzimuths; ++azimuth) {
      result.cells[row * PolarImage::kAzimuths + (azimuth + azimuths) % PolarImage::kAzimuths] =
          image.cells[row * PolarImage::kAzimuths + azimuth];
    }
  }
  return result;
}

TEST(LoopNet, TellsTheYawThatTurnsTheSecondFrameIntoTheFirst) {
  const PolarImage b = Vectors().image(0);
  const PolarImage a = turned(b, 20);  // what b sees at φ stands at φ + 60° in a
  LoopNet sut;
  Descriptor descriptor_a;
  Descriptor descriptor_b;
  sut.describe(a, descriptor_a);
  sut.describe(b, descriptor_b);

  const float yaw_rad = sut.compare(descriptor_a, descriptor_b).yaw_rad;

  EXPECT_NEAR(yaw_rad, M_PI / 3.0, 1e-3);
  EXPECT_NEAR(sut.compare(descriptor_b, descriptor_a).yaw_rad, -M_PI / 3.0, 1e-3);
  EXPECT_NEAR(similarity(descriptor_a, descriptor_b), 1.0F, 1e-4F);
}

TEST(LoopNet, TakesAnEmptyImage) {
  LoopNet sut;
  Descriptor descriptor;

  sut.describe(PolarImage{}, descriptor);

  const Comparison pair = sut.compare(descriptor, descriptor);
  EXPECT_TRUE(std::isfinite(pair.overlap_logit));
  EXPECT_TRUE(std::isfinite(pair.yaw_rad));
  EXPECT_TRUE(std::isfinite(similarity(descriptor, descriptor)));
}

TEST(LoopNet, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  LoopNet sut;
  Descriptor descriptor;
  PolarImage image;
  image.cells[1000] = 32;
  sut.describe(image, descriptor);

  EXPECT_EQ(support::count_allocations([&] {
              sut.describe(image, descriptor);
              sut.compare(descriptor, descriptor);
            }),
            0U);
}

TEST(LoopNet, RefusesDamagedWeights) {
  const std::span<const std::byte> linked = linked_weights();
  std::vector<std::byte> weights(linked.begin(), linked.end());
  weights[5000] ^= std::byte{1};

  EXPECT_THROW(LoopNet{std::span<const std::byte>(weights)}, std::invalid_argument);
  EXPECT_THROW(LoopNet{linked.first(1000)}, std::invalid_argument);
  EXPECT_THROW(LoopNet{std::span<const std::byte>{}}, std::invalid_argument);
}

TEST(LinkedWeights, AreTheFileInTheSourceTree) {
  const std::vector<std::byte> file = bytes_of(std::string(SLAMD_SOURCE_DIR) + "/core/loop/weights/loop_net.bin");
  const std::span<const std::byte> linked = linked_weights();

  EXPECT_LE(file.size(), 1'000'000U);
  EXPECT_TRUE(std::equal(file.begin(), file.end(), linked.begin(), linked.end()));
}

}  // namespace
}  // namespace slamd::loop
