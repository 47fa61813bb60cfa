#include "lcp/fold.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rounding = 1e-13;  // relative, between numbers that should be opposites
constexpr std::size_t most_runs = 8;  // of neighbouring columns that are searched for one by one

struct Entry {
    int index;
    double value;
};

bool opposite(double a, double b, double scale) { return std::abs(a + b) <= rounding * scale; }
bool equal(double a, double b) { return std::abs(a - b) <= rounding * std::abs(a); }

/// Finds the patterns; what it is not sure of stays as it is.
class Folder {
public:
    explicit Folder(const LcpProblem& problem) : problem_(problem), n_(problem.size()), role_(n_, plain), unknown_of_(n_) {
        for (int i = 0; i < n_; ++i) unknown_of_[i] = {.row = i, .upper = infinity};
    }

    void find_patterns() {
        find_candidates();
        for (const int k : candidates_) recognise(k);
        unfold_chains();
    }

    void unfold_pairs(const std::vector<int>& columns) {
        for (const int i : columns)
            if (role_[i] == first) unfold(i);
        unfold_chains();
    }

    std::vector<FoldedUnknown> unknowns() const {
        std::vector<FoldedUnknown> kept;
        for (int i = 0; i < n_; ++i)
            if (role_[i] == plain || role_[i] == first) kept.push_back(unknown_of_[i]);
        return kept;
    }

private:
    enum Role : char { plain, first, second, slack };  // first: capped, or i of a pair

    /// Rows without diagonal and with at most three entries, and what their columns hold.
    void find_candidates() {
        std::vector<int> place(n_, -1);
        for (int k = 0; k < n_; ++k) {
            const int size = problem_.M.outerIndexPtr()[k + 1] - problem_.M.outerIndexPtr()[k];
            if (size == 0 || size > 3 || problem_.q[k] < 0) continue;
            bool has_diagonal = false;
            for (LcpMatrix::InnerIterator entry(problem_.M, k); entry; ++entry) has_diagonal |= entry.col() == k;
            if (has_diagonal) continue;
            place[k] = static_cast<int>(candidates_.size());
            candidates_.push_back(k);
        }
        columns_.resize(candidates_.size());
        if (candidates_.empty()) return;
        // candidates come in runs of neighbours: a row is searched for their ends, not read entry by entry
        std::vector<std::pair<int, int>> runs;
        for (const int k : candidates_)
            if (runs.empty() || runs.back().second != k) runs.push_back({k, k + 1});
            else ++runs.back().second;
        if (runs.size() > most_runs) runs = {{candidates_.front(), candidates_.back() + 1}};
        const int* column = problem_.M.innerIndexPtr();
        for (int i = 0; i < n_; ++i) {
            const int* end = column + problem_.M.outerIndexPtr()[i + 1];
            const int* entry = column + problem_.M.outerIndexPtr()[i];
            for (const auto& [first_of_run, end_of_run] : runs)
                for (entry = std::lower_bound(entry, end, first_of_run); entry != end && *entry < end_of_run; ++entry)
                    if (const int k = place[*entry]; k >= 0 && columns_[k].size() < 4) columns_[k].push_back({i, problem_.M.valuePtr()[entry - column]});
        }
    }

    void recognise(int k) {
        std::vector<Entry> down, up;  // entries of row k
        for (LcpMatrix::InnerIterator entry(problem_.M, k); entry; ++entry)
            (entry.value() < 0 ? down : up).push_back({static_cast<int>(entry.col()), entry.value()});
        const std::vector<Entry>& column = columns_[std::lower_bound(candidates_.begin(), candidates_.end(), k) - candidates_.begin()];
        if (down.size() == 1 && up.empty()) recognise_cap(k, down[0], column);
        if (down.size() == 2 && up.size() <= 1) recognise_pair(k, down[0], down[1], up, column);
    }

    void recognise_cap(int k, const Entry& down, const std::vector<Entry>& column) {
        const int i = down.index;
        if (column.size() != 1 || column[0].index != i || column[0].value <= 0 || role_[i] != plain || role_[k] != plain) return;
        if (unknown_of_[i].upper < infinity) return;
        unknown_of_[i] = {.row = i, .slack = k, .upper = -problem_.q[k] / down.value, .slack_factor = column[0].value};
        role_[i] = first;
        role_[k] = slack;
    }

    void recognise_pair(int k, const Entry& a, const Entry& b, const std::vector<Entry>& up, const std::vector<Entry>& column) {
        const int i = a.index, j = b.index;
        if (role_[i] != plain || role_[j] != plain || role_[k] != plain || !equal(a.value, b.value)) return;
        double c = 0, other_c = 0;
        std::vector<Entry> fed;
        for (const Entry& entry : column)
            if (entry.index == i) c = entry.value;
            else if (entry.index == j) other_c = entry.value;
            else fed.push_back(entry);
        if (!(c > 0) || !equal(c, other_c) || fed.size() > 1 || !opposite_rows(i, j, k)) return;
        FoldedUnknown u{.row = i, .opposite = j, .slack = k, .two_sided = true, .upper = -problem_.q[k] / a.value, .slack_factor = c};
        if (!up.empty()) u.bound_by = up[0].index, u.bound_factor = -up[0].value / a.value;
        if (!fed.empty()) u.feeds = fed[0].index, u.feed_factor = fed[0].value / c;
        unknown_of_[i] = u;
        role_[i] = first;
        role_[j] = second;
        role_[k] = slack;
    }

