#include "tools/pose_graphs/ceres_peer.hpp"

#include <cmath>
#include <ctime>
#include <vector>

#include <Eigen/Eigenvalues>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

namespace slamd::pose_graphs {

namespace {

using geometry::Matrix6d;
using geometry::Se3;

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <typename T>
using Quaternion = Eigen::Quaternion<T>;

/// The square root of an information, which may be zero along some axes: Sᵀ S = Ω.
Matrix6d square_root(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

/// Log of a rotation, by Ceres's own function.
template <typename T>
Vector3<T> log_of(const Quaternion<T>& q) {
  const T wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
  Vector3<T> out;
  ceres::QuaternionToAngleAxis(wxyz, out.data());
  return out;
}

struct Between {
  Vector3<double> p_a_b;
  Quaternion<double> q_a_b;
  Matrix6d root;

  template <typename T>
  bool operator()(const T* p_a, const T* q_a, const T* p_b, const T* q_b, T* out) const {
    const Eigen::Map<const Quaternion<T>> R_a(q_a);
    const Eigen::Map<const Quaternion<T>> R_b(q_b);
    const Vector3<T> between = Eigen::Map<const Vector3<T>>(p_b) - Eigen::Map<const Vector3<T>>(p_a);
    Eigen::Matrix<T, 6, 1> r;
    r.template head<3>() = R_a.conjugate() * between - p_a_b.cast<T>();
    r.template tail<3>() = log_of<T>(q_a_b.conjugate().cast<T>() * (R_a.conjugate() * R_b));
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{out} = root.cast<T>() * r;
    return true;
  }
};

struct Prior {
  Vector3<double> p;
  Quaternion<double> q;
  Matrix6d root;

  template <typename T>
  bool operator()(const T* p_base, const T* q_base, T* out) const {
    Eigen::Matrix<T, 6, 1> r;
    r.template head<3>() = Eigen::Map<const Vector3<T>>(p_base) - p.cast<T>();
    r.template tail<3>() = log_of<T>(q.conjugate().cast<T>() * Eigen::Map<const Quaternion<T>>(q_base));
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{out} = root.cast<T>() * r;
    return true;
  }
};

struct Gravity {
  Vector3<double> up_base;
  double root;

  template <typename T>
  bool operator()(const T* q_base, T* out) const {
    // The part of up across up_base: its three components have the length of the two in the tangent plane.
    const Vector3<T> up = Eigen::Map<const Quaternion<T>>(q_base).conjugate() * Vector3<T>(T(0.0), T(0.0), T(1.0));
    const Vector3<T> measured = up_base.cast<T>();
    Eigen::Map<Vector3<T>>{out} = T(root) * (up - measured * measured.dot(up));
    return true;
  }
};

struct Fix {
  graph::GnssFactor factor;
  double weight;

  template <typename T>
  bool operator()(const T* p_base, const T* q_base, const T* p_enu, const T* yaw, T* out) const {
    const T c = cos(yaw[0]);
    const T s = sin(yaw[0]);
    const Vector3<T> measured(c * factor.p_enu.x() - s * factor.p_enu.y(), s * factor.p_enu.x() + c * factor.p_enu.y(),
                              T(factor.p_enu.z()));
    const Vector3<T> r = Eigen::Map<const Vector3<T>>(p_base) +
                         Eigen::Map<const Quaternion<T>>(q_base) * factor.p_base_antenna.cast<T>() -
                         Eigen::Map<const Vector3<T>>(p_enu) - measured;
    const double w = std::sqrt(weight);
    out[0] = w / factor.horizontal_std_m * r.x();
    out[1] = w / factor.horizontal_std_m * r.y();
    out[2] = w / factor.vertical_std_m * r.z();
    return true;
  }
};

double cpu_now_s() {
  std::timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The variables as Ceres moves them.
struct Variables {
  std::vector<Vector3<double>> p;
  std::vector<Quaternion<double>> q;
  Vector3<double> p_map_enu = Vector3<double>::Zero();
  double yaw = 0.0;
};

void add_between(ceres::Problem& problem, Variables& x, std::size_t a, std::size_t b, const graph::BetweenFactor& factor,
                 double weight) {
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<Between, 6, 3, 4, 3, 4>(new Between{
          factor.T_a_b.translation(), factor.T_a_b.quaternion(), std::sqrt(weight) * square_root(factor.information)}),
      nullptr, x.p[a].data(), x.q[a].coeffs().data(), x.p[b].data(), x.q[b].coeffs().data());
}

void build(ceres::Problem& problem, Variables& x, const graph::PoseGraph& graph) {
  for (std::size_t i = 0; i < graph.size(); ++i) {
    x.p.push_back(graph.node(i).T_map_base.translation());
    x.q.push_back(graph.node(i).T_map_base.quaternion());
  }
  if (graph.alignment()) {
    x.p_map_enu = graph.alignment()->p_map_enu;
    x.yaw = graph.alignment()->yaw_rad;
  }
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const graph::Node& node = graph.node(i);
    problem.AddParameterBlock(x.p[i].data(), 3);
    problem.AddParameterBlock(x.q[i].coeffs().data(), 4, new ceres::EigenQuaternionManifold);
    if (i > 0) {
      add_between(problem, x, i - 1, i, node.odometry, 1.0);
    }
    if (node.gravity) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Gravity, 3, 4>(
                                   new Gravity{node.gravity->up_base, 1.0 / node.gravity->std_rad}),
                               nullptr, x.q[i].coeffs().data());
    }
    if (node.fix && graph.alignment()) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Fix, 3, 3, 4, 3, 1>(new Fix{*node.fix, node.fix_weight}),
                               nullptr, x.p[i].data(), x.q[i].coeffs().data(), x.p_map_enu.data(), &x.yaw);
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
            new Prior{prior.T_map_base.translation(), prior.T_map_base.quaternion(), square_root(prior.information)}),
        nullptr, x.p[i].data(), x.q[i].coeffs().data());
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
  const double begin = cpu_now_s();
  ceres::Solve(options, &problem, &summary);
  const CeresResult result{summary.num_successful_steps + summary.num_unsuccessful_steps, summary.final_cost,
                           cpu_now_s() - begin};
  for (std::size_t i = 0; i < graph.size(); ++i) {
    graph.set_pose(i, Se3(x.q[i], x.p[i]));
  }
  if (graph.alignment()) {
    graph.set_alignment({x.yaw, x.p_map_enu});
  }
  return result;
}

}  // namespace slamd::pose_graphs
