// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/navigation_chain.h"

#include <Eigen/Cholesky>
#include <map>

#include "core/error.h"

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Covariances of pairs of the block's images in the axes of the equations.
class Pairs {
 public:
  Pairs(const OrientationCorrelation& c, const std::vector<std::int64_t>& image_of, const std::vector<PoseCovariance>& turn,
        ChainParts parts)
      : parts_(parts) {
    for (const CovariancePair& p : c.pairs) {
      const auto a = image_of[p.image], b = image_of[p.other];
      if (a < 0 || b < 0) continue;
      const auto i = static_cast<std::uint32_t>(a), j = static_cast<std::uint32_t>(b);
      values_[{i, j}] = turn[i] * p.value * turn[j].transpose();
    }
  }
  /// False where the pair is not there.
  bool get(std::uint32_t i, std::uint32_t j, MatrixXd& out) const {
    auto found = values_.find({i, j});
    const bool turned = found == values_.end();
    if (turned) found = values_.find({j, i});
    if (found == values_.end()) return false;
    const MatrixXd part = found->second.block(parts_.first, parts_.first, parts_.size, parts_.size);
    out = turned ? MatrixXd(part.transpose()) : part;
    return true;
  }

 private:
  ChainParts parts_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, PoseCovariance> values_;
};

/// The errors of `image` given those of `before`; `name`: of the image, for faults.
NavigationStep step_of(const Pairs& pairs, std::uint32_t image, const std::vector<std::uint32_t>& before, Index d, const std::string& name,
                       const std::string& file) {
  const auto n = static_cast<Index>(before.size());
  MatrixXd C(d * (n + 1), d * (n + 1)), block;  // of those before, and of the image
  for (Index a = 0; a <= n; ++a)
    for (Index b = 0; b <= a; ++b) {
      const std::uint32_t i = a < n ? before[static_cast<size_t>(a)] : image, j = b < n ? before[static_cast<size_t>(b)] : image;
      if (!pairs.get(i, j, block))
        throw core::Error("image " + name + " is paired with two images that are not paired with each other", file);
      C.block(d * a, d * b, d, d) = block;
      C.block(d * b, d * a, d, d) = block.transpose();
    }
  // Scaled, so that metres and radians have one size.
  const VectorXd scale = C.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> factor(scale.asDiagonal() * C * scale.asDiagonal());
  if (factor.info() != Eigen::Success)
    throw core::Error("the covariances of image " + name + " with those before it are not positive definite", file,
                      "errors that are the same to all digits of the file have no covariance of their own: keep more digits");
  // C = L L': the last rows of L are [B L_bb, root of Cov(q)].
  const MatrixXd L = scale.cwiseInverse().asDiagonal() * MatrixXd(factor.matrixL());
  NavigationStep step;
  step.image = image, step.before = before;
  if (n > 0)
    step.by_before = L.topLeftCorner(d * n, d * n)
                         .triangularView<Eigen::Lower>()
                         .transpose()
                         .solve(L.bottomLeftCorner(d, d * n).transpose())
                         .transpose();
  step.root = L.bottomRightCorner(d, d);
  return step;
}

}  // namespace

std::vector<NavigationStep> navigation_chain(const OrientationCorrelation& correlation,
                                             const std::unordered_map<std::string, std::uint32_t>& number,
                                             const std::vector<PoseCovariance>& turn, ChainParts parts, const std::string& file) {
  std::vector<std::int64_t> image_of(correlation.images.size(), -1);
  std::vector<char> there(turn.size(), 0);
  for (size_t k = 0; k < image_of.size(); ++k)
    if (const auto found = number.find(correlation.images[k]); found != number.end()) image_of[k] = found->second, there[found->second] = 1;
  for (const auto& [name, image] : number)
    if (image < there.size() && !there[image])
      throw core::Error("image " + name + " is not in the file of correlations", file, "it must have all images of the table");
  const Pairs pairs(correlation, image_of, turn, parts);
  std::vector<std::vector<std::uint32_t>> before(correlation.images.size());
  for (const CovariancePair& p : correlation.pairs)
    if (p.other != p.image && image_of[p.other] >= 0) before[p.image].push_back(static_cast<std::uint32_t>(image_of[p.other]));
  std::vector<NavigationStep> out;
  for (size_t k = 0; k < image_of.size(); ++k)
    if (image_of[k] >= 0)
      out.push_back(step_of(pairs, static_cast<std::uint32_t>(image_of[k]), before[k], parts.size, correlation.images[k], file));
  return out;
}

}  // namespace swath::calib
