#pragma once
// The rates of free obstacles in an implicit step, W = theta V+ + (1 - theta) V:
//
//     M (V+ - V) = h F + Q(W) + sum along' P,     Q: wrench of the impulses of the body, solved for given rates
//     V = sum along W,     P in the theta law at V: rows, contacts with other obstacles and with what is held
//
// Q is piecewise linear, so this is solved by Newton's method on the few components that the body touches, with a slope
// of Q by differences. In each step the rows are one problem (nonsmooth/contact_cluster.hpp), in which these components
// have the body linearised as their mass, and those of all other obstacles their own.
#include "nonsmooth/contact_cluster.hpp"
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/common/obstacle_motion.hpp"
#include "stepper/contact/contact_row.hpp"
#include "stepper/implicit/active_point.hpp"

#include <functional>
#include <span>
#include <vector>

namespace knap {

class FreeObstacles {
public:
    /// Both must outlive it.
    FreeObstacles(const Model& model, ObstacleMotion& motion, const ObstacleContacts& contacts);

    /// Contacts between obstacles. False: nothing may touch a free one.
    bool begin(const StepContext& step);
    /// Of the body in its present solution: a point for each contact, and the rates of the nodes [m/s].
    struct Body {
        std::span<const ActivePoint> points;
        const std::vector<Vec2>& rate;
        const CornerPartition& nodes;
        double momentum;  // [N s] the scale to which its balance is solved
    };
    /// Solves the body at motion.rate().
    using Response = std::function<Body()>;
    /// Finds the rates of free obstacles that the body touches, from `body`, whose nodes are known.
    void solve(const Body& body, const Response& response);
    /// When the body is solved for good: wrenches, and the rates of obstacles that it does not touch.
    void finish(const Body& body);
    /// [-] Of the solution: relative to the largest impulse.
    double residual() const { return residual_; }
    /// [J] At most what its error works, where it is more than max_residual of the impulses of obstacles.
    double residual_work() const { return residual_work_; }

    /// [N s, N s, N m s] of all contacts on each obstacle.
    const std::vector<Vec3>& wrenches() const { return wrench_; }
    /// Subtracts what the rows press on held nodes from theta times the impulses that these need [N s, per node].
    void subtract_impulses(const CornerPartition& nodes, std::vector<Vec2>& of_node) const;
    bool presses_on_held() const;
    void account(StepReport& report) const;

private:
    struct Row : ContactRow {
        Index contact;              // with the body: into the contacts; -1: of two obstacles, or a support
        Vec2 given = Vec2::Zero();  // [m/s] V of the body
        int n_terms = 0;
        std::array<ClusterTerm, 2> terms;

        void add(const ClusterTerm& term) { terms[n_terms++] = term; }
        std::span<const ClusterTerm> on_obstacles() const { return std::span(terms).first(n_terms); }
    };
    using Matrix = Eigen::MatrixXd;
    using Vector = Eigen::VectorXd;
    struct Component {
        Index obstacle;
        int k;
        double root_mass;  // [sqrt(kg)] or [sqrt(kg) m], with damping
    };
    void add_held(const Body& body);
    void find_wrench(const Body& body);
    void solve_rows(const Matrix& B, const Vector& x_free);
    bool is_touched(Index obstacle) const {
        return std::ranges::any_of(place_[obstacle], [](Index c) { return c >= 0; });
    }
    static Vec2 rate_of(const Row& row, const std::vector<Vec3>& velocity);
    template <int max_components>
    double find_rates(const Response& response);

    const Model& model_;
    ObstacleMotion& motion_;
    const ObstacleContacts& contacts_;
    ObstaclePairs pairs_;
    const StepContext* step_ = nullptr;
    std::vector<Row> rows_;  // of pairs, then of what is held
    ContactCluster cluster_;
    std::vector<Vec3> without_contact_;  // W of all obstacles
    std::vector<Vec3> under_;            // W with the impulses of the rows
    std::vector<Vec3> trial_, wrench_, row_wrench_;
    std::vector<Component> free_;              // that the body touches
    std::vector<std::array<Index, 3>> place_;  // per obstacle: its components in free_, or -1
    std::vector<std::uint8_t> touched_;        // [0/1] per obstacle
    Matrix along_, answer_;                    // of two columns a row: its impulses on x, and the change of x by them
    Vector x_under_, pressed_;                 // [sqrt(kg) m/s] x and theta R/sqrt(M) of the rows
    double residual_ = 0;                      // [-]
    double residual_work_ = 0;                 // [J]
    double body_momentum_ = 0;                 // [N s] Body::momentum
    double rate_error_ = 0;                    // [m/s] of rows
};

}  // namespace knap