    /// Rows i and j are opposite but for column k.
    bool opposite_rows(int i, int j, int k) const {
        const LcpMatrix& M = problem_.M;
        const int a = M.outerIndexPtr()[i], b = M.outerIndexPtr()[j], size = M.outerIndexPtr()[i + 1] - a;
        if (M.outerIndexPtr()[j + 1] - b != size) return false;
        const int* columns = M.innerIndexPtr() + a;
        if (!std::equal(columns, columns + size, M.innerIndexPtr() + b)) return false;
        const int place_of_k = static_cast<int>(std::lower_bound(columns, columns + size, k) - columns);
        double scale = 0, largest_sum = 0;
        const auto take = [&](int from, int count) {
            if (count <= 0) return;
            const Eigen::Map<const Eigen::ArrayXd> of_i(M.valuePtr() + a + from, count), of_j(M.valuePtr() + b + from, count);
            scale = std::max(scale, of_i.abs().maxCoeff());
            largest_sum = std::max(largest_sum, (of_i + of_j).abs().maxCoeff());
        };
        take(0, place_of_k);
        take(place_of_k + 1, size - place_of_k - 1);
        return largest_sum <= rounding * scale && opposite(problem_.q[i], problem_.q[j], std::abs(problem_.q[i]));
    }

    void unfold(int i) {
        const FoldedUnknown u = unknown_of_[i];
        for (const int row : {i, u.opposite, u.slack}) {
            if (row < 0) continue;
            role_[row] = plain;
            unknown_of_[row] = {.row = row, .upper = infinity};
        }
    }

    /// A bound may depend on, and a slack may feed, only unknowns that are themselves no pair.
    void unfold_chains() {
        const auto simple = [&](int i) { return i < 0 || role_[i] == plain || (role_[i] == first && !unknown_of_[i].two_sided); };
        for (bool changed = true; changed;) {
            changed = false;
            for (int i = 0; i < n_; ++i)
                if (role_[i] == first && unknown_of_[i].two_sided && !(simple(unknown_of_[i].bound_by) && simple(unknown_of_[i].feeds))) {
                    unfold(i);
                    changed = true;
                }
        }
    }

    const LcpProblem& problem_;
    int n_;
    std::vector<Role> role_;
    std::vector<FoldedUnknown> unknown_of_;
    std::vector<int> candidates_;
    std::vector<std::vector<Entry>> columns_;
};

/// Rows and columns of the unknowns, scaled by a D such that D M D has ones on the diagonal, or of the largest entry where there is none.
/// Powers of two, which round nothing. `place` is the folded index of a row of the LCP, -1 where it has none. Returns the columns i of
/// pairs whose columns i and j are not opposite in one of these rows: they may not be folded.
std::vector<int> take_and_scale(const LcpProblem& problem, const std::vector<int>& place, FoldedLcp& folded) {
    const int n = static_cast<int>(folded.unknowns.size());
    const LcpMatrix& M = problem.M;
    Eigen::VectorXd& factor = folded.factor = Eigen::VectorXd::Zero(n);
    for (int i = 0; i < n; ++i)
        if (const double diagonal = std::abs(M.coeff(folded.unknowns[i].row, folded.unknowns[i].row)); diagonal > 0)
            factor[i] = std::exp2(-std::round(0.5 * std::log2(diagonal)));
    for (int i = 0; i < n; ++i) {
        if (factor[i] > 0) continue;
        double largest = 0;
        for (LcpMatrix::InnerIterator entry(M, folded.unknowns[i].row); entry; ++entry)
            if (const int j = place[entry.col()]; j >= 0) largest = std::max(largest, std::abs(entry.value()) * (factor[j] > 0 ? factor[j] : 1.0));
        factor[i] = largest > 0 ? std::exp2(-std::round(std::log2(largest))) : 1.0;
    }
    struct Column {
        int place = -1;               // in the folded problem
        int mate = -1, leader = -1;   // of a column of a pair: the other, and i
        double factor = 0;
    };
    std::vector<Column> columns(problem.size());  // in one piece: this loop over all entries is what folding costs
    for (int c = 0; c < problem.size(); ++c) columns[c].place = place[c], columns[c].factor = place[c] >= 0 ? factor[place[c]] : 0.0;
    for (const FoldedUnknown& u : folded.unknowns)
        if (u.two_sided) {
            columns[u.row].mate = u.opposite;
            columns[u.opposite].mate = u.row;
            columns[u.row].leader = columns[u.opposite].leader = u.row;
        }
    std::vector<int> not_opposite;
    folded.q.resize(n);
    folded.M.resize(n, n);
    folded.M.resizeNonZeros(M.nonZeros());
    int* const kept_columns = folded.M.innerIndexPtr();
    double* const kept_values = folded.M.valuePtr();
    int n_entries = 0;
    for (int i = 0; i < n; ++i) {
        const int row = folded.unknowns[i].row;
        const double row_factor = factor[i];
        folded.q[i] = row_factor * problem.q[row];
        folded.M.outerIndexPtr()[i] = n_entries;
        const auto keep = [&](const Column& column, double value) {
            kept_columns[n_entries] = column.place;
            kept_values[n_entries++] = row_factor * column.factor * value;
        };
        for (int e = M.outerIndexPtr()[row], end = M.outerIndexPtr()[row + 1]; e < end; ++e) {
            const int c = M.innerIndexPtr()[e];
            const Column& column = columns[c];
            const double value = M.valuePtr()[e];
            if (column.mate < 0) {
                if (column.place >= 0) keep(column, value);
                continue;
            }
            const bool follows = e + 1 < end && M.innerIndexPtr()[e + 1] == column.mate;
            const double of_mate = follows ? M.valuePtr()[e + 1] : M.coeff(row, column.mate);
            if (!opposite(value, of_mate, std::abs(value))) not_opposite.push_back(column.leader);
            if (column.place >= 0) keep(column, value);
            else if (follows) keep(columns[column.mate], of_mate);
            e += follows;
        }
    }
    folded.M.outerIndexPtr()[n] = n_entries;
    folded.M.resizeNonZeros(n_entries);
    const double largest = n > 0 ? folded.q.cwiseAbs().maxCoeff() : 0.0;
    if (largest > 0) folded.unit = std::exp2(std::round(std::log2(largest)));
    folded.q /= folded.unit;
    return not_opposite;
}

}  // namespace

