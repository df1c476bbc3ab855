// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/tie_matrix.h"

#include <algorithm>

namespace swath::calib {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

UnknownNodes::UnknownNodes(std::vector<int> node) : node_(std::move(node)) {
  row_.reserve(node_.size());
  for (const int n : node_) {
    if (static_cast<size_t>(n) >= sizes_.size()) sizes_.resize(static_cast<size_t>(n) + 1, 0);
    row_.push_back(sizes_[static_cast<size_t>(n)]++);
  }
}

std::vector<UnknownNodes::Part> UnknownNodes::parts(const std::vector<int>& unknowns) const {
  std::vector<Part> out;
  for (size_t i = 0; i < unknowns.size(); ++i) {
    const int n = node(unknowns[i]);
    auto at = out.empty() || out.back().node != n ? std::find_if(out.begin(), out.end(), [n](const Part& p) { return p.node == n; })
                                                  : out.end() - 1;
    if (at == out.end()) at = out.insert(out.end(), {n, {}, {}});
    at->rows.push_back(row(unknowns[i]));
    at->places.push_back(static_cast<int>(i));
  }
  return out;
}

TieMatrix TieMatrix::dense(int unknowns) {
  return TieMatrix(std::make_shared<UnknownNodes>(std::vector<int>(static_cast<size_t>(unknowns), 0)));
}

void TieMatrix::add(const std::vector<int>& unknowns, const MatrixXd& M, double factor) {
  const std::vector<UnknownNodes::Part> parts = nodes_->parts(unknowns);
  for (const UnknownNodes::Part& a : parts)
    for (const UnknownNodes::Part& b : parts) {
      if (a.node < b.node) continue;
      auto block = N_.block_for(a.node, b.node);
      for (size_t j = 0; j < b.rows.size(); ++j)
        for (size_t i = 0; i < a.rows.size(); ++i) block(a.rows[i], b.rows[j]) += factor * M(a.places[i], b.places[j]);
    }
}

void TieMatrix::add(const TieMatrix& other) {
  for (const auto& [a, b] : other.N_.blocks()) N_.block_for(a, b) += other.N_.block(a, b);
}

VectorXd TieMatrix::times(const VectorXd& x) const {
  VectorXd in(x.size()), out = VectorXd::Zero(x.size()), back(x.size());
  for (int u = 0; u < unknowns(); ++u) in[N_.first(nodes_->node(u)) + nodes_->row(u)] = x[u];
  for (const auto& [a, b] : N_.blocks()) {
    const auto B = N_.block(a, b);
    out.segment(N_.first(a), N_.size(a)) += B * in.segment(N_.first(b), N_.size(b));
    if (a != b) out.segment(N_.first(b), N_.size(b)) += B.transpose() * in.segment(N_.first(a), N_.size(a));
  }
  for (int u = 0; u < unknowns(); ++u) back[u] = out[N_.first(nodes_->node(u)) + nodes_->row(u)];
  return back;
}

VectorXd TieMatrix::diagonal() const {
  const VectorXd by_node = N_.diagonal();
  VectorXd out(unknowns());
  for (int u = 0; u < unknowns(); ++u) out[u] = by_node[N_.first(nodes_->node(u)) + nodes_->row(u)];
  return out;
}

MatrixXd TieMatrix::whole() const {
  MatrixXd by_node = MatrixXd::Zero(unknowns(), unknowns());
  for (const auto& [a, b] : N_.blocks()) {
    by_node.block(N_.first(a), N_.first(b), N_.size(a), N_.size(b)) = N_.block(a, b);
    by_node.block(N_.first(b), N_.first(a), N_.size(b), N_.size(a)) = N_.block(a, b).transpose();
  }
  std::vector<int> at;
  for (int u = 0; u < unknowns(); ++u) at.push_back(N_.first(nodes_->node(u)) + nodes_->row(u));
  return by_node(at, at);
}

std::vector<int> TieInverse::firsts(const TieMatrix& matrix) {
  std::vector<int> out;
  for (int n = 0; n < matrix.N_.nodes(); ++n) out.push_back(matrix.N_.first(n));
  return out;
}

MatrixXd TieInverse::solve(const MatrixXd& b) const {
  MatrixXd in(b.rows(), b.cols()), out(b.rows(), b.cols());
  for (int u = 0; u < nodes_->unknowns(); ++u) in.row(place(u)) = b.row(u);
  const MatrixXd x = factor_.solve(in);
  for (int u = 0; u < nodes_->unknowns(); ++u) out.row(u) = x.row(place(u));
  return out;
}

MatrixXd TieInverse::of(const std::vector<int>& unknowns) const {
  const auto n = static_cast<Index>(unknowns.size());
  MatrixXd out(n, n);
  const std::vector<UnknownNodes::Part> parts = nodes_->parts(unknowns);
  for (size_t p = 0; p < parts.size(); ++p)
    for (size_t q = 0; q <= p; ++q) {
      const MatrixXd B = factor_.covariance(parts[p].node, parts[p].rows, parts[q].node, parts[q].rows);
      out(parts[p].places, parts[q].places) = B;
      out(parts[q].places, parts[p].places) = B.transpose();
    }
  return out;
}

VectorXd TieInverse::diagonal() const {
  VectorXd out(nodes_->unknowns());
  for (int u = 0; u < nodes_->unknowns(); ++u)
    out[u] = factor_.covariance(nodes_->node(u), {nodes_->row(u)}, nodes_->node(u), {nodes_->row(u)})(0, 0);
  return out;
}

}  // namespace swath::calib
