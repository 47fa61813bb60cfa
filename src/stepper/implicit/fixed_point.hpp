#pragma once
// The iteration x <- g(x) of a step with large rotations, whose error a few motions (the bending of a slender part)
// decay slowly: each next point is the one for which the changes so far cancel most of g(x) - x (D. G. Anderson, J. ACM
// 12 (1965) 547).
#include "base/vec.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <vector>

namespace knap {

class FixedPoint {
public:
    void begin() { n_ = 0; }
    /// From x and g(x) to the next x, the same number of vectors as before.
    void advance(const std::vector<Vec2>& image, std::vector<Vec2>& x) {
        const Eigen::Map<const Eigen::VectorXd> g(image.data()->data(), 2 * std::ssize(image));
        Eigen::Map<Eigen::VectorXd> at(x.data()->data(), 2 * std::ssize(x));
        const Eigen::VectorXd lack = g - at;
        if (lack.isZero(0)) return begin();  // the solution had nothing to do
        if (lack_changes_.rows() != g.size())
            lack_changes_.resize(g.size(), depth), image_changes_.resize(g.size(), depth), n_ = 0;
        if (n_ > 0) {
            const int column = (n_ - 1) % depth;
            lack_changes_.col(column) = lack - lack_;
            image_changes_.col(column) = g - image_;
        }
        lack_ = lack, image_ = g, at = g;
        if (const int m = std::min(n_, depth); m > 0) {
            Eigen::ColPivHouseholderQR<Eigen::MatrixXd> changes;
            changes.setThreshold(1e-6);
            const Eigen::VectorXd part = changes.compute(lack_changes_.leftCols(m)).solve(lack);
            if (part.allFinite()) at -= image_changes_.leftCols(m) * part;
        }
        ++n_;
    }

private:
    static constexpr int depth = 5;

    int n_ = 0;  // points so far
    Eigen::VectorXd lack_, image_;
    Eigen::MatrixXd lack_changes_, image_changes_;
};

}  // namespace knap