Eigen::VectorXd FoldedLcp::value(const Eigen::VectorXd& x) const {
    Eigen::VectorXd F = linear_part(x);
    for (int i = 0; i < size(); ++i)
        if (unknowns[i].feeds >= 0) F[unknowns[i].feeds] += unknowns[i].feed_factor * std::abs(F[i]);
    return F;
}

Eigen::VectorXd FoldedLcp::natural_map(const Eigen::VectorXd& x, const Eigen::VectorXd& F) const {
    Eigen::VectorXd map(size());
    for (int i = 0; i < size(); ++i) {
        const double b = upper(i, x);
        map[i] = x[i] - std::clamp(x[i] - F[i], lower(i, b), b);
    }
    return map;
}

Eigen::VectorXd FoldedLcp::folded(const Eigen::VectorXd& z) const {
    Eigen::VectorXd x(size());
    for (int i = 0; i < size(); ++i) {
        const FoldedUnknown& u = unknowns[i];
        x[i] = (z[u.row] - (u.two_sided ? z[u.opposite] : 0.0)) / (unit * factor[i]);
    }
    return x;
}

Eigen::VectorXd FoldedLcp::unfolded(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd F = value(x);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n_original);
    for (int i = 0; i < size(); ++i) {
        const FoldedUnknown& u = unknowns[i];
        const double b = upper(i, x), kept = unit * factor[i] * std::clamp(x[i], lower(i, b), b), rate = unit * F[i] / factor[i];
        z[u.row] = std::max(0.0, kept);
        if (u.two_sided) z[u.opposite] = std::max(0.0, -kept);
        if (u.two_sided) z[u.slack] = std::abs(rate) / u.slack_factor;
        else if (u.slack >= 0) z[u.slack] = x[i] - F[i] > b ? std::max(0.0, -rate) / u.slack_factor : 0.0;
    }
    return z;
}

FoldedLcp fold(const LcpProblem& problem) {
    FoldedLcp result;
    result.n_original = problem.size();
    Folder folder(problem);
    folder.find_patterns();
    std::vector<int> place;
    for (std::vector<int> not_opposite{-1}; !not_opposite.empty();) {
        result.unknowns = folder.unknowns();
        place.assign(problem.size(), -1);
        for (std::size_t i = 0; i < result.unknowns.size(); ++i) place[result.unknowns[i].row] = static_cast<int>(i);
        not_opposite = take_and_scale(problem, place, result);
        folder.unfold_pairs(not_opposite);
    }
    const int n = static_cast<int>(result.unknowns.size());
    result.fed_by.resize(n);
    for (int i = 0; i < n; ++i) {
        FoldedUnknown& u = result.unknowns[i];
        u.upper /= result.unit * result.factor[i];
        if (u.bound_by >= 0) {
            u.bound_by = place[u.bound_by];
            u.bound_factor *= result.factor[u.bound_by] / result.factor[i];
        }
        if (u.feeds >= 0) {
            u.feeds = place[u.feeds];
            u.feed_factor *= result.factor[u.feeds] / result.factor[i];
            result.fed_by[u.feeds].push_back(i);
        }
    }
    return result;
}

}  // namespace knap
