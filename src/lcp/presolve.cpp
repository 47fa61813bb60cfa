#include "lcp/presolve.hpp"

#include "base/vec.hpp"
#include "lcp/linear_system.hpp"
#include "lcp/rows.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double equal_numbers = 1e-13;  // relative difference of numbers that count as equal

using Entries = std::vector<std::pair<int, double>>;  // index and value
constexpr std::size_t max_entries = 3;                // of a row that states a bound, and of its column

/// Whether rows i and j have the same pattern and opposite entries, apart from the column `ignored`.
bool are_opposite_rows(const LcpMatrix& M, int i, int j, int ignored) {
    const LcpRow a = row_of(M, i), b = row_of(M, j);
    if (!std::ranges::equal(a.columns, b.columns)) return false;
    double scale = 0, largest_sum = 0;
    const auto compare = [&](std::ptrdiff_t first, std::ptrdiff_t end) {
        if (first >= end) return;
        const RowValues in_a(a.values.data() + first, end - first), in_b(b.values.data() + first, end - first);
        scale = std::max(scale, in_a.abs().maxCoeff());
        largest_sum = std::max(largest_sum, (in_a + in_b).abs().maxCoeff());
    };
    const auto place = std::ranges::lower_bound(a.columns, ignored) - a.columns.begin(), size = std::ssize(a.columns);
    compare(0, place);
    compare(place < size && a.columns[place] == ignored ? place + 1 : place, size);
    return largest_sum <= equal_numbers * scale;
}

bool equal(double a, double b) { return std::abs(a - b) <= equal_numbers * std::abs(a); }

/// Finds the two patterns. Rows that fit neither stay as they are. A dense matrix is read twice, and never transposed.
class Patterns {
public:
    explicit Patterns(const LcpProblem& problem)
        : M_(problem.M), q_(problem.q), role_(q_.size(), plain), unknown_of_(q_.size()) {
        for (int i = 0; i < q_.size(); ++i) unknown_of_[i] = {.row = i, .upper = infinity};
    }

    void recognise() {
        find_candidates();
        for (const Candidate& candidate : candidates_) recognise(candidate);
        undo_pairs_with_other_columns();
        undo_chains();
    }

    std::vector<BoxUnknown> unknowns() const {
        std::vector<BoxUnknown> kept;
        std::vector<int> place(q_.size(), -1);
        for (int i = 0; i < q_.size(); ++i)
            if (role_[i] == plain || role_[i] == first)
                place[i] = static_cast<int>(kept.size()), kept.push_back(unknown_of_[i]);
        for (BoxUnknown& u : kept) {
            if (u.bound_by >= 0) u.bound_by = place[u.bound_by];
            if (u.feeds >= 0) u.feeds = place[u.feeds];
        }
        return kept;
    }

private:
    enum Role : char { plain, first, second, slack };  // first: capped, or i of a pair

    struct Candidate {
        int k;  // may state a bound: has no diagonal entry, and at most three others
        Entries row = {}, column = {};
    };

    void find_candidates() {
        std::vector<int> place(q_.size(), -1);
        for (int k = 0; k < q_.size(); ++k) {
            const auto [columns, values] = row_of(M_, k);
            if (columns.empty() || columns.size() > max_entries || q_[k] < 0) continue;
            if (std::ranges::find(columns, k) != columns.end()) continue;
            place[k] = static_cast<int>(candidates_.size());
            Candidate& candidate = candidates_.emplace_back(Candidate{.k = k});
            for (std::size_t e = 0; e < columns.size(); ++e) candidate.row.emplace_back(columns[e], values[e]);
        }
        if (candidates_.empty()) return;
        const ColumnSet of_candidates(static_cast<int>(q_.size()), [&](int k) { return place[k] >= 0; });
        for (int i = 0; i < q_.size(); ++i) {
            const LcpRow row = row_of(M_, i);
            of_candidates.for_each(row, [&](int e) {
                if (Entries& column = candidates_[place[row.columns[e]]].column; column.size() <= max_entries)
                    column.emplace_back(i, row.values[e]);
            });
        }
    }

    void recognise(const Candidate& candidate) {
        const auto& [k, row, column] = candidate;
        if (column.empty() || column.size() > max_entries || role_[k] != plain) return;
        Entries negative, positive;
        for (const auto& [j, value] : row) (value < 0 ? negative : positive).emplace_back(j, value);
        if (negative.size() == 1 && positive.empty()) recognise_cap(k, negative[0].first, -negative[0].second, column);
        if (negative.size() == 2 && positive.size() <= 1 && equal(negative[0].second, negative[1].second))
            recognise_pair(k, negative[0].first, negative[1].first, -negative[0].second, positive, column);
    }

