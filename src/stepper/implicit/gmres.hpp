#pragma once
// GMRES without restart (Y. Saad, M. Schultz 1986): A x = b with A given by its products, for A close to the unit
// matrix. Memory is kept from one system to the next.
#include <Eigen/Core>
#include <Eigen/Jacobi>

#include <functional>
#include <vector>

namespace knap {

class Gmres {
public:
    using Product = std::function<void(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Ref<Eigen::VectorXd> A_x)>;

    /// False: the residual exceeds `tolerance` times |b| after `max_steps` products.
    bool solve(const Product& product, const Eigen::Ref<const Eigen::VectorXd>& b, int max_steps, double tolerance);
    auto solution() const { return x_.head(n_); }

private:
    Eigen::Index n_ = 0;  // size of this system; V, next and x may be larger
    Eigen::MatrixXd V_, H_;
    Eigen::VectorXd g_, next_, x_;
    std::vector<Eigen::JacobiRotation<double>> rotations_;
};

}  // namespace knap
