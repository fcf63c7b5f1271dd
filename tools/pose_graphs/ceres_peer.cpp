#include "tools/pose_graphs/ceres_peer.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <ceres/autodiff_cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>
#include <ceres/solver.h>

#include "tools/pose_graphs/cpu_time.hpp"

namespace slamd::pose_graphs {

namespace {

using geometry::Matrix6d;
using geometry::Se3;

/// Position, and quaternion w, x, y, z: the form of Ceres's functions. Plain arrays compile in a fifth of the time that
/// Eigen's matrices of Ceres's numbers take.
using Position = std::array<double, 3>;
using Turn = std::array<double, 4>;

Position position_of(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

Turn turn_of(const Se3& T) {
  const Eigen::Quaterniond q = T.quaternion();
  return {q.w(), q.x(), q.y(), q.z()};
}

/// The square root of an information, which may be zero along some axes: Sᵀ S = Ω.
Matrix6d square_root(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

template <typename T>
void conjugated(const T* q, T* out) {
  out[0] = q[0];
  for (int k = 1; k < 4; ++k) {
    out[k] = -q[k];
  }
}

/// out = S (p − p₀, Log(q₀⁻¹ q)).
template <typename T>
void whitened_difference(const T* p, const T* q, const Position& p0, const Turn& q0, const Matrix6d& root, T* out) {
  T r[6];
  for (int k = 0; k < 3; ++k) {
    r[k] = p[k] - p0[static_cast<std::size_t>(k)];
  }
  const T back[4] = {T(q0[0]), T(-q0[1]), T(-q0[2]), T(-q0[3])};
  T difference[4];
  ceres::QuaternionProduct(back, q, difference);
  ceres::QuaternionToAngleAxis(difference, r + 3);
  for (int i = 0; i < 6; ++i) {
    out[i] = root(i, 0) * r[0];
    for (int k = 1; k < 6; ++k) {
      out[i] += root(i, k) * r[k];
    }
  }
}

struct Between {
  Position p_a_b;
  Turn q_a_b;
  Matrix6d root;

  template <typename T>
  bool operator()(const T* p_a, const T* q_a, const T* p_b, const T* q_b, T* out) const {
    T back[4];
    conjugated(q_a, back);
    const T way[3] = {p_b[0] - p_a[0], p_b[1] - p_a[1], p_b[2] - p_a[2]};
    T p[3];
    T q[4];
    ceres::UnitQuaternionRotatePoint(back, way, p);
    ceres::QuaternionProduct(back, q_b, q);
    whitened_difference(p, q, p_a_b, q_a_b, root, out);
    return true;
  }
};

struct Prior {
  Position p;
  Turn q;
  Matrix6d root;

  template <typename T>
  bool operator()(const T* p_base, const T* q_base, T* out) const {
    whitened_difference(p_base, q_base, p, q, root, out);
    return true;
  }
};

struct Gravity {
  Position up_base;
  double root;

  template <typename T>
  bool operator()(const T* q_base, T* out) const {
    // The part of up across up_base: its three components have the length of the two in the tangent plane.
    T back[4];
    conjugated(q_base, back);
    const T z[3] = {T(0.0), T(0.0), T(1.0)};
    T up[3];
    ceres::UnitQuaternionRotatePoint(back, z, up);
    const T along = up_base[0] * up[0] + up_base[1] * up[1] + up_base[2] * up[2];
    for (std::size_t k = 0; k < 3; ++k) {
      out[k] = root * (up[k] - up_base[k] * along);
    }
    return true;
  }
};

struct Fix {
  graph::GnssFactor factor;
  double weight;

  template <typename T>
  bool operator()(const T* p_base, const T* q_base, const T* p_enu, const T* yaw, T* out) const {
    const T lever[3] = {T(factor.p_base_antenna.x()), T(factor.p_base_antenna.y()), T(factor.p_base_antenna.z())};
    T arm[3];
    ceres::UnitQuaternionRotatePoint(q_base, lever, arm);
    const T c = cos(yaw[0]);
    const T s = sin(yaw[0]);
    const T measured[3] = {c * factor.p_enu.x() - s * factor.p_enu.y(), s * factor.p_enu.x() + c * factor.p_enu.y(),
                           T(factor.p_enu.z())};
    const double w = std::sqrt(weight);
    const double root[3] = {w / factor.horizontal_std_m, w / factor.horizontal_std_m, w / factor.vertical_std_m};
    for (int k = 0; k < 3; ++k) {
      out[k] = root[k] * (p_base[k] + arm[k] - p_enu[k] - measured[k]);
    }
    return true;
  }
};

/// The variables as Ceres moves them.
struct Variables {
  std::vector<Position> p;
  std::vector<Turn> q;
  Position p_map_enu{};
  double yaw = 0.0;
};

void add_between(ceres::Problem& problem, Variables& x, std::size_t a, std::size_t b, const graph::BetweenFactor& factor,
                 double weight) {
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<Between, 6, 3, 4, 3, 4>(new Between{
          position_of(factor.T_a_b.translation()), turn_of(factor.T_a_b), std::sqrt(weight) * square_root(factor.information)}),
      nullptr, x.p[a].data(), x.q[a].data(), x.p[b].data(), x.q[b].data());
}

void build(ceres::Problem& problem, Variables& x, const graph::PoseGraph& graph) {
  for (std::size_t i = 0; i < graph.size(); ++i) {
    x.p.push_back(position_of(graph.node(i).T_map_base.translation()));
    x.q.push_back(turn_of(graph.node(i).T_map_base));
  }
  if (graph.alignment()) {
    x.p_map_enu = position_of(graph.alignment()->p_map_enu);
    x.yaw = graph.alignment()->yaw_rad;
  }
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const graph::Node& node = graph.node(i);
    problem.AddParameterBlock(x.p[i].data(), 3);
    problem.AddParameterBlock(x.q[i].data(), 4, new ceres::QuaternionManifold);
    if (i > 0) {
      add_between(problem, x, i - 1, i, node.odometry, 1.0);
    }
    if (node.gravity) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Gravity, 3, 4>(
                                   new Gravity{position_of(node.gravity->up_base), 1.0 / node.gravity->std_rad}),
                               nullptr, x.q[i].data());
    }
    if (node.fix && graph.alignment()) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Fix, 3, 3, 4, 3, 1>(new Fix{*node.fix, node.fix_weight}),
                               nullptr, x.p[i].data(), x.q[i].data(), x.p_map_enu.data(), &x.yaw);
    }
  }
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    const graph::Loop& loop = graph.loop(k);
    if (loop.enabled) {
      add_between(problem, x, graph.index_of(loop.a), graph.index_of(loop.b), loop.factor, loop.weight);
    }
  }
  for (std::size_t k = 0; k < graph.priors(); ++k) {
    const graph::PriorFactor& prior = graph.prior(k);
    const std::size_t i = graph.index_of(graph.prior_keyframe(k));
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Prior, 6, 3, 4>(
            new Prior{position_of(prior.T_map_base.translation()), turn_of(prior.T_map_base), square_root(prior.information)}),
        nullptr, x.p[i].data(), x.q[i].data());
  }
}

}  // namespace

std::optional<CeresResult> solve_with_ceres(graph::PoseGraph& graph, int max_iterations, double tolerance) {
  Variables x;
  ceres::Problem problem;
  build(problem, x, graph);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = tolerance;
  options.gradient_tolerance = tolerance;
  options.parameter_tolerance = tolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  const double begin = cpu_s();
  ceres::Solve(options, &problem, &summary);
  const CeresResult result{summary.num_successful_steps + summary.num_unsuccessful_steps, summary.final_cost,
                           cpu_s() - begin};
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const auto& [w, qx, qy, qz] = x.q[i];
    graph.set_pose(i, Se3(Eigen::Quaterniond(w, qx, qy, qz), Eigen::Vector3d(x.p[i].data())));
  }
  if (graph.alignment()) {
    graph.set_alignment({x.yaw, Eigen::Vector3d(x.p_map_enu.data())});
  }
  return result;
}

}  // namespace slamd::pose_graphs