    void recognise_cap(int k, int i, double a, const Entries& column) {
        if (column.size() != 1 || column[0].first != i || column[0].second <= 0 || role_[i] != plain) return;
        unknown_of_[i] = {.row = i, .slack = k, .upper = q_[k] / a, .slack_factor = column[0].second};
        role_[i] = first;
        role_[k] = slack;
    }

    void recognise_pair(int k, int i, int j, double a, const Entries& positive, const Entries& column) {
        if (role_[i] != plain || role_[j] != plain) return;
        BoxUnknown u{.row = i, .opposite = j, .slack = k, .two_sided = true, .upper = q_[k] / a};
        double factor_of_j = 0;
        int n_fed = 0;
        for (const auto& [row, value] : column)
            if (row == i) u.slack_factor = value;
            else if (row == j) factor_of_j = value;
            else u.feeds = row, u.feed_factor = value, ++n_fed;
        if (!(u.slack_factor > 0) || !equal(u.slack_factor, factor_of_j) || n_fed > 1) return;
        if (std::abs(q_[i] + q_[j]) > equal_numbers * std::abs(q_[i])) return;
        if (!are_opposite_rows(M_, i, j, k)) return;
        u.feed_factor /= u.slack_factor;
        if (!positive.empty()) u.bound_by = positive[0].first, u.bound_factor = positive[0].second / a;
        unknown_of_[i] = u;
        role_[i] = first;
        role_[j] = second;
        role_[k] = slack;
    }

    void undo(int i) {
        const BoxUnknown u = unknown_of_[i];
        for (const int row : {u.row, u.opposite, u.slack}) {
            role_[row] = plain;
            unknown_of_[row] = {.row = row, .upper = infinity};
        }
    }

    bool is_pair(int i) const { return role_[i] == first && unknown_of_[i].two_sided; }

    /// Undoes pairs whose columns i and j are not opposite, apart from the row of their bound. Rows j say what rows i
    /// say.
    void undo_pairs_with_other_columns() {
        const auto n = q_.size();
        std::vector<int> pair_of(n, -1);  // of a column: i of its pair
        for (int i = 0; i < n; ++i)
            if (is_pair(i)) pair_of[i] = pair_of[unknown_of_[i].opposite] = i;
        const ColumnSet of_pairs(static_cast<int>(n), [&](int c) { return pair_of[c] >= 0; });
        // The entry in the column of a pair that comes first in a row waits for that in the other one.
        Eigen::VectorXd scale = Eigen::VectorXd::Zero(n), largest_sum = scale, waiting = scale;
        for (int r = 0; r < n; ++r) {
            if (role_[r] == second) continue;
            const LcpRow row = row_of(M_, r);
            const auto [columns, values] = row;
            const auto size = static_cast<int>(row.size());
            const auto settle = [&](int i, double sum) {
                if (unknown_of_[i].slack != r) largest_sum[i] = std::max(largest_sum[i], std::abs(sum));
                waiting[i] = 0;
            };
            int n_waiting = 0;
            for (int e = of_pairs.first(row, 0); e < size; e = of_pairs.first(row, e + 1)) {
                const int i = pair_of[columns[e]];
                if (role_[r] != slack && e + 1 < size && pair_of[columns[e + 1]] == i) {  // most are neighbours
                    const double a = values[e++], b = values[e];
                    scale[i] = std::max(scale[i], std::max(std::abs(a), std::abs(b)));
                    largest_sum[i] = std::max(largest_sum[i], std::abs(a + b));
                    continue;
                }
                if (values[e] == 0) continue;
                if (unknown_of_[i].slack != r) scale[i] = std::max(scale[i], std::abs(values[e]));
                if (waiting[i] != 0) settle(i, waiting[i] + values[e]), --n_waiting;
                else waiting[i] = values[e], ++n_waiting;
            }
            for (int e = 0; e < size && n_waiting > 0; ++e)  // the other entry is 0
                if (const int i = pair_of[columns[e]]; i >= 0 && waiting[i] != 0) settle(i, waiting[i]), --n_waiting;
        }
        for (int i = 0; i < n; ++i)
            if (is_pair(i) && largest_sum[i] > equal_numbers * scale[i]) undo(i);
    }

    /// A bound may depend on, and a slack may feed, only unknowns that are not two-sided themselves.
    void undo_chains() {
        const auto is_simple = [&](int i) {
            return i < 0 || role_[i] == plain || (role_[i] == first && !unknown_of_[i].two_sided);
        };
        for (bool changed = true; changed;) {
            changed = false;
            for (int i = 0; i < q_.size(); ++i) {
                if (!is_pair(i) || (is_simple(unknown_of_[i].bound_by) && is_simple(unknown_of_[i].feeds))) continue;
                undo(i);
                changed = true;
            }
        }
    }

    const LcpMatrix& M_;
    const Eigen::VectorXd& q_;
    std::vector<Role> role_;
    std::vector<BoxUnknown> unknown_of_;
    std::vector<Candidate> candidates_;
};

BoxLcp box_form(const LcpProblem& problem, bool eliminates_bounds) {
    Patterns patterns(problem);
    if (eliminates_bounds) patterns.recognise();
    BoxLcp box{.unknowns = patterns.unknowns(), .n_original = problem.size()};
    std::vector<int> rows;
    for (const BoxUnknown& u : box.unknowns) rows.push_back(u.row);
    LcpProblem reduced{submatrix(problem.M, rows), problem.q(rows)};
    box.scaling = equilibrate(reduced);
    box.M.swap(reduced.M);
    box.q.swap(reduced.q);
    const auto& [factor, unit] = box.scaling;
    box.fed_by.resize(rows.size());
    for (int i = 0; i < box.size(); ++i) {
        BoxUnknown& u = box.unknowns[i];
        u.upper /= unit * factor[i];
        if (u.bound_by >= 0) u.bound_factor *= factor[u.bound_by] / factor[i];
        if (u.feeds < 0) continue;
        u.feed_factor *= factor[u.feeds] / factor[i];
        box.fed_by[u.feeds].push_back(i);
    }
    return box;
}

}  // namespace

BoxLcp presolve(const LcpProblem& problem) { return box_form(problem, true); }

BoxLcp without_presolve(const LcpProblem& problem) { return box_form(problem, false); }

bool BoxLcp::has_positive_diagonal() const { return size() == 0 || Eigen::VectorXd(M.diagonal()).minCoeff() > 0; }

Eigen::VectorXd BoxLcp::value(const Eigen::VectorXd& x) const {
    Eigen::VectorXd F = product(M, x) + q;
    for (int i = 0; i < size(); ++i)
        if (unknowns[i].feeds >= 0) F[unknowns[i].feeds] += unknowns[i].feed_factor * std::abs(F[i]);
    return F;
}

Eigen::VectorXd BoxLcp::natural_map(const Eigen::VectorXd& x, const Eigen::VectorXd& F) const {
    Eigen::VectorXd map(size());
    for (int i = 0; i < size(); ++i) {
        const double b = upper(i, x);
        map[i] = std::clamp(F[i], x[i] - b, x[i] - lower(i, b));  // of x - (x - F) a large x would leave nothing
    }
    return map;
}

double BoxLcp::residual(const Eigen::VectorXd& x, const Eigen::VectorXd& F) const {
    if (size() == 0) return 0;
    return x.allFinite() ? natural_map(x, F).cwiseAbs().maxCoeff() : infinity;
}

Eigen::VectorXd BoxLcp::box_start(const Eigen::VectorXd& z) const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size());
    if (z.size() != n_original) return x;
    for (int i = 0; i < size(); ++i)
        x[i] = z[unknowns[i].row] - (unknowns[i].two_sided ? z[unknowns[i].opposite] : 0.0);
    return scaling.scaled_z(x);
}

Eigen::VectorXd BoxLcp::lcp_point(const Eigen::VectorXd& x, const Eigen::VectorXd& F) const {
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n_original);
    for (int i = 0; i < size(); ++i) {
        const BoxUnknown& u = unknowns[i];
        const double b = upper(i, x), rate = scaling.unit * F[i] / scaling.factor[i];
        const double inside = scaling.unit * scaling.factor[i] * std::clamp(x[i], lower(i, b), b);
        z[u.row] = std::max(0.0, inside);
        if (u.two_sided) z[u.opposite] = std::max(0.0, -inside);
        if (u.two_sided) z[u.slack] = std::abs(rate) / u.slack_factor;
        else if (u.slack >= 0) z[u.slack] = x[i] - F[i] > b ? std::max(0.0, -rate) / u.slack_factor : 0.0;
    }
    return z;
}

}  // namespace knap
